"""All problems of a sweep are reported at once, each one time, with its place."""

from pathlib import Path

import pytest

from rubnoise.scenario import limits
from tests.unit.sweeps import GRID, HEAD, sweep_of, sweep_refusal

START = HEAD.count("\n")


def _grid(line: str) -> str:
    return f"[sweep.grid]\n{line}\n"


@pytest.mark.parametrize(
    ("line", "said", "hint"),
    [
        ("interface.mean_junction_coun = [1]", "sweep.grid.interface.mean_junction_coun: unknown key",
         "did you mean interface.mean_junction_count?"),
        ("mean_junction_count = [1]", "sweep.grid.mean_junction_count: unknown key",
         "did you mean interface.mean_junction_count?"),
        ('"interface.mean_junction_count" = [1]', "sweep.grid.interface.mean_junction_count: unknown key",
         "write interface.mean_junction_count without quotation marks: a dotted key stands for its table"),
        ("slider.sped = [1]", "sweep.grid.slider.sped: unknown key", "did you mean sliding.speed?"),
        ("run.seed = [1, 2]", "sweep.grid.run.seed: is not swept",
         "seeds follow from run.seed, the point and the replicate; replicates = 4 makes four of each"),
        ('title = ["a"]', "sweep.grid.title: unknown key",
         "a key of a scenario with its table, such as interface.mean_junction_count"),
        ("interface.mean_junction_count = 10", "sweep.grid.interface.mean_junction_count: needs a list of values",
         "a list in brackets: interface.mean_junction_count = [..., ...]"),
        ("interface.mean_junction_count = []",
         "sweep.grid.interface.mean_junction_count: an empty list, which leaves no point",
         "give it values, or take the line away"),
        ("interface = [1]", "sweep.grid.interface: unknown key",
         "did you mean interface.mean_real_contact_area or interface.load?"),
    ],
)  # fmt: skip
def test_a_wrong_key_is_named_with_what_is_right(tmp_path: Path, line: str, said: str, hint: str) -> None:
    lines = sweep_refusal(tmp_path, _grid(line)).splitlines()
    assert lines[0] == f"s.toml:{START + 2}: error: {said}"
    assert lines[1] == f"    {line}"
    assert lines[3] == f"    {hint}"
    assert len(lines) == 4


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("[sweep]\nreplicates = 0\n", "sweep.replicates: must be above 0"),
        ("[sweep]\nreplicates = 2.5\n", "sweep.replicates: needs a whole number"),
        ("[sweep]\nreplicate = 2\n", "sweep.replicate: unknown key"),
        ("[sweep]\ngrid = 3\n", "sweep.grid: needs a table of keys"),
        ("[sweep]\nmean_junction_count = [1]\n", "sweep.mean_junction_count: unknown key"),
        ("[[sweep]]\nreplicates = 1\n", "sweep: needs a table"),
    ],
)
def test_a_wrong_table_is_refused(tmp_path: Path, table: str, said: str) -> None:
    assert f": error: {said}" in sweep_refusal(tmp_path, table).splitlines()[0]


def test_values_are_judged_as_the_key_judges_them_each_once(tmp_path: Path) -> None:
    table = GRID.replace("[10, 20, 30]", '[10, -3, "20", [1]]').replace('"100 um^2"', '"100 um"')
    report = sweep_refusal(tmp_path, table)
    heads = [line for line in report.splitlines() if ": error: " in line]
    assert heads == [
        f's.toml:{START + 4}: error: interface.mean_real_contact_area: "um" is the unit of a length, an area is needed',
        f"s.toml:{START + 5}: error: interface.mean_junction_count: must be above 0",
        f"s.toml:{START + 5}: error: interface.mean_junction_count: needs a number, not a text",
        f"s.toml:{START + 5}: error: interface.mean_junction_count: needs a number, not a list",
    ]
    assert (
        '    interface.mean_junction_count = [10, -3, "20", [1]]\n                                         ^^\n'
        in report
    )


def test_everything_is_told_at_once(tmp_path: Path) -> None:
    table = (
        GRID.replace("[10, 20, 30]", "[10, -3]").replace("replicates = 2", "replicates = 0") + "sliding.sped = [1]\n"
    )
    report = sweep_refusal(tmp_path, table, "sliding.distance=1 um^2", "output.tik=3")
    for said in (
        "sweep.replicates",
        "junction_count: must be above 0",
        "grid.sliding.sped",
        "sliding.distance",
        "output.tik",
    ):
        assert report.count(f"{said}: " if "above" not in said else said) == 1 + (
            said in {"sliding.distance", "output.tik"}
        ), said


def test_a_problem_of_the_file_is_told_as_in_a_file_of_its_own(tmp_path: Path) -> None:
    head = HEAD.replace('"2 mm"', '"2 mm^2"')
    report = sweep_refusal(tmp_path, GRID, head=head)
    assert report.count("error:") == 1
    assert report.startswith(f"s.toml:{START}: error: sliding.distance: ")
    assert " point" not in report


def test_a_problem_of_some_points_names_the_first(tmp_path: Path) -> None:
    report = sweep_refusal(tmp_path, GRID, head=HEAD + '[output]\ntick = "7 um"\n')
    assert report.count("error:") == 1
    assert report.splitlines()[0].endswith(
        "a trace would miss whole lives, "
        "at interface.mean_real_contact_area = 100 um^2, interface.mean_junction_count = 30"
    )
    report = sweep_refusal(tmp_path, GRID, head=HEAD + '[output]\ntick = "9 um"\n')
    assert report.splitlines()[0].endswith("interface.mean_junction_count = 20, and at 2 more points")


def test_a_doubt_is_told_once_and_allowed(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, GRID, head=HEAD + '[strength]\nmean = "250 mPa"\n')
    assert len(sweep.warnings) == 1
    assert 'did you mean "250 MPa"?' in sweep.warnings[0]


def test_zipped_lists_are_of_one_length(tmp_path: Path) -> None:
    table = '[sweep.zip]\ninterface.mean_junction_count = [10, 20]\nsliding.distance = ["1 mm", "2 mm", "3 mm"]\n'
    lines = sweep_refusal(tmp_path, table).splitlines()
    assert lines[0].endswith("sweep.zip.sliding.distance: 3 values beside the 2 of interface.mean_junction_count")
    assert lines[3] == "    lists of [sweep.zip] go in parallel and need equal length"


def test_a_key_is_swept_once(tmp_path: Path) -> None:
    lines = sweep_refusal(tmp_path, f"{GRID}[sweep.zip]\ninterface.mean_junction_count = [1]\n").splitlines()
    assert lines[0].endswith("sweep.zip.interface.mean_junction_count: swept in [sweep.grid] and in [sweep.zip]")


@pytest.mark.parametrize("values", ["[10, 10]", "[10, 20, 10.0]"])
def test_a_run_is_not_made_twice(tmp_path: Path, values: str) -> None:
    lines = sweep_refusal(tmp_path, _grid(f"interface.mean_junction_count = {values}")).splitlines()
    number = 2 if values == "[10, 10]" else 3
    assert f"sweep: points 1 and {number} are the same run (interface.mean_junction_count = 10" in lines[0]


def test_a_change_that_the_sweep_would_overrule_is_refused(tmp_path: Path) -> None:
    lines = sweep_refusal(tmp_path, GRID, "interface.mean_junction_count=7").splitlines()
    assert lines[0].endswith("error: interface.mean_junction_count: the sweep gives it a value at every point")
    assert lines[3] == '    to change its values: --set "sweep.grid.interface.mean_junction_count=[...]"'


def test_too_many_are_refused_before_any_is_looked_at(tmp_path: Path) -> None:
    numbers = ", ".join(map(str, range(1, 101)))
    lists = [f"{key} = [{numbers}]" for key in ("interface.mean_junction_count", "slider.damping_ratio")]
    lists.append('sliding.distance = ["1 mm", "2 mm"]')
    report = sweep_refusal(tmp_path, _grid("\n".join(lists)))
    head = f"s.toml:{START + 1}: error: sweep: too many: 20,000 points, 20,000 runs with replicates; "
    assert report.splitlines()[0].startswith(head)
    assert "too many: 6 points, 120,000 runs" in sweep_refusal(tmp_path, GRID, "sweep.replicates=20000")
    assert limits.SWEEP_POINTS < 20_000


def test_what_is_no_sweep_is_told_so(tmp_path: Path) -> None:
    assert sweep_refusal(tmp_path, "") == "s.toml: no sweep: it has no table [sweep]; rubnoise run makes this one run"


def test_a_broken_line_is_told_beside_the_rest(tmp_path: Path) -> None:
    report = sweep_refusal(tmp_path, GRID + "sliding.speed = 1 mm/s\ndiameter.sprea = [1]\n")
    assert report.count("error:") == 2
    assert "a value with a unit needs quotation marks" in report
    assert "sweep.grid.diameter.sprea: unknown key" in report

"""A sweep file: the runs that it stands for, and its problems."""

from math import sqrt
from pathlib import Path

import pytest

from rubnoise.scenario import build
from rubnoise.scenario.points import canonical
from rubnoise.scenario.sweep import Sweep, expand
from rubnoise.scenario.sweep_table import SWEEP_POINTS
from rubnoise.streams import SEED_LIMIT
from tests.unit.scenarios import GRID, HEAD, sweep_of, sweep_refusal

# A sweep file stands for the runs that it says, each with a name and a seed that nothing else moves.
COUNT = "interface.mean_junction_count"
AREA = "interface.mean_real_contact_area"


def test_a_grid_is_the_product_in_the_order_written(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, GRID)
    assert sweep.keys == (AREA, COUNT)
    told = [(*point.values.values(), point.replicate) for point in expand(sweep)]
    assert told == [(area, count, n) for area in ("100 um^2", "200 um^2") for count in (10, 20, 30) for n in (0, 1)]


def test_a_zip_goes_side_by_side_within_the_grid(tmp_path: Path) -> None:
    table = (
        '[sweep.zip]\ndiameter.law = ["fixed", "normal"]\noutput.tick = ["0.1 um", "0.2 um"]\n'
        "[sweep.grid]\ninterface.mean_junction_count = [10, 20]\n"
    )
    head = HEAD + '[diameter]\nlaw = "normal"\nspread = "0.2 um"\n'
    sweep = sweep_of(tmp_path, table.replace('"fixed"', '"normal"'), head=head)
    told = [tuple(point.values.values()) for point in expand(sweep)]
    assert told == [(count, "normal", tick) for count in (10, 20) for tick in ("0.1 um", "0.2 um")]


def test_a_point_is_the_scenario_that_a_file_of_its_own_would_be(tmp_path: Path) -> None:
    for point in expand(sweep_of(tmp_path, GRID)):
        own = {
            "format": 1,
            "title": "swept",
            "interface": {"mean_real_contact_area": point.values[AREA], "mean_junction_count": point.values[COUNT]},
            "sliding": {"distance": "2 mm"},
            "run": {"seed": point.seed, "engine": "batch"},
        }
        assert point.scenario.resolved() == build(own).resolved()
        assert point.scenario.model().calibrated_diameter == pytest.approx(
            sqrt(3.0 * float(point.scenario.interface.mean_real_contact_area) / point.values[COUNT]), rel=1e-14
        )


def test_seeds_and_names_are_all_different_and_in_range(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, GRID.replace("replicates = 2", "replicates = 50")))
    assert len({point.seed for point in points}) == len({point.run_id for point in points}) == len(points) == 300
    assert all(0 <= point.seed < SEED_LIMIT and point.scenario.run.seed == point.seed for point in points)
    assert all(len(point.run_id) == 16 and int(point.run_id, 16) >= 0 for point in points)


@pytest.mark.parametrize(
    "table",
    [
        GRID.replace("[10, 20, 30]", "[30, 10, 20, 40]"),
        GRID.replace("replicates = 2", "replicates = 5"),
        GRID.replace("100 um^2", "0.0001 mm^2").replace("[10,", "[10.0,"),
        "[sweep]\nreplicates = 2\n[sweep.grid]\n" + "\n".join(reversed(GRID.splitlines()[3:])) + "\n",
        GRID + '[sweep.zip]\ninterface.calibration = ["matched"]\n',
    ],
    ids=["in another order, with a point more", "more replicates", "other units", "other order of keys", "another key"],
)
def test_a_seed_follows_from_its_point_alone(tmp_path: Path, table: str) -> None:
    def named(sweep: Sweep) -> dict[tuple[str, float, int], tuple[int, str]]:
        contacts = ((point, point.scenario.interface) for point in expand(sweep))
        return {
            (area.mean_real_contact_area.as_text(), area.mean_junction_count, point.replicate): (
                point.seed,
                point.run_id,
            )
            for point, area in contacts
        }

    assert named(sweep_of(tmp_path, GRID)).items() <= named(sweep_of(tmp_path, table)).items()


def test_the_seeds_of_a_point_do_not_change_with_versions(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, GRID))
    assert [(point.seed, point.run_id) for point in points[:2]] == KEPT


def test_how_a_run_is_written_changes_its_name_and_not_its_seed(tmp_path: Path) -> None:
    table = '[sweep.grid]\noutput.tick = ["0.1 um", "0.2 um"]\n'
    fine, coarse = expand(sweep_of(tmp_path, table))
    assert fine.seed == coarse.seed
    assert fine.run_id != coarse.run_id
    retitled = expand(sweep_of(tmp_path, table, "title=another"))
    assert [(p.seed, p.run_id) for p in retitled] == [(p.seed, p.run_id) for p in (fine, coarse)]


def test_both_couplings_meet_the_same_junctions(tmp_path: Path) -> None:
    both = 'slider.coupling = ["one-way", "two-way"]\n'
    table = f'[sweep]\nreplicates = 3\n[sweep.grid]\n{both}sliding.speed = ["1 mm/s", "1 m/s"]\n'
    slider = '[strength]\nmean = "250 MPa"\n[slider]\nmass = "5 g"\nstiffness = "300 N/m"\ndamping_ratio = 0.02\n'
    points = expand(sweep_of(tmp_path, table, head=HEAD + slider))
    one_way, two_way = points[:6], points[6:]
    assert [point.seed for point in one_way] == [point.seed for point in two_way]
    assert len({point.seed for point in one_way}) == 6
    assert len({point.run_id for point in points}) == 12
    # A scenario without coupling has the seeds that it always had.
    alone = expand(sweep_of(tmp_path, table.replace(both, ""), head=HEAD + slider))
    assert [point.seed for point in alone] == [point.seed for point in one_way]


def test_defaults_have_no_part_in_names_and_seeds(tmp_path: Path) -> None:
    told, untold = (expand(sweep_of(tmp_path, GRID, *changes))[3] for changes in ((), ("pulse.shape=lens",)))
    assert (told.seed, told.run_id) == (untold.seed, untold.run_id)
    assert canonical(told.scenario.resolved(), without=("run", "output")) == (
        b'{"format":1,"interface":{"mean_junction_count":20.0,"mean_real_contact_area":"100 um^2"},'
        b'"sliding":{"distance":"2000 um"},"title":"swept"}'
    )
    other = expand(sweep_of(tmp_path, GRID, "pulse.shape=triangle"))[3]
    assert other.seed != told.seed


KEPT = [(765688994715997, "22bead39afcfb42b"), (3070721805695893, "2b2f8947c938dbec")]

# All problems of a sweep are reported at once, each one time, with its place.
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
        ("sliding.sped = [1]", "sweep.grid.sliding.sped: unknown key", "did you mean sliding.speed?"),
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
    shown = '    interface.mean_junction_count = [10, -3, "20", [1]]\n'
    assert f"{shown}{' ' * shown.index('[')}{'^' * 19}\n" in report


def test_a_problem_of_some_points_names_the_first(tmp_path: Path) -> None:
    report = sweep_refusal(tmp_path, GRID, head=HEAD + '[output]\ntick = "7 um"\n')
    assert report.count("error:") == 1
    assert report.splitlines()[0].endswith(
        "a trace would miss whole lives, "
        "at interface.mean_real_contact_area = 100 um^2, interface.mean_junction_count = 30"
    )
    report = sweep_refusal(tmp_path, GRID, head=HEAD + '[output]\ntick = "9 um"\n')
    assert report.splitlines()[0].endswith("interface.mean_junction_count = 20, and at 2 more points")


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
    assert SWEEP_POINTS < 20_000


def test_what_said_the_first_calibration_keeps_its_name_and_seed(tmp_path: Path) -> None:
    # Name and seed are those of the version whose default was exact, where no file had to say it.
    sweep = sweep_of(tmp_path, GRID, "interface.calibration=exact")
    first = next(point for point in expand(sweep) if point.replicate == 0)
    assert (first.run_id, first.seed) == ("22bead39afcfb42b", 765688994715997)

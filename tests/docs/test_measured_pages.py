"""Pages that show what was measured: two-way motion, detection, reproducibility."""

import json
import re
from dataclasses import replace
from math import hypot, sqrt
from pathlib import Path

import h5py
import pytest

import rubnoise
from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import GROUPS
from rubnoise.streams import STREAM_VERSION, Stream
from rubnoise.theory.coupling import coupling
from rubnoise.theory.motion import response
from tests.architecture.sources import ROOT
from tools.parts import parts_of
from tools.studies import detection, free_motion
from tools.studies import two_way as tool

# What docs/two-way.md shows as measured is what the tool measures.
TEXT = tool.PAGE.read_text(encoding="utf-8")


def part(name: str) -> list[str]:
    """Return the lines of a measured part of the page."""
    return parts_of(TEXT)[name].removesuffix("\n").split("\n")


def rows(name: str) -> list[list[str]]:
    """Return the cells of the rows of the first table in a part."""
    table = [line for line in part(name) if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table[2:]]


def model_at(speed: float, junctions: float) -> Model:
    """Return the two-way model of a point of the reference."""
    changes = [f"sliding.speed={speed} um/s", f"interface.mean_junction_count={junctions}"]
    return rubnoise.load(tool.TWO_WAY, changes).model()


def test_what_is_exact_in_the_table_of_speeds_is_what_theory_says() -> None:
    points = tool.kept()
    assert len(rows("reference")) == len(points) > 10
    for (speed, count, validity, strength, *_), point in zip(rows("reference"), points, strict=True):
        model = model_at(1e3 * float(speed), float(count))
        exact = response(model)
        assert float(validity) == pytest.approx(exact.one_way_validity, rel=6e-3)
        assert float(strength) == pytest.approx(coupling(model).strength, rel=6e-3)
        change = point["displacement_std"][0] / exact.displacement_std
        assert point["over_one_way"][0] == pytest.approx(change, rel=0.05)


def test_the_law_of_weak_coupling_is_what_runs_have_where_coupling_is_weak_alone() -> None:
    points = tool.kept()
    laws = [coupling(model_at(point["speed"], point["junctions"])) for point in points]
    weak = [law.expected_change for law in laws if law.unknown is None]
    assert len(weak) == 3
    for point, law in zip(points, laws, strict=True):
        value, error = point["over_one_way"]
        expected = weak[0] if law.unknown else law.expected_change
        assert (abs(value - expected) < 4.0 * error) == (law.unknown is None)


@pytest.fixture(scope="module")
def two_way(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "two_way.h5"
    rubnoise.run(rubnoise.load(tool.TWO_WAY, ["run.engine=batch"]), path).close()
    return path


def test_figure_5_is_told_as_it_is(figure_5: Path, two_way: Path) -> None:
    with open_run(figure_5) as one, open_run(two_way) as two:
        assert parts_of(TEXT)["figures"] == tool.figures(one, two), "python tools/studies two_way"


def test_runs_part_when_the_page_says() -> None:
    speeds = {row[0]: row for row in rows("chaos")}
    assert list(map(int, speeds)) == list(tool.CHAOS)
    times = {speed: re.findall(r"never|[\d.]+", row[1]) for speed, row in speeds.items()}
    time, _ = tool.parted(10, tool.CHAOS[10], tool.SEEDS[2])
    assert f"{time:.3g}" == times["10"][2]
    assert set(times["50"]) == {"never"}
    # What the page advises: a tenth of a second.
    assert min(float(time) for speed in ("1", "3", "10") for time in times[speed]) > 0.1


# The table of what sliding distance shows what follows from the theory, and is written if wrong runs bear it out.
BY_NAME = {fault.name: fault for fault in detection.FAULTS}


def cells(page: str) -> dict[str, list[str]]:
    """Return the cells of each row of the table by its fault."""
    lines = parts_of(page)["detection"].split("\n")
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if "|" in line]
    return {row[0]: row[1:] for row in rows[2:]}


ROWS = cells(detection.PAGE.read_text(encoding="utf-8"))


@pytest.mark.slow
@pytest.mark.parametrize("name", BY_NAME)
def test_a_row_is_what_theory_says(name: str) -> None:
    assert tuple(ROWS[name][:2]) == detection.predicted(BY_NAME[name])[1:], "python tools/studies detection"


def test_wrong_runs_are_outside_and_right_ones_are_not() -> None:
    name = "diameters 1 % larger"
    assert "diameter_mean" in detection.outside(BY_NAME[name], 3000.0, 1)
    assert detection.outside(detection.Fault(name="none"), 3000.0, 1) == []
    assert "area_from_rows" in detection.outside(detection.Fault(name="small", area=0.981), 3000.0, 1)


# docs/reproducibility.md promises what the program does, and lists all of it.
PAGE = (ROOT / "docs" / "reproducibility.md").read_text(encoding="utf-8")
PROMISED = re.findall(r"`/(\w+)`", PAGE.partition("every column of ")[2].partition(".\n")[0])


def test_every_group_of_columns_is_promised() -> None:
    assert sorted(PROMISED) == sorted(group.name for group in GROUPS)


def test_streams_and_their_version_are_those_of_the_program() -> None:
    listed = re.findall(r"^\| `(\w+)` \| (\d+) \|", PAGE, re.MULTILINE)
    assert [(name, int(key)) for name, key in listed] == [(stream.name, stream.value) for stream in Stream]
    assert f"and is **{STREAM_VERSION}** now" in " ".join(PAGE.split())


def scenario(engine: str, compression: str, seed: int = 7) -> Scenario:
    return rubnoise.build(
        {
            "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
            "diameter": {"law": "normal", "spread": "0.2 um"},
            "strength": {"mean": "250 MPa"},
            "sliding": {"distance": "1 mm", "speed": "1 mm/s"},
            "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
            "output": {"tick": "0.5 um", "compression": compression},
            "run": {"seed": seed, "engine": engine},
        }
    )


def hashes(path: Path) -> dict[str, str]:
    with h5py.File(path) as file:
        return {
            column.name: column.attrs["xxh3_128"] for name in PROMISED if name in file for column in file[name].values()
        }


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("kept") / "kept.h5"
    rubnoise.run(scenario("events", "none"), path).close()
    return path


@pytest.mark.parametrize(("engine", "compression"), [("events", "none"), ("events", "gzip"), ("batch", "none")])
def test_what_is_promised_is_the_same_and_the_file_is_not(
    kept: Path, tmp_path: Path, engine: str, compression: str
) -> None:
    again = tmp_path / "again.h5"
    rubnoise.run(scenario(engine, compression), again).close()
    assert hashes(again) == hashes(kept)
    assert len(hashes(kept)) > 20
    assert again.read_bytes() != kept.read_bytes()


# Free motion: docs/load.md shows what docs/free_motion.json holds, once it has been held against what is exact.
FREE = free_motion.kept()
SCALE = free_motion.HEIGHT * sqrt(free_motion.GRAVITY / free_motion.HEIGHT)
"""s_0 omega_c in um/s."""


def test_tables_of_free_motion_are_those_of_its_data() -> None:
    page = free_motion.PAGE.read_text("utf-8")
    assert free_motion.faults(FREE) == []
    assert free_motion.tables(FREE).items() <= parts_of(page).items()


@pytest.mark.slow
def test_a_level_of_free_motion_is_what_its_seeds_give() -> None:
    live, loss, value, duration = free_motion.CONTACTS[0]
    seeds = range(free_motion.SEED, free_motion.SEED + free_motion.RUNS)
    found = free_motion.level(live, loss, value, free_motion.SPEEDS[0], free_motion.HEIGHT, duration, seeds)
    assert found.velocity == pytest.approx(FREE[0].levels[0].velocity, rel=1e-9)
    assert found.load == pytest.approx(FREE[0].levels[0].load, rel=1e-9)


def test_levels_of_free_motion_are_those_of_another_program() -> None:
    rows = json.loads((ROOT / "tests" / "reference" / "bouncing.json").read_text(encoding="utf-8"))["rows"]
    wrong = 0
    for row in rows:
        [each] = [one for one in FREE if (one.live, one.value) == (row["live"], row.get(one.loss))]
        at = free_motion.SPEEDS.index(row["v"])
        level = each.levels[at]
        allowed = max(0.06 * row["velocity"], 4.0 * hypot(row["error"], level.error / SCALE))
        assert abs(level.velocity / SCALE - row["velocity"]) < allowed, row
        wrong += abs(each.levels[at - 3].velocity / SCALE - row["velocity"]) > allowed
    assert len(rows) > 20
    assert wrong == len(rows), "a level at thirty times another speed should be outside"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"load": 1.0 + 10.0 * FREE[1].levels[2].load_error}, "N 0.1, restitution 0.7: mean load 1.0"),
        ({"drift": 10.0 * FREE[1].levels[2].drift_error}, "N 0.1, restitution 0.7: the level drifts by "),
        ({"velocity": 1.1 * FREE[1].levels[2].velocity}, "N 0.1, restitution 0.7: m - (1 + n)/2 = "),
    ],
)
def test_runs_of_free_motion_that_are_wrong_are_told(change: dict[str, float], said: str) -> None:
    levels = tuple(replace(each, **change) if at == 2 else each for at, each in enumerate(FREE[1].levels))
    wrong = free_motion.faults([FREE[0], replace(FREE[1], levels=levels), *FREE[2:]])
    assert any(said in words for words in wrong)

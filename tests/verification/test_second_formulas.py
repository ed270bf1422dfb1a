"""Every row of a run by other formulas, and traces rebuilt from rows one junction at a time."""

import ast
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.model import Model, Slider
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation.run import slider_constants
from rubnoise.simulation.slider import propagator
from rubnoise.theory.sizes import panels
from tests.models import bare, recorded
from tests.oracle.second import sums
from tests.oracle.second.contact import contact_checks
from tests.oracle.second.motion import cell_motion, motion_check
from tests.oracle.slow_contact import Doubles, Rows, lens_area, traces
from tests.unit.tampering import ONE_WAY, Kind, scenario_of
from tests.verification.scores import Held, seed_of

# Every row of runs of every kind comes out of other formulas, too; and those formulas are right by themselves.
LIVES = {
    "inside": (1.3, 2.0, 5.3),
    "within a cell": (1.02, 0.04, 1.10),
    "at edges": (1.0, 1.5, 4.0),
    "born before": (-3.3, 2.0, 0.7),
    "dies after": (7.7, 2.5, 12.7),
    "ended early, rising": (2.05, 2.0, 3.333),
    "ended early, falling": (2.05, 2.0, 5.21),
    "over before": (-5.0, 2.0, -1.0),
    "born at the end": (8.0, 2.0, 12.0),
}


def ran(name: str, of: Mapping[str, Kind] = ONE_WAY) -> tuple[Model, Held]:
    """Return a run of a kind, played by the batch engine."""
    left_out, changes = of[name]
    scenario = scenario_of(*left_out, **changes)
    model = scenario.model()
    return model, recorded(model, scenario.run.seed, engine="batch")


def cells(model: Model) -> int:
    constants = slider_constants(model)
    return 1 if constants is None else constants.cells_per_tick


def changed(rows: Held, group: str, column: str, row: int, by: float) -> Held:
    values = rows.groups[group][column].copy()
    values[row] += by
    return Held({**rows.groups, group: {**rows.groups[group], column: values}})


@pytest.mark.parametrize("name", ONE_WAY)
def test_sums_and_motion_of_every_kind_are_those_of_other_formulas(name: str) -> None:
    model, rows = ran(name)
    checks = contact_checks(model, rows)
    if model.slider is not None:
        checks.append(motion_check(model, rows, cells(model)))
    assert [str(check.first) for check in checks if not check.holds] == []
    assert sum(check.values for check in checks) >= 3 * rows.rows("trace")


@pytest.mark.parametrize(
    ("column", "by", "judge"),
    [("real_contact_area", 1e-9, "areas"), ("friction_force", 1e-6, "forces"), ("junction_count", 1, "counts")],
)
def test_a_sum_that_is_off_by_little_is_seen(column: str, by: float, judge: str) -> None:
    model, rows = ran("lognormal sizes and strengths")
    wrong = changed(rows, "trace", column, 700, by)
    (check,) = [check for check in contact_checks(model, wrong) if not check.holds]
    assert (check.name, check.first and check.first.row) == (judge, 700)


@pytest.mark.parametrize("name", ["everything", "slow", "overdamped", "coarse ticks", "triangles"])
@pytest.mark.parametrize("column", ["displacement", "velocity"])
def test_a_motion_off_by_a_thousandth_of_a_millionth_is_seen(name: str, column: str) -> None:
    model, rows = ran(name)
    row, largest = rows.rows("slider") // 2, float(np.abs(rows.groups["slider"][column]).max())
    assert motion_check(model, changed(rows, "slider", column, row, 1e-11 * largest), cells(model)).holds
    check = motion_check(model, changed(rows, "slider", column, row, 1e-9 * largest), cells(model))
    assert str(check.first).startswith(f"/slider/{column} row {row} is")


WAYS = {"closed forms": np.inf, "quadrature": 0.0}
"""From how many cells a diameter on which way to the moments is taken."""

QUADRATURE = 1e-7
"""What six nodes leave of moments over cells of an eighth of a diameter; they are for narrower ones."""


def rounding(d: float, width: float) -> NDArray[np.float64]:
    """Return what differences of integrals over a whole life lose of moments over a cell, per unit of strength."""
    return 2.0**-48 * d**3 * (d / width) ** np.arange(3.0)[:, None]


def moments_by_quadrature(pulse: Pulse, edges: NDArray[np.float64], life: tuple[float, float, float]):
    birth, d, death = life
    found = np.zeros((3, edges.size - 1))
    for cell, (low, high) in enumerate(pairwise(edges)):
        inside = [each for each in (birth, birth + d, death) if low < each < high]
        s, weights = panels(np.array([low, *inside, high]), 60, rooted=True)
        area = np.where((s >= birth) & (s < death), pulse.area(s - birth, d), 0.0)
        y = 2.0 * (s - low) / (high - low) - 1.0
        found[:, cell] = [(weights * area * shape).sum() for shape in (np.ones_like(y), y, 1.5 * y * y - 0.5)]
    return found


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("pulse", [LENS, TRIANGLE], ids=lambda pulse: pulse.shape)
@pytest.mark.parametrize("name", LIVES)
def test_moments_of_a_life_are_those_of_its_area(
    monkeypatch: pytest.MonkeyPatch, name: str, pulse: Pulse, way: str
) -> None:
    monkeypatch.setattr(sums, "NARROW", WAYS[way])
    birth, d, death = LIVES[name]
    edges = np.linspace(0.0, 8.0, 33)
    shapes = tuple(np.array([value]) for value in (birth, d, death, 250.0))
    found = sums.force_moments(pulse, edges, 0.25, shapes)
    right = 250.0 * moments_by_quadrature(pulse, edges, LIVES[name])
    lost = QUADRATURE if way == "quadrature" and pulse is LENS else rounding(max(d, 1.0), 0.25)
    assert (np.abs(found - right) < 250.0 * lost).all()
    assert (np.abs(found).max() > 0.0) == (name not in {"over before", "born at the end"})


@pytest.mark.parametrize("damping", [0.0, 0.05, 2.0 * (0.005 * 300.0) ** 0.5, 50.0, 5e3])
@pytest.mark.parametrize("width", [1e-4, 0.1, 5.0])
def test_a_step_of_the_slider_is_that_of_another_derivation(damping: float, width: float) -> None:
    slider = Slider(mass=0.005, stiffness=300.0, damping=damping)
    found, right = cell_motion(slider, 1000.0, width), propagator(slider, 1000.0, width)
    assert np.abs(found.free - np.eye(2) - right.transition)[0, 0] < 1e-14
    assert np.allclose(found.free - np.eye(2), right.transition, rtol=1e-9, atol=1e-14)
    largest = np.abs(right.gains).max(axis=1, keepdims=True)
    assert (np.abs(found.gains - right.gains) < 1e-13 * largest).all()


def test_second_formulas_share_nothing_with_the_simulation() -> None:
    folder, named = Path(sums.__file__).parent, set()
    for path in folder.glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        named |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert "rubnoise.compiling" in named
    assert not {name for name in named if name.startswith("rubnoise.simulation")}


# The traces rebuilt from the rows of /junctions alone, one junction and one tick at a time.
AREA_BOUND = 1e-9


def around(rows: Rows, low: float, high: float) -> Rows:
    """Return the junctions that may live between two distances; births are in order, no life is longer than 4 d_m."""
    first = np.searchsorted(rows.birth, low - 2.0 * rows.diameter.max())
    last = np.searchsorted(rows.birth, high, side="right")
    part = slice(first, last)
    return Rows(
        birth=rows.birth[part], diameter=rows.diameter[part], strength=rows.strength[part], death=rows.death[part]
    )


def rebuilt(
    rows: Rows, distance: Doubles, together: int, area_of: Callable[[float, float], float] = lens_area
) -> Iterator[tuple[slice, Doubles, NDArray[np.int64], Doubles]]:
    """Yield area, count and force of the slow reference for so many ticks at a time."""
    for first in range(0, distance.size, together):
        part = slice(first, first + together)
        ticks = distance[part]
        yield part, *traces(around(rows, ticks[0], ticks[-1]), ticks.tolist(), area_of)


def rows_in_memory(record: MemoryRecord) -> Rows:
    columns = record["junctions"]
    return Rows(
        birth=columns["birth_distance"],
        diameter=columns["diameter"],
        strength=columns.get("shear_strength", np.ones(columns["diameter"].size)),
        death=columns["death_distance"],
    )


def test_a_metre_away_nothing_has_been_lost() -> None:
    run = bare(count=4.0, distance=1e6, tick=250.0)
    record = recorded(run, seed_of("metre"))
    rows, trace = rows_in_memory(record), record["trace"]
    for part, area, count, _ in rebuilt(rows, trace["distance"], together=1):
        assert np.abs(trace["real_contact_area"][part] - area).max() < AREA_BOUND
        assert np.array_equal(trace["junction_count"][part], count)

"""Every row of a run by other formulas, and traces rebuilt from rows one junction at a time."""

import ast
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import h5py
import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

import rubnoise
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.model import Model, Slider
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation.linear import propagator, slider_constants, under_force
from rubnoise.theory.sizes import panels
from tests.models import UNEQUAL, bare, model, recorded
from tests.oracle.second import slips, sums, two_way
from tests.oracle.second.contact import FORMULA, contact_checks
from tests.oracle.second.motion import cell_motion, motion_check
from tests.oracle.slow_contact import Doubles, Rows, lens_area, traces, triangle_area
from tests.unit.tampering import ONE_WAY, TWO_WAY, Kind, scenario_of
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


@pytest.mark.parametrize("name", TWO_WAY)
def test_slips_of_every_kind_are_those_of_other_steps(name: str) -> None:
    model, rows = ran(name, TWO_WAY)
    checks, left_out = two_way.motion_checks(model, rows)
    assert [str(check.first) for check in [*checks, *contact_checks(model, rows)] if not check.holds] == []
    assert left_out == []


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


def test_a_slip_with_a_thousandth_more_mass_or_damping_is_seen() -> None:
    model, rows = ran("figure 5", TWO_WAY)
    assert model.slider is not None
    for key in ("mass", "damping"):
        wrong = replace(model, slider=replace(model.slider, **{key: getattr(model.slider, key) * 1.001}))
        assert not two_way.motion_checks(wrong, rows)[0][0].holds


def test_a_row_of_a_slip_moved_in_agreement_with_itself_is_seen() -> None:
    model, rows = ran("figure 5", TWO_WAY)
    row = 300 + int(np.argmax(rows.groups["slider"]["phase"][300:] == 0))
    wrong = changed(changed(rows, "slider", "displacement", row, 1e-5), "slider", "distance", row, -1e-5)
    check = two_way.motion_checks(model, wrong)[0][0]
    assert str(check.first).startswith("/slider/")
    assert f"row {row} is" in str(check.first)


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


def test_closed_forms_and_quadrature_agree_on_narrow_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    edges = np.linspace(0.0, 0.5, 101)
    shapes = tuple(np.array(values) for values in ([-9.9, -5.0, 0.1], [5.0] * 3, [0.1, 5.0, 10.1], [1.0, 2.0, 3.0]))
    found = []
    for narrow in WAYS.values():
        monkeypatch.setattr(sums, "NARROW", narrow)
        found.append(sums.force_moments(LENS, edges, 0.005, shapes))
    closed, fine = found
    assert (np.abs(closed - fine) < 6.0 * rounding(5.0, 0.005)).all()
    assert (np.abs(fine).max(axis=1) > 1e3 * rounding(5.0, 0.005)[:, 0]).tolist() == [True, True, False]


def test_an_area_keeps_its_digits_at_birth_and_death() -> None:
    def exact(u: float) -> float:
        with mpmath.workdps(40):
            x = 1 - mpmath.mpf(u)
            return float((mpmath.acos(x) - x * mpmath.sqrt(1 - x * x)) / 2)

    worst = max(abs(sums.lens_fraction(u) - exact(u)) for u in (0.0, 1e-16, 1e-12, 1e-7, 1e-3, 0.1, 0.5, 0.9, 1.0))
    assert worst < FORMULA / 8.0


@pytest.mark.parametrize("damping", [0.0, 0.05, 2.0 * (0.005 * 300.0) ** 0.5, 50.0, 5e3])
@pytest.mark.parametrize("width", [1e-4, 0.1, 5.0])
def test_a_step_of_the_slider_is_that_of_another_derivation(damping: float, width: float) -> None:
    slider = Slider(mass=0.005, stiffness=300.0, damping=damping)
    found, right = cell_motion(slider, 1000.0, width), propagator(under_force(slider), 1000.0, width)
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


MASS, STIFFNESS, DAMPING, DRIVE = 0.005, 300.0, 0.05, 1000.0
BORDER = 0.00136


@pytest.mark.parametrize("most", [1e-3, 2e-3])
def test_a_slip_that_begins_with_no_speed_and_no_acceleration_finds_its_border(most: float) -> None:
    """Without a contact and with f = k x + c V = 0 it goes as k V t^3 / 6 m, and Newton's first steps go astray."""
    oscillator = slips.Oscillator(MASS, STIFFNESS, DAMPING, DRIVE, longest=2e-3, limit=1e-12, error=1e-9)
    start = slips.Start(way=1.0, displacement=-DAMPING * DRIVE / STIFFNESS, since=0.0, path=0.0, speed=0.0)
    no_lives = slips.Lives(*(np.empty(1) for _ in range(4)))
    clocks = (0, 0)
    time, path, u, landed = slips._step(oscillator, start, most, BORDER, clocks, 0, no_lives, 0, np.empty((8, 2)))
    assert landed
    assert path == BORDER
    # u = y' with m y'' + c y' + k y = k V t: the first terms of its series are enough for so short a time.
    cubic = np.cbrt(6.0 * MASS * BORDER / (STIFFNESS * DRIVE))
    assert time == pytest.approx(cubic * (1.0 + DAMPING * cubic / (12.0 * MASS)), rel=1e-3)
    assert u == pytest.approx(3.0 * BORDER / time, rel=1e-2)


# The traces rebuilt from the rows of /junctions alone, one junction and one tick at a time.
FIGURE_5 = Path(__file__).parents[2] / "scenarios" / "paper" / "fig5.toml"
AREA_BOUND = 1e-9
SPEED, STRENGTH = 1000.0, 250.0


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


@pytest.fixture(scope="module")
def figure_5(tmp_path_factory: pytest.TempPathFactory) -> Iterator[h5py.File]:
    """Run Figure 5 as the paper's scenario has it and open the file with h5py alone."""
    path = tmp_path_factory.mktemp("rebuild") / "fig5.h5"
    rubnoise.run(rubnoise.load(FIGURE_5), path).close()
    with h5py.File(path, "r") as file:
        yield file


def rows_of(file: h5py.File) -> Rows:
    names = {"birth": "birth_distance", "diameter": "diameter", "strength": "shear_strength", "death": "death_distance"}
    return Rows(**{name: file["junctions"][column][:] for name, column in names.items()})


def rows_in_memory(record: MemoryRecord) -> Rows:
    columns = record["junctions"]
    return Rows(
        birth=columns["birth_distance"],
        diameter=columns["diameter"],
        strength=columns.get("shear_strength", np.ones(columns["diameter"].size)),
        death=columns["death_distance"],
    )


def test_rows_of_a_file_hold_whole_lives(figure_5: h5py.File) -> None:
    columns = {name: dataset[:] for name, dataset in figure_5["junctions"].items()}
    birth, diameter = columns["birth_distance"], columns["diameter"]
    assert columns["junction"].tolist() == list(range(birth.size))
    assert np.all(np.diff(birth) >= 0.0)
    assert birth[-1] <= 20_000.0
    assert np.array_equal(columns["death_distance"], birth + 2.0 * diameter)
    assert np.array_equal(columns["life_distance"], 2.0 * diameter)
    assert np.allclose(columns["max_area"], np.pi * diameter**2 / 4.0, rtol=1e-15, atol=0.0)
    assert np.array_equal(columns["birth_time"], birth / SPEED)
    assert np.array_equal(columns["death_time"], columns["death_distance"] / SPEED)
    assert np.all(columns["shear_strength"] == STRENGTH)
    alive = (birth < 0.0).astype(int) + 2 * (columns["death_distance"] > 20_000.0)
    assert np.array_equal(columns["state"], alive)


def test_ticks_of_a_file_are_where_they_were_asked_for(figure_5: h5py.File) -> None:
    distance = figure_5["trace"]["distance"][:]
    assert np.array_equal(distance, np.arange(200_001) * 0.1)
    assert np.array_equal(figure_5["slider"]["distance"][:], distance)
    assert np.array_equal(figure_5["slider"]["time"][:], distance / SPEED)
    assert np.array_equal(figure_5["slider"]["friction_force"][:], figure_5["trace"]["friction_force"][:])


@pytest.mark.parametrize("quarter", range(4))
def test_every_tick_of_a_file_follows_from_its_rows(figure_5: h5py.File, quarter: int) -> None:
    rows, trace = rows_of(figure_5), figure_5["trace"]
    ticks = slice(50_000 * quarter, 50_000 * (quarter + 1) + 1)
    distance, found_area, found_count, found_force = (
        trace[name][ticks] for name in ("distance", "real_contact_area", "junction_count", "friction_force")
    )
    for part, area, count, force in rebuilt(rows, distance, together=40):
        assert np.abs(found_area[part] - area).max() < AREA_BOUND
        assert np.array_equal(found_count[part], count)
        assert np.abs(found_force[part] - force).max() < AREA_BOUND * STRENGTH


LAWS = {
    "triangles": (model(pulse=TRIANGLE, distance=2_000.0, tick=0.3), triangle_area),
    "regular births": (model(births="regular", distance=2_000.0, tick=0.3), lens_area),
    "unequal strengths": (model(strength=UNEQUAL, distance=2_000.0, tick=0.3), lens_area),
    "all three, wide sizes": (
        model(pulse=TRIANGLE, births="regular", strength=UNEQUAL, spread=Spread(relative=0.6), distance=2e3, tick=0.3),
        triangle_area,
    ),
}


@pytest.mark.parametrize("name", LAWS)
def test_every_tick_of_other_laws_follows_from_the_rows(name: str) -> None:
    run, area_of = LAWS[name]
    record = recorded(run, seed_of(f"rebuild/{name}"))
    rows, trace = rows_in_memory(record), record["trace"]
    assert (np.unique(rows.strength).size > 1) == (run.strengths is UNEQUAL)
    for part, area, count, force in rebuilt(rows, trace["distance"], together=40, area_of=area_of):
        assert np.abs(trace["real_contact_area"][part] - area).max() < AREA_BOUND
        assert np.array_equal(trace["junction_count"][part], count)
        assert np.abs(trace["friction_force"][part] - force).max() < AREA_BOUND * rows.strength.max()


def test_equal_strengths_in_place_of_unequal_ones_are_seen() -> None:
    trace = recorded(LAWS["unequal strengths"][0], seed_of("rebuild/unequal strengths"))["trace"]
    share = trace["friction_force"] / trace["real_contact_area"]
    assert share.min() < 0.8 * STRENGTH
    assert share.max() > 1.2 * STRENGTH


def test_a_birth_moved_by_a_nanometre_is_seen(figure_5: h5py.File) -> None:
    rows, trace = rows_of(figure_5), figure_5["trace"]
    rows.birth[1000] += 1e-3
    death = rows.death[1000]
    near = slice(int(rows.birth[1000] / 0.1) - 5, int(death / 0.1) + 5)
    area = traces(around(rows, rows.birth[1000], death), trace["distance"][near].tolist())[0]
    assert np.abs(trace["real_contact_area"][near] - area).max() > 1e5 * AREA_BOUND


def test_a_metre_away_nothing_has_been_lost() -> None:
    run = bare(count=4.0, distance=1e6, tick=250.0)
    record = recorded(run, seed_of("metre"))
    rows, trace = rows_in_memory(record), record["trace"]
    for part, area, count, _ in rebuilt(rows, trace["distance"], together=1):
        assert np.abs(trace["real_contact_area"][part] - area).max() < AREA_BOUND
        assert np.array_equal(trace["junction_count"][part], count)

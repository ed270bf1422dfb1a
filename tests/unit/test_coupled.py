"""The pieces of two-way coupling: G in a cell, the balance of energy, sticks and slips."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.analysis.balance import Balance
from rubnoise.analysis.landmarks import StickSlip
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.errors import Refused
from rubnoise.model import Slider
from rubnoise.record.rows import LandmarkKind
from rubnoise.simulation.coupled import quadrature
from rubnoise.simulation.coupled.field import (
    SHAPES,
    ForceField,
    first_beyond,
    force_and_integral,
    force_in_cell,
    gather,
    merged,
    near_index,
)
from rubnoise.simulation.coupled.quadrature import CLOCKS, INTEGRAL, LEGENDRE, NODES, POWERS, RATES, TABLE, WEIGHTS
from rubnoise.simulation.coupled.steps import WORK, clock_at, integral_to, rate_at, value_at
from rubnoise.simulation.state import LiveRows
from tests.models import model
from tests.oracle.second.balance import FrictionIntegral
from tests.oracle.slow_contact import lens_area, triangle_area

# G in one cell and over a stretch: polynomial, near lives and primitives against the areas themselves.
Doubles = NDArray[np.float64]
WIDTH = 0.05
PULSES = pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)


def rows(count: int = 60, first: float = -20.0, end: float = 12.0) -> LiveRows:
    source = np.random.default_rng(7)
    birth = np.sort(source.uniform(first, end, count))
    return LiveRows(
        junction=np.arange(count, dtype=np.int64),
        birth=birth,
        diameter=source.uniform(0.02, 8.0, count),
        strength=source.uniform(100.0, 300.0, count),
        departure=np.full(count, np.inf),
    )


def force(pulse: Pulse, some: LiveRows, place: float) -> float:
    return float(np.sum(some.strength * pulse.area(place - some.birth, some.diameter)))


def field_over(pulse: Pulse, some: LiveRows) -> ForceField:
    return ForceField.over(pulse.shape, some, -8, 240, WIDTH)


@PULSES
def test_a_cell_has_the_force_at_any_place(pulse: Pulse) -> None:
    some = rows()
    field = field_over(pulse, some)
    near, far, work = np.zeros(4 * 61), np.zeros(NODES), np.zeros(WORK)
    largest, counts = 0.0, []
    for cell in range(-8, 240):
        origin = cell * WIDTH
        count = gather(field.lives, field.shape, origin, WIDTH, TABLE, near, far, work)
        counts.append(count)
        part = (2.0 / WIDTH, far, near, count, SHAPES[pulse.shape])
        for share in (0.0, 0.13, 0.5, 0.77, 1.0):
            expected = force(pulse, some, origin + share * WIDTH)
            largest = max(largest, abs(force_in_cell(share * WIDTH, part) - expected))
    assert largest < 1e-10 * 3e5
    assert 0 < np.mean(counts) < 20


@PULSES
def test_the_integral_is_that_of_the_force(pulse: Pulse) -> None:
    some = rows()
    field = field_over(pulse, some)
    work = np.zeros(WORK)
    for begin, end in ((0.0, 3.0), (3.0, 0.0), (1.0, 1.0), (-0.3, 9.0)):
        here, integral = force_and_integral(field.lives, field.shape, 1.5, begin, end, 3, work)
        assert here == pytest.approx(force(pulse, some, 1.5 + end), rel=1e-12)
        cuts = np.concatenate([some.birth, some.birth + some.diameter, some.birth + 2.0 * some.diameter])
        low, high = sorted((1.5 + begin, 1.5 + end))
        cuts = np.unique(np.concatenate([cuts[(cuts > low) & (cuts < high)], [low, high]]))
        expected = 0.0
        nodes, weights = np.polynomial.legendre.leggauss(20)
        for a, b in pairwise(cuts.tolist()):
            q = 0.5 * (nodes + 1.0)
            place, rate = a + (b - a) * q * q * (3.0 - 2.0 * q), (b - a) * 6.0 * q * (1.0 - q)
            expected += float(np.sum(0.5 * weights * rate * [force(pulse, some, s) for s in place]))
        assert integral == pytest.approx(expected if end >= begin else -expected, rel=1e-11, abs=1e-9)


def test_moments_of_cells_together_are_those_of_one_wide_cell() -> None:
    some = rows()
    narrow = field_over(LENS, some).moments
    wide = ForceField.over("lens", some, -1, 30, 8.0 * WIDTH).moments
    for cell in range(31):
        # The cubic of a wide cell misses some 1e-7 of the largest force.
        assert merged.py_func(narrow, 8 * cell, 8) == pytest.approx(wide[:, cell], rel=1e-9, abs=0.01)


def test_places_are_found_from_any_guess() -> None:
    ordered = np.array([-1.0, 0.0, 0.0, 2.5, 7.0, np.inf])
    for place in (-2.0, -1.0, 0.0, 1.0, 7.0, 1e9):
        expected = int(np.searchsorted(ordered, place, side="right"))
        assert first_beyond(ordered, place) == expected
        assert {near_index.py_func(ordered, place, guess) for guess in range(-2, 9)} == {expected}


POLYNOMIALS: tuple[Callable[[Doubles], Doubles], ...] = (
    np.ones_like,
    lambda q: q**3 - 0.2,
    lambda q: (1.0 - q) ** 7 + q,
)


@pytest.mark.parametrize("polynomial", POLYNOMIALS)
def test_matrices_are_exact_for_polynomials(polynomial: Callable[[Doubles], Doubles]) -> None:
    nodes = TABLE[CLOCKS : CLOCKS + NODES]
    values = polynomial(nodes)

    def matrix(at: int) -> Doubles:
        return TABLE[at : at + NODES * NODES].reshape(NODES, NODES).T

    fine, weights = np.polynomial.legendre.leggauss(12)
    for q, found in zip([*nodes, 1.0], [*(matrix(INTEGRAL) @ values), TABLE[WEIGHTS:CLOCKS] @ values], strict=True):
        expected = 0.5 * q * np.sum(weights * polynomial(0.5 * q * (fine + 1.0)))
        assert found == pytest.approx(expected, rel=1e-14, abs=1e-15)
    series = matrix(LEGENDRE) @ values
    powers = matrix(POWERS) @ values
    for q in (0.0, 0.3, 1.0):
        expected = float(polynomial(np.array([q]))[0])
        assert value_at(q, series, 0) == pytest.approx(expected, abs=1e-14)
        assert np.polynomial.Polynomial(powers)(2.0 * q - 1.0) == pytest.approx(expected, abs=1e-13)
        assert integral_to(q, series, 0) == pytest.approx(
            0.5 * q * np.sum(weights * polynomial(0.5 * q * (fine + 1.0))), abs=1e-15
        )


@pytest.mark.parametrize("clock", range(4))
def test_clocks_run_from_0_to_1_at_their_rates(clock: int) -> None:
    nodes = TABLE[CLOCKS : CLOCKS + NODES]
    assert (clock_at(0.0, clock), clock_at(1.0, clock)) == (0.0, 1.0)
    for n, q in enumerate(nodes):
        assert clock_at(q, clock) == pytest.approx(TABLE[CLOCKS + NODES * clock + n], rel=1e-15)
        assert rate_at(q, clock) == pytest.approx(TABLE[RATES + NODES * clock + n], rel=1e-14)
        slope = (clock_at(q + 1e-6, clock) - clock_at(q - 1e-6, clock)) / 2e-6
        assert slope == pytest.approx(rate_at(q, clock), rel=1e-8)


def test_a_table_has_a_place_for_everything() -> None:
    assert TABLE.size == RATES + 4 * NODES
    assert quadrature.FIVE_POWERS[0] == (1.0, 0.0, 0.0, 0.0, 0.0)


# The balance of a two-way run: its laws in closed form, and the work of friction against quadrature.
SLIDER = Slider(mass=0.005, stiffness=300.0, damping=0.05)
BEARS, SPEED, START, TIME = 3000.0, 40_000.0, 60.0, 0.0731


def sliding(bears: float = BEARS) -> Balance:
    """Return that of a slider on a constant force, which never comes to w = 0: a damped oscillation about G/k."""
    m, k, c = SLIDER.mass, SLIDER.stiffness, SLIDER.damping
    decay = c / (2.0 * m)
    rate = np.sqrt(k / m - decay * decay)
    away = START - bears / k
    nodes, weights = np.polynomial.legendre.leggauss(200)
    time = np.append(0.5 * TIME * (nodes + 1.0), TIME)
    phase = rate * time
    x = bears / k + away * np.exp(-decay * time) * (np.cos(phase) + decay / rate * np.sin(phase))
    v = -away * np.exp(-decay * time) * (decay * decay / rate + rate) * np.sin(phase)
    assert np.abs(v).max() < SPEED
    w = 0.5 * TIME * weights
    distance = SPEED * TIME - (x[-1] - START)
    return Balance(
        slider=SLIDER,
        speed=SPEED,
        start=START,
        time=TIME,
        distance=distance,
        displacement=float(x[-1]),
        velocity=float(v[-1]),
        time_stuck=0.0,
        displacement_integral=float(w @ x[:-1]),
        displacement_squared_integral=float(w @ x[:-1] ** 2),
        velocity_squared_integral=float(w @ v[:-1] ** 2),
        friction_work=bears * distance,
        reverse_work=0.0,
    )


@pytest.mark.parametrize("bears", [0.0, BEARS])
def test_a_constant_force_is_balanced(bears: float) -> None:
    found = sliding(bears)
    assert abs(found.energy_residual) < 1e-12
    assert found.impulse == pytest.approx(bears * TIME, rel=1e-11, abs=1e-11)
    assert found.mean_force == pytest.approx(bears, rel=1e-11, abs=1e-9)
    assert found.excess_over(found.friction_along) == pytest.approx(found.expected_excess(), abs=1e-9 * BEARS)
    # Moving towards the drive it slides less far in the same time: the mean force over time is not that over distance.
    assert found.distance != pytest.approx(SPEED * TIME, rel=1e-6)
    assert found.displacement_mean == pytest.approx(found.displacement_integral / TIME, rel=1e-15)
    assert 0.0 < found.displacement_std < abs(START - bears / 300.0)


@pytest.mark.parametrize(
    "column",
    ["displacement", "velocity", "displacement_integral", "velocity_squared_integral", "friction_work"],
)
def test_what_is_wrong_is_missing_in_the_balance(column: str) -> None:
    found = sliding()
    wrong = replace(found, **{column: 1.001 * getattr(found, column)})
    assert abs(wrong.energy_residual) > 1e-7
    assert wrong.excess_over(wrong.friction_along) != pytest.approx(wrong.expected_excess(), rel=1e-6)


@pytest.mark.parametrize("part", ["speed", "start"])
def test_another_drive_is_missing_too(part: str) -> None:
    found = sliding()
    assert abs(replace(found, **{part: 1.01 * getattr(found, part)}).energy_residual) > 1e-5


def test_another_slider_is_missing_too() -> None:
    for name in ("mass", "stiffness", "damping"):
        other = replace(SLIDER, **{name: 1.01 * getattr(SLIDER, name)})
        assert abs(replace(sliding(), slider=other).energy_residual) > 1e-6


def test_the_end_term_is_added_and_a_reversal_counts_twice() -> None:
    found = sliding()
    size = found.speed * found.time
    without = (found.dissipated + 2.0 * found.reverse_work) / size
    assert abs(found.expected_excess() - without) > 1.0
    assert found.expected_excess() == pytest.approx(without + found.stored / size, rel=1e-12)
    back = replace(found, friction_work=found.friction_work + 7.0, reverse_work=3.5)
    assert back.friction_along == pytest.approx(found.friction_along, rel=1e-15)


def test_it_is_read_with_the_model() -> None:
    run = model(speed=SPEED)
    row = {name: 1.0 for name in Balance.__dataclass_fields__ if name not in {"slider", "speed", "start"}}
    found = Balance.of(run, row)
    assert (found.slider, found.speed, found.start) == (run.slider, SPEED, run.equilibrium_displacement)
    with pytest.raises(Refused, match="slider"):
        Balance.of(model(slider=None), row)


@pytest.mark.parametrize(("pulse", "area"), [(LENS, lens_area), (TRIANGLE, triangle_area)], ids=["lens", "triangle"])
def test_the_work_of_friction_is_that_of_the_areas(pulse: Pulse, area: object) -> None:
    generator = np.random.default_rng(5)
    diameter = generator.uniform(1.0, 6.0, 40)
    birth = np.sort(generator.uniform(-12.0, 30.0, 40))
    strength = generator.uniform(100.0, 400.0, 40)
    places = np.array([31.5, 0.0, 3.25, 17.0, 3.25])
    found = FrictionIntegral(pulse, places)
    for part in (slice(0, 13), slice(13, 13), slice(13, 40)):
        found.add({"birth_distance": birth[part], "diameter": diameter[part], "shear_strength": strength[part]})
    nodes, weights = np.polynomial.legendre.leggauss(12)

    def force(s: float) -> float:
        return float(sum(p * area(s - b, d) for p, b, d in zip(strength, birth, diameter, strict=True)))  # type: ignore[operator]

    cuts = np.concatenate([birth, birth + diameter, birth + 2.0 * diameter, places])
    cuts = np.unique(cuts[(cuts >= 0.0) & (cuts <= places.max())])
    # Between two events y -> s = a + (b - a)(3 y^2 - 2 y^3) takes the roots at both ends away.
    y = 0.5 * (nodes + 1.0)
    pieces = [
        (b - a)
        * sum(
            0.5 * w * 6.0 * q * (1.0 - q) * force(a + (b - a) * (3.0 - 2.0 * q) * q * q)
            for w, q in zip(weights, y, strict=True)
        )
        for a, b in zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True)
    ]
    sums = np.concatenate([[0.0], np.cumsum(pieces)])
    expected = sums[np.searchsorted(cuts, places)]
    assert found.at_places() == pytest.approx(expected, rel=1e-10, abs=1e-9)
    assert found.at_places()[1] == 0.0
    assert expected[0] > 1e4


# Sticks and slips, read off landmarks that were written by hand.
@dataclass(frozen=True, kw_only=True)
class Held:
    """Rows of a made-up slider."""

    groups: dict[str, dict[str, Any]]
    columns: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def rows(self, group: str) -> int:
        return len(next(iter(self.groups[group].values())))

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> np.ndarray:
        return np.asarray(self.groups[group][name])[start:stop]


def _held(*landmarks: tuple[float, float, LandmarkKind]) -> Held:
    time, distance, kind = zip(*landmarks, strict=True)
    return Held(groups={"landmarks": {"time": time, "distance": distance, "kind": kind}})


def test_sticks_and_slips_are_those_of_the_landmarks() -> None:
    stick, slip, back, forward = LandmarkKind
    rows = _held(
        (1.0, 5.0, stick), (1.5, 5.0, slip), (1.8, 9.0, back), (2.0, 7.0, forward), (2.5, 8.0, stick), (4.0, 8.0, slip)
    )
    found = StickSlip.of(rows, 0.0, 5.0)
    assert found.stick_begin.tolist() == [1.0, 2.5]
    assert found.stick_end.tolist() == [1.5, 4.0]
    assert found.stick_times.tolist() == [0.5, 1.5]
    assert found.slip_lengths.tolist() == [4.0]  # up to where it turns; the last slip never ends


@pytest.mark.parametrize(
    ("begin", "end", "sticks", "times"),
    [
        (1.2, 5.0, [(1.2, 1.5), (2.5, 4.0)], [1.5]),
        (0.0, 3.0, [(1.0, 1.5), (2.5, 3.0)], [0.5]),
        (2.6, 3.0, [(2.6, 3.0)], []),
        (1.6, 2.0, [], []),
        (0.0, 0.5, [], []),
        (4.5, 5.0, [], []),
    ],
)
def test_sticks_are_cut_off_where_one_stops_looking(
    begin: float, end: float, sticks: list[tuple[float, float]], times: list[float]
) -> None:
    stick, slip, *_ = LandmarkKind
    rows = _held((1.0, 5.0, stick), (1.5, 5.0, slip), (2.5, 8.0, stick), (4.0, 8.0, slip))
    found = StickSlip.of(rows, begin, end)
    assert list(zip(found.stick_begin.tolist(), found.stick_end.tolist(), strict=True)) == sticks
    assert found.stick_times.tolist() == times


def test_of_very_many_landmarks_the_first_are_taken() -> None:
    stick, slip, *_ = LandmarkKind
    rows = _held((1.0, 5.0, stick), (1.5, 5.0, slip), (2.5, 8.0, stick), (4.0, 8.0, slip))
    found = StickSlip.of(rows, 0.0, 9.0, most=3)
    assert (found.stick_begin.tolist(), found.stick_end.tolist()) == ([1.0, 2.5], [1.5, 4.0])
    assert found.stick_times.tolist() == [0.5]

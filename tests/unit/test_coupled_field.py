"""G in one cell and over a stretch: polynomial, near lives and primitives against the areas themselves."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.pulses import LENS, PULSES, Pulse
from rubnoise.simulation.coupled import quadrature
from rubnoise.simulation.coupled.field import (
    SHAPES,
    Field,
    first_beyond,
    force_and_integral,
    force_in_cell,
    gather,
    merged,
    near_index,
)
from rubnoise.simulation.coupled.quadrature import CLOCKS, INTEGRAL, LEGENDRE, NODES, POWERS, RATES, TABLE, WEIGHTS
from rubnoise.simulation.coupled.steps import WORK, clock_at, integral_to, rate_at, value_at
from rubnoise.simulation.kernels import Scratch
from rubnoise.simulation.state import LiveRows

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


def field_over(pulse: Pulse, some: LiveRows) -> Field:
    return Field.over(pulse.shape, some, -8, 240, WIDTH, Scratch(0))


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
    wide = Field.over("lens", some, -1, 30, 8.0 * WIDTH, Scratch(0)).moments
    for cell in range(31):
        assert merged.py_func(narrow, 8 * cell, 8) == pytest.approx(wide[:, cell], rel=1e-9, abs=1e-6)


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

"""The compiled kernels of triangle and parabola against exact fractions, over single junctions."""

from fractions import Fraction
from itertools import pairwise
from math import inf, pi

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.pulses import PULSES
from rubnoise.simulation.kernels import parabola, triangle

Doubles = NDArray[np.float64]
KERNELS = {"triangle": triangle, "parabola": parabola}
BOOLE = (7, 32, 12, 32, 7)

pytestmark = pytest.mark.parametrize("shape", KERNELS)

DIAMETERS = [0.03, 1.0, 5.53, 240.0]


def areas(
    shape: str, positions: Doubles, birth: float, diameter: float, departure: float = inf, weight: float = 1.0
) -> Doubles:
    total = np.zeros(positions.size)
    rows = (np.array([value]) for value in (birth, diameter, departure, weight * diameter**2))
    KERNELS[shape].deposit_areas(positions, *rows, total)
    return total


def cell_moments(
    shape: str, positions: Doubles, birth: float, diameter: float, departure: float = inf, strength: float = 1.0
) -> Doubles:
    """Return the Legendre moments of the force over every cell between positions."""
    moments = np.zeros((3, positions.size))
    rows = (np.array([value]) for value in (birth, diameter, departure, strength))
    width = (positions[-1] - positions[0]) / (positions.size - 1)
    KERNELS[shape].deposit_moments(positions, width, *rows, moments)
    return moments[:, 1:]


def exact_cell_moments(
    shape: str, left: float, right: float, birth: float, diameter: float, departure: float = inf
) -> list[float]:
    """Return the same over one cell in rational numbers, but for pi/4 and the last rounding.

    On each piece force and P_i are of degree 2 at most: Boole's rule is exact for their product.
    """
    start, stop, born, d = (Fraction(value) for value in (left, right, birth, diameter))
    end = born + 2 * d if departure == inf else min(born + 2 * d, Fraction(departure))
    cuts = sorted({start, stop} | {place for place in (born, born + d, end) if start < place < stop})
    legendre = (lambda y: Fraction(1), lambda y: 2 * y - 1, lambda y: 6 * y * y - 6 * y + 1)

    def height(place: Fraction, *, rising: bool) -> Fraction:
        age = place - born
        if shape == "parabola":
            return age * (2 * d - age)
        return d * (age if rising else 2 * d - age)

    def moment(i: int) -> Fraction:
        total = Fraction(0)
        for low, high in pairwise(cuts):
            rising, alive = (low + high) / 2 < born + d, born < (low + high) / 2 < end
            for n, weight in enumerate(BOOLE if alive else ()):
                place = low + (high - low) * n / 4
                here = height(place, rising=rising) * legendre[i]((place - start) / (stop - start))
                total += (high - low) * weight * here / 90
        return total

    return [pi / 4 * float(moment(i)) for i in range(3)]


def exact_moments(shape: str, positions: Doubles, *life: float) -> Doubles:
    return np.array([exact_cell_moments(shape, a, b, *life) for a, b in pairwise(positions.tolist())]).T


@pytest.mark.parametrize("diameter", DIAMETERS)
def test_area_follows_the_formula_over_a_life(shape: str, diameter: float) -> None:
    birth = 3.7 * diameter
    positions = birth + diameter * np.linspace(-0.1, 2.1, 4_001)
    expected = PULSES[shape].area(positions - birth, diameter)
    assert np.abs(areas(shape, positions, birth, diameter) - expected).max() < 1e-15 * diameter**2
    assert expected.max() == pytest.approx(pi / 4 * diameter**2, rel=1e-12)


def test_a_weight_is_a_strength(shape: str) -> None:
    positions = np.arange(0.0, 12.0, 0.1)
    assert np.allclose(
        areas(shape, positions, 0.5, 5.0, weight=250.0), 250.0 * areas(shape, positions, 0.5, 5.0), rtol=1e-15
    )


def test_a_life_ended_early_has_no_area_from_then_on(shape: str) -> None:
    area = areas(shape, np.arange(0.0, 12.0), 0.5, 5.0, departure=4.0)
    assert area[3] == pytest.approx(PULSES[shape].area(2.5, 5.0), rel=1e-15)
    assert not area[4:].any()


@pytest.mark.parametrize("birth", [0.13, 0.5, 1.0, 0.97])
@pytest.mark.parametrize("diameter", [0.1, 0.4, 0.7, 2.3, 20.0])
def test_moments_of_cells_that_hold_births_mid_lives_and_deaths(shape: str, birth: float, diameter: float) -> None:
    positions = np.arange(0.0, 2.0 * diameter + 3.0)
    got, expected = cell_moments(shape, positions, birth, diameter), exact_moments(shape, positions, birth, diameter)
    assert np.abs(got - expected).max() < 1e-15 * max(1.0, diameter) ** 2


@pytest.mark.parametrize("power", [6, 12, 20, 30])
def test_moments_keep_their_digits_in_narrow_cells(shape: str, power: int) -> None:
    diameter, birth, width = 5.53, 1.234, 0.5 ** (power - 2)
    for place in (birth, birth + diameter, birth + 2.0 * diameter):
        positions = width * (np.floor(place / width) + np.arange(-3, 5))
        got, expected = (
            cell_moments(shape, positions, birth, diameter),
            exact_moments(shape, positions, birth, diameter),
        )
        # The area at each edge is that of a distance of some 10 um, rounded.
        assert np.abs(got - expected).max() < 2e-15 * 12.0 * diameter * width


@pytest.mark.parametrize("ended", [0.15, 0.2, 0.25, 0.55, 1.0, 1.31, 1.9, 2.55, 3.2])
@pytest.mark.parametrize("diameter", [0.9, 1.7])
def test_moments_of_a_life_ended_early(shape: str, ended: float, diameter: float) -> None:
    positions, birth = np.arange(0.0, 6.0, 0.25), 0.15
    got = cell_moments(shape, positions, birth, diameter, departure=ended)
    assert np.abs(got - exact_moments(shape, positions, birth, diameter, ended)).max() < 1e-15


@pytest.mark.parametrize("nudge", [-1.0, 0.0, 1.0])
def test_a_life_may_end_at_mid_life_itself(shape: str, nudge: float) -> None:
    positions = np.arange(0.0, 6.0, 0.25)
    ended = float(np.nextafter(0.1 + 1.7, 1.8 + nudge)) if nudge else 0.1 + 1.7
    got = cell_moments(shape, positions, 0.1, 1.7, departure=ended)
    assert np.abs(got - exact_moments(shape, positions, 0.1, 1.7, ended)).max() < 1e-15


def test_a_missing_kink_would_be_seen(shape: str) -> None:
    """The chords alone are wrong by half a hundredth or more of what the cell holds that mid-life is in."""
    positions = np.arange(0.0, 12.0)
    chords = areas(shape, positions, 0.5, 5.0)
    chord = (chords[5] + chords[6]) / 2
    assert abs(cell_moments(shape, positions, 0.5, 5.0)[0, 5] / chord - 1.0) > 0.005


def test_panels_cut_a_life_anywhere_without_a_trace(shape: str) -> None:
    positions = np.arange(0.0, 12.0, 0.5)
    whole = cell_moments(shape, positions, 0.7, 5.0, departure=9.3)
    for cut in range(1, positions.size - 1):
        parts = [cell_moments(shape, part, 0.7, 5.0, departure=9.3) for part in (positions[: cut + 1], positions[cut:])]
        assert np.array_equal(np.concatenate(parts, axis=1), whole)

"""The compiled kernels of the other pulses over single junctions, and the lanes they work in."""

from fractions import Fraction
from itertools import pairwise
from math import inf, pi, sqrt

import mpmath
import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray

from rubnoise.contact.pulses import PULSES
from rubnoise.simulation.kernels import Deposited, Grid, Scratch, deposit, parabola, peak_areas, triangle
from rubnoise.simulation.kernels.lanes import (
    fused,
    larger,
    load,
    one_after,
    one_before,
    root,
    smaller,
    spread,
    store,
    where_above,
)
from rubnoise.simulation.state import LiveRows
from tests.frozen import frozen

# The compiled kernels of triangle and parabola against exact fractions, over single junctions.
Doubles = NDArray[np.float64]
KERNELS = {"triangle": triangle, "parabola": parabola}
BOOLE = (7, 32, 12, 32, 7)

EACH_POLYNOMIAL = pytest.mark.parametrize("shape", KERNELS)

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
    KERNELS[shape].deposit_moments(positions, width, *rows, np.zeros((2, positions.size)), moments)
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


@EACH_POLYNOMIAL
@pytest.mark.parametrize("diameter", DIAMETERS)
def test_area_follows_the_formula_over_a_life(shape: str, diameter: float) -> None:
    birth = 3.7 * diameter
    positions = birth + diameter * np.linspace(-0.1, 2.1, 4_001)
    expected = PULSES[shape].area(positions - birth, diameter)
    assert np.abs(areas(shape, positions, birth, diameter) - expected).max() < 1e-15 * diameter**2
    assert expected.max() == pytest.approx(pi / 4 * diameter**2, rel=1e-12)


@EACH_POLYNOMIAL
def test_a_weight_is_a_strength(shape: str) -> None:
    positions = np.arange(0.0, 12.0, 0.1)
    assert np.allclose(
        areas(shape, positions, 0.5, 5.0, weight=250.0), 250.0 * areas(shape, positions, 0.5, 5.0), rtol=1e-15
    )


@EACH_POLYNOMIAL
def test_a_life_ended_early_has_no_area_from_then_on(shape: str) -> None:
    area = areas(shape, np.arange(0.0, 12.0), 0.5, 5.0, departure=4.0)
    assert area[3] == pytest.approx(PULSES[shape].area(2.5, 5.0), rel=1e-15)
    assert not area[4:].any()


@EACH_POLYNOMIAL
@pytest.mark.parametrize("birth", [0.13, 0.5, 1.0, 0.97])
@pytest.mark.parametrize("diameter", [0.1, 0.4, 0.7, 2.3, 20.0])
def test_moments_of_cells_that_hold_births_mid_lives_and_deaths(shape: str, birth: float, diameter: float) -> None:
    positions = np.arange(0.0, 2.0 * diameter + 3.0)
    got, expected = cell_moments(shape, positions, birth, diameter), exact_moments(shape, positions, birth, diameter)
    assert np.abs(got - expected).max() < 1e-15 * max(1.0, diameter) ** 2


@EACH_POLYNOMIAL
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


@EACH_POLYNOMIAL
@pytest.mark.parametrize("ended", [0.15, 0.2, 0.25, 0.55, 1.0, 1.31, 1.9, 2.55, 3.2])
@pytest.mark.parametrize("diameter", [0.9, 1.7])
def test_moments_of_a_life_ended_early(shape: str, ended: float, diameter: float) -> None:
    positions, birth = np.arange(0.0, 6.0, 0.25), 0.15
    got = cell_moments(shape, positions, birth, diameter, departure=ended)
    assert np.abs(got - exact_moments(shape, positions, birth, diameter, ended)).max() < 1e-15


@EACH_POLYNOMIAL
@pytest.mark.parametrize("nudge", [-1.0, 0.0, 1.0])
def test_a_life_may_end_at_mid_life_itself(shape: str, nudge: float) -> None:
    positions = np.arange(0.0, 6.0, 0.25)
    ended = float(np.nextafter(0.1 + 1.7, 1.8 + nudge)) if nudge else 0.1 + 1.7
    got = cell_moments(shape, positions, 0.1, 1.7, departure=ended)
    assert np.abs(got - exact_moments(shape, positions, 0.1, 1.7, ended)).max() < 1e-15


@EACH_POLYNOMIAL
def test_a_missing_kink_would_be_seen(shape: str) -> None:
    """The chords alone are wrong by half a hundredth or more of what the cell holds that mid-life is in."""
    positions = np.arange(0.0, 12.0)
    chords = areas(shape, positions, 0.5, 5.0)
    chord = (chords[5] + chords[6]) / 2
    assert abs(cell_moments(shape, positions, 0.5, 5.0)[0, 5] / chord - 1.0) > 0.005


@EACH_POLYNOMIAL
def test_panels_cut_a_life_anywhere_without_a_trace(shape: str) -> None:
    positions = np.arange(0.0, 12.0, 0.5)
    whole = cell_moments(shape, positions, 0.7, 5.0, departure=9.3)
    for cut in range(1, positions.size - 1):
        parts = [cell_moments(shape, part, 0.7, 5.0, departure=9.3) for part in (positions[: cut + 1], positions[cut:])]
        assert np.array_equal(np.concatenate(parts, axis=1), whole)


# The compiled kernel of passes off the centre line against quadrature at 30 digits, over single junctions.
BORN = 101.3
LIVES = [
    (110.0, 0.01), (110.0, 3.4), (110.0, 3.6), (110.0, 60.0), (110.0, 109.9), (30.0, 0.5), (30.0, 25.0), (13.0, 1.0),
    (4.0, 1e-6), (4.0, 2.0), (0.9, 0.3), (390.0, 118.0), (230.0, 5.5),
]  # fmt: skip
"""Diameters and offsets in cells: cells close to the turn and far from it, lives of many cells and of less than one."""


def deposited(diameter: float, offset: float, share: float = 2.0, weight: float = 1.0) -> Deposited:
    """Return what one junction adds, its life ended at a share of half of it."""
    departure = inf if share >= 2.0 else BORN + share * half_of(diameter, offset)
    row = (np.array([value]) for value in (BORN, diameter, 1.0, departure, offset))
    names = ("birth", "diameter", "strength", "departure", "offset")
    rows = LiveRows(junction=np.zeros(1, np.int64), **dict(zip(names, row, strict=True)))
    return deposit("lens", grid_of(diameter), rows, np.array([weight]), Scratch(0))


def grid_of(diameter: float) -> Grid:
    return Grid.around(100, 110 + int(2.0 * diameter), 1.0)


def half_of(diameter: float, offset: float) -> float:
    return sqrt((diameter - offset) * (diameter + offset))


@frozen
def exact(diameter: float, offset: float, share: float) -> list[list[float]]:
    """Return the area at some positions and the three moments of the cells that end there, a row a position."""
    rows = []
    with mpmath.workdps(30):
        d, b, born = mpmath.mpf(diameter), mpmath.mpf(offset), mpmath.mpf(BORN)
        half = mpmath.sqrt(d * d - b * b)
        end = born + 2 * half if share >= 2.0 else mpmath.mpf(BORN + share * half_of(diameter, offset))

        def fraction(s: object) -> object:
            r = min(mpmath.sqrt((s - born - half) ** 2 + b * b) / d, mpmath.mpf(1))
            return (mpmath.acos(r) - r * mpmath.sqrt((1 - r) * (1 + r))) / 2

        for position in chosen(diameter, offset):
            low, high = mpmath.mpf(position - 1), mpmath.mpf(position)
            start, stop = max(low, born), min(high, end)
            around = [born + half + sign * b * size for sign in (-1, 0, 1) for size in (1, 8, 64, 512)]
            cuts = sorted({start, stop, *(cut for cut in around if start < cut < stop)}) if start < stop else []
            legendre = (lambda y: 1, lambda y: y, lambda y: (3 * y * y - 1) / 2)
            moments = [
                sum(
                    mpmath.quad(lambda s, p=p, low=low: fraction(s) * p(2 * (s - low) - 1), piece)
                    for piece in pairwise(cuts)
                )
                for p in legendre
            ]
            area = fraction(high) if born <= high < end else 0
            rows.append([float(area), *map(float, moments)])
    return rows


def chosen(diameter: float, offset: float) -> list[int]:
    """Return positions from birth to death, those about mid-life among them."""
    half = half_of(diameter, offset)
    first, middle, last = (int(BORN + share * half) for share in (0.0, 1.0, 2.0))
    near = {first + 1, first + 2, middle - 3, middle, middle + 1, middle + 4, last, last + 1, last + 2}
    near |= {place + far for place in (first, middle) for far in range(17, 26, 4) if 2.0 * half > 60.0}
    return sorted(place for place in near | {first + int(0.4 * half)} if place > 100)


@pytest.mark.parametrize("share", [2.0, 1.37, 0.62])
@pytest.mark.parametrize(("diameter", "offset"), LIVES)
def test_areas_and_moments_are_those_of_many_digits(diameter: float, offset: float, share: float) -> None:
    found, places = deposited(diameter, offset, share), np.array(chosen(diameter, offset)) - 100
    expected = np.array(exact(diameter, offset, share))
    assert expected[:, 0].max() > 0.0 or diameter < 4.0
    assert np.abs(found.total[places] - expected[:, 0]).max() < 2.0**-50
    mean, slope, bend = np.abs(found.moments[:, places] - expected[:, 1:].T).max(axis=1)
    assert mean < (2e-13 if diameter >= 4.0 else 2e-11)
    assert slope < 2e-11
    assert bend < 2e-9


def test_bits_do_not_depend_on_where_a_run_is_cut() -> None:
    """Lives of all kinds, as one range of 4700 positions and as four, each with the lives that are in it."""
    rng = np.random.default_rng(5)
    sizes = np.concatenate([np.array(LIVES)[:, 0], rng.uniform(4.0, 400.0, 60)])
    names = ("birth", "diameter", "strength", "departure", "offset")
    births = np.sort(rng.uniform(101.0, 4500.0, sizes.size))
    values = (births, sizes, sizes, np.full(sizes.size, inf), rng.uniform(-1.0, 1.0, sizes.size) * sizes)
    rows = LiveRows(junction=np.arange(sizes.size), **dict(zip(names, values, strict=True)))

    def part(begin: int, end: int) -> list[np.ndarray]:
        some = rows.at(np.flatnonzero((rows.death > begin - 1) & (rows.birth < end)))
        found = deposit("lens", Grid.around(begin, end, 1.0), some, some.strength, Scratch(0))
        return [found.total.copy(), *found.moments.copy()]

    edges = [100, 1003, 1337, 4000, 4800]
    parts = [part(*each) for each in pairwise(edges)]
    for whole, pieces in zip(part(edges[0], edges[-1]), zip(*parts, strict=True), strict=True):
        assert whole.tobytes() == np.concatenate(pieces).tobytes()


@pytest.mark.parametrize(("diameter", "offset"), [(110.0, 60.0), (110.0, 0.01), (30.0, 25.0)])
def test_the_lens_of_passes_through_both_centres_is_another(diameter: float, offset: float) -> None:
    """The control: what the test above allows, it would not allow the centred kernel, nor an offset 1e-6 d away."""
    expected, places = np.array(exact(diameter, offset, 2.0)), np.array(chosen(diameter, offset)) - 100
    off = deposited(diameter, offset + 1e-6 * diameter).total[places]
    assert np.abs(off - expected[:, 0]).max() > 100.0 * 2.0**-50
    row = (np.array([value]) for value in (BORN, diameter, 1.0, inf))
    rows = LiveRows(
        junction=np.zeros(1, np.int64),
        **dict(zip(("birth", "diameter", "strength", "departure"), row, strict=True)),
    )
    centred = deposit("lens", grid_of(diameter), rows, np.ones(1), None).total[places]
    assert np.abs(centred - expected[:, 0]).max() > 1e-6


def test_weights_scale_and_lives_before_and_after_add_nothing() -> None:
    once, thrice = deposited(30.0, 5.0), deposited(30.0, 5.0, weight=3.0)
    assert np.allclose(3.0 * once.total, thrice.total, rtol=1e-14, atol=0.0)
    places = np.arange(100, 110 + 60)
    dead = (places < BORN) | (places >= BORN + 2.0 * half_of(30.0, 5.0))
    assert not once.total[dead].any()
    assert once.total[~dead].all()


def test_the_largest_area_is_that_at_mid_life() -> None:
    diameter, offset = np.array([5.0, 5.0, 5.0, 2.0]), np.array([-4.9, 1e-9, 2.5, 1.0])
    r = np.abs(offset) / diameter
    expected = diameter**2 * 0.5 * (np.arccos(r) - r * np.sqrt((1.0 - r) * (1.0 + r)))
    assert peak_areas("parabola", diameter, offset) == pytest.approx(0.25 * pi * (diameter**2 - offset**2), rel=1e-12)
    assert peak_areas("lens", diameter, offset) == pytest.approx(expected, rel=1e-12)


# Eight doubles at once: every operation lane by lane, with the bits of single doubles.
SOURCE = np.random.default_rng(3)
ONE, OTHER, THIRD = (SOURCE.normal(size=11) for _ in range(3))


@njit
def worked(one: Doubles, other: Doubles, third: Doubles, results: Doubles) -> None:
    a, b, c = load(one, 1), load(other, 2), load(third, 3)
    store(results, 0, a + b)
    store(results, 8, a - b)
    store(results, 16, a * b)
    store(results, 24, a / b)
    store(results, 32, fused(a, b, c))
    store(results, 40, root(a * a))
    store(results, 48, smaller(a, b))
    store(results, 56, larger(a, b))
    store(results, 64, where_above(a, b, c, spread(7.0)))
    store(results, 72, one_before(a, b))
    store(results, 80, one_after(a, b))


def test_every_operation_has_the_bits_of_single_doubles() -> None:
    results = np.full(90, np.nan)
    worked(ONE, OTHER, THIRD, results)
    a, b, c = ONE[1:9], OTHER[2:10], THIRD[3:11]
    exact = [float(Fraction(x) * Fraction(y) + Fraction(z)) for x, y, z in zip(a, b, c, strict=True)]
    expected = [
        a + b,
        a - b,
        a * b,
        a / b,
        np.array(exact),
        np.sqrt(a * a),
        np.minimum(a, b),
        np.maximum(a, b),
        np.where(a < b, c, 7.0),
        np.concatenate([a[-1:], b[:-1]]),
        np.concatenate([a[1:], b[:1]]),
    ]
    assert np.array_equal(results[:88].reshape(11, 8), expected)
    assert np.isnan(results[88:]).all()


def test_vectors_are_made_of_the_widest_instructions_there_are() -> None:
    results = np.zeros(88)
    worked(ONE, OTHER, THIRD, results)
    (assembly,) = worked.inspect_asm().values()
    if not any(register in assembly for register in ("zmm", "ymm")):
        pytest.skip("this processor has no vectors of four or eight doubles")
    assert "vaddsd" not in assembly
    assert "vmulsd" not in assembly

"""The compiled kernel of passes off the centre line against quadrature at 30 digits, over single junctions."""

from itertools import pairwise
from math import inf, sqrt

import mpmath
import numpy as np
import pytest

from rubnoise.simulation.kernels import Deposited, Grid, Scratch, deposit, peak_areas
from rubnoise.simulation.state import LiveRows
from tests.frozen import frozen

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
    assert peak_areas(diameter, offset) == pytest.approx(expected, rel=1e-12)

"""The compiled kernel: areas against the formulas, moments of cells against a slow twin, bits, and counts."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.pulses import PULSES, peak_areas
from rubnoise.simulation.kernel import sum_at_places, sum_over_cells
from rubnoise.simulation.state import LiveRows

Doubles = NDArray[np.float64]
SHAPES = ["lens", "triangle", "parabola", "off-centre lens", "off-centre parabola"]
EVERY_SHAPE = pytest.mark.parametrize("name", SHAPES)


def lives(name: str, birth: Any, diameter: Any, departure: Any = np.inf, offset: Any = 0.0) -> LiveRows:
    """Return rows; offsets (in diameters) count for passes off the centre line only."""
    birth, diameter, departure, offset = np.broadcast_arrays(*np.atleast_1d(birth, diameter, departure, offset))
    return LiveRows(
        junction=np.arange(birth.size),
        birth=birth.astype(float),
        diameter=diameter.astype(float),
        strength=np.ones(birth.size),
        departure=departure.astype(float),
        offset=offset * diameter if name.startswith("off") else None,
    )


def fraction(name: str, x: float, aside: float) -> float:
    """Return the area over d^2 at x d from mid-life, of a pass at aside d from the centre line."""
    if name == "off-centre lens":
        r = min(np.hypot(x, aside), 1.0)
        return 0.5 * (np.arccos(r) - r * np.sqrt((1.0 - r) * (1.0 + r)))
    if name == "off-centre parabola":
        return max(0.25 * np.pi * (1.0 - x * x - aside * aside), 0.0)
    return float(PULSES[name].area(1.0 - abs(x), 1.0))


def of_one_life(name: str, rows: LiveRows, row: int, places: Doubles) -> Doubles:
    """Return the area of a life at places, by the formula."""
    half, diameter, begin = rows.half_life[row], rows.diameter[row], rows.birth[row]
    aside = 0.0 if rows.offset is None else rows.offset[row] / diameter
    there = (places >= begin) & (places < rows.death[row])
    x = (places - begin - half) / diameter
    return np.array([diameter**2 * fraction(name, a, aside) if b else 0.0 for a, b in zip(x, there, strict=True)])


def moments_of_one_life(name: str, rows: LiveRows, row: int, cells: int) -> Doubles:
    """The slow twin: Legendre moments over the cells from 0 on, by Gauss nodes in pieces between all landmarks."""
    half, begin, end = rows.half_life[row], rows.birth[row], rows.death[row]
    nodes, weights = np.polynomial.legendre.leggauss(24)
    q, middle = 0.5 + 0.5 * nodes, begin + half
    near = half * np.geomspace(1e-6, 0.5, 24)
    landmarks = np.concatenate([[begin, middle, end], middle - near, middle + near])
    found = np.zeros((3, cells))
    for cell in range(max(int(begin) - 1, 0), min(int(end) + 2, cells)):
        low, high = max(cell, begin), min(cell + 1, end)
        cuts = np.unique([low, *landmarks[(landmarks > low) & (landmarks < high)], high]) if low < high else []
        for a, b in pairwise(cuts):
            s = a + (b - a) * q * q * (3.0 - 2.0 * q)
            share = 0.5 * weights * (b - a) * 6.0 * q * (1.0 - q) * of_one_life(name, rows, row, s)
            z = 2.0 * (s - cell) - 1.0
            found[:, cell] += share.sum(), (share * z).sum(), (share * (1.5 * z * z - 0.5)).sum()
    return found


@EVERY_SHAPE
@pytest.mark.parametrize("diameter", [0.03, 1.0, 5.53, 240.0])
def test_area_follows_the_formula_over_a_life(name: str, diameter: float) -> None:
    rows, spacing = lives(name, 3.7 * diameter, diameter, offset=0.3), diameter / 977.0
    first, end = 3500, 5700
    found = sum_at_places(name.rsplit(maxsplit=1)[-1], rows, rows.diameter**2, first, end, spacing)  # type: ignore[arg-type]
    expected = of_one_life(name, rows, 0, np.arange(first, end) * spacing)
    # The formula off the centre line loses digits next to the ends.
    bound = {"lens": 1e-12, "off-centre lens": 2e-12}.get(name, 2e-14)
    assert np.abs(found - expected).max() < bound * diameter**2
    assert found.max() > 0.4 * diameter**2


BOUNDS = {4.7: 2e-6, 11.3: 2e-7, 27.5: 6e-9, 110.5: 5e-10}
"""Largest error of the mean over a cell, by the cells in a diameter; the others matter less, and err more."""


@pytest.mark.parametrize("diameter", BOUNDS)
@pytest.mark.parametrize("phase", [0.0, 0.13, 0.5, 0.97])
@pytest.mark.parametrize(
    ("name", "offset"),
    [(name, offset) for name in SHAPES for offset in (0.002, 0.04, 0.7) if offset == 0.04 or name.startswith("off")],
)
def test_moments_of_cells_are_those_of_quadrature(name: str, diameter: float, phase: float, offset: float) -> None:
    rows, cells = lives(name, 3.0 + phase, diameter, offset=offset), int(2.0 * diameter) + 8
    shape: Any = name.rsplit(maxsplit=1)[-1]
    _, found = sum_over_cells(shape, rows, np.ones(1), 0, cells, 1.0)
    error = np.abs(found - moments_of_one_life(name, rows, 0, cells) / diameter**2)
    bound = BOUNDS[diameter] if "lens" in name else 1e-13
    assert (error.max(axis=1) < bound * np.array([1.0, 4.0, 50.0])).all()
    assert error[0].sum() < 5.0 * bound


@EVERY_SHAPE
@pytest.mark.parametrize("share", [0.002, 0.01, 0.31, 0.99, 1.0, 1.01, 1.31, 1.99])
@pytest.mark.parametrize("diameter", [0.4, 2.6, 40.3])
def test_a_life_that_is_ended_early_acts_until_then(name: str, share: float, diameter: float) -> None:
    half = lives(name, 3.2, diameter, offset=0.4).half_life[0]
    rows, cells = lives(name, 3.2, diameter, 3.2 + share * half, offset=0.4), int(2.0 * diameter) + 8
    shape: Any = name.rsplit(maxsplit=1)[-1]
    _, found = sum_over_cells(shape, rows, np.ones(1), 0, cells, 1.0)
    expected = moments_of_one_life(name, rows, 0, cells) / diameter**2
    assert np.abs(found - expected).max() < (1e-7 if diameter > 4.0 else 1e-6)


def crowd(name: str) -> LiveRows:
    source = np.random.default_rng(8)
    count = 1200
    diameter = np.concatenate([source.uniform(0.05, 6.0, count - 2), [0.01, 30.0]])
    birth = -10.0 + np.cumsum(source.exponential(0.5, count))
    departure = np.where(source.random(count) < 0.2, birth + source.uniform(0.0, 2.0, count) * diameter, np.inf)
    return lives(name, birth, diameter, departure, source.uniform(-1.0, 1.0, count))


@EVERY_SHAPE
@pytest.mark.parametrize("cuts", [[700], [1, 2, 65, 4100, 9000], list(range(37, 9900, 613))])
def test_only_moments_near_a_cut_depend_on_it(name: str, cuts: list[int]) -> None:
    rows, spacing, shape = crowd(name), 0.05, name.rsplit(maxsplit=1)[-1]
    weight = rows.diameter**2
    total, moments = sum_over_cells(shape, rows, weight, 0, 10_000, spacing)  # type: ignore[arg-type]
    assert np.array_equal(total[:-1], sum_at_places(shape, rows, weight, 0, 10_000, spacing))  # type: ignore[arg-type]
    for first, end in pairwise([0, *cuts, 10_000]):
        # Only who is alive there is handed over, as a block hands over its rows.
        some = np.flatnonzero((rows.birth <= end * spacing) & (rows.death > first * spacing))
        here = rows.at(some), weight[some], first, end, spacing
        part, of_part = sum_over_cells(shape, *here)  # type: ignore[arg-type]
        assert np.array_equal(part, total[first : end + 1])
        assert np.array_equal(of_part[:, 4:-4], moments[:, first:end][:, 4:-4])
        assert np.abs(of_part - moments[:, first:end]).max() < 1e-11 * np.abs(moments).max()


@pytest.mark.parametrize("shape", ["lens", "parabola"])
def test_the_largest_area_is_that_at_mid_life(shape: Any) -> None:
    name, offset = f"off-centre {shape}", np.linspace(-0.99, 0.99, 7)
    rows = lives(name, 0.0, 4.0, offset=offset)
    found = peak_areas(shape, rows.diameter, offset * 4.0)
    middle = [of_one_life(name, rows, row, rows.half_life[row : row + 1])[0] for row in range(7)]
    assert found == pytest.approx(middle, rel=1e-12)

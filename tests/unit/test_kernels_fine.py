"""The compiled kernel for lives of many ticks against exact areas and moments, and against being cut in pieces."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.simulation.kernels.fine import FINEST, deposit_fine_lives
from rubnoise.simulation.kernels.grid import Grid
from rubnoise.simulation.kernels.taylor import cell_weights

Doubles = NDArray[np.float64]

WEIGHTS = cell_weights().ravel()


def deposited(grid: Grid, birth: Doubles, diameter: Doubles, weight: Doubles) -> tuple[Doubles, Doubles]:
    """Return the sum of the lives at the positions wanted, and its moments over the cells that end there."""
    total, moments = np.zeros(grid.position.size), np.zeros(3 * grid.position.size)
    wanted = grid.wanted
    where = (grid.position, grid.origin, grid.spacing, wanted.start, wanted.stop)
    lives = (birth, diameter, np.full(birth.size, np.inf), weight)
    assert not deposit_fine_lives(*where, *lives, WEIGHTS, total, moments).size
    return total[wanted], moments.reshape(3, -1)[:, wanted]


def integral(s: mpmath.mpf, times: int) -> mpmath.mpf:
    """The lens of unit diameter at s, 0 <= s <= 2, integrated from 0 ``times`` times."""
    if s <= 0:
        return mpmath.mpf(0)
    if s > 1:
        # The falling half is the rising one in a mirror: what the integrals have gathered by mid-life goes on.
        return _beyond(min(s, mpmath.mpf(2)), s, times)
    t = mpmath.acos(1 - s)
    sine, cosine = mpmath.sin(t), mpmath.cos(t)
    if times == 0:
        return (t - sine * cosine) / 2
    if times == 1:
        return (sine - t * cosine - sine**3 / 3) / 2
    if times == 2:
        return (3 * t * (1 + 4 * cosine**2) - 15 * sine * cosine + 2 * sine**3 * cosine) / 48
    seven = 7 * sine - t * cosine * (3 + 4 * cosine**2) - mpmath.mpf(19) / 3 * sine**3 + mpmath.mpf(2) / 5 * sine**5
    return seven / 48


def _beyond(inside: mpmath.mpf, s: mpmath.mpf, times: int) -> mpmath.mpf:
    left, after = 2 - inside, s - 2
    whole = [mpmath.mpf(0), mpmath.mpf(2) / 3, mpmath.mpf(2) / 3, 2 * integral(mpmath.mpf(1), 3) + mpmath.mpf(1) / 3]
    if after > 0:
        return [mpmath.mpf(0), whole[1], whole[1] * (after + 1), whole[3] + whole[2] * after + whole[1] * after**2 / 2][
            times
        ]
    t = inside - 1
    if times == 0:
        return integral(left, 0)
    if times == 1:
        return whole[1] - integral(left, 1)
    if times == 2:
        return whole[1] * t + integral(left, 2)
    return 2 * integral(mpmath.mpf(1), 3) + t * t / 3 - integral(left, 3)


def exact_moments(low: mpmath.mpf, high: mpmath.mpf) -> list[mpmath.mpf]:
    """Legendre moments of the lens of unit diameter from low to high, by parts."""
    width = high - low
    (l1, l2, l3), (t1, t2, t3) = ([integral(s, n) for n in (1, 2, 3)] for s in (low, high))
    slope = (t1 + l1) - 2 * (t2 - l2) / width
    return [t1 - l1, slope, (t1 - l1) - 6 * (t2 + l2) / width + 12 * (t3 - l3) / width**2]


# Moments at the ends of a life are differences of integrals over up to 24 cells: of 2e-16 of a diameter, by which the
# place in a life is rounded, they make up to 24^(n + 1/2) times as much. Between the ends they are right to rounding.
BOUNDS = np.array([[1e-14], [1e-13], [5e-12]])


@pytest.mark.parametrize("place", [0.0, 12_345.678, 1e6])
@pytest.mark.parametrize("ticks", [FINEST, 110.5, 127.0, 513.3])
def test_area_and_moments_of_one_life(ticks: float, place: float) -> None:
    # Positions are multiples of a power of two, and none is rounded.
    spacing, diameter = 0.0625, 0.0625 * ticks
    birth = place + 3.0217
    first = int(birth / spacing) - 2
    grid = Grid.around(first, first + int(2.0 * ticks) + 6, spacing)
    area, moments = deposited(grid, np.array([birth]), np.array([diameter]), np.array([diameter**2]))
    with mpmath.workdps(60):
        ages = [(mpmath.mpf(float(p)) - mpmath.mpf(birth)) / mpmath.mpf(diameter) for p in grid.position[grid.wanted]]
        expected = np.array([float(integral(min(s, mpmath.mpf(2)), 0)) for s in ages])
        width = mpmath.mpf(spacing) / mpmath.mpf(diameter)
        cells = np.array([[float(m / width) for m in exact_moments(s - width, s)] for s in ages]).T
    assert np.abs(area / diameter**2 - expected).max() < 2.5e-15
    error = np.abs(moments / diameter**2 - cells)
    assert np.all(error < BOUNDS)
    between = slice(30, -32)
    assert error[:, between].max() < 1e-14
    assert np.abs(cells[2, between]).max() > 1e-6


@pytest.mark.parametrize("offset", np.linspace(0.0, 8.0, 33).tolist())
def test_wherever_birth_and_mid_life_fall_between_panels(offset: float) -> None:
    spacing, diameter = 1.0, 101.0 + 0.37 * offset
    birth = 100.0 + offset
    grid = Grid.around(90, 330, spacing)
    area, moments = deposited(grid, np.array([birth]), np.array([diameter]), np.array([1.0]))
    ages = (grid.position[grid.wanted] - birth) / diameter
    u = np.clip(np.minimum(ages, 2.0 - ages), 0.0, 1.0)
    expected = (np.arccos(1.0 - u) - (1.0 - u) * np.sqrt(u * (2.0 - u))) / 2.0
    assert np.abs(area - expected).max() < 1e-14
    with mpmath.workdps(50):
        width = 1 / mpmath.mpf(diameter)
        exact = [exact_moments(mpmath.mpf(float(s)) - width, mpmath.mpf(float(s))) for s in ages]
        cells = np.array([[float(m / width) for m in each] for each in exact]).T
    assert np.all(np.abs(moments - cells) < BOUNDS)


def crowd(count: int, spacing: float) -> tuple[Doubles, Doubles, Doubles]:
    source = np.random.default_rng(8)
    birth = -40.0 + np.cumsum(source.exponential(0.5, count))
    diameter = FINEST * spacing * (1.0 + source.exponential(0.4, count))
    return birth, diameter, source.random(count) * diameter**2


@pytest.mark.parametrize("cuts", [[700], [64, 128, 4096], [1, 2, 65, 4100, 9000], list(range(37, 9900, 613))])
def test_no_bit_depends_on_where_a_run_is_cut(cuts: list[int]) -> None:
    spacing = 0.05
    birth, diameter, weight = crowd(1200, spacing)
    whole = deposited(Grid.around(0, 10_000, spacing), birth, diameter, weight)
    edges = [0, *cuts, 10_000]
    for first, end in pairwise(edges):
        # Only who is alive there is handed over, as a block hands over its rows.
        near = (birth <= end * spacing) & (birth + 2.0 * diameter > (first - 1) * spacing)
        rows = birth[near], diameter[near], weight[near]
        area, moments = deposited(Grid.around(first, end, spacing), *rows)
        assert np.array_equal(area, whole[0][first:end])
        # No cell ends at the first tick of a run.
        assert np.array_equal(moments[:, first == 0 :], whole[1][:, max(first, 1) : end])


def test_moments_are_left_out_where_nobody_asks_and_the_area_stays() -> None:
    birth, diameter, weight = crowd(300, 0.05)
    grid = Grid.around(0, 3000, 0.05)
    total = np.zeros(grid.position.size)
    wanted = grid.wanted
    where = (grid.position, grid.origin, grid.spacing, wanted.start, wanted.stop)
    lives = (birth, diameter, np.full(birth.size, np.inf), weight)
    deposit_fine_lives(*where, *lives, WEIGHTS, total, np.empty(0))
    assert np.array_equal(total[wanted], deposited(grid, birth, diameter, weight)[0])


def test_weights_of_cells_are_moments_of_powers() -> None:
    weights = cell_weights()
    for n, cell in [(0, 0), (1, 3), (5, 7), (14, 0), (14, 4)]:
        for i in range(3):
            with mpmath.workdps(30):
                low = mpmath.mpf(cell - 4) / 4
                exact = mpmath.quad(
                    lambda y, n=n, i=i, low=low: (low + y / 4) ** n * mpmath.legendre(i, 2 * y - 1), [0, 1]
                )
            assert weights[i, n, cell] == pytest.approx(float(exact), rel=1e-14, abs=1e-17)


def test_a_life_that_went_on_past_its_middle_would_be_seen() -> None:
    """The series alone, eight positions past mid-life, would be off by what is taken off there."""
    birth, diameter = 100.3, 101.0
    grid = Grid.around(90, 330, 1.0)
    area, _ = deposited(grid, np.array([birth]), np.array([diameter]), np.array([1.0]))
    assert 0.7 < area.max() < np.pi / 4
    rising = np.pi / 4 + 0.5 / diameter
    assert rising - area.max() > 0.5 / diameter

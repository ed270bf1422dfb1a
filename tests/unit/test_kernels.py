"""The compiled kernel of centred circles over single junctions: against the plain formula, exact areas and moments."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.overlap import junction_area
from rubnoise.simulation.kernels import coarse, lens
from rubnoise.simulation.kernels.fine import FINEST, deposit_fine_lives
from rubnoise.simulation.kernels.grid import Grid, count_live
from rubnoise.simulation.kernels.taylor import cell_weights
from tests.frozen import frozen

# The compiled kernel against the plain formula, over single junctions.
DIAMETERS = [0.03, 1.0, 5.53, 240.0]


def one(*values):
    """The columns of one life."""
    return [np.array([float(value)]) for value in values]


def padded(positions):
    """Positions with others behind them, as vectors need them."""
    return np.concatenate([positions, positions[-1] + (positions[-1] - positions[0]) * np.arange(1.0, 17.0)])


def areas(positions, birth, diameter, departure=np.inf):
    whole, count = np.zeros(positions.size + 16), np.zeros(positions.size, dtype=np.uint32)
    born, size, left = one(birth, diameter, departure)
    nothing = np.empty(0)
    coarse.deposit_coarse_lives(
        padded(positions), 1.0, 0, positions.size, born, size, left, size * size, nothing, whole, nothing, 1
    )
    count_live(positions, born, left, count)
    return whole[: positions.size], count


def cell_moments(positions, birth, diameter, departure=np.inf, strength=1.0):
    """Legendre moments of the force over every cell."""
    whole = padded(positions)
    moments, gathered = np.zeros(3 * whole.size), np.zeros(6 * whole.size)
    born, size, left, weight = one(birth, diameter, departure, strength * diameter * diameter)
    coarse.deposit_coarse_lives(
        whole, 1.0, 1, positions.size, born, size, left, weight, gathered, np.empty(0), moments, 1
    )
    assert not gathered.any()
    return moments.reshape(3, -1)[:, 1 : positions.size]


def fine_cell_moments(positions, birth, diameter, departure=np.inf, strength=1.0):
    """The same from the kernel for narrow cells."""
    moments = np.zeros((3, positions.size))
    lens.deposit_fine_moments(positions, *one(birth, diameter, departure, strength), moments)
    return moments[:, 1:]


KERNELS = pytest.mark.parametrize("moments_of", [cell_moments, fine_cell_moments])


@frozen
def exact_cell_moments(left, right, birth, diameter, departure=np.inf):
    """The same over one cell, by quadrature at 30 digits with breaks where the area is not smooth."""
    with mpmath.workdps(30):
        left, right, birth, diameter = (mpmath.mpf(float(value)) for value in (left, right, birth, diameter))
        end = min(birth + 2 * diameter, mpmath.mpf(float(departure)))
        breaks = sorted({left, right} | {b for b in (birth, birth + diameter, end) if left < b < right})

        def area(s):
            x = abs(birth + diameter - s)
            if not birth <= s <= end or x >= diameter:
                return mpmath.mpf(0)
            return (diameter**2 * mpmath.acos(x / diameter) - x * mpmath.sqrt(diameter**2 - x**2)) / 2

        return [
            float(mpmath.quad(lambda s, i=i: area(s) * mpmath.legendre(i, 2 * (s - left) / (right - left) - 1), breaks))
            for i in range(3)
        ]


@pytest.mark.parametrize("diameter", DIAMETERS)
def test_area_follows_the_formula_over_a_life(diameter):
    birth = 3.7 * diameter
    positions = birth + diameter * np.linspace(-0.1, 2.1, 40_001)
    expected = np.where(
        (positions >= birth) & (positions < birth + 2 * diameter), junction_area(positions - birth, diameter), 0.0
    )
    area, count = areas(positions, birth, diameter)
    assert np.abs(area - expected).max() < 1e-13 * diameter**2
    assert count.max() == 1


def test_area_at_birth_keeps_its_digits_where_the_formula_loses_them():
    since = 2.0 ** -np.arange(60.0, 1.0, -1.0)
    with mpmath.workdps(60):
        x = [1 - mpmath.mpf(float(s)) for s in since]
        expected = np.array([float((mpmath.acos(y) - y * mpmath.sqrt(1 - y * y)) / 2) for y in x])
    assert np.abs(areas(since, 0.0, 1.0)[0] / expected - 1.0).max() < 1e-13


@pytest.mark.parametrize(("h", "bound"), [(0.05, 1e-11), (0.4, 1e-11), (0.005, 1e-10)])
def test_area_integral_over_a_cell(h, bound):
    birth, diameter = 1234.5678, 5.53
    positions = (
        np.arange(24_600, 24_950 if h == 0.05 else 24_612) * h
        if h == 0.05
        else birth - 0.3 * h + h * np.arange(int(11.2 / h) + 3)
    )
    mean = cell_moments(positions, birth, diameter)[0]
    with mpmath.workdps(40):

        def integral(s):
            """int_0^s a for unit diameter, the elementary antiderivative."""
            s = min(max(s, mpmath.mpf(0)), mpmath.mpf(2))
            x = abs(1 - s)
            rising = (mpmath.sqrt(1 - x * x) - x * mpmath.acos(x) - (1 - x * x) ** mpmath.mpf("1.5") / 3) / 2
            return rising if s <= 1 else mpmath.mpf(2) / 3 - rising

        edges = [integral((mpmath.mpf(float(p)) - mpmath.mpf(birth)) / mpmath.mpf(diameter)) for p in positions]
        expected = np.array([float((b - a) * mpmath.mpf(diameter) ** 3) for a, b in pairwise(edges)])
    # The first and last cells hold a sliver of a life whose area is all rounding; they are held to the life's scale.
    full = expected > 1e-3 * expected.max()
    assert np.abs(mean / np.where(full, expected, 1.0) - 1.0)[full].max() < bound
    assert np.abs(mean - expected).max() < 1e-14 * diameter**3


@KERNELS
@pytest.mark.parametrize("birth", [0.13, 0.5, 0.97])
@pytest.mark.parametrize("diameter", [0.1, 0.4, 0.7, 2.3, 20.0])
def test_moments_of_cells_that_hold_births_mid_lives_and_deaths(birth, diameter, moments_of):
    positions = np.arange(0.0, 2.0 * diameter + 3.0)
    got = moments_of(positions, birth, diameter)
    expected = np.array([exact_cell_moments(a, a + 1.0, birth, diameter) for a in positions[:-1]]).T
    # Differences of integrals lose the square of a life over a cell; the fine kernel is right to 2e-7 even in cells as
    # wide as a life, and to rounding in the narrow ones that it is for.
    bound = 1e-15 * max(1.0, diameter) ** 2 * diameter**3 if moments_of is cell_moments else 2e-7 * diameter**2
    assert np.abs(got - expected).max() < 1e-15 + bound


def test_the_fine_kernel_is_right_to_rounding_in_narrow_cells():
    diameter, birth, h = 5.53, 1.234, 5.53 / 4096
    positions = np.concatenate([birth + k * diameter + h * (np.arange(8) - 3.4) for k in range(3)])
    got = fine_cell_moments(positions, birth, diameter)
    narrow = np.flatnonzero(np.diff(positions) < 2 * h)
    expected = np.array([exact_cell_moments(positions[i], positions[i + 1], birth, diameter) for i in narrow]).T
    assert np.abs(got[:, narrow] - expected).max() < 1e-14 * diameter**2 * h


@KERNELS
@pytest.mark.parametrize("ended", [0.2, 0.55, 1.0, 1.31, 1.9, 2.55, 3.2])
@pytest.mark.parametrize("diameter", [0.9, 1.7])
def test_moments_of_a_life_ended_early(ended, diameter, moments_of):
    positions, birth = np.arange(0.0, 6.0, 0.25), 0.15
    got = moments_of(positions, birth, diameter, departure=ended)
    expected = np.array([exact_cell_moments(a, a + 0.25, birth, diameter, ended) for a in positions[:-1]]).T
    assert np.abs(got - expected).max() < 1e-10 if moments_of is fine_cell_moments else 1e-13


def test_a_life_ended_early_counts_until_then():
    positions = np.arange(0.0, 12.0)
    area, count = areas(positions, 0.5, 5.0, departure=4.0)
    assert count.tolist() == [0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0]
    assert area[3] == pytest.approx(float(junction_area(2.5, 5.0)), rel=1e-14)
    assert not area[4:].any()


def test_strength_scales_the_force_and_not_the_area():
    positions = np.arange(0.0, 12.0)
    assert np.array_equal(cell_moments(positions, 0.5, 5.0, strength=2.0), 2.0 * cell_moments(positions, 0.5, 5.0))


def test_many_lives_are_worked_out_as_each_by_itself():
    """Cells that are complete are worked out while others go on: whatever their number, the moments are the same."""
    positions, generator = np.arange(0.0, 5000.0), np.random.default_rng(7)
    birth = np.sort(generator.uniform(-60.0, 4990.0, 300))
    diameter = generator.uniform(1.5, 90.0, birth.size)
    departure = np.where(generator.random(birth.size) < 0.3, birth + 1.3 * diameter, np.inf)
    whole, nothing = padded(positions), np.empty(0)
    found, gathered = np.full(3 * whole.size, np.nan), np.zeros(6 * whole.size)
    rows = birth, diameter, departure, diameter * diameter
    coarse.deposit_coarse_lives(whole, 1.0, 1, positions.size, *rows, gathered, nothing, found, 0)
    assert not gathered.any()
    apart = sum(cell_moments(positions, b, d, left) for b, d, left in zip(birth, diameter, departure, strict=True))
    found = found.reshape(3, -1)[:, 1 : positions.size]
    # Differences of integrals over a cell lose one power of the life's length after the other.
    assert (np.abs(found - apart).max(axis=1) < 1e-14 * 90.0 ** np.array([3.0, 4.0, 5.0])).all()
    for begin, end in pairwise([1, 700, 2500, positions.size]):
        piece = np.full(3 * whole.size, np.nan)
        coarse.deposit_coarse_lives(whole, 1.0, begin, end, *rows, gathered, nothing, piece, 0)
        assert np.array_equal(piece.reshape(3, -1)[:, begin:end], found[:, begin - 1 : end - 1])
    twice = np.zeros(3 * whole.size)
    for _ in range(2):
        coarse.deposit_coarse_lives(whole, 1.0, 1, positions.size, *rows, gathered, nothing, twice, 1)
    assert np.array_equal(twice.reshape(3, -1)[:, 1 : positions.size], 2.0 * found)


def test_a_missing_kink_would_be_seen():
    """Without what mid-life restores, the moments of its cell are wrong by the size of the junction."""
    positions = np.arange(0.0, 12.0)
    kept = np.zeros(6 * 12)
    coarse._pass_mid_life(positions, 0, 12, 1, 0, 0.5, 5.0, 0.2, np.inf, 125.0, kept)
    assert np.abs(kept).max() > 0.1 * 5.0**3
    assert set(np.flatnonzero(kept).tolist()) <= {12 * n + 6 for n in (3, 4, 5)}


# The compiled kernel for lives of many ticks against exact areas and moments, and against being cut in pieces.
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

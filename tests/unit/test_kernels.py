"""The compiled kernel against the plain formula, over single junctions."""

from itertools import pairwise

import mpmath
import numpy as np
import pytest

from rubnoise.contact.overlap import junction_area
from rubnoise.simulation.kernels import coarse, lens
from rubnoise.simulation.kernels.grid import count_live
from tests.frozen import frozen

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

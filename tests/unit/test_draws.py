"""What a seed decides: streams, deviates by inversion, and draws block by block."""

import itertools
import sys
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy import special

from rubnoise.contact import deviates, plain_deviates
from rubnoise.contact import deviates as module
from rubnoise.contact.deviates import (
    antilogarithm,
    density_at_the_mean,
    exponential,
    gamma_deviates,
    likely_range,
    logarithm,
    normal_above,
    normal_quantile,
)
from rubnoise.contact.laws import Spread
from rubnoise.simulation import draws
from rubnoise.simulation.draws import (
    birth_distances,
    births_per_block,
    count_births,
    draw_blocks,
    first_birth,
    start,
)
from rubnoise.streams import SEED_LIMIT, Stream, generator, uniforms
from tests.models import UNEQUAL, bare, model
from tests.verification.scores import seed_of

# Named streams: the same numbers for the same purpose, and others for another.
COUNT = 20_000


def correlation(one: np.ndarray, other: np.ndarray) -> float:
    """Return the correlation times sqrt(n), a unit normal for independent numbers."""
    return float(np.corrcoef(one, other)[0, 1] * np.sqrt(one.size))


def test_streams_and_their_numbers_never_change() -> None:
    assert {stream.name: int(stream) for stream in Stream} == {
        "FIRST_BIRTH": 1,
        "GAPS": 2,
        "DIAMETERS": 3,
        "STRENGTHS": 4,
        "START_COUNT": 5,
        "START_DIAMETERS": 6,
        "START_AGES": 7,
        "PAST_GAPS": 8,
        "PAST_DIAMETERS": 9,
        "PAST_STRENGTHS": 10,
        "OFFSETS": 11,
        "START_OFFSETS": 12,
        "CENTRES": 13,
        "FAMILIES": 14,
        "CHILDREN": 15,
        "ENCOUNTERS": 16,
        "HEIGHTS": 17,
        "SURFACE": 64,
    }


def test_a_stream_is_philox_keyed_by_seed_and_purpose() -> None:
    """The counter is raised before each output, so the first numbers are those of counter 1 in the lowest word."""
    raw = np.random.Philox(key=np.array([9, 2], dtype=np.uint64), counter=np.array([0, 0, 5, 0], dtype=np.uint64))
    expected = (raw.random_raw(4) >> np.uint64(11)) * 2.0**-53
    assert np.array_equal(uniforms(9, Stream.GAPS, 5, 4), expected)


def test_uniforms_lie_on_a_grid_below_one() -> None:
    u = uniforms(1, Stream.GAPS, 0, COUNT)
    assert np.all((u >= 0.0) & (u < 1.0))
    assert np.array_equal(u * 2.0**53, np.floor(u * 2.0**53))
    assert abs(u.mean() - 0.5) <= 4.0 / np.sqrt(12.0 * COUNT)


def test_numbers_do_not_depend_on_how_many_are_drawn() -> None:
    assert np.array_equal(uniforms(3, Stream.DIAMETERS, 7, 10), uniforms(3, Stream.DIAMETERS, 7, 500)[:10])
    assert np.array_equal(uniforms(3, Stream.DIAMETERS, 7, 10), generator(3, Stream.DIAMETERS, 7).random(10))
    assert uniforms(3, Stream.DIAMETERS, 7, 0).size == 0


def test_streams_are_independent_of_each_other() -> None:
    seed = seed_of("streams")
    drawn = [uniforms(seed, stream, 0, COUNT) for stream in Stream]
    for one, other in itertools.combinations(drawn, 2):
        assert abs(correlation(one, other)) <= 4.5  # 21 pairs
        assert not np.isin(one, other).any()


@pytest.mark.parametrize("stream", Stream)
def test_blocks_and_seeds_of_a_stream_are_independent(stream: Stream) -> None:
    seed = seed_of(f"blocks of {stream.name}")
    first = uniforms(seed, stream, 0, COUNT)
    others = [
        uniforms(seed, stream, 1, COUNT),
        uniforms(seed, stream, 2**63, COUNT),
        uniforms(seed + 1, stream, 0, COUNT),
    ]
    for other in others:
        assert abs(correlation(first, other)) <= 4.5
        assert not np.isin(first, other).any()
    assert abs(correlation(first[:-1], first[1:])) <= 4.5


def test_a_shared_half_would_be_seen() -> None:
    one, other = uniforms(1, Stream.GAPS, 0, COUNT), uniforms(1, Stream.DIAMETERS, 0, COUNT)
    other[: COUNT // 2] = one[: COUNT // 2]
    assert correlation(one, other) > 4.5


def test_the_largest_seed_has_its_own_numbers() -> None:
    largest = uniforms(SEED_LIMIT - 1, Stream.GAPS, 0, 8)
    assert not np.array_equal(largest, uniforms(SEED_LIMIT - 2, Stream.GAPS, 0, 8))


# Deviates by inversion against a library's special functions, and their moments against theory.
MANY = 200_000
UNIFORM = np.random.default_rng(20).random(MANY)


def test_logarithm_is_right_to_the_last_bits():
    x = np.concatenate([UNIFORM[UNIFORM > 0], 1.0 - 2.0**-53 * np.arange(1, 100), 2.0 ** -np.arange(1.0, 1000.0)])
    assert np.abs(logarithm(x) / np.log(x) - 1.0).max() < 5e-16


def test_numpy_has_the_bits_of_the_compiled_functions():
    """What counts the births of a run need not load the compiler for it."""
    tails = [10.0 ** -np.linspace(0.5, 300, 5000), 1.0 - 2.0**-53 * np.arange(1, 100)]
    numbers = np.concatenate([UNIFORM[UNIFORM > 0.0], *tails, 0.5 + 2.0 ** -np.arange(2.0, 50.0)])
    assert plain_deviates.logarithms(numbers).tobytes() == logarithm(numbers).tobytes()
    assert plain_deviates.normal_quantiles(numbers).tobytes() == normal_quantile(numbers).tobytes()
    assert plain_deviates.logarithms(numbers[:0]).size == plain_deviates.normal_quantiles(numbers[:0]).size == 0


@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
def test_without_the_compiler_arrays_of_any_shape_come_back(shape: tuple[int, ...], monkeypatch: pytest.MonkeyPatch):
    numbers = UNIFORM[: np.prod(shape, dtype=int)].reshape(shape)
    compiled = logarithm(numbers), normal_quantile(numbers), exponential(numbers)
    monkeypatch.setattr(deviates, "_has_compiler", lambda: False)
    monkeypatch.setitem(sys.modules, "rubnoise.contact.compiled_deviates", None)  # not to be imported
    plain = logarithm(numbers), normal_quantile(numbers), exponential(numbers)
    assert [(each.shape, each.tobytes()) for each in plain] == [(each.shape, each.tobytes()) for each in compiled]


def test_antilogarithm_is_right_to_the_last_bit():
    x = np.concatenate([np.linspace(-708.0, 709.0, 3001), UNIFORM[:3000] - 0.5, 1e-9 * UNIFORM[:100]])
    with mpmath.workdps(30):
        errors = [
            float(mpmath.mpf(y) / mpmath.exp(v) - 1) for v, y in zip(x.tolist(), antilogarithm(x).tolist(), strict=True)
        ]
    assert max(map(abs, errors)) < 2.0**-52


def test_antilogarithm_undoes_the_logarithm_and_ends_where_doubles_do():
    x = np.array([1e-300, 0.3, 1.0, 7.0, 1e300])
    assert antilogarithm(logarithm(x)) == pytest.approx(x, rel=2e-13)
    assert antilogarithm(np.array([0.0])).tolist() == [1.0]
    tiny = antilogarithm(np.array([-708.0, -1e4]))
    assert tiny[0] == tiny[1] > 0.0


def test_normal_quantile_follows_the_library_into_both_tails():
    p = np.concatenate([UNIFORM, 10.0 ** -np.linspace(0.5, 300, 5000), 1.0 - 10.0 ** -np.linspace(0.5, 15.9, 5000)])
    expected = special.ndtri(p)
    assert np.abs(normal_quantile(p) - expected).max() < 1e-13
    assert np.abs(normal_quantile(p) / expected - 1.0)[np.abs(expected) > 1e-3].max() < 1e-14


@pytest.mark.parametrize(("power", "moment", "variance"), [(1, 1.0, 1.0), (2, 2.0, 20.0), (3, 6.0, 684.0)])
def test_exponential_moments(power, moment, variance):
    z = (np.mean(exponential(UNIFORM) ** power) - moment) / np.sqrt(variance / MANY)
    assert abs(z) <= 4


def test_a_one_percent_longer_gap_would_be_seen():
    z = (np.mean(1.01 * exponential(UNIFORM)) - 1.0) / np.sqrt(1.0 / MANY)
    assert abs(z) > 4


def test_uniform_ends_give_finite_deviates():
    ends = np.array([0.0, 1.0 - 2.0**-53])
    assert np.all(np.isfinite(exponential(ends)))
    assert np.all(np.isfinite(normal_above(ends, 1.0)))


def test_normal_above_lies_above_its_bound():
    bound = -0.5
    assert normal_above(UNIFORM, float(special.ndtr(-bound))).min() >= bound - 1e-12


# Gamma deviates against their distribution function at 30 digits, and against finer pieces of themselves.
FEW_UNIFORM = np.concatenate([np.random.default_rng(4).random(60), [0.0, 2.0**-53, 1e-6, 0.5, 1.0 - 2.0**-53]])
SHAPES = ["0.1111111", "0.5", "1", "2", "7.3", "123.25"]


def relative_errors(shape):
    """Return how far deviates are from the quantile, by one Newton step at 30 digits."""
    for z, deviate in zip(
        normal_above(FEW_UNIFORM, 1.0).tolist(), gamma_deviates(FEW_UNIFORM, shape).tolist(), strict=True
    ):
        x = shape * mpmath.mpf(deviate)
        if z < 0.0:
            off = mpmath.gammainc(shape, 0, x, regularized=True) - mpmath.ncdf(z)
        else:
            off = mpmath.ncdf(-z) - mpmath.gammainc(shape, x, mpmath.inf, regularized=True)
        height = mpmath.exp(shape * mpmath.log(x) - x - mpmath.loggamma(shape))
        yield float(off / height) / (1.0 + abs(float(mpmath.log(deviate))))


@pytest.mark.parametrize("shape", SHAPES)
def test_deviates_invert_the_distribution_function(shape):
    with mpmath.workdps(30):
        assert max(map(abs, relative_errors(mpmath.mpf(shape)))) < 1e-15


@pytest.mark.parametrize("shape", ["0.1111111", "25", "1e20"])
def test_finer_pieces_and_more_terms_change_nothing_but_rounding(shape, monkeypatch):
    as_is = gamma_deviates(FEW_UNIFORM, mpmath.mpf(shape))
    module._table.cache_clear()
    for name, value in {"_PIECES_PER_UNIT": 16, "_REACH": 136, "_TERMS_KEPT": 15, "_TERMS_STEPPED": 44}.items():
        monkeypatch.setattr(module, name, value)
    finer = gamma_deviates(FEW_UNIFORM, mpmath.mpf(shape))
    module._table.cache_clear()
    assert np.max(np.abs(finer / as_is - 1.0) / (1.0 + np.abs(np.log(as_is)))) < 5e-16


def test_too_few_terms_would_be_seen(monkeypatch):
    module._table.cache_clear()
    monkeypatch.setattr(module, "_TERMS_STEPPED", 14)
    with mpmath.workdps(30):
        worst = max(map(abs, relative_errors(mpmath.mpf("0.1111111"))))
    module._table.cache_clear()
    assert worst > 1e-15


@pytest.mark.parametrize("shape", [0.2, 1.0, 40.0])
def test_hardly_anything_lies_beyond_the_likely_range(shape):
    low, high = likely_range(mpmath.mpf(shape))
    below = mpmath.gammainc(shape, 0, shape * low, regularized=True)
    above = mpmath.gammainc(shape, shape * high, mpmath.inf, regularized=True)
    assert 1e-20 < below <= 5e-17
    assert 1e-20 < above <= 5e-17


def test_the_density_at_the_mean_of_the_exponential_law_is_one_over_e():
    assert float(density_at_the_mean(mpmath.mpf(1))) == pytest.approx(np.exp(-1.0), rel=1e-15)


# What a seed decides, block by block.
RUN = bare(distance=3_000.0, tick=1.0)


@pytest.mark.parametrize(
    ("count", "births"), [(0.01, 1000), (20.0, 1000), (100.0, 1000), (100.01, 1001), (5000.0, 50_000)]
)
def test_a_block_has_a_thousand_births_or_ten_lives(count: float, births: int) -> None:
    assert births_per_block(bare(count=count)) == births


def test_each_birth_is_the_one_before_plus_its_gap() -> None:
    birth, gaps = birth_distances(RUN, 4, 2, 812.25), draws._drawn(RUN, 4, Stream.GAPS, 2, 1)
    assert birth[0] == 812.25
    at = 812.25
    for gap, following in zip(gaps.tolist(), birth[1:].tolist(), strict=True):
        at += gap
        assert at == following


def test_blocks_follow_each_other_without_a_gap() -> None:
    block, begin, seen = 0, first_birth(RUN, 4), []
    while begin <= RUN.distance:
        births = draw_blocks(RUN, 4, block, begin)
        assert births.birth[0] == begin
        seen.extend(births.birth.tolist())
        block, begin = block + 1, births.next_birth
    assert len(seen) == count_births(RUN, 4)
    assert block == -(-len(seen) // 1000)
    assert seen[-1] <= RUN.distance < begin


def test_a_birth_at_the_very_end_is_still_of_the_run() -> None:
    birth = birth_distances(RUN, 4, 0, first_birth(RUN, 4))
    at = replace(RUN, distance=float(birth[10]))
    assert count_births(at, 4) == 11
    assert draw_blocks(at, 4, 0, first_birth(at, 4)).next_birth == birth[11]
    assert count_births(replace(RUN, distance=float(np.nextafter(birth[10], 0.0))), 4) == 10


def test_no_birth_within_the_run() -> None:
    run = bare(count=0.01, distance=1e-3, tick=1e-3)
    assert count_births(run, 1) == 0
    assert len(draw_blocks(run, 1, 0, first_birth(run, 1))) == 0


def test_one_purpose_never_shifts_another() -> None:
    """Births are the same whatever the sizes, sizes the same whatever the strength: each has its own stream."""
    wide = bare(distance=3_000.0, spread=Spread(absolute=1.0), start="empty")
    first = draw_blocks(RUN, 4, 0, 1.0)
    assert np.array_equal(draw_blocks(wide, 4, 0, 1.0).birth, first.birth)
    stressed = model(distance=3_000.0)
    assert np.array_equal(draw_blocks(stressed, 4, 0, 1.0).diameter, first.diameter)
    assert np.all(draw_blocks(stressed, 4, 0, 1.0).strength == 250.0)
    assert np.all(first.strength == 1.0)


def test_the_start_is_in_order_of_birth_and_alive() -> None:
    state = start(RUN, 4)
    assert np.all(np.diff(state.live.birth) >= 0.0)
    assert np.all(state.live.birth <= 0.0)
    assert np.all(state.live.death > 0.0)
    assert state.junctions == len(state.live) == state.live.junction[-1] + 1
    assert (state.block, state.ticks, state.begin) == (0, 0, 0.0)
    assert len(start(replace(RUN, start="empty"), 4).live) == 0


@pytest.mark.parametrize("mean", [0.0, 0.3, 20.0, 1024.0, 5000.0])
def test_a_poisson_count_is_how_many_unit_exponentials_fit(mean: float) -> None:
    """Also beyond the 1024 that are drawn at a time."""
    waits = exponential(generator(8, Stream.START_COUNT).random(9_000))
    total, count = 0.0, 0
    while total + waits[count] <= mean:
        total += waits[count]
        count += 1
    assert draws._poisson(8, mean) == count


@pytest.mark.parametrize("births", ["poisson", "regular"])
def test_blocks_drawn_together_are_the_blocks_drawn_alone(monkeypatch, births):
    run = model(distance=6000.0, births=births, strength=UNEQUAL)
    together = draw_blocks(run, 5, 9, 4977.0)
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)
    alone = draw_blocks(run, 5, 9, 4977.0)
    assert len(together) == len(alone) > 500
    for column in ("birth", "diameter", "strength"):
        assert getattr(together, column).tobytes() == getattr(alone, column).tobytes()
    with pytest.raises(ValueError, match="read-only"):
        together.diameter[0] = 1.0

"""What a seed decides: streams, deviates by inversion, and draws block by block."""

import itertools

import mpmath
import numpy as np
import pytest
from rubnoise.contact.deviates import (
    antilogarithm,
    gamma_deviates,
    logarithm,
    normal_above,
    normal_quantile,
)
from scipy import special

from rubnoise.contact import deviates as module
from rubnoise.contact import plain_deviates
from rubnoise.contact.laws import Spread
from rubnoise.simulation.draws import (
    draw_blocks,
)
from rubnoise.streams import Stream, uniforms
from tests.models import bare, model
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


# Deviates by inversion against a library's special functions, and their moments against theory.
MANY = 200_000
UNIFORM = np.random.default_rng(20).random(MANY)


def test_numpy_has_the_bits_of_the_compiled_functions():
    """What counts the births of a run need not load the compiler for it."""
    tails = [10.0 ** -np.linspace(0.5, 300, 5000), 1.0 - 2.0**-53 * np.arange(1, 100)]
    numbers = np.concatenate([UNIFORM[UNIFORM > 0.0], *tails, 0.5 + 2.0 ** -np.arange(2.0, 50.0)])
    assert plain_deviates.logarithms(numbers).tobytes() == logarithm(numbers).tobytes()
    assert plain_deviates.normal_quantiles(numbers).tobytes() == normal_quantile(numbers).tobytes()
    assert plain_deviates.logarithms(numbers[:0]).size == plain_deviates.normal_quantiles(numbers[:0]).size == 0


def test_antilogarithm_is_right_to_the_last_bit():
    x = np.concatenate([np.linspace(-708.0, 709.0, 3001), UNIFORM[:3000] - 0.5, 1e-9 * UNIFORM[:100]])
    with mpmath.workdps(30):
        errors = [
            float(mpmath.mpf(y) / mpmath.exp(v) - 1) for v, y in zip(x.tolist(), antilogarithm(x).tolist(), strict=True)
        ]
    assert max(map(abs, errors)) < 2.0**-52


def test_normal_quantile_follows_the_library_into_both_tails():
    p = np.concatenate([UNIFORM, 10.0 ** -np.linspace(0.5, 300, 5000), 1.0 - 10.0 ** -np.linspace(0.5, 15.9, 5000)])
    expected = special.ndtri(p)
    assert np.abs(normal_quantile(p) - expected).max() < 1e-13
    assert np.abs(normal_quantile(p) / expected - 1.0)[np.abs(expected) > 1e-3].max() < 1e-14


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


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_deviates_invert_the_distribution_function(shape):
    with mpmath.workdps(30):
        assert max(map(abs, relative_errors(mpmath.mpf(shape)))) < 1e-15


def test_too_few_terms_would_be_seen(monkeypatch):
    module._table.cache_clear()
    monkeypatch.setattr(module, "_TERMS_STEPPED", 14)
    with mpmath.workdps(30):
        worst = max(map(abs, relative_errors(mpmath.mpf("0.1111111"))))
    module._table.cache_clear()
    assert worst > 1e-15


# What a seed decides, block by block.
RUN = bare(distance=3_000.0, tick=1.0)


def test_one_purpose_never_shifts_another() -> None:
    """Births are the same whatever the sizes, sizes the same whatever the strength: each has its own stream."""
    wide = bare(distance=3_000.0, spread=Spread(absolute=1.0), start="empty")
    first = draw_blocks(RUN, 4, 0, 1.0)
    assert np.array_equal(draw_blocks(wide, 4, 0, 1.0).birth, first.birth)
    stressed = model(distance=3_000.0)
    assert np.array_equal(draw_blocks(stressed, 4, 0, 1.0).diameter, first.diameter)
    assert np.all(draw_blocks(stressed, 4, 0, 1.0).strength == 250.0)
    assert np.all(first.strength == 1.0)

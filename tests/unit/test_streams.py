"""Named streams: the same numbers for the same purpose, and others for another."""

import itertools

import numpy as np
import pytest

from rubnoise.streams import SEED_LIMIT, Stream, generator, uniforms
from tests.verification.seeds import seed_of

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

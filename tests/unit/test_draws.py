"""What a seed decides: streams, and draws block by block."""

import itertools

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.simulation.draws import draw_block
from rubnoise.streams import LARGEST_UNIFORM, Stream, uniforms
from tests.laws.scores import seed_of
from tests.models import bare, model

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
        "OFFSETS": 5,
        "PAST_GAPS": 8,
        "PAST_DIAMETERS": 9,
        "PAST_STRENGTHS": 10,
        "PAST_OFFSETS": 11,
        "CENTRES": 13,
        "FAMILIES": 14,
        "CHILDREN": 15,
        "SIZES": 16,
        "ENCOUNTERS": 17,
        "HEIGHTS": 18,
        "SURFACE": 64,
    }


def test_a_stream_is_philox_keyed_by_seed_and_purpose() -> None:
    """The counter is raised before each output, so the first numbers are those of counter 1 in the lowest word."""
    raw = np.random.Philox(key=np.array([9, 2], dtype=np.uint64), counter=np.array([0, 0, 5, 0], dtype=np.uint64))
    expected = ((raw.random_raw(4) >> np.uint64(12)) + 0.5) * 2.0**-52
    assert np.array_equal(uniforms(9, Stream.GAPS, 5, 4), expected)
    assert (1.0 - LARGEST_UNIFORM, LARGEST_UNIFORM) == (0.5 * 2.0**-52, (2.0**52 - 0.5) * 2.0**-52)


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


# What a seed decides, block by block.
RUN = bare(distance=3_000.0, tick=1.0)


def test_one_purpose_never_shifts_another() -> None:
    """Births are the same whatever the sizes, sizes the same whatever the strength: each has its own stream."""
    wide = bare(distance=3_000.0, spread=Spread(absolute=1.0), start="empty")
    first, _ = draw_block(RUN, 4, 0, 1.0, 0)
    assert np.array_equal(draw_block(wide, 4, 0, 1.0, 0)[0].birth, first.birth)
    stressed, _ = draw_block(model(distance=3_000.0), 4, 0, 1.0, 0)
    assert np.array_equal(stressed.diameter, first.diameter)
    assert np.all(stressed.strength == 250.0)
    assert np.all(first.strength == 1.0)

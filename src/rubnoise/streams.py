"""Named streams of random numbers: what is drawn for one purpose never shifts what is drawn for another."""

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

STREAM_VERSION = 1
"""Version of the random numbers of a seed; a change to any stream, its use or its order raises it."""

SEED_LIMIT = 2**53
"""Seeds lie below this, so that JSON, HDF5 and TOML readers that hold integers in doubles keep them exactly."""

LARGEST_UNIFORM = 1.0 - 2.0**-53
"""No uniform number is larger than this."""


class Stream(IntEnum):
    """One purpose of random numbers; its value is the second word of the Philox key and never changes."""

    FIRST_BIRTH = 1
    GAPS = 2
    DIAMETERS = 3
    STRENGTHS = 4
    START_COUNT = 5
    START_DIAMETERS = 6
    START_AGES = 7
    PAST_GAPS = 8
    PAST_DIAMETERS = 9
    PAST_STRENGTHS = 10
    OFFSETS = 11
    START_OFFSETS = 12
    CENTRES = 13
    FAMILIES = 14
    CHILDREN = 15
    ENCOUNTERS = 16
    HEIGHTS = 17
    SURFACE = 64


def generator(seed: int, stream: Stream, block: int = 0) -> np.random.Generator:
    """Return the generator of one stream at the beginning of one block.

    Philox 4x64-10 (Salmon et al. 2011, doi:10.1145/2063384.2063405) keyed by (seed, stream), with the block in the
    third word of its counter: any block's numbers are reached without drawing those before it.
    """
    key = np.array([seed, int(stream)], dtype=np.uint64)
    counter = np.array([0, 0, block, 0], dtype=np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter))


def uniforms(seed: int, stream: Stream, block: int, count: int, blocks: int = 1) -> NDArray[np.float64]:
    """Return ``count`` numbers uniform on [0, 1), multiples of 2^-53: integer arithmetic, equal bits everywhere.

    With ``blocks``: ``count`` numbers from each of these blocks, one block after the other.
    """
    source = generator(seed, stream, block)
    if blocks == 1:
        return source.random(count)
    numbers = np.empty((blocks, count))
    bits: Any = source.bit_generator
    begin = bits.state  # before its first number, where another block differs by its word of the counter alone
    for number, row in enumerate(numbers, start=block):
        begin["state"]["counter"][2] = number
        bits.state = begin
        source.random(out=row)
    return numbers.ravel()


_AT_ONCE = 4
"""Numbers that Philox makes of each counter."""


def uniforms_from(seed: int, stream: Stream, block: int, first: int, count: int) -> NDArray[np.float64]:
    """Return ``count`` of the numbers of `uniforms`, from number ``first`` on, without drawing those before it."""
    source = generator(seed, stream, block)
    bits: Any = source.bit_generator
    bits.advance(first // _AT_ONCE)
    before = first % _AT_ONCE
    return source.random(before + count)[before:]

"""Named streams of random numbers: what is drawn for one purpose never shifts what is drawn for another."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

STREAM_VERSION = 2  # version of the random numbers of a seed; a change to any stream, its use or its order raises it

SEED_LIMIT = 2**53
"""Seeds lie below this, so that JSON, HDF5 and TOML readers that hold integers in doubles keep them exactly."""

LARGEST_UNIFORM = 1.0 - 2.0**-53  # no uniform number is larger than this


class Stream(IntEnum):
    """One purpose of random numbers; its value is the second word of the Philox key and never changes."""

    FIRST_BIRTH = 1
    GAPS = 2
    DIAMETERS = 3
    STRENGTHS = 4
    OFFSETS = 5
    PAST_GAPS = 8
    PAST_DIAMETERS = 9
    PAST_STRENGTHS = 10
    PAST_OFFSETS = 11
    CENTRES = 13
    FAMILIES = 14
    CHILDREN = 15
    SIZES = 16
    ENCOUNTERS = 17
    HEIGHTS = 18
    SURFACE = 64


def uniforms(seed: int, stream: Stream, block: int, count: int) -> NDArray[np.float64]:
    """Return ``count`` numbers uniform on (0, 1), odd multiples of 2^-53, from the begin of a block of a stream.

    Philox 4x64-10 (Salmon et al. 2011, doi:10.1145/2063384.2063405) keyed by (seed, stream), with the block in the
    third word of its counter: any block's numbers are reached without drawing those before it. The upper 52 bits of
    each of its numbers are used, in integer arithmetic: equal bits everywhere.
    """
    upper = philox(seed, stream, block).random_raw(count) >> np.uint64(12)
    return (2.0 * upper.astype(np.float64) + 1.0) * 2.0**-53


def philox(seed: int, stream: Stream, block: int = 0) -> np.random.Philox:
    """Return the source of bits of a stream, at the beginning of a block."""
    key = np.array([seed, int(stream)], dtype=np.uint64)
    return np.random.Philox(key=key, counter=np.array([0, 0, block, 0], dtype=np.uint64))

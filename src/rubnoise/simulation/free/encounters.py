"""Encounters: summits at the places of a Poisson process, with heights of density exp(-h); each block is drawn alone.

Heights are drawn in layers: first all above a lowest height, then whole units of s_0 downward. Each layer has its own
stream for each block, so that drawing a deeper layer changes nothing in those above.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.streams import Stream, uniforms

HIGHEST: Final = 37
"""Upper bound of heights above the lowest one of their layer, in units of s_0: -ln 2^-53 is 36.7."""

LAYERS: Final = 64
"""Largest number of layers; the deepest has e^63 times the encounters of the first."""

_FIRST_BLOCK: Final = 2**20
"""Number of block 0 in the streams; blocks before the start have lower numbers."""

_PER_ROOT_PI: Final = float.fromhex("0x1.20dd750429b6dp-1")
"""1/sqrt(pi)."""

_WITHIN_A_UNIT: Final = float.fromhex("0x1.43a54e4e98864p-1")
"""1 - 1/e: the part of exp(-h) within one unit of s_0."""

_E: Final = float.fromhex("0x1.5bf0a8b145769p+1")

_FEWEST: Final = 1000.0
"""Smallest expected number of encounters of the first layer in a block."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Encounters:
    """Encounters in order of place: place (c) from the origin of their block, height (s_0), and their numbers."""

    place: Doubles
    height: Doubles
    number: NDArray[np.int64]

    def __len__(self) -> int:
        """Return the number of encounters."""
        return self.place.size


@dataclass(frozen=True, slots=True, kw_only=True)
class RoughSurface:
    """A surface of which any block can be drawn.

    live: N; tick: length of a tick (c); ticks: number of ticks in a block; base: depth of the first layer below 0, in
    units of s_0.
    """

    live: float
    seed: int
    tick: float
    ticks: int
    base: int

    @classmethod
    def of(cls, live: float, seed: int, tick: float) -> "RoughSurface":
        """Return the surface, with about a thousand encounters per block; base is the least with e^base >= 5 + 25/N.

        Base depends on N because a light slider sinks deep.
        """
        base = 1
        while _power(base) < 5.0 + 25.0 / live:
            base += 1
        ticks = max(ceil(_FEWEST / (_rate(live, base, 0) * tick)), 1)
        return cls(live=live, seed=seed, tick=tick, ticks=ticks, base=base)

    @property
    def length(self) -> float:
        """Length of a block (c)."""
        return float(self.ticks) * self.tick

    def bottom(self, layers: int) -> float:
        """Return the lowest height in the first ``layers`` layers."""
        return float(-(self.base + layers - 1))

    def around(self, block: int, layers: int) -> Encounters:
        """Return all encounters that a slider above the bottom can touch in a block; places are from its origin."""
        reach = ceil(sqrt(HIGHEST + layers) / self.length)
        found = [
            (drawn.place + float(offset) * self.length, drawn.height, drawn.number)
            for offset in range(-reach, reach + 1)
            for drawn in (_drawn(self, block + offset, layer) for layer in range(layers))
        ]
        place, height, number = (np.concatenate(columns) for columns in zip(*found, strict=True))
        order = np.argsort(place, kind="stable")
        return Encounters(place=place[order], height=height[order], number=number[order])


def _rate(live: float, base: int, layer: int) -> float:
    """Return the number of encounters of a layer per c: (N/sqrt(pi)) times the integral of exp(-h) over its heights."""
    above = _power(base + layer - 1) if layer else 0.0
    return live * _PER_ROOT_PI * (_power(base + layer) - above)


def _power(exponent: int) -> float:
    """Return e^exponent by multiplication, so that the bits are equal everywhere."""
    power = 1.0
    for _ in range(exponent):
        power *= _E
    return power


@lru_cache(maxsize=512)
def _drawn(surface: RoughSurface, block: int, layer: int) -> Encounters:
    """Return the encounters of one layer in one block, gap by gap from its origin."""
    rate, length = _rate(surface.live, surface.base, layer), surface.length
    stream = (_FIRST_BLOCK + block) * LAYERS + layer
    expected = rate * length
    count, place = ceil(expected + 6.0 * sqrt(expected) + 16.0), np.empty(0)
    while not place.size or place[-1] < length:  # more numbers begin with the same ones
        place = np.add.accumulate(-np.log1p(-uniforms(surface.seed, Stream.ENCOUNTERS, stream, count)) / rate)
        count *= 2
    place = place[place < length]
    chance = uniforms(surface.seed, Stream.HEIGHTS, stream, place.size)
    height = surface.bottom(layer + 1) - np.log1p(-(chance if layer == 0 else chance * _WITHIN_A_UNIT))
    number = ((_FIRST_BLOCK + block) * LAYERS + layer) * 2**24 + np.arange(place.size, dtype=np.int64)
    return Encounters(place=place, height=height, number=number)

"""Encounters: summits at the places of a Poisson process, with heights of density exp(-h); each block is drawn alone.

Heights are drawn in layers: first all above a lowest height, then whole units of s_0 downward. Each layer has its own
stream for each block, so that drawing a deeper layer changes nothing in those above.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, e, exp, log, pi, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.streams import Stream, uniforms

HIGHEST: Final = 37  # upper bound of heights above the lowest one of their layer, in units of s_0: -ln 2^-53 is 36.7
LAYERS: Final = 64  # largest number of layers; the deepest has e^63 times the encounters of the first

ENCOUNTER: Final = np.dtype([("place", np.float64), ("height", np.float64), ("number", np.int64)])
"""Place (c) from the origin of its block, height (s_0), and number."""

_FIRST_BLOCK: Final = 2**20  # number of block 0 in the streams; blocks before the start have lower numbers
_FEWEST: Final = 1000.0  # smallest expected number of encounters of the first layer in a block


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
        base = ceil(log(5.0 + 25.0 / live))
        ticks = max(ceil(_FEWEST / (_rate(live, base, 0) * tick)), 1)
        return cls(live=live, seed=seed, tick=tick, ticks=ticks, base=base)

    @property
    def length(self) -> float:
        """Length of a block (c)."""
        return float(self.ticks) * self.tick

    def bottom(self, layers: int) -> float:
        """Return the lowest height in the first ``layers`` layers."""
        return float(-(self.base + layers - 1))

    def around(self, block: int, layers: int) -> NDArray[Any]:
        """Return all encounters that a slider above the bottom can touch in a block, in order of place."""
        reach, found = ceil(sqrt(HIGHEST + layers) / self.length), []
        for offset in range(-reach, reach + 1):
            for layer in range(layers):
                drawn = _drawn(self, block + offset, layer).copy()
                drawn["place"] += float(offset) * self.length
                found.append(drawn)
        together = np.concatenate(found)
        return together[np.argsort(together["place"], kind="stable")]


def _rate(live: float, base: int, layer: int) -> float:
    """Return the number of encounters of a layer per c: (N/sqrt(pi)) times the integral of exp(-h) over its heights."""
    above = exp(base + layer - 1) if layer else 0.0
    return live / sqrt(pi) * (exp(base + layer) - above)


@lru_cache(maxsize=512)
def _drawn(surface: RoughSurface, block: int, layer: int) -> NDArray[Any]:
    """Return the encounters of one layer in one block, gap by gap from its origin."""
    rate, length = _rate(surface.live, surface.base, layer), surface.length
    stream = (_FIRST_BLOCK + block) * LAYERS + layer
    expected = rate * length
    count, place = ceil(expected + 6.0 * sqrt(expected) + 16.0), np.empty(0)
    while not place.size or place[-1] < length:  # more numbers begin with the same ones
        place = np.add.accumulate(-np.log1p(-uniforms(surface.seed, Stream.ENCOUNTERS, stream, count)) / rate)
        count *= 2
    found = np.empty(np.count_nonzero(place < length), ENCOUNTER)
    chance = uniforms(surface.seed, Stream.HEIGHTS, stream, found.size)
    within = chance if layer == 0 else chance * (1.0 - 1.0 / e)  # of a layer one unit deep
    found["place"] = place[: found.size]
    found["height"] = surface.bottom(layer + 1) - np.log1p(-within)
    found["number"] = stream * 2**24 + np.arange(found.size)
    return found

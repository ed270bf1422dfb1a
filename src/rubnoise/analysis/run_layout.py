"""Where the summary of a run looks: fixed by its model beforehand, so that all replicates look at the same places."""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, log2
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.bands import bands_of
from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.regular_births import are_at_random
from rubnoise.theory.spectrum import spectral_density

BINS: Final = 64
BANDS: Final = 128
LAGS: Final = 128
"""Numbers that a summary keeps of a histogram, a spectrum and an autocovariance."""

_STDS: Final = 8.0
_LIVES_A_REACH: Final = 2.0
_LIVES_A_SEGMENT: Final = 64.0
_FEWEST_SEGMENTS: Final = 8
_MOST_TICKS_A_LIFE: Final = 1024
_FEWEST_TICKS: Final = 16
_ROUNDING: Final = 1e-6
_CORRELATIONS_A_BATCH: Final = 10.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RunLayout:
    """Edges of a histogram in um^2, lags and segments for every ``stride``-th tick, and ticks of an independent batch.

    ``lags`` and ``segment`` count those ticks, ``step`` um apart: fine ticks cost no more than they tell. Bands of a
    spectrum begin at its bins ``starts`` and are ``widths`` bins wide: of equal ratio, but of one bin at the least.
    """

    edges: Doubles
    batch: int
    stride: int
    step: float
    lags: NDArray[np.int64]
    segment: int
    segments: int
    starts: NDArray[np.int64]
    widths: NDArray[np.int64]

    @classmethod
    @lru_cache(maxsize=8)
    def of(cls, model: Model) -> "RunLayout":
        """Return the layout that suits a model: no part of it grows with the length of its runs."""
        life = model.mean_life_distance
        stride = max(1, floor(life / model.tick / _MOST_TICKS_A_LIFE))
        ticks = model.tick_count // stride + 1
        segment = _segment(ticks, life / (stride * model.tick))
        segments = max(0, (ticks - segment) // (segment // 2) + 1)
        bands = bands_of(segment // 2 + 1, BANDS) if segments else []
        return cls(
            edges=_edges(model),
            batch=ceil(_CORRELATIONS_A_BATCH * _correlation_length(model) / model.tick),
            stride=stride,
            step=stride * model.tick,
            lags=_lags(ticks, life / (stride * model.tick)),
            segment=segment,
            segments=segments,
            starts=np.array([bins[0] for bins in bands], dtype=np.int64),
            widths=np.array([bins.size for bins in bands], dtype=np.int64),
        )

    @property
    def middles(self) -> Doubles:
        """The middles of the bins in um^2."""
        return 0.5 * (self.edges[1:] + self.edges[:-1])

    @property
    def distances(self) -> Doubles:
        """The lags in um."""
        return self.step * self.lags.astype(np.float64)

    def banded(self, values: Doubles) -> Doubles:
        """Return the mean over each band of what a spectrum has in its bins."""
        if not self.starts.size:
            return np.empty(0)
        sums: Doubles = np.add.reduceat(values[: self.starts[-1] + self.widths[-1]], self.starts)
        return sums / self.widths


def _edges(model: Model) -> Doubles:
    """Return edges eight standard deviations about the exact mean, and none far below 0, where no area is."""
    area = area_cumulants(model)
    reach = max(_STDS * area.std, _ROUNDING * area.mean)
    # What is left of a sum whose junctions have all ended may lie below 0 by a rounding.
    low = max(area.mean - reach, -_ROUNDING * reach)
    return np.linspace(low, area.mean + reach, BINS + 1)


def _correlation_length(model: Model) -> float:
    """Return how many um tell as much of a mean as one independent value, S(0)/R(0); a life for regular births."""
    variance = area_cumulants(model).variance
    if not are_at_random(model) or variance == 0.0:
        return model.mean_life_distance
    return float(spectral_density(model, 0.0)) / variance


def _lags(ticks: int, ticks_a_life: float) -> NDArray[np.int64]:
    reach = max(1, min(round(_LIVES_A_REACH * ticks_a_life), ticks // _FEWEST_SEGMENTS))
    return np.arange(0, reach + 1, ceil((reach + 1) / LAGS), dtype=np.int64)


def _segment(ticks: int, ticks_a_life: float) -> int:
    """Return the ticks of a segment, a power of two: 64 lives, or less where a run would hold fewer than eight."""
    most = min(_LIVES_A_SEGMENT * ticks_a_life, 2.0 * ticks / (_FEWEST_SEGMENTS + 1))
    return max(_FEWEST_TICKS, 2 ** floor(log2(max(most, 1.0))))

"""Figures of a record, each with its standard error, or a refusal with the length that the record needs.

Batch means give a standard error from the record alone: the means m of B parts are nearly independent, so the error of
their mean is sqrt(sum of (m - mean)^2 / (B (B - 1))).
Source: Law and Kelton, Simulation Modeling and Analysis, section 9.5.3.
"""

from math import ceil, isfinite

import numpy as np

from rubnoise.analysis.covariance import autocovariance
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused


class RecordTooShort(Refused):
    """A record is too short for a standard error of a figure; the figure itself is in ``estimate``.

    ``length`` and ``needed`` are sliding distances in um; needed is inf if no length would do.
    """

    def __init__(self, what: str, estimate: object, *, length: float, needed: float) -> None:
        """Keep the figure, the length of the record, and the length that it needs."""
        super().__init__(what, estimate, length, needed)
        self.what = what
        self.estimate = estimate
        self.length = length
        self.needed = needed

    def __str__(self) -> str:
        """Return the figure without an error, and the length from which on it has one."""
        message = f"{self.what}: {self.length:.6g} um of sliding are too short for it"
        return f"{message}; it needs about {self.needed:.3g} um" if isfinite(self.needed) else message


def longer(length: float, error: float, largest_error: float) -> float:
    """Return the length in um at which a standard error falls to another: it falls as 1/sqrt(length)."""
    return length * (error / largest_error) ** 2


FEWEST_BATCHES = 30
"""Batches from which a standard error is given: it is then known to 13 %, 1/sqrt(2 n)."""

MOST_BATCHES = 256
LENGTHS_A_BATCH = 10.0
"""Integrated autocorrelation lengths to a batch: what neighbours share then takes a few per cent off the error."""

_WINDOW = 5.0
_FIRST_REACH = 256


def integrated_autocorrelation(values: Doubles) -> float:
    """Return 1 + 2 sum of the autocorrelation, in ticks: the number of ticks that are worth one independent value.

    The sum ends at the first lag beyond five times itself, after which only noise would add up. 1 for constant values,
    inf if the record ends before that lag.
    Source: Sokal (1997), doi:10.1007/978-1-4899-0319-8_6.
    """
    reach = min(_FIRST_REACH, values.size - 1)
    while True:
        covariance = autocovariance(values, reach)
        if covariance[0] <= 0.0:
            return 1.0
        lengths = 2.0 * np.cumsum(covariance) / covariance[0] - 1.0
        enough = np.flatnonzero(np.arange(reach + 1) >= _WINDOW * np.maximum(lengths, 1.0))
        if enough.size:
            return max(1.0, float(lengths[enough[0]]))
        if reach == values.size - 1:
            return float("inf")
        reach = min(4 * reach, values.size - 1)


def batch_length(values: Doubles, tick: float, what: str, estimate: object) -> int:
    """Return the ticks to a batch: ten integrated autocorrelation lengths, or a 256th of the record if that is more.

    ``tick`` in um. Raises RecordTooShort, with the estimate, if fewer than 30 batches fit.
    """
    correlated = integrated_autocorrelation(values)
    length = max(LENGTHS_A_BATCH * correlated, values.size / MOST_BATCHES)
    needed = FEWEST_BATCHES * LENGTHS_A_BATCH * correlated * tick
    if length * FEWEST_BATCHES > values.size:
        raise RecordTooShort(what, estimate, length=values.size * tick, needed=needed)
    return min(ceil(length), values.size // FEWEST_BATCHES)

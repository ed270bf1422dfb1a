"""A number with its standard error and confidence interval, from one record or from the replicates of one point."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf, isfinite, nan, sqrt
from typing import Final

import numpy as np


@dataclass(frozen=True, slots=True, kw_only=True)
class PooledEstimate:
    """A figure from ``runs`` runs, and its standard error in the same unit; inf if it is not known.

    ``from_theory``: the error comes from theory, and not from the scatter of the runs.
    """

    value: float
    standard_error: float
    runs: int = 1
    from_theory: bool = False

    @property
    def reach(self) -> float:
        """Half the width of the 95 % interval: by Student's law for the runs, or a normal law with theory's error."""
        from scipy.special import ndtri, stdtrit

        if self.from_theory:
            return float(ndtri(0.975)) * self.standard_error
        return float(stdtrit(self.runs - 1, 0.975)) * self.standard_error if self.runs > 1 else inf

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval."""
        return self.value - self.reach, self.value + self.reach


UNKNOWN: Final = PooledEstimate(value=nan, standard_error=inf, runs=0)


def estimate(values: Sequence[float]) -> PooledEstimate:
    """Return the mean of the values of independent runs, with its standard error from their scatter."""
    found = np.asarray(values, dtype=np.float64)
    error = _error(found) if found.size > 1 else inf
    return PooledEstimate(value=float(found.mean()), standard_error=error, runs=found.size)


LARGEST: Final = 1e75
"""Figures beyond it are left out as nan is: squares of their squares are not finite. None of ours come near."""


def pooled(name: str, values: Sequence[float], standard_error: float = nan) -> PooledEstimate:
    """Return a figure over replicates (without nan) with the standard error from their scatter.

    Standard deviations are pooled as squares: the root of their mean square is less biased than their mean, by a factor
    1/n. For a single run ``standard_error`` is used, which theory gives for one run.
    """
    found = np.array([value for value in values if abs(value) <= LARGEST])
    if not found.size:
        return UNKNOWN
    if found.size == 1:
        known = isfinite(standard_error)
        return PooledEstimate(value=float(found[0]), standard_error=standard_error if known else inf, from_theory=known)
    if not name.endswith("_std"):
        return estimate(found.tolist())
    squares = np.square(found)
    value = sqrt(float(squares.mean()))
    error = _error(squares) / (2.0 * value) if value else 0.0
    return PooledEstimate(value=value, standard_error=error, runs=found.size)


def ratio(first: PooledEstimate, second: PooledEstimate) -> PooledEstimate:
    """Return first / second for independent runs, with the standard error of first order; the fewer runs count."""
    if not first.value or not second.value:
        return UNKNOWN
    value = first.value / second.value
    relative = hypot(first.standard_error / first.value, second.standard_error / second.value)
    return PooledEstimate(value=value, standard_error=abs(value) * relative, runs=min(first.runs, second.runs))


def ratio_of_pairs(name: str, first: Sequence[float], second: Sequence[float]) -> PooledEstimate:
    """Return first / second of a figure over pairs of runs, the runs of a pair having the same seed.

    Common deviations of a pair cancel: with r = sum a / sum b over pairs (for standard deviations their squares, and
    the root of r), the standard error is that of the mean of a - r b, over the mean of b. Pairs with nan are left out.
    """
    pairs = np.array(
        [pair for pair in zip(first, second, strict=True) if all(abs(value) <= LARGEST for value in pair)]
    ).reshape(-1, 2)
    if not len(pairs) or not pairs[:, 1].any():
        return UNKNOWN
    squared = name.endswith("_std")
    one, other = (np.square(pairs) if squared else pairs).T
    value = float(one.sum() / other.sum())
    error = _error(one - value * other) / abs(float(other.mean())) if len(pairs) > 1 else inf
    if squared:
        value, error = sqrt(value), error / (2.0 * sqrt(value)) if value else 0.0
    return PooledEstimate(value=value, standard_error=error, runs=len(pairs))


def _error(values: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> float:
    return float(values.std(ddof=1)) / sqrt(values.size)

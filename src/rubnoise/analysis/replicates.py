"""A figure from the replicates of one point: their mean and its confidence interval."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf, isfinite, nan, sqrt
from typing import Final

import numpy as np

_TAIL = 0.025
_NORMAL = 1.959963984540054


@dataclass(frozen=True, slots=True, kw_only=True)
class Pooled:
    """A figure of so many runs, and its standard error; inf where it is not known."""

    value: float
    standard_error: float
    runs: int
    from_theory: bool = False

    @property
    def reach(self) -> float:
        """Half the width of the 95 % interval: by Student's law of the runs, or a normal one by the theory's error."""
        from scipy.special import stdtrit

        if self.from_theory:
            return _NORMAL * self.standard_error
        return float(stdtrit(self.runs - 1, 1.0 - _TAIL)) * self.standard_error if self.runs > 1 else inf


LARGEST: Final = 1e75
"""Figures beyond it are left out as nan is: squares of their squares are not finite. None of ours come near."""


def pooled(name: str, values: Sequence[float], standard_error: float = nan) -> Pooled:
    """Return a figure over replicates, nan among them left out, with the standard error that their scatter gives.

    Standard deviations are pooled as squares: the root of their mean square falls less short of the true one than their
    mean does, by the share 1/n of it. Of a single run ``standard_error`` is taken, which theory gives one run.
    """
    found = np.array([value for value in values if abs(value) <= LARGEST])
    if not found.size:
        return Pooled(value=nan, standard_error=inf, runs=0)
    if found.size == 1:
        known = isfinite(standard_error)
        return Pooled(value=float(found[0]), standard_error=standard_error if known else inf, runs=1, from_theory=known)
    if not name.endswith("_std"):
        return Pooled(value=float(found.mean()), standard_error=_error(found), runs=found.size)
    squares = np.square(found)
    value = sqrt(float(squares.mean()))
    return Pooled(value=value, standard_error=_error(squares) / (2.0 * value) if value else 0.0, runs=found.size)


def ratio(first: Pooled, second: Pooled) -> Pooled:
    """Return first / second for independent runs, with the standard error of first order; counts the fewer runs."""
    if not first.value or not second.value:
        return Pooled(value=nan, standard_error=inf, runs=0)
    value = first.value / second.value
    relative = hypot(first.standard_error / first.value, second.standard_error / second.value)
    return Pooled(value=value, standard_error=abs(value) * relative, runs=min(first.runs, second.runs))


def ratio_of_pairs(name: str, first: Sequence[float], second: Sequence[float]) -> Pooled:
    """Return first / second of a figure over runs that were made in pairs, each pair on the same seed.

    What a pair has in common cancels: with r = sum a / sum b over pairs (of standard deviations their squares, and the
    root of r), the standard error is that of the mean of a - r b, over the mean of b. Pairs with nan are left out.
    """
    pairs = np.array(
        [pair for pair in zip(first, second, strict=True) if all(abs(value) <= LARGEST for value in pair)]
    ).reshape(-1, 2)
    if not len(pairs) or not pairs[:, 1].any():
        return Pooled(value=nan, standard_error=inf, runs=0)
    squared = name.endswith("_std")
    one, other = (np.square(pairs) if squared else pairs).T
    value = float(one.sum() / other.sum())
    error = _error(one - value * other) / abs(float(other.mean())) if len(pairs) > 1 else inf
    if squared:
        value, error = sqrt(value), error / (2.0 * sqrt(value)) if value else 0.0
    return Pooled(value=value, standard_error=error, runs=len(pairs))


def _error(values: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> float:
    return float(values.std(ddof=1)) / sqrt(values.size)

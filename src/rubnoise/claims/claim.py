"""What the paper claims, what a simulation and the theory say to it, and the verdict that follows from the numbers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import inf, isnan, sqrt

import numpy as np

_CLOSE = 0.05
"""Relative difference up to which a printed number needs a correction and not another claim."""

_FOUR_SIGMA = 3.1671241833119857e-05
"""Chance that a normal number lies more than four standard deviations above its mean."""


class Verdict(StrEnum):
    """What becomes of a claim; unsettled where simulation and theory do not agree."""

    HOLDS = "holds"
    CORRECTED = "holds with a correction"
    FAILS = "does not hold"
    UNSETTLED = "unsettled"


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A number found by independent runs: their mean, its standard error (unit of the mean), and how many they were."""

    value: float
    standard_error: float
    runs: int

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval, by Student's distribution of the runs' mean."""
        reach = self._reach(0.025)
        return self.value - reach, self.value + reach

    def agrees_with(self, exact: float, rounding: float = 0.0) -> bool:
        """Whether an exact value is as near as four standard deviations of a normal number would be, or as rounding."""
        return abs(self.value - exact) <= max(self._reach(_FOUR_SIGMA), rounding)

    def times(self, factor: float) -> "Estimate":
        """Return the estimate times an exact number."""
        return replace(self, value=factor * self.value, standard_error=abs(factor) * self.standard_error)

    def plus(self, number: float) -> "Estimate":
        """Return the estimate plus an exact number."""
        return replace(self, value=self.value + number)

    def _reach(self, tail: float) -> float:
        from scipy.special import stdtrit

        return float(stdtrit(self.runs - 1, 1.0 - tail)) * self.standard_error if self.runs > 1 else inf


def estimate(values: Sequence[float]) -> Estimate:
    """Return the mean of independent runs' values with its standard error, from their scatter alone."""
    found = np.asarray(values, dtype=np.float64)
    error = float(found.std(ddof=1)) / sqrt(found.size) if found.size > 1 else inf
    return Estimate(value=float(found.mean()), standard_error=error, runs=found.size)


def difference(first: Estimate, second: Estimate) -> Estimate:
    """Return first - second for independent estimates; counts the runs of the one with fewer."""
    error = sqrt(first.standard_error**2 + second.standard_error**2)
    return Estimate(value=first.value - second.value, standard_error=error, runs=min(first.runs, second.runs))


def ratio(first: Estimate, second: Estimate) -> Estimate:
    """Return first / second for independent estimates, with the error of first order; counts the fewer runs."""
    value = first.value / second.value
    relative = sqrt((first.standard_error / first.value) ** 2 + (second.standard_error / second.value) ** 2)
    return Estimate(value=value, standard_error=abs(value) * relative, runs=min(first.runs, second.runs))


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One number of a claim: as printed, as simulated, and exact, all in ``unit``.

    None is printed where the paper gives no number; exact is nan where theory has none, as of a slider that pushes
    back. ``rounding`` is the agreement to ask for where the runs do not scatter, in the same unit.
    """

    name: str
    unit: str
    printed: float | None
    simulated: Estimate
    exact: float
    rounding: float = 0.0

    @property
    def agrees(self) -> bool:
        """Whether simulation and theory agree, where theory has a number."""
        return isnan(self.exact) or self.simulated.agrees_with(self.exact, self.rounding)

    def below(self, bound: float) -> bool:
        """Whether the number is below a bound: the exact one, where there is one, and the interval of the runs."""
        return (isnan(self.exact) or self.exact < bound) and self.simulated.interval[1] < bound


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A claim of the paper with what was found: ``where`` it stands, what it says, and why the verdict is as it is."""

    name: str
    where: str
    says: str
    quantities: tuple[Quantity, ...]
    verdict: Verdict
    because: str
    scenario: str


def verdict_if_agreed(*, quantities: tuple[Quantity, ...], verdict: Verdict) -> Verdict:
    """Return the verdict, or unsettled where simulation and theory disagree about any number it rests on."""
    return verdict if all(quantity.agrees for quantity in quantities) else Verdict.UNSETTLED


def nearness(quantity: Quantity, step: float) -> Verdict:
    """Compare a printed number with the exact one; ``step`` is the unit of its last digit."""
    printed = quantity.printed or 0.0
    if abs(quantity.exact - printed) <= 0.5 * step:
        return Verdict.HOLDS
    return Verdict.CORRECTED if abs(quantity.exact - printed) <= _CLOSE * abs(quantity.exact) else Verdict.FAILS

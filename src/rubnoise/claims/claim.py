"""A claim of the paper, its simulated and exact numbers, and the verdict that follows from them."""

from dataclasses import dataclass
from enum import StrEnum
from math import isnan, nan

from rubnoise.analysis.replicates import PooledEstimate

_CLOSE = 0.05
"""Relative difference up to which a printed number needs a correction and not another claim."""


class Verdict(StrEnum):
    """The verdict on a claim; unsettled if simulation and theory do not agree."""

    HOLDS = "holds"
    CORRECTED = "holds with a correction"
    FAILS = "does not hold"
    UNSETTLED = "unsettled"


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimedNumber:
    """One number of a claim: as printed, as simulated, and exact, all in ``unit``.

    ``printed`` is None if the paper gives no number; ``exact`` is nan if theory has none, as for a slider that
    pushes back. ``rounding`` is the needed agreement if the runs do not scatter, in the same unit.
    """

    name: str
    simulated: PooledEstimate
    exact: float = nan
    unit: str = ""
    printed: float | None = None
    rounding: float = 0.0

    @property
    def agrees(self) -> bool:
        """Whether simulation and theory agree, if theory has a number."""
        return isnan(self.exact) or self.simulated.agrees_with(self.exact, self.rounding)

    def below(self, bound: float) -> bool:
        """Whether the number is below a bound: the exact one, if there is one, and the interval of the runs."""
        return (isnan(self.exact) or self.exact < bound) and self.simulated.interval[1] < bound


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A claim of the paper with its findings: its place (``where``), its words, and the reason of the verdict.

    ``if_agreed`` is the verdict if simulation and theory agree.
    """

    name: str
    where: str
    says: str
    quantities: tuple[ClaimedNumber, ...]
    if_agreed: Verdict
    because: str
    scenario: str

    @property
    def verdict(self) -> Verdict:
        """The verdict, or unsettled if simulation and theory disagree about any number it rests on."""
        return self.if_agreed if all(quantity.agrees for quantity in self.quantities) else Verdict.UNSETTLED


def nearness(quantity: ClaimedNumber, step: float) -> Verdict:
    """Compare a printed number with the exact one; ``step`` is the unit of its last digit."""
    printed = quantity.printed or 0.0
    if abs(quantity.exact - printed) <= 0.5 * step:
        return Verdict.HOLDS
    return Verdict.CORRECTED if abs(quantity.exact - printed) <= _CLOSE * abs(quantity.exact) else Verdict.FAILS

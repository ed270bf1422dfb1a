"""A row of the ledger: what a published source says, what the model says to it, and how a verdict follows."""

from dataclasses import dataclass
from enum import StrEnum
from math import isnan, log

from rubnoise.analysis.replicates import Estimate, ratio
from rubnoise.claims.claim import ClaimedNumber

Range = tuple[float, float]
"""The numbers that a source allows, from the lowest to the highest, both among them."""


class Known(StrEnum):
    """How well a statement is known; only an original that was read, or a proof, can carry a verdict on numbers."""

    PROOF = "proved here"
    ORIGINAL = "original"
    ABSTRACT = "abstract alone"
    SECOND_HAND = "second-hand"
    MEMORY = "memory"


class FieldVerdict(StrEnum):
    """What becomes of a published statement."""

    REPRODUCES = "reproduces"
    CONTRADICTS = "contradicts"
    OUT_OF_SCOPE = "out of scope"
    NOT_YET = "not yet"


_CARRIES_A_VERDICT = (Known.PROOF, Known.ORIGINAL)
_SHOWS_ITS_SUBJECT = (*_CARRIES_A_VERDICT, Known.ABSTRACT)


@dataclass(frozen=True, slots=True, kw_only=True)
class Publication:
    """A publication: author and year, its DOI where it was found, and how well what it says is known."""

    name: str
    doi: str | None
    known: Known


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldClaim:
    """A published statement with the model's numbers.

    ``quantity`` is None if the model has no such number, ``published`` where the source gives none. ``lacks`` says
    what the model would need to speak of the subject at all, and is None if it does. ``scenario`` is that of the
    runs. ``cannot_fail`` marks numbers that agree by assumption, whatever is measured: they test nothing.
    """

    id: str
    source: Publication
    statement: str
    conditions: str
    because: str
    quantity: ClaimedNumber | None = None
    published: Range | None = None
    lacks: str | None = None
    scenario: str | None = None
    cannot_fail: bool = False

    @property
    def numbers_agree(self) -> bool | None:
        """Whether the model's numbers lie among the published ones: the exact one, and some of the runs' interval.

        None if there is nothing to compare, or no comparison could fail.
        """
        if self.quantity is None or self.published is None or self.cannot_fail:
            return None
        low, high = self.published
        exact, simulated = self.quantity.exact, self.quantity.simulated.interval
        return (isnan(exact) or low <= exact <= high) and simulated[0] <= high and low <= simulated[1]

    @property
    def verdict(self) -> FieldVerdict:
        """What follows from the numbers, as far as the source is known."""
        if self.lacks is not None and self.source.known in _SHOWS_ITS_SUBJECT:
            return FieldVerdict.OUT_OF_SCOPE
        if self.numbers_agree is None or self.source.known not in _CARRIES_A_VERDICT:
            return FieldVerdict.NOT_YET
        return FieldVerdict.REPRODUCES if self.numbers_agree else FieldVerdict.CONTRADICTS

    @property
    def missing(self) -> str | None:
        """What a verdict waits for; None if there is one."""
        if self.verdict is not FieldVerdict.NOT_YET:
            return None
        if self.cannot_fail:
            return "a number that could disagree"
        if self.source.known not in _CARRIES_A_VERDICT:
            return f"a look at the original, which is known from {_KNOWN_FROM[self.source.known]}"
        return "a published number to compare with"


_KNOWN_FROM = {
    Known.ABSTRACT: "its abstract alone",
    Known.SECOND_HAND: "the notes of others",
    Known.MEMORY: "memory alone",
}


def exponent(near: Estimate, far: Estimate, factor: float) -> Estimate:
    """Return n of a power law between two points whose variable differs by ``factor``: ln(far/near) / ln(factor)."""
    found = ratio(far, near)
    return Estimate(
        value=log(found.value) / log(factor),
        standard_error=found.standard_error / found.value / abs(log(factor)),
        runs=found.runs,
    )


def exponent_of(
    name: str, near: tuple[Estimate, float], far: tuple[Estimate, float], factor: float, *, times: float = 1.0
) -> ClaimedNumber:
    """Return an exponent, simulated and exact, times a number that turns one variable into another.

    ``near`` and ``far`` are estimates with their exact values, nan if theory has none.
    """
    simulated = exponent(near[0], far[0], factor).times(times)
    return ClaimedNumber(
        name=name,
        simulated=simulated,
        exact=times * log(far[1] / near[1]) / log(factor),
    )

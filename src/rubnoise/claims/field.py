"""A row of the ledger: a published statement, the model's numbers, and the verdict that follows."""

from dataclasses import dataclass
from enum import StrEnum
from math import isnan, log

from rubnoise.analysis.replicates import PooledEstimate, ratio
from rubnoise.claims.claim import ClaimedNumber

Range = tuple[float, float]
"""The numbers that a source allows, from the lowest to the highest, both among them."""


class Known(StrEnum):
    """How well a statement is known; the ledger has only statements read, at least in an abstract, or proved."""

    PROOF = "proved here"
    ORIGINAL = "original"
    ABSTRACT = "abstract alone"
    SECOND_HAND = "law in the abstract, numbers second-hand"


class FieldVerdict(StrEnum):
    """The verdict on a published number."""

    AGREES = "agrees"
    DISAGREES = "disagrees"
    NO_TEST = "no test"


@dataclass(frozen=True, slots=True, kw_only=True)
class Publication:
    """A publication: author and year, its DOI if it was found, and how well its statement is known.

    ``label`` is its name in a table.
    """

    label: str
    name: str
    doi: str | None
    known: Known


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldClaim:
    """A published statement with the model's numbers.

    ``label`` is the name of the number in a table. ``published`` is None if the source gives no number, and ``widened``
    if it holds several readings of the source: to lie in it is then no test. ``scenario`` is that of the runs.
    """

    id: str
    label: str
    source: Publication
    statement: str
    conditions: str
    because: str
    quantity: ClaimedNumber | None = None
    published: Range | None = None
    widened: bool = False
    scenario: str | None = None

    @property
    def numbers_agree(self) -> bool | None:
        """Whether the model's numbers agree with the published range: the exact one, and a part of the runs' interval.

        None if there is nothing to compare.
        """
        if self.quantity is None or self.published is None:
            return None
        low, high = self.published
        exact, simulated = self.quantity.exact, self.quantity.simulated.interval
        return (isnan(exact) or low <= exact <= high) and simulated[0] <= high and low <= simulated[1]

    @property
    def verdict(self) -> FieldVerdict:
        """The verdict that follows from the numbers."""
        agree = None if self.widened and self.numbers_agree else self.numbers_agree
        return {None: FieldVerdict.NO_TEST, True: FieldVerdict.AGREES, False: FieldVerdict.DISAGREES}[agree]


def exponent(near: PooledEstimate, far: PooledEstimate, factor: float) -> PooledEstimate:
    """Return n of a power law between two points whose variable differs by ``factor``: ln(far/near) / ln(factor)."""
    found = ratio(far, near)
    return PooledEstimate(
        value=log(found.value) / log(factor),
        standard_error=found.standard_error / found.value / abs(log(factor)),
        runs=found.runs,
    )


def exponent_of(
    name: str,
    near: tuple[PooledEstimate, float],
    far: tuple[PooledEstimate, float],
    factor: float,
    *,
    times: float = 1.0,
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

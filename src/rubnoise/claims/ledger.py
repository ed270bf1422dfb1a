"""The ledger of the field: every published statement in its order, with the model's numbers."""

from collections.abc import Callable, Iterator, Sequence

from rubnoise.claims import field_levels, field_spectra, field_traces
from rubnoise.claims.evidence import Report
from rubnoise.claims.field import FieldClaim

_SOURCES: tuple[Callable[[Report], Sequence[FieldClaim]], ...] = (
    field_levels.claims,
    field_spectra.claims,
    field_traces.claims,
)


def evaluate_field(report: Report) -> tuple[FieldClaim, ...]:
    """Run what the ledger rests on, from fixed seeds, and return every row.

    ``report`` is called with a text on the run that begins.
    """
    return tuple(_all(report))


def disagreeing(claims: Sequence[FieldClaim]) -> list[str]:
    """Return the rows whose simulated and exact numbers differ by more than four standard errors."""
    return [claim.id for claim in claims if claim.quantity is not None and not claim.quantity.agrees]


def _all(report: Report) -> Iterator[FieldClaim]:
    for claims in _SOURCES:
        yield from claims(report)

"""The ledger of the field: every published statement in its order, with the model's numbers."""

from collections.abc import Callable, Iterator, Sequence

from rubnoise.claims import field_levels, field_spectra, field_traces
from rubnoise.claims.evidence import Tell
from rubnoise.claims.field import FieldClaim

_SOURCES: tuple[Callable[[Tell], Sequence[FieldClaim]], ...] = (
    field_levels.claims,
    field_spectra.claims,
    field_traces.claims,
)


def settle_field(tell: Tell) -> tuple[FieldClaim, ...]:
    """Run what the ledger rests on, from fixed seeds, and return every row.

    ``tell`` is told what is being run.
    """
    return tuple(_all(tell))


def disagreeing(claims: Sequence[FieldClaim]) -> list[str]:
    """Return the rows whose simulated and exact numbers differ by more than four standard errors."""
    return [claim.id for claim in claims if claim.quantity is not None and not claim.quantity.agrees]


def _all(tell: Tell) -> Iterator[FieldClaim]:
    for claims in _SOURCES:
        yield from claims(tell)

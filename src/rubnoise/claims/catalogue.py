"""Every claim of the paper, in the order in which the paper makes them, and every published statement of its field."""

from collections.abc import Sequence

from rubnoise.claims import (
    area_spread,
    contact_and_slider,
    field_levels,
    field_normal,
    field_spectra,
    field_traces,
    rabinowicz,
    spectrum,
    unequal_sizes,
)
from rubnoise.claims.claim import Claim
from rubnoise.claims.evidence import Report
from rubnoise.claims.field import FieldClaim

_OF_PAPER = (contact_and_slider.claims, rabinowicz.claims, area_spread.claims, spectrum.claims, unequal_sizes.claims)
_OF_FIELD = (field_levels.claims, field_normal.claims, field_spectra.claims, field_traces.claims)

ORDER = (
    "life_mean",
    "rabinowicz",
    "present_mean",
    "mean_area",
    "live_count",
    "constant_speed",
    "area_spread",
    "psd_decay",
    "psd_same",
    "psd_sizes",
    "psd_floor",
    "few_or_many",
)


def evaluate_claims(report: Report) -> tuple[Claim, ...]:
    """Make the runs of all claims, from fixed seeds, and return every claim with its verdict.

    ``report`` is called with a text about each run that begins.
    """
    found = [claim for claims in _OF_PAPER for claim in claims(report)]
    return tuple(sorted(found, key=lambda claim: ORDER.index(claim.name)))


def evaluate_field(report: Report) -> tuple[FieldClaim, ...]:
    """Make the runs of the field's ledger, and return every row, as `evaluate_claims` does."""
    return tuple(claim for claims in _OF_FIELD for claim in claims(report))


def disagreeing(claims: Sequence[FieldClaim]) -> list[str]:
    """Return the rows whose simulated and exact numbers differ by more than four standard errors."""
    return [claim.id for claim in claims if claim.quantity is not None and not claim.quantity.agrees]

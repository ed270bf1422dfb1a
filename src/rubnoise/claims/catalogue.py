"""Every claim of the paper, in the order in which the paper makes them."""

from collections.abc import Callable, Iterator, Sequence

from rubnoise.claims import area_spread, contact_and_slider, rabinowicz, spectrum, unequal_sizes
from rubnoise.claims.claim import Claim
from rubnoise.claims.evidence import Report

_SOURCES: tuple[Callable[[Report], Sequence[Claim]], ...] = (
    contact_and_slider.claims,
    rabinowicz.claims,
    area_spread.claims,
    spectrum.claims,
    unequal_sizes.claims,
)

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
    """Run what the claims rest on, from fixed seeds, and return every claim with its verdict.

    ``report`` is called with a text on the run that begins.
    """
    return tuple(sorted(_all(report), key=lambda claim: ORDER.index(claim.name)))


def _all(report: Report) -> Iterator[Claim]:
    for claims in _SOURCES:
        yield from claims(report)

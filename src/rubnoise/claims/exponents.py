"""Exponents: how an amplitude grows with speed, junction size or load, from two points of a sweep."""

from math import log

from rubnoise.analysis.replicates import Estimate, ratio
from rubnoise.claims.claim import Quantity


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
) -> Quantity:
    """Return an exponent, simulated and exact, times a number that turns one variable into another.

    ``near`` and ``far`` are estimates with their exact values, nan where theory has none.
    """
    simulated = exponent(near[0], far[0], factor).times(times)
    return Quantity(
        name=name,
        simulated=simulated,
        exact=times * log(far[1] / near[1]) / log(factor),
    )

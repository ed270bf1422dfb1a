"""Section 2: Rabinowicz's model, from which the paper starts, and its constant contact area."""

from collections.abc import Sequence

from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict
from rubnoise.claims.evidence import Evidence, Report, gather
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.cumulants import area_cumulants

SCENARIO = "claims/rabinowicz.toml"
_CONSTANT = 1e-12
"""Relative spread that rounding leaves of a constant area."""


def claims(report: Report) -> Sequence[Claim]:
    """Run the points and evaluate the claim."""
    found = gather(SCENARIO, _measured, report)
    constant, odd, lens = (
        _ripple(found, shape, count, words)
        for shape, count, words in (
            ("triangle", 20, "triangle, 20 junctions"),
            ("triangle", 21, "triangle, 21 junctions"),
            ("lens", 20, "lens, 20 junctions"),
        )
    )
    quantities = (constant, odd, lens)
    still = constant.exact <= _CONSTANT and constant.simulated.value <= _CONSTANT
    everywhere = still and all(quantity.exact <= _CONSTANT for quantity in quantities)
    return [
        Claim(
            name="rabinowicz",
            where="Section 2",
            says="In Rabinowicz's model, identical junctions are born at regular spacing. Their contact area is "
            "constant.",
            quantities=quantities,
            if_agreed=Verdict.HOLDS if everywhere else Verdict.CORRECTED if still else Verdict.FAILS,
            because="This is true for triangles and an even number of junctions. An odd number leaves a ripple of "
            "1/(sqrt(3) N_jm^2) of the mean. The lens, which is not a triangle, also leaves a ripple.",
            scenario=SCENARIO,
        )
    ]


def _measured(_model: Model, record: MemoryRecord) -> dict[str, float]:
    area = record["trace"]["real_contact_area"]
    return {"ripple": float(area.std() / area.mean())}


def _ripple(found: Evidence, shape: str, count: int, words: str) -> ClaimedNumber:
    point = found.at(shape=shape, count=count)
    area = area_cumulants(point.model)
    ripple = area.std / area.mean
    return ClaimedNumber(
        name=f"std over mean: {words}",
        printed=0.0,
        simulated=point.numbers["ripple"],
        exact=ripple,
        # The runs do not scatter; what is left is that ticks take their samples of the period not quite evenly.
        rounding=max(_CONSTANT, 1e-3 * ripple),
    )

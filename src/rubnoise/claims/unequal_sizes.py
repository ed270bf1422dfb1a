"""The effect of unequal sizes on the mean area of live junctions, Eq. (8), and on the spectrum of Figure 9."""

from collections.abc import Sequence

import numpy as np

from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict, nearness
from rubnoise.claims.evidence import Evidence, Found, Report, gather
from rubnoise.claims.spectrum import SAME, in_bands, power_ratio
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.second_order import density_at_zero

SCENARIO = "claims/size_spread.toml"
_EQUAL, _PAPER, _WIDE, _WIDEST = "0 um", "0.2 um", "1 um", "2 um"
"""Standard deviations of the diameter: none, that of the paper, and two larger ones."""


def claims(report: Report) -> Sequence[Claim]:
    """Run the points and evaluate the claims about them."""
    found = gather(SCENARIO, _measured, report)
    return [_present_mean(found), _sizes(found)]


def _measured(model: Model, record: MemoryRecord) -> dict[str, float]:
    trace, rows = record["trace"], record["junctions"]
    alive = trace["junction_count"] > 0
    present = (trace["real_contact_area"][alive] / trace["junction_count"][alive]).mean()
    newborn = rows["diameter"][rows["birth_distance"] >= 0.0]
    over_lives = float(model.pulse.life_mean()) * np.square(newborn).mean()
    return {"present": float(present / over_lives), **in_bands(model, record)}


def _present_mean(found: Evidence) -> Claim:
    quantities = tuple(_present(found.at(spread=spread), spread) for spread in (_EQUAL, _PAPER, _WIDE, _WIDEST))
    paper = quantities[1]
    return Claim(
        name="present_mean",
        where="Eq. (8)",
        says="The mean area of the junctions present at a moment is the mean area of a junction during its life.",
        quantities=quantities,
        if_agreed=nearness(paper, step=1e-9),
        because="This is true for junctions of one size. Larger junctions live longer, so you meet them more often. "
        "The mean over the junctions present is E[d^3]/(E[d] E[d^2]) times the mean over lives, "
        f"{100.0 * (paper.exact - 1.0):.2f} % more with the spread of the paper. Eq. (10) needs the mean over the "
        "junctions present.",
        scenario=SCENARIO,
    )


def _present(point: Found, spread: str) -> ClaimedNumber:
    moment = point.model.sizes.moment
    return ClaimedNumber(
        name=f"mean over junctions present, over that of lives, spread {spread}",
        printed=1.0,
        simulated=point.numbers["present"],
        exact=moment(3) / (moment(1) * moment(2)),
    )


def _sizes(found: Evidence) -> Claim:
    equal = found.at(spread=_EQUAL)
    quantities = (
        *(
            power_ratio(found.at(spread=spread), equal, f"S at low wavenumbers, spread {spread} over none")
            for spread in (_PAPER, _WIDE, _WIDEST)
        ),
        power_ratio(
            found.at(spread=_WIDEST), equal, f"the same over variance and life, {_WIDEST} over none", scaled=True
        ),
    )
    rise = [density_at_zero(found.at(spread=each).model) / density_at_zero(equal.model) for each in (_WIDE, _WIDEST)]
    area = area_cumulants(found.at(spread=_WIDEST).model).mean / area_cumulants(equal.model).mean
    holds = all(abs(quantity.exact - 1.0) <= SAME for quantity in quantities)
    return Claim(
        name="psd_sizes",
        where="Section 3, Fig. 9",
        says="The relative size of the junctions has a negligible effect on the spectral density.",
        quantities=quantities,
        if_agreed=Verdict.HOLDS if holds else Verdict.FAILS,
        because="S(0) is proportional to E[d^6], mostly from the largest junctions. The spread of the paper is too "
        f"small to show it, but one of {_WIDE} multiplies S(0) by {rise[0]:.2f}, and one of {_WIDEST} by "
        f"{rise[1]:.2f}. At {_WIDEST} the mean area also grows, by a factor of {area:.2f}; over its square, S(0) still "
        f"grows by {rise[1] / area**2:.2f}. The claim psd_same covers the size that changes with the number of "
        "junctions.",
        scenario=SCENARIO,
    )

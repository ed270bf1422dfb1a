"""Figure 7: the fluctuation of the real contact area, which is smaller with more junctions."""

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt

from rubnoise.analysis.replicates import difference
from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict
from rubnoise.claims.evidence import Evidence, Report, gather
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.cumulants import area_cumulants

SCENARIO = "claims/area_spread.toml"
_PRINTED = ((100.0, 22.0, 1.0), (500.0, 110.0, 10.0))
"""A_rm in um^2, the printed drop from 10 to 50 junctions in um^2, and the unit of its last digit."""


def claims(report: Report) -> Sequence[Claim]:
    """Run the points and evaluate the claim that Figure 7 makes."""
    found = gather(SCENARIO, _measured, report)
    quantities = tuple(_drop(found, area, printed, 10, 50) for area, printed, _ in _PRINTED)
    early, late = (_drop(found, 500.0, None, *counts) for counts in ((10, 30), (30, 50)))
    near = all(
        abs(quantity.exact - printed) <= 0.5 * step
        for quantity, (_, printed, step) in zip(quantities, _PRINTED, strict=True)
    )
    bends = early.exact > late.exact > 0.0 and early.simulated.value > late.simulated.value
    plain = [_drop_of_one_size(found, area) for area, _, _ in _PRINTED]
    return [
        Claim(
            name="area_spread",
            where="Section 3, Fig. 7",
            says="The standard deviation of the real contact area falls with the number of junctions, but not in a "
            "straight line. From 10 to 50 junctions it falls by 22 um^2 at a mean of 100 um^2, and by 110 um^2 at "
            "500 um^2.",
            quantities=(*quantities, early, late),
            if_agreed=Verdict.HOLDS if near and bends else Verdict.CORRECTED if bends else Verdict.FAILS,
            because="The exact drops round to the printed ones. They follow 1/sqrt(N_jm), which falls fast at first. "
            "For equal sizes the spread is 1.2298/sqrt(N_jm) of the mean. Equal sizes would give "
            f"{plain[0]:.2f} and {plain[1]:.2f} um^2; the printed digits cannot distinguish these.",
            scenario=SCENARIO,
        )
    ]


def _measured(_model: Model, record: MemoryRecord) -> dict[str, float]:
    return {"std": float(record["trace"]["real_contact_area"].std())}


def _drop(found: Evidence, area: float, printed: float | None, few: int, many: int) -> ClaimedNumber:
    first, second = found.at(area=area, count=few), found.at(area=area, count=many)
    return ClaimedNumber(
        name=f"drop of the std from {few} to {many} junctions at {area:g} um^2",
        unit="um^2",
        printed=printed,
        simulated=difference(first.numbers["std"], second.numbers["std"]),
        exact=sqrt(area_cumulants(first.model).variance) - sqrt(area_cumulants(second.model).variance),
    )


def _drop_of_one_size(found: Evidence, area: float) -> float:
    """Return the exact drop in um^2 from 10 to 50 junctions that all have the diameter d_m."""
    few, many = (
        replace(model, sizes=Fixed(value=model.calibrated_diameter))
        for model in (found.at(area=area, count=count).model for count in (10, 50))
    )
    return area_cumulants(few).std - area_cumulants(many).std

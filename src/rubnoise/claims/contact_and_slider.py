"""Claims about the contact of Figure 5: mean area, live count, and the vibration of the slider."""

from collections.abc import Sequence

import numpy as np

from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict, nearness
from rubnoise.claims.evidence import Evidence, Found, Report, gather, quotient
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.cumulants import force_cumulants
from rubnoise.theory.exact import exact
from rubnoise.theory.motion import response

SCENARIO = "claims/vibration.toml"


def claims(report: Report) -> Sequence[Claim]:
    """Run the points and evaluate the claims about them."""
    found = gather(SCENARIO, _measured, report)
    paper = found.at(count=20)
    return [_life_mean(paper), _mean_area(paper), _live_count(paper), _few_or_many(found), _constant_speed(found)]


def _measured(model: Model, record: MemoryRecord) -> dict[str, float]:
    area = record["trace"]["real_contact_area"]
    count = record["trace"]["junction_count"]
    diameters = record["junctions"]["diameter"][record["junctions"]["birth_distance"] >= 0.0]
    return {
        # Lives that the start and the end cut off balance each other, since the contact is stationary.
        "life_mean": float(area.sum() * model.tick / (2.0 * diameters**3).sum()),
        "area_mean": float(area.mean()),
        "count_mean": float(count.mean()),
        "count_variance": float(count.var()),
        "force_std": float(record["trace"]["friction_force"].std()),
        "displacement_std": float(record["slider"]["displacement"].std()),
        "velocity_ratio": float(record["slider"]["velocity"].std()) / (model.sliding_speed or np.inf),
    }


def _life_mean(paper: Found) -> Claim:
    quantity = ClaimedNumber(
        name="mean area over a life, over d^2",
        printed=0.327,
        simulated=paper.numbers["life_mean"],
        exact=float(paper.model.pulse.life_mean()),
    )
    return Claim(
        name="life_mean",
        where="Eq. (6)",
        says="The mean area of a junction during its life is about 0.327 d^2.",
        quantities=(quantity,),
        if_agreed=nearness(quantity, step=0.001),
        because="The integral of the lens over a life is (2/3) d^3, so its mean over 2d is d^2/3. The printed number "
        f"is {100.0 * (1.0 - 0.327 / quantity.exact):.1f} % low.",
        scenario=SCENARIO,
    )


def _mean_area(paper: Found) -> Claim:
    quantity = ClaimedNumber(
        name="mean real contact area",
        unit="um^2",
        printed=paper.model.mean_real_contact_area,
        simulated=paper.numbers["area_mean"],
        exact=exact(paper.model).area.mean,
    )
    return Claim(
        name="mean_area",
        where="Eqs. (10) to (12)",
        says="The diameter of Eq. (12) gives the specified mean real contact area, 200 um^2.",
        quantities=(quantity,),
        if_agreed=nearness(quantity, step=1.0),
        because="0.327 makes the junctions too large, and the spread of sizes adds to the mean of d^3. The calibration "
        "`matched` gives the specified area.",
        scenario=SCENARIO,
    )


def _live_count(paper: Found) -> Claim:
    mean = exact(paper.model).count_mean
    quantities = tuple(
        ClaimedNumber(
            name=f"{name} of the number of junctions",
            printed=paper.model.mean_junction_count,
            simulated=paper.numbers[f"count_{name}"],
            exact=mean,
        )
        for name in ("mean", "variance")
    )
    holds = all(nearness(quantity, step=1.0) is Verdict.HOLDS for quantity in quantities)
    return Claim(
        name="live_count",
        where="Eq. (9), second Eq. (12)",
        says="Exponential intervals of mean L_jm/N_jm keep N_jm junctions in contact on average. Their number is "
        "Poisson distributed.",
        quantities=quantities,
        if_agreed=Verdict.HOLDS if holds else Verdict.CORRECTED,
        because="Births at random, with lives of any length, give a Poisson number of live junctions (M/G/infinity "
        "queue). Its variance equals its mean.",
        scenario=SCENARIO,
    )


def _few_or_many(found: Evidence) -> Claim:
    many, few = found.at(count=50), found.at(count=10)
    both_ways = [found.at(count=count, coupling="two-way") for count in (50, 10)]
    force, motion = "std of the friction force, 50 junctions over 10", "std of the displacement, 50 junctions over 10"
    quantities = (
        quotient(force, many, few, "force_std", lambda model: force_cumulants(model).std),
        quotient(motion, many, few, "displacement_std", lambda model: response(model).displacement_std),
        quotient("the same, with two-way coupling", both_ways[0], both_ways[1], "displacement_std"),
    )
    holds = all(quantity.below(1.0) for quantity in quantities)
    return Claim(
        name="few_or_many",
        where="Sections 4 and 5",
        says="At equal real contact area, many small junctions vibrate less than few large ones.",
        quantities=quantities,
        if_agreed=Verdict.HOLDS if holds else Verdict.FAILS,
        because="The spread of the force falls as 1/sqrt(N_jm). From 10 to 50 junctions of equal size it falls to "
        "1/sqrt(5) = 0.447. Shorter lives move its spectrum to higher frequencies. Depending on the speed, the "
        "slider's resonance then gets more or less of it. A slider that pushes back sticks and slips at this speed. "
        "Its displacement spreads less, and falls from 10 to 50 junctions as the force does.",
        scenario=SCENARIO,
    )


def _constant_speed(found: Evidence) -> Claim:
    paper, two_way = found.at(count=20), found.at(count=20, coupling="two-way")
    name = "std of the slider's velocity over the sliding speed"
    one_way = ClaimedNumber(
        name=name,
        simulated=paper.numbers["velocity_ratio"],
        exact=response(paper.model).one_way_validity,
    )
    pushing_back = ClaimedNumber(
        name="the same, with two-way coupling",
        simulated=two_way.numbers["velocity_ratio"],
    )
    change = quotient("std of its displacement, two-way over one-way", two_way, paper, "displacement_std")
    steady = all(quantity.below(0.1) for quantity in (one_way, pushing_back))
    return Claim(
        name="constant_speed",
        where="Fig. 5, implied",
        says="The paper assumes, without saying so, a constant sliding speed of 1 mm/s while the slider vibrates.",
        quantities=(one_way, pushing_back, change),
        if_agreed=Verdict.HOLDS if steady else Verdict.FAILS,
        because=f"With one-way coupling, the slider moves {one_way.exact:.0f} times as fast as the surface under it. "
        "Its motion must change the sliding distance, and so the births and deaths. Two-way coupling does this. The "
        "slider then sticks for most of the time. It still moves "
        f"{pushing_back.simulated.value:.0f} times as fast as the surface, and its displacement spreads "
        f"{change.simulated.value:.2f} times as far as in Fig. 5.",
        scenario=SCENARIO,
    )

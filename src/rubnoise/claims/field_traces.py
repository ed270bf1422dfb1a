"""Published statistics of friction traces: junction sizes, normality, load, and the origin of the noise."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, pi, sqrt

import numpy as np

from rubnoise.analysis.covariance import autocovariance as sample_autocovariance
from rubnoise.analysis.replicates import PooledEstimate
from rubnoise.arrays import Doubles
from rubnoise.claims import sources
from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.evidence import Found, Report, gather
from rubnoise.claims.field import FieldClaim, exponent_of
from rubnoise.contact.births import PoissonBirths
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.second_order import autocovariance

CONTACT = "claims/field_contact.toml"
_LENS = 2.25 * (2.0 * pi / 3.0 - 64.0 / 45.0)
"""Variance over the squared mean, times N_jm, of equal lenses, from closed integrals of the lens and its square."""


def claims(report: Report) -> Sequence[FieldClaim]:
    """Run the points and return the rows."""
    found = gather(CONTACT, _of_area, report)
    paper, loaded, fine = (found.at(area=area, count=count) for area, count in ((200, 20), (800, 80), (200, 80)))
    return [
        _rabinowicz_1956(paper),
        *_rabinowicz_1955(paper, loaded, fine),
        _kilburn(paper),
        _campbell(paper),
    ]


def _of_area(model: Model, record: MemoryRecord) -> dict[str, float]:
    area, count = record["trace"]["real_contact_area"], record["trace"]["junction_count"]
    mean, std = float(area.mean()), float(area.std())
    return {
        "std": std,
        "relative_std": std / mean,
        "relative_variance": model.mean_junction_count * (std / mean) ** 2,
        "skewness": float(np.mean((area - mean) ** 3)) / std**3,
        "count_dispersion": float(count.var()) / float(count.mean()),
        "half_width": _half_width(area, model),
    }


def _half_width(values: Doubles, model: Model) -> float:
    """Return the lag in um at which a record's autocovariance has fallen to a half."""
    found = sample_autocovariance(values, round(model.mean_life_distance / model.tick))
    after = int(np.flatnonzero(found < 0.5 * found[0])[0])
    above, below = float(found[after - 1]), float(found[after])
    return model.tick * (after - 1 + (above - 0.5 * float(found[0])) / (above - below))


def _exact_half_width(model: Model) -> float:
    """Return the lag in um at which the autocovariance of independent junctions has fallen to a half."""
    from scipy.optimize import brentq

    at_random = replace(model, births=PoissonBirths(mean_spacing=model.mean_birth_spacing))
    half = 0.5 * float(autocovariance(at_random, 0.0))
    return float(
        brentq(lambda lag: float(autocovariance(at_random, lag)) - half, 0.0, 2.0 * model.mean_life_distance, xtol=1e-9)
    )


def _rabinowicz_1956(paper: Found) -> FieldClaim:
    lens = _exact_half_width(paper.model) / paper.model.calibrated_diameter
    return FieldClaim(
        id="rabinowicz1956_diameter",
        label="diameter, autocorrelation (µm)",
        source=sources.RABINOWICZ_1956,
        statement="Real traces give a mean junction diameter of 9 um by autocorrelation, and 5 um in another way.",
        conditions="slow sliding; the metal is not in the abstract; here the contact of Figure 5",
        quantity=ClaimedNumber(
            name="diameter read from the half-width",
            unit="um",
            simulated=paper.numbers["half_width"].times(1.0 / lens),
            exact=paper.model.calibrated_diameter,
        ),
        published=(8.95, 9.05),
        because="Like is compared with like: both numbers are read from an autocorrelation. The paper's choice of "
        "20 junctions on 200 um^2 gives less. Its diameter is nearer to the 5 um of the other way. Wide sizes "
        "enlarge the reading by autocorrelation: lognormal diameters with a spread of 30 % and 50 % enlarge it "
        f"{_overstated(paper.model, 0.3, lens):.2f} and {_overstated(paper.model, 0.5, lens):.2f} times.",
        scenario=CONTACT,
    )


def _overstated(model: Model, spread: float, lens: float) -> float:
    """Return the diameter read from the half-width over the mean diameter, for lognormal sizes."""
    from rubnoise.contact.laws.lognormal import Lognormal

    mean = model.calibrated_diameter
    wide = replace(model, sizes=Lognormal(mean=mean, std=spread * mean))
    return _exact_half_width(wide) / lens / mean


def _rabinowicz_1955(paper: Found, loaded: Found, fine: Found) -> list[FieldClaim]:
    factor = paper.model.calibrated_diameter / fine.model.calibrated_diameter
    return [
        FieldClaim(
            id="rabinowicz1955_load",
            label="std/mean, exponent of load",
            source=sources.RABINOWICZ_1955,
            statement="High load gives steady traces.",
            conditions="copper, well lubricated, smooth finish; load makes more junctions of the same size",
            quantity=exponent_of(
                "exponent of load, std over mean",
                _relative_std(paper),
                _relative_std(loaded),
                loaded.model.mean_real_contact_area / paper.model.mean_real_contact_area,
            ),
            published=(-inf, 0.0),
            because="std over mean is 1.2298/sqrt(N_jm), and N_jm grows with load. The source gives no number.",
            scenario=CONTACT,
        ),
        FieldClaim(
            id="rabinowicz1955_finish",
            label="std/mean, exponent of $d$",
            source=sources.RABINOWICZ_1955,
            statement="A rougher finish gives steadier traces, if unlubricated.",
            conditions="copper in solid contact; a rougher finish makes fewer and larger junctions of the same area",
            quantity=exponent_of("exponent of d, std over mean", _relative_std(fine), _relative_std(paper), factor),
            published=(-inf, 0.0),
            because="At one area, std over mean grows as d. The opposite needs a roughness that makes more junctions, "
            "or junctions that the finish does not size.",
            scenario=CONTACT,
        ),
    ]


def _relative_std(point: Found) -> tuple[PooledEstimate, float]:
    area = area_cumulants(point.model)
    return point.numbers["relative_std"], area.std / area.mean


def _kilburn(paper: Found) -> FieldClaim:
    conditions = "cast-iron button on a cast-iron disk, 60 runs"
    scaled = area_cumulants(paper.model).skewness * sqrt(paper.model.mean_junction_count)
    return FieldClaim(
        id="kilburn1974_normal",
        label="skewness",
        source=sources.KILBURN_1974,
        statement="The instantaneous coefficient of friction is normally distributed.",
        conditions=f"{conditions}, test of Kolmogorov and Smirnov; here 20 junctions",
        quantity=ClaimedNumber(
            name="skewness of the area",
            simulated=paper.numbers["skewness"],
            exact=area_cumulants(paper.model).skewness,
        ),
        published=(-0.1, 0.1),
        because=f"Shot noise of equal lenses is skewed by {scaled:.2f}/sqrt(N_jm), so some 200 junctions look "
        "normal. Normal is taken as a skewness below 0.1.",
        scenario=CONTACT,
    )


def _campbell(paper: Found) -> FieldClaim:
    area = area_cumulants(paper.model)
    return FieldClaim(
        id="campbell_rice",
        label="$N_{jm}$ times relative variance",
        source=sources.CAMPBELL_RICE,
        statement="Pulses F at a rate nu have the variance nu int F^2.",
        conditions="births at random, linear superposition; here lenses of one size",
        quantity=ClaimedNumber(
            name="N_jm times the relative variance",
            simulated=paper.numbers["relative_variance"],
            exact=paper.model.mean_junction_count * area.variance / area.mean**2,
        ),
        published=(_LENS - 1e-6, _LENS + 1e-6),
        because=f"For the lens it is (9/4)(2 pi/3 - 64/45) = {_LENS:.6f}.",
        scenario=CONTACT,
    )

"""Published laws of normal motion, compared with a light slider that may leave its contact."""

from collections.abc import Sequence
from math import inf, nan

import numpy as np

from rubnoise.claims import sources
from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.evidence import Evidence, Found, Report, gather
from rubnoise.claims.field import FieldClaim, exponent_of
from rubnoise.model import Model, Separation
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.rows import ContactKind

BOUNCING = "claims/field_bouncing.toml"
DAMPED = "claims/field_impact_damping.toml"

_START = 0.2
"""Share of a run in which the start is forgotten."""

_HARD = 10.0
"""Weights below which peaks of the load are counted."""

_ROUGHNESS_OVER_SCALE = 3.0
"""Root mean square roughness over the height scale, if the summits in contact are 3 times as high as the roughness."""

_OWN = "Here a rigid slider under its own weight, 0.1 junctions in contact"
_GROWING = "a loss that grows with the speed of impact"


def measured(model: Model, record: MemoryRecord) -> dict[str, float]:
    """Return numbers of the normal motion; strength is the mean speed of impact."""
    first, held, load = int(_START * model.tick_count), _held(model), record["load"]
    touching = record["trace"]["junction_count"][first:] > 0
    marks = record["landmarks"]
    made = (marks["kind"] == ContactKind.CONTACT_MADE) & (marks["distance"] > first * model.tick)
    begun = np.flatnonzero(~touching[:-1] & touching[1:]) + 1
    peaks = np.maximum.reduceat(load["load"][first:], begun)[:-1] if begun.size > 1 else np.array([nan])
    return {
        "velocity": float(load["velocity"][first:].std()),
        "separation": float(load["separation"][first:].std()) / held.height_scale,
        "apart": float((~touching).mean()),
        "shocks": float(made.sum()) / ((1.0 - _START) * model.distance / (model.sliding_speed or nan)),
        "strength": float(marks["impact_speed"][made].mean()) if made.any() else nan,
        "light peaks": float((peaks < _HARD * held.load).mean()),
    }


def claims(report: Report) -> Sequence[FieldClaim]:
    """Run the points and return the rows."""
    bouncing, damped = gather(BOUNCING, measured, report), gather(DAMPED, measured, report)
    return [*_exponents(bouncing, damped), *_impacts(damped), *_slow_and_fast(bouncing)]


def _held(model: Model) -> Separation:
    if model.free is None:
        raise ValueError("the slider of the model is not free")
    return model.free.held


def _point(found: Evidence, speed: float, height: float) -> Found:
    """Return the point of a speed in mm/s and a height scale in um."""
    [point] = [
        each
        for each in found.points
        if each.model.sliding_speed == 1e3 * speed and _held(each.model).height_scale == height
    ]
    return point


def _of_speed(found: Evidence, name: str, of: str, first: float = 21.0) -> ClaimedNumber:
    near, far = (_point(found, speed, 5.0).numbers[of] for speed in (first, 700.0))
    return exponent_of(name, (near, nan), (far, nan), 700.0 / first)


def _of_height(found: Evidence) -> ClaimedNumber:
    near, far = (_point(found, 121.0, height).numbers["velocity"] for height in (2.5, 10.0))
    return exponent_of("exponent of height, normal velocity, 121 mm/s", (near, nan), (far, nan), 4.0)


def _exponents(bouncing: Evidence, damped: Evidence) -> list[FieldClaim]:
    speed = "exponent of speed, normal velocity, 21 to 700 mm/s"
    constant, growing = "normal motion with a restitution of 0.7", f"normal motion with {_GROWING}"
    return [
        FieldClaim(
            id="ba2010_normal_speed",
            label="$n$, normal",
            source=sources.BA_2010,
            statement=f"The level rises as V^n, n = 0.7 to 0.96 or 0.8 to 1.16: {constant}.",
            conditions=f"two rough flats, dry, light load. {_OWN}",
            quantity=_of_speed(bouncing, speed, "velocity"),
            published=(0.7, 1.16),
            widened=True,
            because="Impacts are harder at higher speed. No single power: the slope falls from 1.4 to 0.4 over this "
            "range.",
            scenario=BOUNCING,
        ),
        FieldClaim(
            id="ba2010_normal_height",
            label="$m$, normal",
            source=sources.BA_2010,
            statement=f"The level rises as Ra^m, m = 0.8 to 1.16 or 0.7 to 0.96: {constant}.",
            conditions=f"two rough flats, dry, light load. {_OWN}",
            quantity=_of_height(bouncing),
            published=(0.7, 1.16),
            widened=True,
            because="m = (1 + n)/2 with the local n, whatever bounces.",
            scenario=BOUNCING,
        ),
        FieldClaim(
            id="dang2013_normal_speed",
            label="$n$, normal",
            source=sources.DANG_2013,
            statement=f"The level rises as V^n, n = 0.52 to 0.63: {growing}.",
            conditions=f"simulated rough surfaces, light load, 20 to 700 mm/s. {_OWN}",
            quantity=_of_speed(damped, speed, "velocity"),
            published=(0.52, 0.63),
            because="The slope is near 1 up to 70 mm/s, and between 0.5 and 0.6 above, as published.",
            scenario=DAMPED,
        ),
        FieldClaim(
            id="dang2013_normal_height",
            label="$m$, normal",
            source=sources.DANG_2013,
            statement=f"The level rises as Rq^m, m = 0.63 to 0.67: {growing}.",
            conditions=f"simulated rough surfaces, light load, Rq 3.6 to 38.6 um. {_OWN}",
            quantity=_of_height(damped),
            published=(0.63, 0.67),
            because="m is (1 + n)/2 with the local n, plus half of the exponent over this loss, which is below 0 here.",
            scenario=DAMPED,
        ),
        FieldClaim(
            id="speed2019_normal",
            label="$n$, normal",
            source=sources.SPEED_2019,
            statement=f"The noise level is a power of speed with an exponent of about 3/4: {growing}.",
            conditions="experiment and simulation, wide band, weak interaction; of an amplitude, or of a power (then "
            f"3/8). {_OWN}",
            quantity=_of_speed(damped, speed, "velocity"),
            published=(0.375, 0.75),
            widened=True,
            because="Its slope lies between these over the whole range.",
            scenario=DAMPED,
        ),
    ]


def _impacts(damped: Evidence) -> list[FieldClaim]:
    conditions = f"simulated profiles. {_OWN}, {_GROWING}"
    return [
        FieldClaim(
            id="ba2011_rate",
            label="$n$ of the rate of shocks",
            source=sources.BA_2011,
            statement="The rate of shocks falls with speed.",
            conditions=conditions,
            quantity=_of_speed(damped, "exponent of speed, rate of shocks, 21 to 700 mm/s", "shocks"),
            published=(-inf, 0.0),
            because="Harder impacts throw the slider higher, and it flies longer.",
            scenario=DAMPED,
        ),
        FieldClaim(
            id="ba2011_strength",
            label="$n$ of the speed of impact",
            source=sources.BA_2011,
            statement="The strength of a shock rises with speed.",
            conditions=conditions,
            quantity=_of_speed(damped, "exponent of speed, speed of impact, 21 to 700 mm/s", "strength"),
            published=(0.0, inf),
            because="Summits are met faster, and the slider falls from higher.",
            scenario=DAMPED,
        ),
        FieldClaim(
            id="dang2013_peaks",
            label="load peaks below ten weights",
            source=sources.DANG_2013,
            statement="57 % of the peaks of contact force are below ten weights of the slider.",
            conditions=f"simulated rough surfaces, light load. {_OWN}, a height scale of 10 um, 121 mm/s",
            quantity=ClaimedNumber(
                name="share of peaks below ten weights",
                simulated=_point(damped, 121.0, 10.0).numbers["light peaks"],
            ),
            published=(0.56, 0.58),
            because="So few junctions at a time are hit harder; docs/load.md has the shares of others.",
            scenario=DAMPED,
        ),
    ]


def _slow_and_fast(bouncing: Evidence) -> list[FieldClaim]:
    slow, fast = _point(bouncing, 7.0, 5.0).numbers, _point(bouncing, 121.0, 10.0).numbers
    own = f"{_OWN}, a restitution of 0.7"
    zouabi = f"rough slider under its own weight on a rough track; no speed is given. {own}"
    return [
        FieldClaim(
            id="zouabi2016_slow",
            label="share of time apart, 7 mm/s",
            source=sources.ZOUABI_2016,
            statement="Contact is unbroken at low speed.",
            conditions=zouabi,
            quantity=ClaimedNumber(name="share of time without contact, 7 mm/s", simulated=slow["apart"]),
            published=(0.0, 1e-3),
            because="Far below c omega_c = 70 mm/s the slider follows the summits that carry it.",
            scenario=BOUNCING,
        ),
        FieldClaim(
            id="zouabi2016_fast",
            label="share of time apart, 121 mm/s",
            source=sources.ZOUABI_2016,
            statement="The slider jumps at higher speed.",
            conditions=zouabi,
            quantity=ClaimedNumber(name="share of time without contact, 121 mm/s", simulated=fast["apart"]),
            published=(0.1, 1.0),
            because="Above it the slider is thrown off. Unbroken is taken as less than 0.1 % of the time apart, jumps "
            "as more than 10 %.",
            scenario=BOUNCING,
        ),
        FieldClaim(
            id="ponthus2019",
            label="rms separation over roughness",
            source=sources.PONTHUS_2019,
            statement="The root mean square of the normal motion is much smaller than the roughness.",
            conditions="rigid self-affine surfaces that touch in one point; much smaller is taken as below half, and "
            f"the height scale as a third of the roughness. {own}",
            quantity=ClaimedNumber(
                name="std of the separation over the roughness, 7 mm/s",
                simulated=slow["separation"].times(1.0 / _ROUGHNESS_OVER_SCALE),
            ),
            published=(0.0, 0.5),
            because="The highest summits scatter by about one height scale, which is smaller than the roughness.",
            scenario=BOUNCING,
        ),
    ]

"""Published laws of normal motion, beside a light slider that may leave its contact."""

from collections.abc import Sequence
from math import inf, nan

import numpy as np

from rubnoise.analysis.replicates import PooledEstimate
from rubnoise.claims import sources
from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.evidence import Evidence, Found, Report, gather
from rubnoise.claims.field import FieldClaim, Publication, Range, exponent_of
from rubnoise.model import Model, Separation
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.rows import ContactKind

BOUNCING = "claims/field_bouncing.toml"
DAMPED = "claims/field_impact_damping.toml"

_START = 0.2
"""Share of a run in which the start is forgotten."""

_HARD = 10.0
"""Weights below which peaks of the load are counted."""

_HEIGHTS_OVER_SCALE = 3.0
"""Root mean square roughness over the scale of heights where summits in contact are 3 times as high as it is."""

_OWN = "Here a rigid slider under its own weight, 0.1 junctions in contact"


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
    constant, growing = "a restitution of 0.7", "a loss that grows with the speed of impact"
    of_constant = _of_speed(bouncing, speed, "velocity"), _of_height(bouncing)
    of_growing = _of_speed(damped, speed, "velocity"), _of_height(damped)
    rows: tuple[tuple[str, Publication, str, str, ClaimedNumber, Range, str, str], ...] = (
        (
            "ba2010_normal_speed",
            sources.BA_2010_NUMBERS,
            f"The level rises as V^n, n = 0.7 to 0.96 or 0.8 to 1.16: normal motion with {constant}.",
            "two rough flats, dry, light load",
            of_constant[0],
            (0.7, 1.16),
            "Impacts are harder at higher speed. No single power: the slope falls from 1.4 to 0.4 over this range.",
            BOUNCING,
        ),
        (
            "ba2010_normal_height",
            sources.BA_2010_NUMBERS,
            f"The level rises as Ra^m, m = 0.8 to 1.16 or 0.7 to 0.96: normal motion with {constant}.",
            "two rough flats, dry, light load",
            of_constant[1],
            (0.7, 1.16),
            "m = (1 + n)/2 with the local n, whatever bounces.",
            BOUNCING,
        ),
        (
            "dang2013_normal_speed",
            sources.DANG_2013,
            f"The level rises as V^n, n = 0.52 to 0.63: normal motion with {growing}.",
            "simulated rough surfaces, light load, 20 to 700 mm/s",
            of_growing[0],
            (0.52, 0.63),
            "The slope is near 1 up to 70 mm/s, and between 0.5 and 0.6 above, as published.",
            DAMPED,
        ),
        (
            "dang2013_normal_height",
            sources.DANG_2013,
            f"The level rises as Rq^m, m = 0.63 to 0.67: normal motion with {growing}.",
            "simulated rough surfaces, light load, Rq 3.6 to 38.6 um",
            of_growing[1],
            (0.63, 0.67),
            "m is (1 + n)/2 with the local n, plus half of the exponent over this loss, which is below 0 here.",
            DAMPED,
        ),
        (
            "speed2019_normal",
            sources.SPEED_2019,
            f"The noise level is a power of speed with an exponent of about 3/4: normal motion with {growing}.",
            "experiment and simulation, wide band, weak interaction; of an amplitude, or of a power (then 3/8)",
            of_growing[0],
            (0.375, 0.75),
            "Its slope lies between these over the whole range.",
            DAMPED,
        ),
    )
    return [
        FieldClaim(
            id=name,
            source=source,
            statement=statement,
            conditions=f"{conditions}. {_OWN}",
            quantity=quantity,
            published=published,
            because=because,
            scenario=scenario,
        )
        for name, source, statement, conditions, quantity, published, because, scenario in rows
    ]


def _impacts(damped: Evidence) -> list[FieldClaim]:
    conditions = f"simulated profiles. {_OWN}, a loss that grows with the speed of impact"
    return [
        FieldClaim(
            id="ba2011_rate",
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
            source=sources.DANG_2013,
            statement="57 % of the peaks of contact force are below ten weights of the slider.",
            conditions=f"simulated rough surfaces, light load. {_OWN}, a height scale of 10 um, 121 mm/s",
            quantity=ClaimedNumber(
                name="share of peaks below ten weights",
                simulated=_point(damped, 121.0, 10.0).numbers["light peaks"],
                exact=nan,
            ),
            published=(0.56, 0.58),
            because="So few junctions at a time are hit harder; docs/load.md has the shares of others.",
            scenario=DAMPED,
        ),
    ]


def _slow_and_fast(bouncing: Evidence) -> list[FieldClaim]:
    slow, fast = _point(bouncing, 7.0, 5.0), _point(bouncing, 121.0, 10.0)

    def row(name: str, source: Publication, statement: str, quantity: ClaimedNumber, published: Range) -> FieldClaim:
        return FieldClaim(
            id=name,
            source=source,
            statement=statement,
            conditions=f"{_CONDITIONS[source.name]}. {_OWN}, a restitution of 0.7",
            quantity=quantity,
            published=published,
            because=_BECAUSE[name],
            scenario=BOUNCING,
        )

    def share(name: str, value: PooledEstimate) -> ClaimedNumber:
        return ClaimedNumber(name=name, simulated=value, exact=nan)

    apart = "share of time without contact"
    still = slow.numbers["separation"].times(1.0 / _HEIGHTS_OVER_SCALE)
    return [
        row(
            "zouabi2016_slow",
            sources.ZOUABI_2016,
            "Contact is unbroken at low speed.",
            share(f"{apart}, 7 mm/s", slow.numbers["apart"]),
            (0.0, 1e-3),
        ),
        row(
            "zouabi2016_fast",
            sources.ZOUABI_2016,
            "The slider jumps at higher speed.",
            share(f"{apart}, 121 mm/s", fast.numbers["apart"]),
            (0.1, 1.0),
        ),
        row(
            "ponthus2019",
            sources.PONTHUS_2019,
            "The root mean square of the normal motion is much smaller than the roughness.",
            share("std of the separation over the roughness, 7 mm/s", still),
            (0.0, 0.5),
        ),
    ]


_CONDITIONS = {
    sources.ZOUABI_2016.name: "rough slider under its own weight on a rough track; no speed is given",
    sources.PONTHUS_2019.name: "rigid self-affine surfaces that touch in one point; much smaller is taken as below "
    "half, and the height scale as a third of the roughness",
}

_BECAUSE = {
    "zouabi2016_slow": "Far below c omega_c = 70 mm/s the slider follows the summits that carry it.",
    "zouabi2016_fast": "Above it the slider is thrown off. Unbroken is taken as less than 0.1 % of the time apart, "
    "jumps as more than 10 %.",
    "ponthus2019": "The highest summits scatter by about one height scale, which is smaller than the roughness.",
}

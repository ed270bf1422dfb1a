"""Published laws of level against roughness, speed, area and damping, the identity that the model obeys, and a peak."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, log, log10, nan

from rubnoise.analysis.replicates import PooledEstimate
from rubnoise.claims import sources
from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.evidence import Evidence, Found, Report, gather, quotient
from rubnoise.claims.field import FieldClaim, exponent_of
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.motion import response

FAST = "claims/field_fast.toml"
SLOW = "claims/field_slow.toml"
DAMPING = "claims/field_damping.toml"
NORMAL = "Normal motion; the model moves along the surface"

_EITHER = "0.8 to 1.16 and 0.7 to 0.96; two notes differ on which of the two is that of roughness"
"""The exponents of Ben Abdelounis and others (2010), which are known from notes of others alone."""
_SIMULATED = "simulated rough surfaces, light load, asperity shocks, 20 to 700 mm/s"
_WHITE = "At these speeds the force is white for the slider, and its vibration goes as d^1.5 V^-0.5."


def measured(_model: Model, record: MemoryRecord) -> dict[str, float]:
    """Return the spreads of displacement and velocity of a run's slider."""
    slider = record["slider"]
    displacement, velocity = float(slider["displacement"].std()), float(slider["velocity"].std())
    return {
        "displacement_std": displacement,
        "velocity_std": velocity,
        "frequency": velocity / displacement,
    }


def claims(report: Report) -> Sequence[FieldClaim]:
    """Run the points and return the rows."""
    fast, slow = gather(FAST, measured, report), gather(SLOW, measured, report)
    damping = gather(DAMPING, measured, report)
    return [
        _identity(slow),
        *_against_speed(fast, slow),
        *_sums(slow),
        _damping(damping),
        _fretting(slow),
        _shift_of_peak(fast),
    ]


def _amplitude(point: Found, of: str = "velocity") -> tuple[PooledEstimate, float]:
    """Return an amplitude of the slider as simulated and, one-way, as exact."""
    exact = nan if point.model.is_two_way else getattr(response(point.model), f"{of}_std")
    return point.numbers[f"{of}_std"], exact


def _of_speed(found: Evidence, name: str, coupling: str = "one-way") -> ClaimedNumber:
    points = [
        point
        for point in found.points
        if point.model.mean_junction_count == 20 and (slider := point.model.slider) and slider.coupling == coupling
    ]
    near, far = sorted(points, key=_speed)
    return exponent_of(name, _amplitude(near), _amplitude(far), _speed(far) / _speed(near))


def _sum_of_exponents(found: Evidence, coupling: str) -> ClaimedNumber:
    """Return the sum of both exponents, from two points that differ in V and d by one factor."""
    speeds = sorted({_speed(point) for point in found.points})
    small = found.at(count=20, speed=speeds[0], coupling=coupling)
    large = found.at(count=5, speed=speeds[1], coupling=coupling)
    return exponent_of(
        "exponent of d plus exponent of V, displacement",
        _amplitude(small, "displacement"),
        _amplitude(large, "displacement"),
        speeds[1] / speeds[0],
    )


def _speed(point: Found) -> float:
    return point.model.sliding_speed or nan


def _identity(slow: Evidence) -> FieldClaim:
    return FieldClaim(
        id="identity_one_way",
        label="$n$ + exponent of $d$",
        source=sources.THIS_MODEL,
        statement="At constant A_rm and psi, the exponents of junction diameter and speed add up to 1.",
        conditions="one-way, births at random, any pulse, any laws that scale with d, any linear structure",
        quantity=_sum_of_exponents(slow, "one-way"),
        published=(1.0 - 1e-6, 1.0 + 1e-6),
        because="Every amplitude is d h(V/d); docs/theory.md has the proof.",
        scenario=SLOW,
    )


def _sums(slow: Evidence) -> list[FieldClaim]:
    quantity = _sum_of_exponents(slow, "one-way")
    return [
        FieldClaim(
            id="sum_measured",
            label="$n$ + exponent of $d$",
            source=sources.BA_2010,
            statement=f"The exponents m and n are {_EITHER}. Those of d and V then add up to 1.5 or more.",
            conditions=f"two rough flats, dry, light load. {NORMAL}",
            quantity=quantity,
            published=(0.8 + 0.7, 2.0 * 1.16 + 0.96),
            because="From 1.5 if d grows as Ra, to 3.28 if d grows as Ra^0.5. The model has 1, whatever its numbers.",
            scenario=SLOW,
        ),
        FieldClaim(
            id="sum_measured_two_way",
            label="$n$ + exponent of $d$, two-way",
            source=sources.BA_2010,
            statement="The same, for a slider that pushes back: does feedback bring the model to the measured sum?",
            conditions="1 to 2 mm/s, 20 and 5 junctions, so few that their force is skewed",
            quantity=_sum_of_exponents(slow, "two-way"),
            published=(0.8 + 0.7, 2.0 * 1.16 + 0.96),
            because="Two-way, the sum is 1 for many junctions and without reversals, as the page proves. Few junctions "
            "bring it somewhat above 1, far from the measured sum.",
            scenario=SLOW,
        ),
        FieldClaim(
            id="sum_computed",
            label="$n$ + exponent of $d$",
            source=sources.DANG_2013,
            statement="m = 0.63 to 0.67 and n = 0.52 to 0.63: the exponents of d and V add up to 1.15 or more.",
            conditions=f"{_SIMULATED}. {NORMAL}",
            quantity=quantity,
            published=(0.63 + 0.52, 2.0 * 0.67 + 0.63),
            because="From 1.15 if d grows as Ra, to 1.97 if d grows as Ra^0.5. The model has 1, whatever its numbers.",
            scenario=SLOW,
        ),
    ]


def _against_speed(fast: Evidence, slow: Evidence) -> list[FieldClaim]:
    quantity = _of_speed(fast, "exponent of speed, velocity, 20 to 80 mm/s")
    two_way = _of_speed(slow, "exponent of speed, velocity, 1 to 2 mm/s, two-way", coupling="two-way")
    rows = (
        (
            "ba2010_speed",
            sources.BA_2010,
            f"The level rises as V^n. The exponents of roughness and speed are {_EITHER}.",
            f"two rough flats, dry, light load. {NORMAL}",
            (0.7, 1.16),
        ),
        (
            "dang2013_speed",
            sources.DANG_2013,
            "The level rises as V^n, n = 0.52 to 0.63.",
            f"{_SIMULATED}, Rq 3.6 to 38.6 um. {NORMAL}",
            (0.52, 0.63),
        ),
        (
            "speed2019",
            sources.SPEED_2019,
            "The noise level follows a power law of speed with an exponent of about 3/4.",
            "experiment and simulation, wide band, weak interaction; of an amplitude, or of a power (then 3/8)",
            (0.375, 0.75),
        ),
    )
    return [
        FieldClaim(
            id=name,
            label="$n$, 20 to 80 mm/s",
            source=source,
            statement=statement,
            conditions=conditions,
            quantity=quantity,
            published=published,
            widened=source is not sources.DANG_2013,
            because=f"{_WHITE} A model of shocks between asperities has stronger shocks at higher speed; here the "
            "force does not depend on speed.",
            scenario=FAST,
        )
        for name, source, statement, conditions, published in rows
    ] + [
        FieldClaim(
            id="speed2019_two_way",
            label="$n$, two-way",
            source=sources.SPEED_2019,
            statement="The same, for a slider that pushes back.",
            conditions="here a slider that sticks and slips at 1 to 2 mm/s, along the surface",
            quantity=two_way,
            published=(0.375, 0.75),
            widened=True,
            because="Feedback turns the sign: where the slider sticks and slips, its velocity grows about as V^0.5. It "
            "does so at lower speeds than measured, and the sum of both exponents stays near 1.",
            scenario=SLOW,
        )
    ]


def _damping(damping: Evidence) -> FieldClaim:
    light, heavy = damping.at(damping=0.05), damping.at(damping=0.5)
    name = "level of velocity at ten times the damping"
    found = quotient(name, heavy, light, "velocity_std", lambda model: response(model).velocity_std)
    return FieldClaim(
        id="dang2013_damping",
        label="dB at ten times the damping",
        source=sources.DANG_2013,
        statement="Ten times the modal damping takes 10 dB from the level.",
        conditions="simulated rough surfaces, damping ratio 0.02 and more; here 0.0204 and 0.204",
        quantity=replace(
            found,
            unit="dB",
            simulated=PooledEstimate(
                value=20.0 * log10(found.simulated.value),
                standard_error=20.0 / log(10.0) * found.simulated.standard_error / found.simulated.value,
                runs=found.simulated.runs,
            ),
            exact=20.0 * log10(found.exact),
        ),
        published=(-10.5, -9.5),
        because="A force that is white over the resonance gives 1/sqrt(c), which is -10 dB for any model of this kind. "
        "Published as -10, taken as within 0.5 dB.",
        scenario=DAMPING,
    )


def _fretting(slow: Evidence) -> FieldClaim:
    return FieldClaim(
        id="jibiki2001",
        label="$n$, 1 to 2 mm/s",
        source=sources.JIBIKI_2001,
        statement="The level rises with stroke and frequency, and is tied to the mean sliding speed.",
        conditions="crossed steel cylinders, 19.6 N, mean speeds 0.05 to 5.8 mm/s, self-excited part included",
        quantity=_of_speed(slow, "exponent of speed, velocity, 1 to 2 mm/s"),
        published=(0.0, inf),
        because="One-way, the slider of Figure 5 vibrates most near 0.7 mm/s, and less at higher speed.",
        scenario=SLOW,
    )


def _mean_frequency(model: Model) -> float:
    """Return std x' over std x, 2 pi times the mean rate of a Gaussian motion."""
    return response(model).velocity_std / response(model).displacement_std


def _shift_of_peak(fast: Evidence) -> FieldClaim:
    """Return the row about the peak of the motion's spectrum, from runs at 20 mm/s with 5 and 20 junctions."""
    fine, rough = fast.at(count=20, speed=20_000.0), fast.at(count=5, speed=20_000.0)
    return FieldClaim(
        id="stoimenov2007",
        label="shift of the peak by roughness",
        source=sources.STOIMENOV_2007,
        statement="The first peak moves from 3.0 to 4.5 kHz with roughness; up or down was not seen.",
        conditions="stainless-steel plates of Rz 0.8 to 12.4 um, rubbed by hand, flat on flat",
        quantity=quotient("mean frequency of motion, 5 junctions over 20", rough, fine, "frequency", _mean_frequency),
        published=(1.5, 1.5),
        because="The model's peak stays; a factor of 1/1.5 is as far from it. A peak that moves needs a contact "
        "stiffness that depends on roughness.",
        scenario=FAST,
    )

"""The slider's motion beside its exact response, or the law of weak coupling, from where its start is forgotten."""

from dataclasses import replace
from math import hypot, inf, log

from rubnoise.analysis.comparing.findings import Finding, LeftOut, judged, judged_mean, too_short
from rubnoise.analysis.comparing.rows import panels, settled_tick
from rubnoise.analysis.comparing.tails import tail_of
from rubnoise.analysis.moments import needed_for_mean
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Rows
from rubnoise.record.tally import Moments
from rubnoise.theory.coupling import weak_motion, weak_motion_errors
from rubnoise.theory.drive import drive_of
from rubnoise.theory.motion_errors import motion_errors
from rubnoise.theory.regular_births import need_random_births
from rubnoise.theory.response import Response, response

FEWEST_DECAYS = 10
"""Decay times that a record of the motion should have behind its start."""

_FORGOTTEN = 1e-3


def slowest_decay(slider: Slider) -> float:
    """Return the time in s in which the slowest free motion falls by e: 2m/c, or about c/k where that is longer."""
    if slider.damping == 0.0:
        return inf
    return max(2.0 * slider.mass / slider.damping, slider.damping / slider.stiffness)


def motion_findings(model: Model, rows: Rows) -> list[Finding]:
    """Return mean and std of displacement and std of velocity; nothing without a slider.

    The record begins where the start has fallen to a thousandth of the spread, and the contact is stationary.
    Of a slider that pushes back it is known while coupling is weak. Raises Refused where theory has no motion for the
    model, or no errors.
    """
    if model.slider is None:
        return []
    need_random_births(model, "the standard error of a slider's motion")
    speed, exact = drive_of(model).speed, weak_motion(model) if model.is_two_way else response(model)
    if model.slider.damping == 0.0:
        return [LeftOut(name="displacement", reason="a slider without damping never forgets its start")]
    first = first_tick(model, exact)
    decays = FEWEST_DECAYS * slowest_decay(model.slider) * speed
    needed = first * model.tick + max(decays, needed_for_mean(model))
    if model.distance < needed:
        return [too_short("displacement", needed)]
    return _figures(model, exact, *_read(rows, first * model.tick))


def first_tick(model: Model, exact: Response) -> int:
    """Return the first tick at which the contact is stationary and the slider's start forgotten."""
    return settled_tick(model) + int(_forgetting(model, exact) * drive_of(model).speed / model.tick)


def _forgetting(model: Model, exact: Response) -> float:
    """Return the time in s in which the start falls to a thousandth of the spread."""
    if model.slider is None:
        return 0.0
    away = abs(exact.mean_displacement - model.equilibrium_displacement)
    if model.start == "empty":
        away = exact.mean_displacement
    spread = hypot(exact.displacement_std, exact.velocity_std / model.slider.natural_angular_frequency)
    return slowest_decay(model.slider) * log((1.0 + away / spread) / _FORGOTTEN)


def _read(rows: Rows, begin: float) -> tuple[Moments, Moments]:
    """Return the moments of displacement (um) and velocity (um/s) in the rows from a distance (um) on."""
    place, speed = Moments(powers=2), Moments(powers=2)
    for columns in panels(rows, "slider", ("distance", "displacement", "velocity")):
        settled = columns["distance"] >= begin
        place.add(columns["displacement"][settled])
        speed.add(columns["velocity"][settled])
    return place, speed


def _figures(model: Model, exact: Response, place: Moments, speed: Moments) -> list[Finding]:
    length = place.count * model.tick
    stretch = replace(model, start="stationary", distance=length)
    errors = (weak_motion_errors if model.is_two_way else motion_errors)(stretch, length)
    # A junction pushes with psi d^3, and leaves the energy of as much motion.
    push, energy = tail_of(model, length, 3, 1), tail_of(model, length, 6, 2)
    return [
        judged_mean(
            "displacement_mean",
            place.mean,
            exact.mean_displacement,
            errors.mean_displacement,
            length=length,
            tail=push,
        ),
        judged(
            "displacement_std", place.std, exact.displacement_std, errors.displacement_std, length=length, tail=energy
        ),
        judged("velocity_std", speed.std, exact.velocity_std, errors.velocity_std, length=length, tail=energy),
    ]

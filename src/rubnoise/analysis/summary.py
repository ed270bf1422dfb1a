"""The figures of a finished run beside the exact ones."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import isnan

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.moments import LARGEST_ERRORS
from rubnoise.analysis.records import longer
from rubnoise.model import Model
from rubnoise.record.rows import LandmarkKind, Phase
from rubnoise.record.tally import Moments, Tally
from rubnoise.theory.campbell import Cumulants
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.motion_errors import (
    expected_mean_displacement,
    mean_displacement_error,
    mean_force_error,
    motion_errors,
)
from rubnoise.theory.occupancy import mean_count_error
from rubnoise.theory.random_births import are_at_random
from rubnoise.theory.response import response
from rubnoise.theory.sampling import StandardErrors, force_standard_errors, mean_area_error, standard_errors

Errors = tuple[float | None, ...]

_UNKNOWN: Errors = (None, None, None, None)

FEWEST_LIVES = 50
"""Shorter runs, in mean lives, get no standard errors of higher moments: these are of first order in life/run."""

FEWEST_DECAYS = 10
"""Runs shorter than so many decay times of the slider get no standard errors of its motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Theory:
    """What is expected of the runs of a model, and how far they may be from it, where that can be defended."""

    exact: Exact
    area_errors: Errors
    force_errors: Errors
    count_error: float | None
    mean_displacement: float | None
    motion_errors: Errors


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingMotion:
    """What a run lacks for standard errors of its slider's motion.

    It lasts ``decays`` decay times of FEWEST_DECAYS; over ``needed`` um of sliding the standard deviations of
    displacement and velocity would be known to a tenth.
    """

    decays: float
    needed: float


@lru_cache(maxsize=8)
def theory_of(model: Model) -> Theory:
    """Return what a model's runs are held to; kept, since the runs of a sweep often differ by their seed alone.

    A run that starts empty gets no standard errors: its record is not stationary from the beginning. Births that are
    not a Poisson process have them for means alone.
    """
    expected, stationary = exact(model), model.start == "stationary"
    moves = expected.slider is not None and not model.is_two_way
    return Theory(
        exact=expected,
        area_errors=_errors(model, mean_area_error, standard_errors) if stationary else _UNKNOWN,
        force_errors=_errors(model, mean_force_error, force_standard_errors)
        if stationary and expected.force
        else _UNKNOWN,
        count_error=mean_count_error(model) if stationary else None,
        mean_displacement=expected_mean_displacement(model, model.distance) if moves else None,
        motion_errors=_motion_errors(model) if moves and stationary and _many_decays(model) else _UNKNOWN[:3],
    )


def summarise(model: Model, tally: Tally) -> list[Agreement]:
    """Return every figure of a run with its exact value, and its standard error where one can be defended."""
    theory, seen = theory_of(model), tally.moments
    figures = _moments("real_contact_area", seen["real_contact_area"], theory.exact.area, theory.area_errors)
    figures += _count(seen["junction_count"], theory.exact, theory.count_error)
    if "friction_force" in seen and theory.exact.force is not None:
        figures += _moments("friction_force", seen["friction_force"], theory.exact.force, theory.force_errors)[:2]
    if "displacement" in seen and model.is_two_way:
        figures += _two_way_motion(model, tally)
    elif "displacement" in seen:
        figures += _motion(seen["displacement"], seen["velocity"], theory)
    return figures


def _errors(
    model: Model, mean_error: Callable[[Model], float], all_errors: Callable[[Model], StandardErrors]
) -> Errors:
    """Return the errors of mean, std, skewness and kurtosis; for short runs and regular births of the mean alone."""
    if not (_many_lives(model) and are_at_random(model)):
        return mean_error(model), None, None, None
    errors = all_errors(model)
    return errors.mean, errors.std, errors.skewness, errors.excess_kurtosis


def _motion_errors(model: Model) -> Errors:
    if not are_at_random(model):
        return mean_displacement_error(model, model.distance), None, None
    errors = motion_errors(model, model.distance)
    return errors.mean_displacement, errors.displacement_std, errors.velocity_std


def _moments(name: str, seen: Moments, exact_values: Cumulants, errors: Errors) -> list[Agreement]:
    """Return mean, std, skewness and kurtosis; a constant has no shape to expect."""
    figures = []
    for part, error in zip(("mean", "std", "skewness", "excess_kurtosis"), errors, strict=True):
        expected = getattr(exact_values, part)
        figures.append(
            Agreement(
                name=f"{name}_{part}",
                observed=getattr(seen, part),
                expected=None if isnan(expected) else expected,
                standard_error=error,
            )
        )
    return figures


def _count(seen: Moments, expected: Exact, error: float | None) -> list[Agreement]:
    mean = Agreement(name="junction_count_mean", observed=seen.mean, expected=expected.count_mean, standard_error=error)
    std = Agreement(name="junction_count_std", observed=seen.std, expected=expected.count_std, standard_error=None)
    return [mean, std]


def _motion(place: Moments, speed: Moments, theory: Theory) -> list[Agreement]:
    slider = theory.exact.slider
    if slider is None:
        return []
    known = (
        ("displacement_mean", place.mean, theory.mean_displacement),
        ("displacement_std", place.std, slider.displacement_std),
        ("velocity_std", speed.std, slider.velocity_std),
    )
    figures = [
        Agreement(name=name, observed=observed, expected=expected, standard_error=error)
        for (name, observed, expected), error in zip(known, theory.motion_errors, strict=True)
    ]
    return [*figures, _validity(figures[-1], slider.sliding_speed)]


def _two_way_motion(model: Model, tally: Tally) -> list[Agreement]:
    """Return what the rows of a two-way slider, which are uniform in time, show: no exact value is known of it.

    A run of one row has no duration, and no rates.
    """
    place, phases = tally.moments["displacement"], tally.counts["phase"]
    kinds = tally.counts.get("kind", [0] * len(LandmarkKind))
    duration = (place.count - 1) * (model.tick_duration or 0.0)
    figures = {
        "displacement_mean": place.mean,
        "displacement_std": place.std,
        "velocity_std": tally.moments["velocity"].std,
        "stick_fraction": phases[Phase.STICK] / place.count,
    }
    if duration:
        figures["sticks_per_s"] = kinds[LandmarkKind.STICK] / duration
        figures["reversals_per_s"] = kinds[LandmarkKind.REVERSAL] / duration
    return [Agreement(name=name, observed=seen, expected=None, standard_error=None) for name, seen in figures.items()]


def _validity(velocity: Agreement, speed: float) -> Agreement:
    """Return std x' / V: one-way coupling takes the sliding speed for constant, so this should be far below 1."""
    error = velocity.standard_error
    return Agreement(
        name="one_way_validity",
        observed=velocity.observed / speed,
        expected=None if velocity.expected is None else velocity.expected / speed,
        standard_error=None if error is None else error / speed,
    )


def _many_lives(model: Model) -> bool:
    return model.distance >= FEWEST_LIVES * model.mean_life_distance


def missing_for_motion(model: Model) -> MissingMotion | None:
    """Return what a run lacks for standard errors of its slider's motion; None where it has them or no length would do.

    No length would do without slider or damping, or from an empty start. The errors fall as one over the root of the
    distance; for births that are not random there is none but that of the mean, which needs the decay times alone.
    """
    decays = _decays(model)
    if decays is None or decays >= FEWEST_DECAYS or model.start != "stationary":
        return None
    shortest = model.distance * FEWEST_DECAYS / decays
    if not are_at_random(model):
        return MissingMotion(decays=decays, needed=shortest)
    errors, exact = motion_errors(model, shortest), response(model)
    relative = max(errors.displacement_std / exact.displacement_std, errors.velocity_std / exact.velocity_std)
    return MissingMotion(decays=decays, needed=max(shortest, longer(shortest, relative, LARGEST_ERRORS["std"])))


def _many_decays(model: Model) -> bool:
    decays = _decays(model)
    return decays is not None and decays >= FEWEST_DECAYS


def _decays(model: Model) -> float | None:
    """Return how many of the slowest decay times of its slider a run lasts; None where nothing decays."""
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None or slider.damping == 0.0 or model.is_two_way:
        return None
    slowest = max(2.0 * slider.mass / slider.damping, slider.damping / slider.stiffness)
    return model.distance / speed / slowest

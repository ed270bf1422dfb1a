"""The figures of a finished run beside the exact ones."""

from dataclasses import replace
from math import sqrt

from rubnoise.analysis.agreement import Agreement
from rubnoise.model import Model
from rubnoise.record.tally import Moments, Tally
from rubnoise.theory.campbell import Cumulants
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.motion_errors import expected_mean_displacement, motion_errors
from rubnoise.theory.occupancy import mean_count_error
from rubnoise.theory.sampling import StandardErrors, standard_errors

FEWEST_LIVES = 50
"""Shorter runs, in mean lives, get no standard errors of higher moments: these are of first order in life/run."""

FEWEST_DECAYS = 10
"""Runs shorter than so many decay times of the slider get no standard errors of its motion."""


def summarise(model: Model, tally: Tally) -> list[Agreement]:
    """Return every figure of a run with its exact value, and its standard error where one can be defended.

    A run that starts empty gets no standard errors: its record is not stationary from the beginning.
    """
    expected, seen = exact(model), tally.moments
    errors = standard_errors(model) if model.start == "stationary" else None
    area = seen["real_contact_area"]
    figures = _mean_and_std(model, "real_contact_area", area, expected.area, errors, 1.0)
    figures += _shape(model, area, expected.area, errors)
    figures += _count(seen["junction_count"], expected, None if errors is None else mean_count_error(model))
    if "friction_force" in seen and expected.force is not None and model.strengths is not None:
        scale = sqrt(model.strengths.moment(2))
        figures += _mean_and_std(model, "friction_force", seen["friction_force"], expected.force, errors, scale)
    if "displacement" in seen:
        figures += _motion(model, seen["displacement"], seen["velocity"], expected)
    return figures


def _mean_and_std(
    model: Model, name: str, seen: Moments, exact_values: Cumulants, errors: StandardErrors | None, scale: float
) -> list[Agreement]:
    """Return mean and std of the area, or of a force that is ``scale`` times it."""
    higher = errors if _many_lives(model) else None
    return [
        Agreement(
            name=f"{name}_mean",
            observed=seen.mean,
            expected=exact_values.mean,
            standard_error=None if errors is None else scale * errors.mean,
        ),
        Agreement(
            name=f"{name}_std",
            observed=seen.std,
            expected=exact_values.std,
            standard_error=None if higher is None else scale * higher.std,
        ),
    ]


def _shape(model: Model, seen: Moments, exact_values: Cumulants, errors: StandardErrors | None) -> list[Agreement]:
    higher = errors if _many_lives(model) else None
    return [
        Agreement(
            name="real_contact_area_skewness",
            observed=seen.skewness,
            expected=exact_values.skewness,
            standard_error=None if higher is None else higher.skewness,
        ),
        Agreement(
            name="real_contact_area_excess_kurtosis",
            observed=seen.excess_kurtosis,
            expected=exact_values.excess_kurtosis,
            standard_error=None if higher is None else higher.excess_kurtosis,
        ),
    ]


def _count(seen: Moments, expected: Exact, error: float | None) -> list[Agreement]:
    mean = Agreement(name="junction_count_mean", observed=seen.mean, expected=expected.count_mean, standard_error=error)
    std = Agreement(name="junction_count_std", observed=seen.std, expected=expected.count_std, standard_error=None)
    return [mean, std]


def _motion(model: Model, place: Moments, speed: Moments, expected: Exact) -> list[Agreement]:
    if expected.slider is None:
        return []
    observed = {"displacement_mean": place.mean, "displacement_std": place.std, "velocity_std": speed.std}
    exact_values = {
        "displacement_mean": expected_mean_displacement(model, model.distance),
        "displacement_std": expected.slider.displacement_std,
        "velocity_std": expected.slider.velocity_std,
    }
    figures = [
        Agreement(name=name, observed=value, expected=exact_values[name], standard_error=None)
        for name, value in observed.items()
    ]
    if model.start == "stationary" and _many_decays(model):
        errors = motion_errors(model, model.distance)
        known = (errors.mean_displacement, errors.displacement_std, errors.velocity_std)
        figures = [replace(figure, standard_error=error) for figure, error in zip(figures, known, strict=True)]
    return [*figures, _validity(figures[-1], expected.slider.sliding_speed)]


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


def _many_decays(model: Model) -> bool:
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None or slider.damping == 0.0:
        return False
    slowest = max(2.0 * slider.mass / slider.damping, slider.damping / slider.stiffness)
    return model.distance / speed >= FEWEST_DECAYS * slowest

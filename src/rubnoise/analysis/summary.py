"""The figures of a finished run with their exact values, and the exact value of any single figure."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from math import inf, isnan, nan
from typing import Final

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.balance import Balance
from rubnoise.analysis.moments import FEWEST_LIVES, LARGEST_ERRORS
from rubnoise.analysis.records import longer
from rubnoise.figure_names import FIGURE_NAMES
from rubnoise.model import Model, Slider
from rubnoise.record.rows import LandmarkKind
from rubnoise.record.tally import Tally
from rubnoise.theory.coupling import coupling, weak_motion, weak_motion_errors
from rubnoise.theory.cumulants import area_cumulants, force_cumulants
from rubnoise.theory.live_count import count_variance, mean_count, mean_count_error
from rubnoise.theory.load import free_motion, load_motion
from rubnoise.theory.motion import Response, contact_drive_of, response
from rubnoise.theory.sampling import (
    StandardErrors,
    expected_mean_displacement,
    force_standard_errors,
    load_errors,
    mean_area_error,
    mean_displacement_error,
    mean_force_error,
    motion_errors,
    standard_errors,
)
from rubnoise.theory.second_order import are_at_random

FEWEST_DECAYS = 10
"""Least decay times of the slider in a run with standard errors of its motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingMotion:
    """The length that a run lacks for standard errors of its slider's motion.

    It lasts ``decays`` decay times, and FEWEST_DECAYS are needed; after ``needed`` um of sliding the standard
    deviations of displacement and velocity would be known to a tenth.
    """

    decays: float
    needed: float


def summarise(model: Model, tally: Tally) -> list[Agreement]:
    """Return every figure of a run with its exact value, and its standard error if it has one."""
    theory, seen = theory_of(model), tally.moments
    found = {
        name: getattr(seen[figure.column], figure.part) / figure.over(model)
        for name, figure in FIGURES.items()
        if figure.column in seen and _is_of(name, model)
    }
    exact = {name: theory[name][0] for name in found}
    if "displacement" in seen and model.is_two_way:
        moving = _two_way_motion(model, tally)
        found = {name: value for name, value in found.items() if FIGURE_NAMES[name].needs != "slider"}
        found |= {name: value for name, (value, _) in moving.items()}
        exact |= {name: value for name, (_, value) in moving.items() if name not in FIGURES}
    return [
        Agreement(
            name=name,
            observed=value,
            expected=exact[name],
            standard_error=theory[name][1] if name in theory else None,
        )
        for name, value in found.items()
    ]


@lru_cache(maxsize=8)
def theory_of(model: Model) -> dict[str, tuple[float | None, float | None]]:
    """Return exact value and standard error of the figures of a model's runs; None for those that theory does not give.

    Cached, since the runs of a sweep often differ only in their seed.
    """
    errors, found = _standard_errors(model), {}
    for name, figure in FIGURES.items():
        value, error = expected_figure(model, name), errors.get(f"{figure.column}_{figure.part}")
        found[name] = None if isnan(value) else value, None if error is None else error / figure.over(model)
    return found


def _standard_errors(model: Model) -> dict[str, float]:
    """Return the standard errors by column and part.

    A run that starts empty has none, since its record is not stationary from the beginning. Births that are not a
    Poisson process have errors of means only. Free motion has no theory of errors.
    """
    if model.start != "stationary" or model.free is not None:
        return {}
    found = {"junction_count_mean": mean_count_error(model)}
    found |= _errors("real_contact_area", model, mean_area_error, standard_errors)
    if model.separation is not None:
        found |= _load_errors(model)
    elif model.strengths is not None:
        found |= _errors("friction_force", model, mean_force_error, force_standard_errors)
    decays = _decays(model, model.slider)
    return found if decays is None or decays < FEWEST_DECAYS else found | _motion_errors(model)


def _errors(
    column: str, model: Model, mean_error: Callable[[Model], float], all_errors: Callable[[Model], StandardErrors]
) -> dict[str, float]:
    """Return the errors of mean, std, skewness and kurtosis; for short runs and regular births only of the mean."""
    if model.distance < FEWEST_LIVES * model.mean_life_distance or not are_at_random(model):
        return {f"{column}_mean": mean_error(model)}
    errors = all_errors(model)
    return {f"{column}_{part}": getattr(errors, part) for part in _PARTS}


def _load_errors(model: Model) -> dict[str, float]:
    """Return the errors under a load that weighs, if a run is long compared with the decay of the separation."""
    decays = _decays(model, contact_drive_of(model).slider)
    if decays is None or decays < FEWEST_DECAYS:
        return {}
    errors = load_errors(model, model.distance)
    force = {"friction_force_mean": errors.force_mean, "friction_force_std": errors.force_std}
    return {
        "separation_std": errors.separation_std,
        "normal_velocity_std": errors.velocity_std,
        "load_mean": errors.load_mean,
        "load_std": errors.load_std,
        **({} if model.strengths is None else force),
    }


def _motion_errors(model: Model) -> dict[str, float]:
    if not model.is_two_way and not are_at_random(model):
        return {"displacement_mean": mean_displacement_error(model, model.distance)}
    errors = (weak_motion_errors if model.is_two_way else motion_errors)(model, model.distance)
    return {
        "displacement_mean": errors.mean_displacement,
        "displacement_std": errors.displacement_std,
        "velocity_std": errors.velocity_std,
    }


def _two_way_motion(model: Model, tally: Tally) -> dict[str, tuple[float, float | None]]:
    """Return the figures of a two-way slider from /balance and /landmarks, over its whole time, with exact values.

    Spreads have an expected value if coupling is weak; the excess of the mean force and the residual of energy always
    have one, which a correct run meets within the errors of its steps.
    """
    if not tally.last:
        return {}
    seen, kinds = Balance.of(model, tally.last), tally.counts.get("kind", [0] * len(LandmarkKind))
    return {
        "displacement_mean": (seen.displacement_mean, None),
        "displacement_std": (seen.displacement_std, None),
        "velocity_std": (seen.velocity_std, None),
        "stick_fraction": (seen.time_stuck / seen.time, None),
        "sticks_per_s": (kinds[LandmarkKind.STICK] / seen.time, None),
        "reversals_per_s": (kinds[LandmarkKind.REVERSAL] / seen.time, None),
        "slips_longer_than_d_per_s": (tally.slips.count / seen.time, None),
        "mean_force_excess": (seen.excess_over(seen.friction_along), seen.expected_excess()),
        "energy_residual": (seen.energy_residual, 0.0),
    }


def missing_for_motion(model: Model) -> MissingMotion | None:
    """Return the length that a run lacks for standard errors of its slider's motion; None if it has or never has them.

    It never has them without slider or damping, or from an empty start. Errors fall as one over the root of the
    distance; births that are not random have only the error of the mean, which needs only the decay times.
    """
    decays = _decays(model, model.slider)
    if decays is None or decays >= FEWEST_DECAYS or model.start != "stationary":
        return None
    shortest = model.distance * FEWEST_DECAYS / decays
    if not are_at_random(model):
        return MissingMotion(decays=decays, needed=shortest)
    errors, exact = motion_errors(model, shortest), response(model)
    relative = max(errors.displacement_std / exact.displacement_std, errors.velocity_std / exact.velocity_std)
    return MissingMotion(decays=decays, needed=max(shortest, longer(shortest, relative, LARGEST_ERRORS["std"])))


def _decays(model: Model, slider: Slider | None) -> float | None:
    """Return the length of a run in the slowest decay times of an oscillator; None if nothing decays."""
    speed = model.sliding_speed
    if slider is None or speed is None or slider.damping == 0.0:
        return None
    if model.free is not None or (model.is_two_way and coupling(model).unknown is not None):
        return None
    return model.distance / speed / slowest_decay(slider)


def slowest_decay(slider: Slider) -> float:
    """Return the time in s in which the slowest free motion decays by e: 2m/c, or about c/k if that is longer."""
    if slider.damping == 0.0:
        return inf
    return max(2.0 * slider.mass / slider.damping, slider.damping / slider.stiffness)


_PARTS: Final = ("mean", "std", "skewness", "excess_kurtosis")


def expected_figure(model: Model, name: str) -> float:
    """Return the exact value of a figure that `rubnoise.analysis.summary.summarise` names, in its unit.

    nan if the model has no such figure, or theory does not give it.
    """
    figure = FIGURES.get(name)
    if figure is None or not _is_of(name, model):
        return nan
    if model.free is not None:
        known = free_motion(model)
        means = {
            "load": known.load_mean,
            "real_contact_area": known.area_mean,
            "friction_force": known.force_mean,
        }
        return means.get(figure.column, nan) / figure.over(model) if figure.part == "mean" else nan
    if FIGURE_NAMES[name].needs == "slider" and model.is_two_way and coupling(model).unknown is not None:
        return nan
    return figure.exact(model) / figure.over(model)


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure of a summary: a moment of a column, and its exact value; both are divided by ``over``."""

    column: str
    part: str
    exact: Callable[[Model], float]
    over: Callable[[Model], float] = lambda _model: 1.0


_IN_MODEL: Final = {"strength": "strengths", "load": "held"}


def _is_of(name: str, model: Model) -> bool:
    """Whether the runs of a model have a figure."""
    known = FIGURE_NAMES[name]
    there = not known.needs or getattr(model, _IN_MODEL.get(known.needs, known.needs)) is not None
    return there and not (known.one_way and model.is_two_way)


def _of_area(part: str, model: Model) -> float:
    return float(getattr(area_cumulants(model), part))


def _of_force(part: str, model: Model) -> float:
    return nan if model.strengths is None else float(getattr(force_cumulants(model), part))


def _exact_motion(model: Model) -> Response:
    return weak_motion(model) if model.is_two_way else response(model)


def _exact_mean_displacement(model: Model) -> float:
    excess = _exact_motion(model).mean_displacement - response(model).mean_displacement
    return expected_mean_displacement(model, model.distance) + excess


def _of_motion(part: str, model: Model) -> float:
    return float(getattr(load_motion(model), part))


def _load(model: Model) -> float:
    return nan if model.load is None else model.load


FIGURES: Final[dict[str, Figure]] = {
    **{f"real_contact_area_{part}": Figure("real_contact_area", part, partial(_of_area, part)) for part in _PARTS},
    "junction_count_mean": Figure("junction_count", "mean", mean_count),
    "junction_count_std": Figure("junction_count", "std", lambda model: float(count_variance(model) ** 0.5)),
    **{f"friction_force_{part}": Figure("friction_force", part, partial(_of_force, part)) for part in _PARTS[:2]},
    "friction_coefficient": Figure("friction_force", "mean", partial(_of_force, "mean"), _load),
    "displacement_mean": Figure("displacement", "mean", _exact_mean_displacement),
    "displacement_std": Figure("displacement", "std", lambda model: _exact_motion(model).displacement_std),
    "velocity_std": Figure("velocity", "std", lambda model: _exact_motion(model).velocity_std),
    "separation_std": Figure("separation", "std", partial(_of_motion, "separation_std")),
    "normal_velocity_std": Figure("normal_velocity", "std", partial(_of_motion, "velocity_std")),
    "load_std": Figure("load", "std", partial(_of_motion, "load_std")),
    "load_mean": Figure("load", "mean", _load),
    # One-way coupling takes the sliding speed for constant, so this should be far below 1.
    "one_way_validity": Figure(
        "velocity", "std", lambda model: response(model).velocity_std, lambda model: response(model).sliding_speed
    ),
}
"""The figures of every run, in the order of a summary; those of a two-way slider alone are in `_two_way_motion`.

What each is called, its unit and what a model needs for it is in `rubnoise.figure_names`.
"""

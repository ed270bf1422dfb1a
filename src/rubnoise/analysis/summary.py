"""The figures of a finished run beside the exact ones, and the exact value of any single figure."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from math import isnan, nan
from typing import Final

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.balance import Balance
from rubnoise.analysis.moments import LARGEST_ERRORS
from rubnoise.analysis.records import longer
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.rows import LandmarkKind
from rubnoise.record.tally import Moments, Tally
from rubnoise.theory.campbell import Cumulants, area_cumulants, force_cumulants
from rubnoise.theory.coupling import coupling, weak_motion, weak_motion_errors
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.motion_errors import (
    expected_mean_displacement,
    mean_displacement_error,
    mean_force_error,
    motion_errors,
)
from rubnoise.theory.occupancy import count_variance, mean_count, mean_count_error
from rubnoise.theory.regular_births import are_at_random
from rubnoise.theory.response import Response, response
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
    two_way: Response | None


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
    one_way = expected.slider is not None and not model.is_two_way
    two_way = _weak_motion(model) if model.is_two_way else None
    moves = one_way or two_way is not None
    return Theory(
        exact=expected,
        area_errors=_errors(model, mean_area_error, standard_errors) if stationary else _UNKNOWN,
        force_errors=_errors(model, mean_force_error, force_standard_errors)
        if stationary and expected.force
        else _UNKNOWN,
        count_error=mean_count_error(model) if stationary else None,
        mean_displacement=_mean_displacement(model, two_way) if moves else None,
        motion_errors=_motion_errors(model) if moves and stationary and _many_decays(model) else _UNKNOWN[:3],
        two_way=two_way,
    )


def summarise(model: Model, tally: Tally) -> list[Agreement]:
    """Return every figure of a run with its exact value, and its standard error where one can be defended."""
    theory, seen = theory_of(model), tally.moments
    figures = _moments("real_contact_area", seen["real_contact_area"], theory.exact.area, theory.area_errors)
    figures += _count(seen["junction_count"], theory.exact, theory.count_error)
    if "friction_force" in seen and theory.exact.force is not None:
        figures += _moments("friction_force", seen["friction_force"], theory.exact.force, theory.force_errors)[:2]
        figures += _coefficient(model, figures[-2])
    if "displacement" in seen and model.is_two_way:
        figures += _two_way_motion(model, tally, theory)
    elif "displacement" in seen:
        figures += _motion(seen["displacement"], seen["velocity"], theory)
    return figures


def _errors(
    model: Model, mean_error: Callable[[Model], float], all_errors: Callable[[Model], StandardErrors]
) -> Errors:
    """Return the errors of mean, std, skewness and kurtosis; for short runs and regular births of the mean alone."""
    if not ((model.distance >= FEWEST_LIVES * model.mean_life_distance) and are_at_random(model)):
        return mean_error(model), None, None, None
    errors = all_errors(model)
    return errors.mean, errors.std, errors.skewness, errors.excess_kurtosis


def _weak_motion(model: Model) -> Response | None:
    try:
        return weak_motion(model)
    except Refused:
        return None


def _mean_displacement(model: Model, two_way: Response | None) -> float:
    expected = expected_mean_displacement(model, model.distance)
    return expected if two_way is None else expected + two_way.mean_displacement - response(model).mean_displacement


def _motion_errors(model: Model) -> Errors:
    if model.is_two_way:
        errors = weak_motion_errors(model, model.distance)
        return errors.mean_displacement, errors.displacement_std, errors.velocity_std
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


def _coefficient(model: Model, force: Agreement) -> list[Agreement]:
    """Return the coefficient of friction, mean force over load, of a model with a hardness."""
    if model.load is None or force.expected is None:
        return []
    return [
        Agreement(
            name="friction_coefficient",
            observed=force.observed / model.load,
            expected=force.expected / model.load,
            standard_error=None if force.standard_error is None else force.standard_error / model.load,
        )
    ]


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


def _two_way_motion(model: Model, tally: Tally, theory: Theory) -> list[Agreement]:
    """Return what /balance and /landmarks say of a two-way slider, over its whole time.

    Spreads have an expected value while coupling is weak; the excess of the mean force and the residual of energy have
    one always, which a right run meets within the steps' errors.
    """
    if not tally.last:
        return []
    seen, kinds = Balance.of(model, tally.last), tally.counts.get("kind", [0] * len(LandmarkKind))
    known = theory.two_way
    spreads = zip(
        ("displacement_mean", "displacement_std", "velocity_std"),
        (seen.displacement_mean, seen.displacement_std, seen.velocity_std),
        (None,) * 3 if known is None else (theory.mean_displacement, known.displacement_std, known.velocity_std),
        theory.motion_errors,
        strict=True,
    )
    exact = {"mean_force_excess": seen.expected_excess(), "energy_residual": 0.0}
    figures = {
        "stick_fraction": seen.time_stuck / seen.time,
        "sticks_per_s": kinds[LandmarkKind.STICK] / seen.time,
        "reversals_per_s": kinds[LandmarkKind.REVERSAL] / seen.time,
        "slips_longer_than_d_per_s": tally.slips.count / seen.time,
        "mean_force_excess": seen.excess_over(seen.friction_along),
        "energy_residual": seen.energy_residual,
    }
    return [
        *(
            Agreement(name=name, observed=at, expected=right, standard_error=error)
            for name, at, right, error in spreads
        ),
        *(
            Agreement(name=name, observed=at, expected=exact.get(name), standard_error=None)
            for name, at in figures.items()
        ),
    ]


def _validity(velocity: Agreement, speed: float) -> Agreement:
    """Return std x' / V: one-way coupling takes the sliding speed for constant, so this should be far below 1."""
    error = velocity.standard_error
    return Agreement(
        name="one_way_validity",
        observed=velocity.observed / speed,
        expected=None if velocity.expected is None else velocity.expected / speed,
        standard_error=None if error is None else error / speed,
    )


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
    if slider is None or speed is None or slider.damping == 0.0:
        return None
    if model.is_two_way and coupling(model).unknown is not None:
        return None
    slowest = max(2.0 * slider.mass / slider.damping, slider.damping / slider.stiffness)
    return model.distance / speed / slowest


_PARTS: Final = ("mean", "std", "skewness", "excess_kurtosis")


def expected_figure(model: Model, name: str) -> float:
    """Return the exact value of a figure that `rubnoise.analysis.summary.summarise` names, in its unit.

    nan where the model has no such figure, or where theory is silent about it.
    """
    needs, value = EXPECTED_FIGURES.get(name, ("", None))
    if value is None or (needs == "slider" and model.is_two_way and not _is_known(model, name)):
        return nan
    return value(model) if needs is None or getattr(model, needs) is not None else nan


def _of_area(part: str, model: Model) -> float:
    return float(getattr(area_cumulants(model), part))


def _of_force(part: str, model: Model) -> float:
    return float(getattr(force_cumulants(model), part))


def _of_load(model: Model) -> float:
    return nan if model.load is None or model.strengths is None else force_cumulants(model).mean / model.load


def _is_known(model: Model, name: str) -> bool:
    """Whether theory has a figure of a two-way slider: its motion while coupling is weak."""
    return name != "one_way_validity" and coupling(model).unknown is None


def _exact_motion(model: Model) -> Response:
    return weak_motion(model) if model.is_two_way else response(model)


def _exact_mean_displacement(model: Model) -> float:
    excess = _exact_motion(model).mean_displacement - response(model).mean_displacement
    return expected_mean_displacement(model, model.distance) + excess


def _displacement_std(model: Model) -> float:
    return _exact_motion(model).displacement_std


def _velocity_std(model: Model) -> float:
    return _exact_motion(model).velocity_std


def _count_std(model: Model) -> float:
    return float(count_variance(model) ** 0.5)


def _one_way_validity(model: Model) -> float:
    found = response(model)
    return found.velocity_std / found.sliding_speed


EXPECTED_FIGURES: Final[dict[str, tuple[str | None, Callable[[Model], float]]]] = {
    **{f"real_contact_area_{part}": (None, partial(_of_area, part)) for part in _PARTS},
    "junction_count_mean": (None, mean_count),
    "junction_count_std": (None, _count_std),
    **{f"friction_force_{part}": ("strengths", partial(_of_force, part)) for part in _PARTS[:2]},
    "friction_coefficient": ("hardness", _of_load),
    "displacement_mean": ("slider", _exact_mean_displacement),
    "displacement_std": ("slider", _displacement_std),
    "velocity_std": ("slider", _velocity_std),
    "one_way_validity": ("slider", _one_way_validity),
}
"""The figures, what a model needs for each, and its exact value."""

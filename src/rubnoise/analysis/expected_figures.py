"""The exact value of any single figure of a run, without what the others take."""

from collections.abc import Callable
from functools import partial
from math import nan
from typing import Final

from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants, force_cumulants
from rubnoise.theory.coupling import coupling, weak_motion
from rubnoise.theory.motion_errors import expected_mean_displacement
from rubnoise.theory.occupancy import count_variance, mean_count
from rubnoise.theory.response import Response, response

_PARTS: Final = ("mean", "std", "skewness", "excess_kurtosis")


def expected_figure(model: Model, name: str) -> float:
    """Return the exact value of a figure that `rubnoise.analysis.summary.summarise` names, in its unit.

    nan where the model has no such figure, or where theory is silent about it.
    """
    needs, value = FIGURES.get(name, ("", None))
    if value is None or (needs == "slider" and model.is_two_way and not _is_known(model, name)):
        return nan
    return value(model) if needs is None or getattr(model, needs) is not None else nan


def _of_area(part: str, model: Model) -> float:
    return float(getattr(area_cumulants(model), part))


def _of_force(part: str, model: Model) -> float:
    return float(getattr(force_cumulants(model), part))


def _is_known(model: Model, name: str) -> bool:
    """Whether theory has a figure of a two-way slider: its motion while coupling is weak."""
    return name != "one_way_validity" and coupling(model).unknown is None


def _motion(model: Model) -> Response:
    return weak_motion(model) if model.is_two_way else response(model)


def _mean_displacement(model: Model) -> float:
    excess = _motion(model).mean_displacement - response(model).mean_displacement
    return expected_mean_displacement(model, model.distance) + excess


def _displacement_std(model: Model) -> float:
    return _motion(model).displacement_std


def _velocity_std(model: Model) -> float:
    return _motion(model).velocity_std


def _count_std(model: Model) -> float:
    return float(count_variance(model) ** 0.5)


def _one_way_validity(model: Model) -> float:
    found = response(model)
    return found.velocity_std / found.sliding_speed


FIGURES: Final[dict[str, tuple[str | None, Callable[[Model], float]]]] = {
    **{f"real_contact_area_{part}": (None, partial(_of_area, part)) for part in _PARTS},
    "junction_count_mean": (None, mean_count),
    "junction_count_std": (None, _count_std),
    **{f"friction_force_{part}": ("strengths", partial(_of_force, part)) for part in _PARTS[:2]},
    "displacement_mean": ("slider", _mean_displacement),
    "displacement_std": ("slider", _displacement_std),
    "velocity_std": ("slider", _velocity_std),
    "one_way_validity": ("slider", _one_way_validity),
}
"""The figures, what a model needs for each, and its exact value."""

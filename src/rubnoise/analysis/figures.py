"""Every moment of a run in one list: its column, its exact value, its standard error and its tail."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import nan, sqrt
from typing import Final

import numpy as np

from rubnoise.analysis.findings import (
    Finding,
    judged,
    judged_mean,
    tail_of,
)
from rubnoise.analysis.measured import MeasuredRun
from rubnoise.analysis.moments import over_ticks
from rubnoise.contact.births import RegularBirths
from rubnoise.model import Model
from rubnoise.theory.coupling import weak_motion, weak_motion_errors
from rubnoise.theory.cumulants import area_cumulants, force_cumulants
from rubnoise.theory.live_count import count_covariance, count_variance, mean_count, mean_count_error
from rubnoise.theory.load import load_motion
from rubnoise.theory.motion import Response, response, strengths_of
from rubnoise.theory.sampling import (
    load_errors,
    mean_area_error,
    mean_displacement_error,
    mean_force_error,
    motion_errors,
    standard_errors,
)
from rubnoise.theory.second_order import (
    are_at_random,
    autocovariance,
    joint_cumulant,
    lag_rule,
)

Errors = Callable[[Model, float], dict[str, float]]
"""Returns standard errors, by moment, of a stationary stretch of a model, and of its length in um."""


def _area_errors(stretch: Model, _length: float) -> dict[str, float]:
    """Return the errors of four moments; of two for births known to second order, of one for regular births.

    Cov[z^2, z^2] = 2 R^2 of a normal contact with the covariance R, plus the part of single junctions, times the cube
    of the dispersion if births come in bunches, as fourth cumulants of a bunch grow.
    """
    if are_at_random(stretch):
        found = standard_errors(stretch)
        return {name: getattr(found, name) for name in ("mean", "std", "skewness", "excess_kurtosis")}
    if isinstance(stretch.births, RegularBirths):
        return {"mean": mean_area_error(stretch)}
    lags, weights = lag_rule(stretch)
    fourth = max(stretch.births.dispersion, 1.0) ** 3 * joint_cumulant(stretch, lags, 2, 2)
    square = float(weights @ (fourth + 2.0 * np.square(autocovariance(stretch, lags))))
    return {"mean": mean_area_error(stretch), "std": sqrt(square) / (2.0 * area_cumulants(stretch).std)}


def _count_errors(stretch: Model, _length: float) -> dict[str, float]:
    """Return the errors of mean and, for Poisson births, variance: Cov[(N - mean)^2, (N_tau - mean)^2] = C + 2 C^2."""
    if not are_at_random(stretch):
        return {"mean": mean_count_error(stretch)}
    lags, weights = lag_rule(stretch)
    shared = count_covariance(stretch, lags)
    return {"mean": mean_count_error(stretch), "variance": sqrt(float(weights @ (shared + 2.0 * shared**2)))}


def _force_errors(stretch: Model, _length: float) -> dict[str, float]:
    """Return the errors of mean and, for Poisson births, spread: Cov = E[psi^4] kappa_22 + 2 (E[psi^2] kappa_11)^2."""
    if not are_at_random(stretch):
        return {"mean": mean_force_error(stretch)}
    (lags, weights), psi = lag_rule(stretch), strengths_of(stretch)
    single = psi.moment(4) * joint_cumulant(stretch, lags, 2, 2)
    square = float(weights @ (single + 2.0 * (psi.moment(2) * autocovariance(stretch, lags)) ** 2))
    return {"mean": mean_force_error(stretch), "std": sqrt(square) / (2.0 * force_cumulants(stretch).std)}


def _motion_errors(stretch: Model, length: float) -> dict[str, float]:
    if not are_at_random(stretch) and not stretch.is_two_way:
        return {"mean": mean_displacement_error(stretch, length)}
    errors = (weak_motion_errors if stretch.is_two_way else motion_errors)(stretch, length)
    return {"mean": errors.mean_displacement, "std": errors.displacement_std, "speed": errors.velocity_std}


def _load_errors(stretch: Model, length: float) -> dict[str, float]:
    errors = load_errors(stretch, length, from_start=False)
    return {name: getattr(errors, name) for name in errors.__slots__}


def motion_of(model: Model) -> Response:
    """Return the exact motion of a slider; raises Refused if theory has none."""
    return weak_motion(model) if model.is_two_way else response(model)


@dataclass(frozen=True, slots=True)
class JudgedMoment:
    """A moment of a column: its exact value, its error among those of its column, and d^p psi^q that a junction brings.

    ``scale``: what the error is measured by, if it is not the exact value.
    """

    name: str
    column: tuple[str, str]
    moment: str
    exact: Callable[[Model], float]
    errors: Errors
    error: str
    powers: tuple[int, int]
    scale: float | None = None


AREA, COUNT, FORCE = ("trace", "real_contact_area"), ("trace", "junction_count"), ("trace", "friction_force")
PLACE, SPEED = ("slider", "displacement"), ("slider", "velocity")
GAP, RISE, BORNE, RUBBED = (("load", name) for name in ("separation", "velocity", "load", "friction_force"))


def _area(moment: str, power: int, scale: float | None = None) -> JudgedMoment:
    def exact(model: Model) -> float:
        return float(getattr(area_cumulants(model), moment))

    return JudgedMoment(f"real_contact_area_{moment}", AREA, moment, exact, _area_errors, moment, (power, 0), scale)


def _force(column: tuple[str, str], moment: str, errors: Errors, error: str, powers: tuple[int, int]) -> JudgedMoment:
    def exact(model: Model) -> float:
        return float(getattr(force_cumulants(model), moment))

    return JudgedMoment(f"friction_force_{moment}", column, moment, exact, errors, error, powers)


def _moved(name: str, column: tuple[str, str], exact: str, error: str, powers: tuple[int, int]) -> JudgedMoment:
    def value(model: Model) -> float:
        return float(getattr(motion_of(model), exact))

    return JudgedMoment(name, column, name.rpartition("_")[2], value, _motion_errors, error, powers)


def _lifted(name: str, column: tuple[str, str], exact: Callable[[Model], float], error: str) -> JudgedMoment:
    moment = name.rpartition("_")[2]
    return JudgedMoment(name, column, moment, exact, _load_errors, error, (3 if moment == "mean" else 6, 0))


JUDGED: Final[tuple[JudgedMoment, ...]] = (
    # A junction brings d^(2n + 1) to the n-th power of the area.
    _area("mean", 3),
    _area("std", 5),
    _area("skewness", 7, scale=1.0),
    _area("excess_kurtosis", 9, scale=1.0),
    JudgedMoment("junction_count_mean", COUNT, "mean", mean_count, _count_errors, "mean", (1, 0)),
    JudgedMoment("junction_count_variance", COUNT, "variance", count_variance, _count_errors, "variance", (1, 0)),
    _force(FORCE, "mean", _force_errors, "mean", (3, 1)),
    _force(FORCE, "std", _force_errors, "std", (5, 2)),
    # A junction pushes with psi d^3, and leaves the energy of as much motion.
    _moved("displacement_mean", PLACE, "mean_displacement", "mean", (3, 1)),
    _moved("displacement_std", PLACE, "displacement_std", "std", (6, 2)),
    _moved("velocity_std", SPEED, "velocity_std", "speed", (6, 2)),
    _lifted("separation_mean", GAP, lambda _: 0.0, "separation_mean"),
    _lifted("load_mean", BORNE, lambda model: model.load or nan, "load_mean"),
    _force(RUBBED, "mean", _load_errors, "force_mean", (3, 0)),
    _lifted("separation_std", GAP, lambda model: load_motion(model).separation_std, "separation_std"),
    _lifted("normal_velocity_std", RISE, lambda model: load_motion(model).velocity_std, "velocity_std"),
    _lifted("load_std", BORNE, lambda model: load_motion(model).load_std, "load_std"),
    _force(RUBBED, "std", _load_errors, "force_std", (6, 0)),
)
"""The moments of columns that have an exact value."""


@lru_cache(maxsize=32)
def _errors(errors: Errors, model: Model, ticks: int) -> dict[str, float]:
    return errors(over_ticks(model, max(ticks, 2), model.tick), ticks * model.tick)


def moments(seen: MeasuredRun, *columns: tuple[str, str]) -> Iterator[Finding]:
    """Yield every moment of some columns that the run has, and of which theory knows the error."""
    model = seen.model
    for figure in JUDGED:
        found = seen.moments.get(figure.column)
        if figure.column not in columns or found is None or not found.count:
            continue
        errors, length = _errors(figure.errors, model, found.count), found.count * model.tick
        if figure.error not in errors:
            continue
        value, exact = getattr(found, figure.moment), figure.exact(model)
        tail, error = tail_of(model, length, *figure.powers), errors[figure.error]
        if figure.moment == "mean":
            yield judged_mean(figure.name, value, exact, error, length=length, tail=tail)
        else:
            yield judged(figure.name, value, exact, error, length=length, scale=figure.scale, tail=tail)

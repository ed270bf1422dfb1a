"""Every figure of a run in one list: its column and moment, its exact value, its standard error and its tail.

A summary has the figures of the whole run, a comparison those of the part in which the start is forgotten. What each is
called in words, and its unit, is in `rubnoise.figure_names`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import isnan, nan, sqrt
from typing import Any, Final

import numpy as np

from rubnoise.analysis import findings
from rubnoise.analysis.balance import Balance
from rubnoise.analysis.findings import SKEWNESS, judged, tail_of
from rubnoise.analysis.measured import MeasuredRun
from rubnoise.analysis.moments import FEWEST_DECAYS, FEWEST_LIVES, decays_of, over_ticks
from rubnoise.answer import Row
from rubnoise.contact.births import RegularBirths
from rubnoise.figure_names import FIGURE_NAMES
from rubnoise.model import Model
from rubnoise.record.rows import LandmarkKind
from rubnoise.record.tally import RENAMED, Tally
from rubnoise.theory import sampling, second_order
from rubnoise.theory.coupling import coupling, free_motion, load_motion, weak_motion, weak_motion_errors
from rubnoise.theory.moments import Cumulants, area_cumulants, count_variance, force_cumulants
from rubnoise.theory.motion import Response, contact_drive_of, response, strengths_of


@dataclass(frozen=True, slots=True)
class Span:
    """A record of ``length`` um that figures are over, with its model; whether it ``holds_start`` of the motion."""

    model: Model
    length: float
    holds_start: bool = False


Errors = Callable[[Span], dict[str, float]]
"""Returns standard errors over a span, by moment."""


def _area_errors(span: Span) -> dict[str, float]:
    """Return the errors of four moments; of two for births known to second order, of one for regular births.

    Cov[z^2, z^2] = 2 R^2 of a normal contact with the covariance R, plus the part of single junctions, times the cube
    of the dispersion if births come in bunches, as fourth cumulants of a bunch grow.
    """
    record = span.model
    if second_order.are_at_random(record):
        return sampling.standard_errors(record)
    if isinstance(record.births, RegularBirths):
        return {"mean": second_order.area_noise(record).error_of_mean()}
    lags, weights = second_order.lag_rule(record)
    fourth = max(record.births.dispersion, 1.0) ** 3 * second_order.joint_cumulant(record, lags, 2, 2)
    square = float(weights @ (fourth + 2.0 * np.square(second_order.autocovariance(record, lags))))
    return {
        "mean": second_order.area_noise(record).error_of_mean(),
        "std": sqrt(square) / (2.0 * area_cumulants(record).std),
    }


def _count_errors(span: Span) -> dict[str, float]:
    """Return the errors of mean and, for Poisson births, variance: Cov[(N - mean)^2, (N_tau - mean)^2] = C + 2 C^2."""
    record = span.model
    if not second_order.are_at_random(record):
        return {"mean": second_order.count_noise(record).error_of_mean()}
    lags, weights = second_order.lag_rule(record)
    shared = second_order.count_noise(record).covariance(lags)
    return {
        "mean": second_order.count_noise(record).error_of_mean(),
        "variance": sqrt(float(weights @ (shared + 2.0 * shared**2))),
    }


def _force_errors(span: Span) -> dict[str, float]:
    """Return the errors of mean and, for Poisson births, spread: Cov = E[psi^4] kappa_22 + 2 (E[psi^2] kappa_11)^2."""
    record = span.model
    if record.separation is not None:
        found = _errors(_load_errors, span)
        return {"mean": found["force_mean"], "std": found["force_std"]}
    if not second_order.are_at_random(record):
        return {"mean": sampling.mean_force_error(record)}
    (lags, weights), psi = second_order.lag_rule(record), strengths_of(record)
    single = psi.moment(4) * second_order.joint_cumulant(record, lags, 2, 2)
    square = float(weights @ (single + 2.0 * (psi.moment(2) * second_order.autocovariance(record, lags)) ** 2))
    return {"mean": sampling.mean_force_error(record), "std": sqrt(square) / (2.0 * force_cumulants(record).std)}


def _motion_errors(span: Span) -> dict[str, float]:
    record = span.model
    if not second_order.are_at_random(record) and not record.is_two_way:
        return {"mean_displacement": sampling.mean_displacement_error(record, span.length)}
    return (weak_motion_errors if record.is_two_way else sampling.motion_errors)(record, span.length)


def _load_errors(span: Span) -> dict[str, float]:
    return sampling.load_errors(span.model, span.length, from_start=span.holds_start)


def motion_of(model: Model) -> Response:
    """Return the exact motion of a slider; raises Refused if theory has none."""
    return weak_motion(model) if model.is_two_way else response(model)


def _moved_so_far(model: Model) -> float:
    """Return the mean displacement over a whole run, which begins where the slider starts."""
    excess = motion_of(model).mean_displacement - response(model).mean_displacement
    return sampling.expected_mean_displacement(model, model.distance) + excess


@dataclass(frozen=True, slots=True)
class Figure:
    """A moment of a column: the law that knows it, what it is ``of`` that law, and d^p psi^q that a junction brings.

    ``of`` is the law's attribute and the name of the error; without it the law is the exact value itself. A law is None
    if the model has no such column. ``scale``: what the error is measured by, if it is not the exact value. ``over``:
    what a summary divides moment, exact value and error by. ``whole``: the exact value over a whole run, if the start
    matters to it. A figure without ``powers`` is in no comparison; ``kept``: whether it is in a summary.
    """

    name: str
    column: tuple[str, str]
    law: Callable[[Model], Any]
    of: str
    errors: Errors
    powers: tuple[int, int] | None = None
    scale: float | None = None
    over: Callable[[Model], float] | None = None
    whole: Callable[[Model], float] | None = None
    kept: bool = True

    @property
    def error(self) -> str:
        """Its name among the errors of its column."""
        return self.of or self.name

    @property
    def moment(self) -> str:
        """The moment of the column."""
        return next(each for each in _MOMENTS if each in self.error)

    def exact(self, model: Model) -> float:
        """Return the exact value; nan if the model has no such column."""
        known = self.law(model)
        return nan if known is None else float(getattr(known, self.of) if self.of else known)

    def divisor(self, model: Model) -> float:
        """Return what a summary divides moment, exact value and error by."""
        return 1.0 if self.over is None else self.over(model)

    def is_of(self, model: Model) -> bool:
        """Whether the summaries of a model's runs have the figure."""
        known = FIGURE_NAMES[self.name]
        there = not known.needs or getattr(model, _IN_MODEL.get(known.needs, known.needs)) is not None
        return there and not (known.one_way and model.is_two_way)


_IN_MODEL: Final = {"strength": "strengths", "load": "held"}
_MOMENTS: Final = ("mean", "std", "skewness", "excess_kurtosis", "variance")

AREA, COUNT, FORCE = ("trace", "real_contact_area"), ("trace", "junction_count"), ("trace", "friction_force")
PLACE, SPEED = ("slider", "displacement"), ("slider", "velocity")
GAP, RISE, BORNE, RUBBED = (("load", name) for name in ("separation", "velocity", "load", "friction_force"))


def _count(model: Model) -> Cumulants:
    return Cumulants(values=(model.mean_live_junctions, count_variance(model)))


def _force(model: Model) -> Cumulants | None:
    return None if model.strengths is None else force_cumulants(model)


def _load(model: Model) -> float:
    return nan if model.load is None else model.load


def _speed(model: Model) -> float:
    return response(model).sliding_speed


FIGURES: Final = (
    # A junction brings d^(2n + 1) to the n-th power of the area.
    Figure("real_contact_area_mean", AREA, area_cumulants, "mean", _area_errors, (3, 0)),
    Figure("real_contact_area_std", AREA, area_cumulants, "std", _area_errors, (5, 0)),
    Figure("real_contact_area_skewness", AREA, area_cumulants, "skewness", _area_errors, (7, 0), 1.0),
    Figure("real_contact_area_excess_kurtosis", AREA, area_cumulants, "excess_kurtosis", _area_errors, (9, 0), 1.0),
    Figure("junction_count_mean", COUNT, _count, "mean", _count_errors, (1, 0)),
    Figure("junction_count_std", COUNT, _count, "std", _count_errors),
    Figure("junction_count_variance", COUNT, _count, "variance", _count_errors, (1, 0), kept=False),
    Figure("friction_force_mean", FORCE, _force, "mean", _force_errors, (3, 1)),
    Figure("friction_force_std", FORCE, _force, "std", _force_errors, (5, 2)),
    Figure("friction_coefficient", FORCE, _force, "mean", _force_errors, over=_load),
    # A junction pushes with psi d^3, and leaves the energy of as much motion.
    Figure("displacement_mean", PLACE, motion_of, "mean_displacement", _motion_errors, (3, 1), whole=_moved_so_far),
    Figure("displacement_std", PLACE, motion_of, "displacement_std", _motion_errors, (6, 2)),
    Figure("velocity_std", SPEED, motion_of, "velocity_std", _motion_errors, (6, 2)),
    # One-way coupling takes the sliding speed for constant, so this should be far below 1.
    Figure("one_way_validity", SPEED, motion_of, "velocity_std", _motion_errors, over=_speed),
    Figure("separation_mean", GAP, lambda _: 0.0, "", _load_errors, (3, 0), kept=False),
    Figure("load_mean", BORNE, _load, "", _load_errors, (3, 0)),
    Figure("friction_force_mean", RUBBED, _force, "mean", _force_errors, (3, 0), kept=False),
    Figure("separation_std", GAP, load_motion, "separation_std", _load_errors, (6, 0)),
    Figure("normal_velocity_std", RISE, load_motion, "velocity_std", _load_errors, (6, 0)),
    Figure("load_std", BORNE, load_motion, "load_std", _load_errors, (6, 0)),
    Figure("friction_force_std", RUBBED, _force, "std", _force_errors, (6, 0), kept=False),
)
"""The moments of columns that a run has. Those of a two-way slider's whole time are in `_two_way_motion`."""

KEPT: Final = {figure.name: figure for figure in FIGURES if figure.kept}
"""The figures of a summary by name, in its order."""


# A comparison.
@lru_cache(maxsize=32)
def _errors(errors: Errors, span: Span) -> dict[str, float]:
    return errors(span)


def moments(seen: MeasuredRun, *columns: tuple[str, str]) -> Iterator[Row]:
    """Yield every moment of some columns that the run has, and of which theory knows the error."""
    model = seen.model
    for figure in FIGURES:
        found = seen.moments.get(figure.column)
        if figure.powers is None or figure.column not in columns or found is None or not found.count:
            continue
        span = Span(over_ticks(model, max(found.count, 2), model.tick), found.count * model.tick)
        errors, length = _errors(figure.errors, span), span.length
        if figure.error not in errors:
            continue
        value, exact = getattr(found, figure.moment), figure.exact(model)
        tail, error = tail_of(model, length, *figure.powers), errors[figure.error]
        scale, skewness = figure.scale, 0.0 if figure.moment == "mean" else SKEWNESS
        yield judged(figure.name, value, exact, error, length=length, scale=scale, skewness=skewness, tail=tail)


# A summary.
def summarise(model: Model, tally: Tally) -> list[Row]:
    """Return every figure of a run with its exact value, and its standard error if it has one."""
    theory, found = theory_of(model), {}
    for name, figure in KEPT.items():
        seen = tally.moments.get(RENAMED.get(figure.column, figure.column[1]))
        if seen is not None and figure.is_of(model):
            found[name] = (getattr(seen, figure.moment) / figure.divisor(model), theory[name][0])
    if "displacement" in tally.moments and model.is_two_way:
        kept = {name: both for name, both in found.items() if FIGURE_NAMES[name].needs != "slider"}
        moved = _two_way_motion(model, tally)
        found = kept | {name: (value, theory[name][0] if name in theory else exact) for name, (value, exact) in moved}
    errors = {name: error for name, (_, error) in theory.items()}
    return [findings.figure(name, value, exact, errors.get(name)) for name, (value, exact) in found.items()]


@lru_cache(maxsize=8)
def theory_of(model: Model) -> dict[str, tuple[float | None, float | None]]:
    """Return exact value and standard error of the figures of a model's runs; None for those that theory does not give.

    Cached, since the runs of a sweep often differ only in their seed.
    """
    found = {}
    for name, figure in KEPT.items():
        value = expected_figure(model, name)
        error = None if isnan(value) else _error_over_all(model, figure)
        found[name] = None if isnan(value) else value, None if error is None else error / figure.divisor(model)
    return found


def _error_over_all(model: Model, figure: Figure) -> float | None:
    """Return the error of a figure over a whole run; None if it has none.

    A run that starts empty has none, since its record is not stationary from the beginning, and free motion has no
    theory of errors. Short runs, and births that are not a Poisson process, have errors of means only.
    """
    if model.start != "stationary" or model.free is not None:
        return None
    moving = None
    if figure.column[0] == "slider":
        moving = model.slider
    elif figure.column[0] == "load" or (figure.column == FORCE and model.separation is not None):
        moving = contact_drive_of(model).slider
    elif figure.moment != "mean":
        short = model.distance < FEWEST_LIVES * model.mean_life_distance
        if short or not second_order.are_at_random(model):
            return None
    if moving is not None:
        decays = decays_of(model, moving)
        if decays is None or decays < FEWEST_DECAYS:
            return None
    return _errors(figure.errors, Span(model, model.distance, holds_start=True)).get(figure.error)


def expected_figure(model: Model, name: str) -> float:
    """Return the exact value of a figure that `summarise` names, in its unit.

    nan if the model has no such figure, or theory does not give it.
    """
    figure = KEPT.get(name)
    if figure is None or not figure.is_of(model):
        return nan
    if model.free is not None:
        known = free_motion(model)
        means = {BORNE: known.load_mean, AREA: known.area_mean, FORCE: known.force_mean}
        return means.get(figure.column, nan) / figure.divisor(model) if figure.moment == "mean" else nan
    if figure.column[0] == "slider" and model.is_two_way and coupling(model).unknown is not None:
        return nan
    return (figure.whole or figure.exact)(model) / figure.divisor(model)


def _two_way_motion(model: Model, tally: Tally) -> Iterator[tuple[str, tuple[float, float | None]]]:
    """Yield the figures of a two-way slider from /balance and /landmarks, over its whole time, with exact values.

    Spreads have an expected value if coupling is weak; the excess of the mean force and the residual of energy always
    have one, which a correct run meets within the errors of its steps.
    """
    if not tally.last:
        return
    seen, kinds = Balance.of(model, tally.last), tally.counts.get("kind", [0] * len(LandmarkKind))
    yield "displacement_mean", (seen.displacement_mean, None)
    yield "displacement_std", (seen.displacement_std, None)
    yield "velocity_std", (seen.velocity_std, None)
    yield "stick_fraction", (seen.time_stuck / seen.time, None)
    yield "sticks_per_s", (kinds[LandmarkKind.STICK] / seen.time, None)
    yield "reversals_per_s", (kinds[LandmarkKind.REVERSAL] / seen.time, None)
    yield "slips_longer_than_d_per_s", (tally.slips.count / seen.time, None)
    yield "mean_force_excess", (seen.excess_over(seen.friction_along), seen.expected_excess())
    yield "energy_residual", (seen.energy_residual, 0.0)

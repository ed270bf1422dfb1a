"""Every figure of a run in one list: its column and moment, its exact value, its standard error and its tail.

A summary and a comparison have the figures of the part in which the start is forgotten. What each is called in words,
and its unit, is in `rubnoise.figure_names`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import isnan, nan, sqrt
from typing import Any, Final

import numpy as np

from rubnoise.analysis import findings
from rubnoise.analysis.findings import SKEWNESS, judged, tail_of
from rubnoise.analysis.measured import Measured, MeasuredRun
from rubnoise.analysis.moments import FEWEST_LIVES, over_ticks, settled
from rubnoise.analysis.motion import Balance
from rubnoise.answer import Row
from rubnoise.contact.births import RegularBirths
from rubnoise.figure_names import FIGURE_NAMES, unit_of
from rubnoise.model import Model
from rubnoise.record.rows import LandmarkKind
from rubnoise.theory import sampling, second_order
from rubnoise.theory.coupling import coupling, free_motion, load_motion, weak_motion, weak_motion_errors
from rubnoise.theory.moments import Cumulants, area_cumulants, count_variance, force_cumulants
from rubnoise.theory.motion import Response, response, strengths_of

Errors = Callable[[Model, float], dict[str, float]]
"""Returns standard errors over a stationary record, given by a model of its own and its length in um, by moment."""


def _area_errors(record: Model, _length: float) -> dict[str, float]:
    """Return the errors of four moments; of two for births known to second order, of one for regular births.

    Cov[z^2, z^2] = 2 R^2 of a normal contact with the covariance R, plus the part of single junctions, times the cube
    of the dispersion if births come in bunches, as fourth cumulants of a bunch grow.
    """
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


def _count_errors(record: Model, _length: float) -> dict[str, float]:
    """Return the errors of mean and, for Poisson births, variance: Cov[(N - mean)^2, (N_tau - mean)^2] = C + 2 C^2."""
    if not second_order.are_at_random(record):
        return {"mean": second_order.count_noise(record).error_of_mean()}
    lags, weights = second_order.lag_rule(record)
    shared = second_order.count_noise(record).covariance(lags)
    return {
        "mean": second_order.count_noise(record).error_of_mean(),
        "variance": sqrt(float(weights @ (shared + 2.0 * shared**2))),
    }


def _force_errors(record: Model, length: float) -> dict[str, float]:
    """Return the errors of mean and, for Poisson births, spread."""
    if record.separation is not None:
        found = sampling.load_errors(record, length)
        return {"mean": found["force_mean"], "std": found["force_std"]}
    if not second_order.are_at_random(record):
        return {"mean": sampling.mean_force_error(record)}
    return sampling.standard_errors(record, strengths=strengths_of(record))


def _motion_errors(record: Model, length: float) -> dict[str, float]:
    if not second_order.are_at_random(record) and not record.is_two_way:
        return {"mean_displacement": sampling.mean_displacement_error(record, length)}
    return (weak_motion_errors if record.is_two_way else sampling.motion_errors)(record, length)


def motion_of(model: Model) -> Response:
    """Return the exact motion of a slider; raises Refused if theory has none."""
    return weak_motion(model) if model.is_two_way else response(model)


@dataclass(frozen=True, slots=True)
class Figure:
    """A moment of a column: the law that knows it, what it is ``of`` that law, and d^p psi^q that a junction brings.

    ``of`` is the law's attribute and the name of the error; without it the law is the exact value itself. A law is None
    if the model has no such column. ``scale``: what the error is measured by, if it is not the exact value. ``over``:
    what moment, exact value and error are divided by. A figure without ``powers`` is in no comparison, one without
    words in `rubnoise.figure_names` in no summary.
    """

    name: str
    column: tuple[str, str]
    law: Callable[[Model], Any]
    of: str
    errors: Errors
    powers: tuple[int, int] | None = None
    scale: float | None = None
    over: Callable[[Model], float] = lambda _: 1.0

    @property
    def moment(self) -> str:
        """The moment of the column."""
        return next(each for each in _MOMENTS if each in (self.of or self.name))

    def column_in(self, model: Model) -> tuple[str, str]:
        """Return the column by its group; under a load the force is judged with the load."""
        return RUBBED if self.column == FORCE and model.held is not None else self.column

    def is_of(self, model: Model) -> bool:
        """Whether the summaries of a model's runs have the figure."""
        known = FIGURE_NAMES[self.name]
        there = not known.needs or getattr(model, _IN_MODEL.get(known.needs, known.needs)) is not None
        return there and not (known.one_way and model.is_two_way)

    def exact(self, model: Model) -> float | None:
        """Return the exact value of a run of a model; None if theory does not give it."""
        if model.free is not None:
            known = free_motion(model)
            means = {BORNE: known.load_mean, AREA: known.area_mean, FORCE: known.force_mean}
            found = means.get(self.column, nan) if self.moment == "mean" else nan
        elif self.column[0] == "slider" and model.is_two_way and coupling(model).unknown is not None:
            return None
        else:
            law = self.law(model)
            found = nan if law is None else float(getattr(law, self.of) if self.of else law)
        return None if isnan(found) else found / self.over(model)

    def error(self, model: Model) -> float | None:
        """Return the standard error over a run, from where its start is forgotten; None if it has none.

        Short runs have errors of means only, and free motion has no theory of errors.
        """
        group, _ = self.column_in(model)
        first = settled(model)[group]
        if first is None or model.free is not None:
            return None
        short = model.distance - first * model.tick < FEWEST_LIVES * model.mean_life_distance
        if group == "trace" and self.moment != "mean" and short:
            return None
        found = _errors(self.errors, model, model.tick_count + 1 - first).get(self.of or self.name)
        return None if found is None else found / self.over(model)

    def measured(self, seen: Measured) -> float | None:
        """Return what was measured of a run; None without rows."""
        found = seen.moments.get(self.column_in(seen.model))
        return getattr(found, self.moment) / self.over(seen.model) if found is not None and found.count else None


_IN_MODEL: Final = {"strength": "strengths", "load": "held"}
_MOMENTS: Final = ("mean", "std", "skewness", "excess_kurtosis", "variance")

AREA, COUNT, FORCE = ("trace", "real_contact_area"), ("trace", "junction_count"), ("trace", "friction_force")
PLACE, SPEED = ("slider", "displacement"), ("slider", "velocity")
GAP, RISE, BORNE, RUBBED = (("load", name) for name in ("separation", "velocity", "load", "friction_force"))


def _count(model: Model) -> Cumulants:
    return Cumulants(values=(model.mean_live_junctions, count_variance(model)))


def _force(model: Model) -> Cumulants | None:
    return None if model.strengths is None else force_cumulants(model)


def _speed(model: Model) -> float:
    return model.sliding_speed or nan


FIGURES: Final = (
    # A junction brings d^(2n + 1) to the n-th power of the area.
    Figure("real_contact_area_mean", AREA, area_cumulants, "mean", _area_errors, (3, 0)),
    Figure("real_contact_area_std", AREA, area_cumulants, "std", _area_errors, (5, 0)),
    Figure("real_contact_area_skewness", AREA, area_cumulants, "skewness", _area_errors, (7, 0), 1.0),
    Figure("real_contact_area_excess_kurtosis", AREA, area_cumulants, "excess_kurtosis", _area_errors, (9, 0), 1.0),
    Figure("junction_count_mean", COUNT, _count, "mean", _count_errors, (1, 0)),
    Figure("junction_count_std", COUNT, _count, "std", _count_errors),
    Figure("junction_count_variance", COUNT, _count, "variance", _count_errors, (1, 0)),
    Figure("friction_force_mean", FORCE, _force, "mean", _force_errors, (3, 1)),
    Figure("friction_force_std", FORCE, _force, "std", _force_errors, (5, 2)),
    Figure("friction_coefficient", FORCE, _force, "mean", _force_errors, over=lambda model: model.load or nan),
    # A junction pushes with psi d^3, and leaves the energy of as much motion.
    Figure("displacement_mean", PLACE, motion_of, "mean_displacement", _motion_errors, (3, 1)),
    Figure("displacement_std", PLACE, motion_of, "displacement_std", _motion_errors, (6, 2)),
    Figure("velocity_std", SPEED, motion_of, "velocity_std", _motion_errors, (6, 2)),
    # One-way coupling takes the sliding speed for constant, so this should be far below 1.
    Figure("one_way_validity", SPEED, motion_of, "velocity_std", _motion_errors, over=_speed),
    Figure("separation_mean", GAP, lambda _: 0.0, "", sampling.load_errors, (3, 0)),
    Figure("load_mean", BORNE, lambda model: model.load, "", sampling.load_errors, (3, 0)),
    Figure("separation_std", GAP, load_motion, "separation_std", sampling.load_errors, (6, 0)),
    Figure("normal_velocity_std", RISE, load_motion, "velocity_std", sampling.load_errors, (6, 0)),
    Figure("load_std", BORNE, load_motion, "load_std", sampling.load_errors, (6, 0)),
)
"""The moments of columns that a run has; what /balance and /landmarks of a two-way slider add is in `_pushed_back`."""

KEPT: Final = {figure.name: figure for figure in FIGURES if figure.name in FIGURE_NAMES}
"""The figures of a summary by name, in its order."""


@lru_cache(maxsize=32)
def _errors(errors: Errors, model: Model, ticks: int) -> dict[str, float]:
    """Return the errors of a column over some ticks, by moment."""
    return errors(over_ticks(model, max(ticks, 2)), ticks * model.tick)


def moments(seen: MeasuredRun, *columns: tuple[str, str]) -> Iterator[Row]:
    """Yield, for a comparison, every moment of some columns that the run has, and of which theory knows the error."""
    model = seen.model
    for figure in FIGURES:
        if figure.powers is None or figure.column_in(model) not in columns:
            continue
        value, (exact, error) = figure.measured(seen), _known(figure, model)
        if value is not None and exact is not None and error is not None:
            length = seen.moments[figure.column_in(model)].count * model.tick
            yield judged(
                figure.name,
                value,
                exact,
                error,
                length=length,
                scale=figure.scale,
                skewness=0.0 if figure.moment == "mean" else SKEWNESS,
                tail=tail_of(model, length, *figure.powers),
                unit=unit_of(figure.name),
            )


def summarise(seen: Measured) -> list[Row]:
    """Return every figure of a run with its exact value, and its standard error if it has one."""
    rows = []
    for name, figure in KEPT.items():
        value = figure.measured(seen) if figure.is_of(seen.model) else None
        if value is not None:
            rows.append(findings.figure(name, value, *_known(figure, seen.model), unit=unit_of(name)))
    return [*rows, *_pushed_back(seen)]


@lru_cache(maxsize=64)
def _known(figure: Figure, model: Model) -> tuple[float | None, float | None]:
    """Return exact value and standard error; cached, since the runs of a sweep often differ only in their seed."""
    exact = figure.exact(model)
    return exact, None if exact is None else figure.error(model)


def expected_figure(model: Model, name: str) -> float:
    """Return the exact value of a figure that `summarise` names, in its unit.

    nan if the model has no such figure, or theory does not give it.
    """
    figure = KEPT.get(name)
    exact = figure.exact(model) if figure is not None and figure.is_of(model) else None
    return nan if exact is None else exact


def _pushed_back(seen: Measured) -> Iterator[Row]:
    """Yield the figures of a two-way slider from /balance and /landmarks, over its whole time.

    The excess of the mean force and the residual of energy have an expected value, which a correct run meets within
    the errors of its steps.
    """
    if not seen.last:
        return
    found, kinds = Balance.of(seen.model, seen.last), seen.kinds.tolist()
    for name, value, exact in (
        ("stick_fraction", found.time_stuck / found.time, None),
        ("sticks_per_s", kinds[LandmarkKind.STICK] / found.time, None),
        ("reversals_per_s", kinds[LandmarkKind.REVERSAL] / found.time, None),
        ("slips_longer_than_d_per_s", seen.slips.count / found.time, None),
        ("mean_force_excess", found.excess_over(found.friction_along), found.expected_excess()),
        ("energy_residual", found.energy_residual, 0.0),
    ):
        yield findings.figure(name, value, exact, None, unit=unit_of(name))

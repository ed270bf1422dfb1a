"""From a measured trace to its junctions, as numbers with intervals."""

import os
from dataclasses import replace
from math import sqrt
from typing import Any, Final, Literal

import numpy as np

from rubnoise.api import keywords
from rubnoise.api.fit import Inference
from rubnoise.api.given_columns import given_columns
from rubnoise.api.infer_options import bandwidth_of, cut, pulse_of, strength_spread_of
from rubnoise.api.trace import Trace
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import LAWS
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.inference.assumed import Assumed
from rubnoise.inference.estimates import Estimate
from rubnoise.inference.inference import LAWS as SIZES
from rubnoise.inference.inference import infer_signal
from rubnoise.inference.signal import Signal, clipped
from rubnoise.model import Model
from rubnoise.real_numbers import real_numbers, with_unit
from rubnoise.record.sink import Columns
from rubnoise.simulation.run import simulate
from rubnoise.storage.measured import read_measured, refusing_files
from rubnoise.storage.samples import LARGEST_VALUE, UNEVEN, Measured, check_values, chosen_column
from rubnoise.storage.text_heads import head_of
from rubnoise.units import FREQUENCY, SPEED, STRESS, QuantityError, parse_unit

MOST_BOOTSTRAPS: Final = 10_000
MOST_COLUMNS: Final = 100_000
STROKE_END: Final = "5 %"
"""Default share of a stroke that is left out at each end."""
_MASK: Final = 0.01  # of the frequency, on either side
_WRONG_WAY: Final = 0.95


def infer(
    trace: Any,
    *,
    speed: Any = None,
    column: str | int | None = None,
    unit: Any = None,
    rate: Any = None,
    zero: Literal["known", "unknown"] = "unknown",
    strength: Any = None,
    strength_spread: Any = None,
    pulse: str | None = None,
    offset: str = "none",
    bandwidth: Any = None,
    poles: int = 1,
    law: str = "auto",
    mask: Any = (),
    drift: bool = False,
    from_: Any = None,
    to: Any = None,
    strokes: Any = None,
    bootstrap: int = 0,
) -> Inference:
    """Return number, size, spread and strength of the junctions behind a friction trace, with 95 % intervals.

    ``trace``: a path (CSV, TSV, WAV, MATLAB 5, a result of ours, ``FILE.h5:PATH``), an array with a ``rate``, a table
    of pandas or xarray, a run or its column, or an object with ``columns``, ``units``, ``place`` and ``step``.
    Quantities are texts with a unit, or quantities of pint.
    ``speed``, such as "1 mm/s", turns time into sliding distance. ``rate``, such as "20 kHz", is how often an array was
    sampled. ``unit`` is a unit of force or V, or what a value of 1 is ("0.5 mN"). ``strength``, such as "250 MPa", is
    known. ``column`` is a name, or a number from 1 on. ``zero`` is "known" if 0 means no force.
    ``strength_spread``, such as "50 %", is the standard deviation over the mean of lognormal strengths, 0 without it.
    ``pulse`` is the shape of lives: "parabola" of rough surfaces, "lens" of equal asperities, taken without it.
    The other one is fitted too, and if no option chose and numbers depend on it, that is a flag. ``offset`` "uniform"
    reads passes that miss the centre. ``bandwidth`` is the corner of the sensor, such as "200 Hz",
    of one pole or two ``poles``. ``mask`` names frequencies that are left out, such as "50 Hz"; ``drift`` fits a random
    walk as well. ``from_`` and ``to`` are the first and the last sample, from 1 on, or times such as "2 s".
    ``strokes``, such as "10 %" (True is 5 %), cuts at reversals, leaves out so much of each stroke at either end,
    and fits the strokes together. ``bootstrap`` traces are simulated from what was found, and
    ``Inference.bootstrap`` holds how the estimates scatter. ``assumptions`` of the answer say what was taken for
    granted. Raises Refused for bad input, and for a quantity without a unit. What statistics refuse stands in
    ``refused_because``, what speaks against the model in ``flags``. Source: docs/inference.md.
    """
    keywords.choice("zero", zero, ("known", "unknown"))
    keywords.choice("law", law, ("auto", *SIZES))
    keywords.choice("drift", drift, (True, False))
    keywords.count("bootstrap", bootstrap, MOST_BOOTSTRAPS)
    velocity, psi = keywords.quantity("speed", speed, SPEED), keywords.quantity("strength", strength, STRESS)
    often, left_out = keywords.quantity("rate", rate, FREQUENCY), keywords.frequencies("mask", mask)
    if unit is not None:
        keywords.scale_of(unit, "unit=")
    measured = _measured(trace, column, often)
    strokes = STROKE_END if strokes is True else None if strokes is False else strokes
    signal = _signal(measured, velocity, unit, often)
    _check_sensor(measured, zero)
    step = signal.tick / velocity if velocity is not None and measured.along == "time" else signal.tick
    signal = cut(signal, from_, to, strokes, step=step, along=measured.along)
    if strength is not None and signal.scale is None:
        raise Refused(
            f'strength=: the trace is in {signal.unit}, which is no force; unit= takes one, such as unit="mN"'
        )
    if strength is not None and signal.is_area:
        raise Refused("strength=: a trace of area has no strengths")
    masked = _masked(left_out, velocity, measured.along, signal.tick)
    assumed = Assumed(
        strength_spread=strength_spread_of(strength_spread, signal, both_known=zero == "known" and psi is not None),
        pulse=pulse_of(pulse or "lens", offset),
        shape_chosen=pulse is not None,
        bandwidth=bandwidth_of(bandwidth, poles, velocity, measured.along),
        poles=poles,
    )
    asked: dict[str, Any] = {"zero": zero, "strength": psi, "masked": masked, "drift": drift, "assumed": assumed}
    found = Inference.of(infer_signal(signal, law=law, **asked), name=_named(measured), speed=speed, strength=strength)
    if not bootstrap or found.refused_because is not None:
        return found
    return replace(found, bootstrap=_bootstrapped(found, bootstrap, asked))


def _measured(trace: Any, column: str | int | None, rate: float | None) -> Measured:
    column = (
        column if column is None or isinstance(column, str) else str(keywords.count("column", column, MOST_COLUMNS))
    )
    if isinstance(trace, str | os.PathLike):
        with refusing_files(trace):
            own = _own_result(trace, column)
            return read_measured(trace, column, rate) if own is None else own
    if all(hasattr(trace, name) for name in ("columns", "units", "place", "step")):
        names = list(trace.columns)
        name = names[chosen_column(getattr(trace, "name", "trace"), names, column, names.index(trace.place))]
        along = "time" if trace.units[trace.place] == "s" else "distance"
        values = real_numbers(trace.columns[name], name)
        check_values(values, name)
        return Measured(name=name, values=values, unit=trace.units[name], step=trace.step, along=along)
    if (columns := given_columns(trace, sampled=rate is not None)) is not None:
        return _of_columns(columns, column, ours=hasattr(trace, "groups_by_name"))
    if column is not None:
        raise Refused(f"column=: {keywords.shown(column)}: an array has one column; leave column= out")
    values, unit = with_unit(trace, "trace", "")
    if values.ndim != 1 or not values.size:
        raise Refused(f"trace: has the shape {values.shape}; one row of finite numbers is needed")
    check_values(values, "trace")
    return Measured(name="trace", values=values, unit=unit, step=None, along="time")


def _of_columns(columns: dict[str, Any], column: str | None, *, ours: bool) -> Measured:
    """Return a column of a table after its time or distance; for a run of ``ours`` the force, otherwise the area."""
    others = [head_of(header).name for header in list(columns)[1:]]
    if column is None and ours:
        column = "friction_force" if "friction_force" in others else "real_contact_area"
    if column is None and len(others) > 1:
        listed = ", ".join(others[:12])
        raise Refused(f'trace: column= is needed, one of {listed}; right form: column="{others[0]}"')
    return _measured(Trace.from_arrays(columns, name="trace"), column, None)


def _own_result(trace: str | os.PathLike[str], column: str | None) -> Measured | None:
    """Return a column of the trace of a result of ours; None for any other file."""
    from rubnoise.regular_file import is_hdf5

    path = os.fspath(trace)
    if not os.path.exists(path) or not is_hdf5(path):  # noqa: PTH110  (a path with a colon may be no path)
        return None
    from rubnoise.api.run import open as open_result

    try:
        opened = open_result(path)
    except RunFileRefused as problem:
        raise Refused(f"{problem}; of a file of another program, {path}:PATH names a dataset") from problem
    with opened as run:
        there = run.trace
        name = column or ("friction_force" if "friction_force" in there else "real_contact_area")
        if name not in there or name not in {"friction_force", "real_contact_area"}:
            raise Refused(
                f"{path}: column=: {name} is neither friction_force, which needs a strength, nor real_contact_area"
            )
        unit = "uN" if name == "friction_force" else "um^2"
        return Measured(
            name=name,
            values=np.asarray(there[name][:], dtype=np.float64),
            unit=unit,
            step=run.scenario.model().tick,
            along="distance",
            where=path,
        )


def _named(measured: Measured) -> str:
    return f"{measured.where}: {measured.name}" if measured.where else measured.name


def _check_sensor(measured: Measured, zero: str) -> None:
    """Raise Refused for a saturated sensor, and for a force of the wrong sign."""
    values = measured.values
    if 0.0 < (largest := float(np.abs(values).max())) < 1.0 / LARGEST_VALUE:
        raise Refused(f"{_named(measured)}: its largest value is {largest:g}; give the values in a smaller unit")
    if end := clipped(values):
        raise Refused(
            f"{_named(measured)}: the sensor was clipped: {end.samples:,} samples are at the largest value,"
            f" {end.longest:,} in a row, first at {measured.place(end.first)}; measure again with a wider range"
        )
    if zero == "known" and np.count_nonzero(values < 0.0) > _WRONG_WAY * values.size:
        first = measured.place(int(np.argmax(values < 0.0)))
        raise Refused(
            f"{_named(measured)}: nearly all values are negative, first at {first}: with a known zero the force of"
            " friction is positive; check the sign of the speed"
        )


def _signal(measured: Measured, speed: float | None, unit: Any, rate: float | None) -> Signal:
    if (
        rate is not None
        and measured.step is not None
        and (measured.along != "time" or abs(measured.step * rate - 1.0) > UNEVEN)
    ):
        raise Refused(f"rate=: the trace says itself how its samples lie, every {measured.step:g}")
    step = measured.step if rate is None else 1.0 / rate
    if step is None:
        raise Refused('the trace has no time and no distance; rate="20 kHz" says how often it was sampled')
    if measured.along == "time":
        if speed is None:
            raise Refused('speed= is needed: the trace is over time, junctions live by distance; as in speed="1 mm/s"')
        step *= speed
    elif speed is not None:
        raise Refused("speed=: the trace is over sliding distance, which needs no speed")
    written = measured.unit if unit is None else _given_unit(measured, unit)
    if not written:
        raise Refused(f'{_named(measured)}: no unit; unit="mN" names it, unit="V" one without a scale of force')
    scale, is_area = keywords.scale_of(written, f"{_named(measured)}: unit" if unit is None else "unit=")
    return Signal(values=measured.values, tick=step, unit=str(written), scale=scale, is_area=is_area)


def _given_unit(measured: Measured, unit: Any) -> Any:
    """Return the given unit; raises Refused if the trace has another one. A trace in volts has no scale yet."""
    try:
        knows = any(parse_unit(measured.unit).dimension)
    except QuantityError:
        knows = False
    if knows and keywords.scale_of(measured.unit, f"{_named(measured)}: unit") != keywords.scale_of(unit, "unit="):
        raise Refused(
            f"unit=: {keywords.shown(unit)}: {_named(measured)} is in {measured.unit} by its own words; leave unit= out"
        )
    return keywords.unit_text(unit).removeprefix("1 ").removeprefix("1.0 ")


def _masked(mask: list[float], speed: float | None, along: str, tick: float) -> tuple[tuple[float, float], ...]:
    """Return the masked ranges in cycles per um."""
    if mask and (along != "time" or speed is None):
        raise Refused("mask=: frequencies are of a trace over time")
    velocity = speed or 1.0
    highest = 0.5 * velocity / tick
    if beyond := [each for each in mask if each > highest]:
        raise Refused(f"mask=: {beyond[0]:g} Hz is beyond half the rate of the samples, which is {highest:g} Hz")
    return tuple(((1.0 - _MASK) * each / velocity, (1.0 + _MASK) * each / velocity) for each in mask)


class _KeptColumn:
    """Keeps one column of a run in memory."""

    def __init__(self, name: str, rows: int) -> None:
        self.name, self.values = name, np.empty(rows)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Keep rows of the trace (see Sink)."""
        if group == "trace":
            self.values[first_row : first_row + columns[self.name].size] = columns[self.name]


def _bootstrapped(found: Inference, count: int, asked: dict[str, Any]) -> dict[str, Estimate]:
    """Return mean, standard deviation and middle 95 % of the estimates of traces simulated from those found."""
    samples: dict[str, list[float]] = {}
    for seed in range(1, count + 1):
        again = replace(found.signal, values=_simulated(found, seed))
        refit = infer_signal(again, law=found.law, tests=False, **asked)
        for name, each in refit.estimates.items():
            samples.setdefault(name, []).append(each.value)
    return {
        name: Estimate(
            value=float(np.mean(values)),
            standard_error=float(np.std(values)),
            interval=(float(np.quantile(values, 0.025)), float(np.quantile(values, 0.975))),
            unit=found.estimates[name].unit,
        )
        for name, values in samples.items()
        if name in found.estimates
    }


def _simulated(found: Inference, seed: int) -> Doubles:
    """Return a trace of the found scenario, of the same length, made by the batch engine."""
    fit, signal = found.fit, found.signal
    if fit is None:
        raise Refused("nothing was found that could be simulated")
    contact, tick, rows = fit.contact, signal.tick, signal.values.size
    diameter = contact.place.diameter * tick
    spread = sqrt(max(contact.inequality - 1.0, 0.0))
    model = Model(
        mean_real_contact_area=1.0,
        mean_junction_count=fit.problem.pulse.mean_life * contact.births * contact.place.diameter,
        calibration="exact",
        calibrated_diameter=diameter,
        sizes=fit.problem.population.law(diameter, contact.place.shape),
        births=PoissonBirths(mean_spacing=tick / contact.births),
        strengths=LAWS["lognormal"].make(1.0, spread, {}) if spread else LAWS["fixed"].make(1.0, 0.0, {}),
        sliding_speed=None,
        distance=tick * (rows - 1),
        start="stationary",
        slider=None,
        tick=tick,
        tick_count=rows - 1,
        pulse=fit.problem.pulse,
    )
    sink = _KeptColumn("friction_force", rows)
    simulate(model, seed, sink, engine="batch")
    scale = float(signal.values.std())
    noise = np.random.default_rng(seed).standard_normal(rows) * np.sqrt(contact.place.noise)
    return scale * (contact.strength / tick**2 * fit.problem.sensor.filtered(sink.values) + noise)

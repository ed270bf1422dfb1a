"""From a measured trace to its junctions, as numbers with intervals."""

import os
from collections.abc import Sequence
from dataclasses import replace
from math import inf, sqrt
from typing import Any, Final, Literal

import numpy as np

from rubnoise.api import keywords
from rubnoise.api.fit import Inference
from rubnoise.api.given_columns import columns_of, source_of
from rubnoise.api.run import Run
from rubnoise.api.run import open as open_result
from rubnoise.api.trace import Trace
from rubnoise.arrays import Doubles
from rubnoise.contact import pulses
from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import LAWS
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused, RunFileRefused, refusing_files
from rubnoise.inference.estimates import Assumed, Estimate
from rubnoise.inference.inference import LAWS as SIZES
from rubnoise.inference.inference import OTHER_OFFSETS, OTHER_SHAPES, infer_signal
from rubnoise.inference.signal import Signal, clipped, digits, joined
from rubnoise.model import Model
from rubnoise.real_numbers import with_unit
from rubnoise.record.reader import MemoryRecord
from rubnoise.regular_file import is_hdf5
from rubnoise.simulation.draws import extent
from rubnoise.simulation.run import simulate
from rubnoise.storage.foreign import opened as opened_file
from rubnoise.storage.measured import LARGEST_VALUE, Asked, Head, Source, measured
from rubnoise.units import FREQUENCY, RATIO, SPEED, STRESS, QuantityError, quantity_of

MOST_BOOTSTRAPS: Final = 10_000
STROKE_END: Final = "5 %"
"""Default share of a stroke that is left out at each end."""
_MASK: Final = 0.01  # of the frequency, on either side
_WRONG_WAY: Final = 0.95


def infer(
    trace: Any,
    *,
    speed: Any = None,
    column: str | int | None = None,
    place: str | int | None = None,
    time: str | int | None = None,
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
    **unknown: Any,
) -> Inference:
    """Return number, size, spread and strength of the junctions behind a friction trace, with 95 % intervals.

    ``trace``: a path (text, WAV, MATLAB 5, a result of ours, ``FILE.h5:PATH``, netCDF), an array with a ``rate``, a
    table of pandas or xarray, a run or its column, or an object with ``columns``, ``units``, ``place`` and ``step``.
    Quantities are texts with a unit, or quantities of pint.
    ``speed``, such as "1 mm/s", turns time into sliding distance. ``rate``, such as "20 kHz", is how often samples were
    taken, whatever the file says. ``unit`` is a unit of force or V, or what a value of 1 is ("0.5 mN", or "-1 mN" to
    turn the sign), whatever the file says. ``strength``, such as "250 MPa", is known. ``column`` is a name, or a number
    from 1 on, and so are ``time`` and ``place``, the columns of times and of distances. ``zero`` is "known" if 0 means
    no force.
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
    keywords.refuse_unknown(unknown, tuple(infer.__kwdefaults__ or ()))
    keywords.choice("zero", zero, ("known", "unknown"))
    keywords.choice("law", law, ("auto", *SIZES))
    keywords.choice("drift", drift, (True, False))
    keywords.count("bootstrap", bootstrap, MOST_BOOTSTRAPS)
    velocity, psi = keywords.quantity("speed", speed, SPEED), keywords.quantity("strength", strength, STRESS)
    left_out = keywords.frequencies("mask", mask)
    if unit is not None:
        keywords.scale_of(unit, "unit=")
    found = _measured(trace, keywords.asked(column=column, place=place, time=time, rate=rate, from_=from_, to=to))
    strokes = STROKE_END if strokes is True else None if strokes is False else strokes
    signal = _signal(found, velocity, unit)
    _check_sensor(found, signal, zero)
    if strokes is not None:
        signal = joined(signal, share("strokes", strokes, MOST_OF_AN_END), found.begin)
    if strength is not None and signal.scale is None:
        raise Refused(
            f'strength=: the trace is in {signal.unit}, which is no force; unit= takes one, such as unit="mN"'
        )
    if strength is not None and signal.is_area:
        raise Refused("strength=: a trace of area has no strengths")
    masked = _masked(left_out, velocity, found.along, signal.tick)
    assumed = Assumed(
        strength_spread=strength_spread_of(strength_spread, signal, both_known=zero == "known" and psi is not None),
        pulse=pulse_of(pulse or "lens", offset),
        shape_chosen=pulse is not None,
        bandwidth=bandwidth_of(bandwidth, poles, velocity, found.along),
        poles=poles,
    )
    asked: dict[str, Any] = {"zero": zero, "strength": psi, "masked": masked, "drift": drift, "assumed": assumed}
    answer = Inference.of(infer_signal(signal, law=law, **asked), name=_named(found), speed=speed, strength=strength)
    if not bootstrap or answer.refused_because is not None:
        return answer
    return replace(answer, bootstrap=_bootstrapped(answer, bootstrap, asked))


def _measured(trace: Any, asked: Asked) -> Source:
    """Return the wanted column of what is given; of a run the force by default, or else the area."""
    name, given = "trace", trace
    if isinstance(trace, str | os.PathLike):
        with refusing_files(trace):
            name, given = os.fspath(trace), _own_result(trace)
            if given is None:
                return measured(opened_file(trace, asked.column), asked)
    columns = columns_of(given, sampled=asked.rate is not None)
    if columns is None:
        return measured(_of_array(given, asked), asked)
    source = source_of(columns, name, trace.notes if isinstance(trace, Trace) else ())
    others = [head.name for head in source.heads[1:]]
    if isinstance(given, Run):
        asked = replace(asked, column=_column_of_run(name, others, asked.column))
    if asked.column is None and len(others) > 1:
        there = ", ".join(others)
        raise Refused(f'trace: column= is needed, one of {there}; right form: column="{others[0]}"')
    if (asked.place, asked.time, asked.rate) == (None, None, None) and source.heads[0].along(named=True):
        asked = replace(asked, place="1")
    return measured(source, asked)


def _column_of_run(name: str, there: Sequence[str], wanted: str | None) -> str:
    column = wanted or ("friction_force" if "friction_force" in there else "real_contact_area")
    if column not in there or column not in {"friction_force", "real_contact_area"}:
        raise Refused(
            f"{name}: column=: {column} is neither friction_force, which needs a strength, nor real_contact_area"
        )
    return column


def _of_array(values: Any, asked: Asked) -> Source:
    if asked.column is not None:
        raise Refused(f"column=: {keywords.shown(asked.column)}: an array has one column; leave column= out")
    found, unit = with_unit(values, "trace", "")
    if found.ndim != 1 or not found.size:
        raise Refused(f"trace: has the shape {found.shape}; one row of finite numbers is needed")
    return Source(path="", heads=[Head("trace", unit, "trace")], arrays={0: found})


def _own_result(trace: str | os.PathLike[str]) -> Run | None:
    """Open a result of ours; None for any other file."""
    path = os.fspath(trace)
    if not os.path.exists(path) or not is_hdf5(path):  # noqa: PTH110  (a path with a colon may be no path)
        return None
    try:
        return open_result(path)
    except RunFileRefused as problem:
        try:
            opened_file(path)
        except Refused as refused:
            raise Refused(f"{problem}; {refused}") from problem
        raise


def _named(found: Source) -> str:
    where = found.where
    return f"{where}: {found.head.name}" if where else found.head.name


def _check_sensor(found: Source, signal: Signal, zero: str) -> None:
    """Raise Refused for a saturated sensor, and for a force of the wrong sign."""
    values = signal.values
    if 0.0 < (largest := float(np.abs(values).max())) < 1.0 / LARGEST_VALUE:
        raise Refused(f"{_named(found)}: its largest value is {largest:g}; give the values in a smaller unit")
    if said := clipped(found.values, found.place):
        raise Refused(f"{_named(found)}: {said}")
    if zero == "known" and np.count_nonzero(values < 0.0) > _WRONG_WAY * values.size:
        first = found.place(int(np.argmax(values < 0.0)))
        raise Refused(
            f"{_named(found)}: nearly all values are negative, first at {first}: with a known zero the force of"
            ' friction is positive; check the sign of the speed, or turn the force with unit="-1 mN"'
        )


def _signal(found: Source, speed: float | None, unit: Any) -> Signal:
    step = found.step
    if found.along == "time":
        if speed is None:
            raise Refused('speed= is needed: the trace is over time, junctions live by distance; as in speed="1 mm/s"')
        step *= speed
    elif speed is not None:
        raise Refused("speed=: the trace is over sliding distance, which needs no speed")
    written = found.head.unit
    if unit is not None:
        keywords.check_own_unit(found, unit)
        written = keywords.unit_text(unit).removeprefix("1 ").removeprefix("1.0 ")
    if not written:
        raise Refused(f'{_named(found)}: no unit; unit="mN" names it, unit="V" one without a scale of force')
    scale, is_area, sign = keywords.scale_of(written, f"{_named(found)}: unit" if unit is None else "unit=")
    return Signal(
        values=found.values if sign > 0.0 else -found.values,
        tick=step,
        unit=str(written),
        scale=scale,
        is_area=is_area,
        left_out=found.left_out,
        notes=(*found.notes, *digits(found.values, found.head.unit)),
    )


def _masked(mask: list[float], speed: float | None, along: str, tick: float) -> tuple[tuple[float, float], ...]:
    """Return the masked ranges in cycles per um."""
    if mask and (along != "time" or speed is None):
        raise Refused("mask=: frequencies are of a trace over time")
    velocity = speed or 1.0
    highest = 0.5 * velocity / tick
    if beyond := [each for each in mask if each > highest]:
        raise Refused(f"mask=: {beyond[0]:g} Hz is beyond half the rate of the samples, which is {highest:g} Hz")
    return tuple(((1.0 - _MASK) * each / velocity, (1.0 + _MASK) * each / velocity) for each in mask)


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
    diameter = contact.diameter * tick
    spread = sqrt(max(contact.inequality - 1.0, 0.0))
    model = Model(
        mean_real_contact_area=1.0,
        mean_junction_count=fit.problem.pulse.mean_life * contact.births * contact.diameter,
        calibration="exact",
        calibrated_diameter=diameter,
        sizes=fit.problem.population.law(diameter, contact.shape),
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
    record = MemoryRecord(extent(model, seed))
    simulate(model, seed, record, engine="batch")
    force = fit.problem.sensor.filtered(record["trace"]["friction_force"])
    scale = float(signal.values.std())
    noise = np.random.default_rng(seed).standard_normal(rows) * np.sqrt(contact.noise)
    return scale * (contact.strength / tick**2 * force + noise)


_WIDEST: Final = 3.0
MOST_OF_AN_END: Final = 0.45


def share(keyword: str, value: Any, most: float) -> float:
    """Return a share from 0 % to ``most`` as a part of 1."""
    try:
        number = float(quantity_of(value, RATIO))
    except QuantityError as problem:
        form = f'right form: {keyword}="{RATIO.example}"'
        raise Refused(f"{keyword}=: {keywords.shown(value)}: {problem}; {form}") from problem
    if not 0.0 <= number <= most:
        raise Refused(f"{keyword}=: {keywords.shown(value)} is not from 0 % to {100.0 * most:g} %")
    return number


def strength_spread_of(value: Any, signal: Signal, *, both_known: bool) -> float:
    """Return the assumed spread of strengths; 0 if none is given."""
    if value is None:
        return 0.0
    if signal.is_area:
        raise Refused("strength_spread=: a trace of area has no strengths")
    if both_known:
        raise Refused("strength_spread=: with a known zero and a known strength the trace tells the spread itself")
    return share("strength_spread", value, _WIDEST)


def pulse_of(shape: str, offset: str) -> Pulse:
    """Return the pulse of a junction's area."""
    keywords.choice("pulse", shape, tuple(OTHER_SHAPES))
    keywords.choice("offset", offset, tuple(OTHER_OFFSETS))
    return pulses.pulse_of(shape, offset)


def bandwidth_of(value: Any, poles: int, speed: float | None, along: str) -> float:
    """Return the corner of the sensor in cycles per um; inf without one."""
    keywords.choice("poles", poles, (1, 2))
    hertz = keywords.quantity("bandwidth", value, FREQUENCY)
    if hertz is None:
        if poles != 1:
            raise Refused('poles=: the poles of a filter need its corner, as in bandwidth="200 Hz"')
        return inf
    if along != "time" or speed is None:
        raise Refused("bandwidth=: frequencies are of a trace over time")
    return hertz / speed

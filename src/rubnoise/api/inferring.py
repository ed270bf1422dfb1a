"""From a measured trace to its junctions, as numbers with intervals."""

import os
from dataclasses import fields, replace
from math import inf, sqrt
from typing import Any, Final, Literal

import numpy as np

from rubnoise.api import keywords
from rubnoise.api.fit import Inference
from rubnoise.api.run import Run
from rubnoise.api.run import open as open_result
from rubnoise.api.trace import sampled
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import LAWS
from rubnoise.contact.pulses import pulse_of
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.inference.estimates import Assumed, Estimate
from rubnoise.inference.inference import LAWS as SIZES
from rubnoise.inference.inference import OTHER_OFFSETS, OTHER_SHAPES, InferenceResult, infer_signal
from rubnoise.inference.signal import Signal, clipped, digits, joined
from rubnoise.model import Model
from rubnoise.record.rows import MemoryRecord
from rubnoise.regular_file import is_hdf5
from rubnoise.simulation.draws import extent
from rubnoise.simulation.run import simulate
from rubnoise.storage.foreign import opened as opened_file
from rubnoise.storage.measured import LARGEST_VALUE, Asked, Source
from rubnoise.units import FREQUENCY, RATIO, SPEED, STRESS

MOST_BOOTSTRAPS: Final = 10_000
STROKE_END: Final = "5 %"
"""Default share of a stroke that is left out at each end."""
MOST_OF_AN_END, _WIDEST = 0.45, 3.0
"""The largest share of a stroke that may be left out, and the largest spread of strengths."""

_MASK: Final = 0.01  # of the frequency, on either side
_WRONG_WAY: Final = 0.95
_OF_A_RUN: Final = ("friction_force", "real_contact_area")


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
    table of pandas or xarray, a run or its column, or an object with ``columns``, ``units``, ``place`` and ``step``;
    ``column``, ``place``, ``time``, ``rate``, ``from_`` and ``to`` are as in `Trace`. Quantities are texts with a unit,
    or quantities of pint.
    ``speed``, such as "1 mm/s", turns time into sliding distance. ``unit`` is a unit of force or V, or what a value of
    1 is ("0.5 mN", or "-1 mN" to turn the sign), whatever the file says. ``zero`` is "known" if 0 means no force.
    ``strength``, such as "250 MPa", is known; ``strength_spread``, such as "50 %", is the standard deviation over the
    mean of lognormal strengths, 0 without it. ``pulse`` is the shape of lives: "parabola" of rough surfaces, "lens" of
    equal asperities, taken without it. The other one is fitted too, and if no option chose and numbers depend on it,
    that is a flag. ``offset`` "uniform" reads passes that miss the centre. ``bandwidth`` is the corner of the sensor,
    such as "200 Hz", of one pole or two ``poles``. ``mask`` names frequencies that are left out, such as "50 Hz";
    ``drift`` fits a random walk as well. ``strokes``, such as "10 %" (True is 5 %), cuts at reversals, leaves out so
    much of each stroke at either end, and fits the strokes together. ``bootstrap`` traces are simulated from what was
    found, and ``Inference.bootstrap`` holds how the estimates scatter.
    Raises Refused for bad input, and for a quantity without a unit. What statistics refuse stands in
    ``refused_because``, what speaks against the model in ``flags``, what was taken for granted in ``assumptions``.
    Source: docs/inference.md.
    """
    keywords.refuse_unknown(unknown, tuple(infer.__kwdefaults__ or ()))
    keywords.choice("zero", zero, ("known", "unknown"))
    keywords.choice("law", law, ("auto", *SIZES))
    keywords.choice("drift", drift, (True, False))
    keywords.choice("pulse", pulse or "lens", tuple(OTHER_SHAPES))
    keywords.choice("offset", offset, tuple(OTHER_OFFSETS))
    keywords.count("bootstrap", bootstrap, MOST_BOOTSTRAPS)
    velocity, psi = keywords.quantity("speed", speed, SPEED), keywords.quantity("strength", strength, STRESS)
    left_out, corner = keywords.frequencies("mask", mask), keywords.quantity("bandwidth", bandwidth, FREQUENCY)
    if keywords.choice("poles", poles, (1, 2)) != 1 and corner is None:
        raise Refused('poles=: the poles of a filter need its corner, as in bandwidth="200 Hz"')
    source = _measured(trace, keywords.asked(column=column, place=place, time=time, rate=rate, from_=from_, to=to))
    signal = _signal(source, velocity, unit, zero)
    if strokes not in (None, False):
        share = keywords.quantity("strokes", STROKE_END if strokes is True else strokes, RATIO, (0.0, MOST_OF_AN_END))
        signal = joined(signal, share or 0.0, source.begin)
    no_force = f'the trace is in {signal.unit}, which is no force; unit= takes one, such as unit="mN"'
    no_strengths, in_time = "a trace of area has no strengths", "frequencies are of a trace over time"
    tells_it = "with a known zero and a known strength the trace tells the spread itself"
    for keyword, value, is_wrong, why in (
        ("strength", psi, signal.scale is None, no_force),
        ("strength", psi, signal.is_area, no_strengths),
        ("strength_spread", strength_spread, signal.is_area, no_strengths),
        ("strength_spread", strength_spread, zero == "known" and psi is not None, tells_it),
        ("mask", left_out or None, velocity is None, in_time),
        ("bandwidth", corner, velocity is None, in_time),
    ):
        if value is not None and is_wrong:
            raise Refused(f"{keyword}=: {why}")
    assumed = Assumed(
        strength_spread=keywords.quantity("strength_spread", strength_spread, RATIO, (0.0, _WIDEST)) or 0.0,
        pulse=pulse_of(pulse or "lens", offset),
        shape_chosen=pulse is not None,
        bandwidth=inf if corner is None or velocity is None else corner / velocity,
        poles=poles,
    )
    asked: dict[str, Any] = {"zero": zero, "strength": psi, "drift": drift, "assumed": assumed}
    asked["masked"] = _masked(left_out, velocity or 1.0, signal.tick)
    found = infer_signal(signal, law=law, **asked)
    if bootstrap and found.refused_because is None:
        found = replace(found, bootstrap=_bootstrapped(found, bootstrap, asked))
    kept = {each.name: getattr(found, each.name) for each in fields(found)}
    return Inference(**kept, name=_named(source), speed=velocity, strength=psi)


def _measured(trace: Any, asked: Asked) -> Source:
    """Return the wanted column of what is given; of a run the force by default, or else the area."""
    run = _own_result(trace) if isinstance(trace, str | os.PathLike) else trace
    if not isinstance(run, Run):
        return sampled(trace, asked)
    name = "trace" if run is trace else os.fspath(trace)
    column = asked.column or next(each for each in _OF_A_RUN if each in run.trace)
    if column not in run.trace or column not in _OF_A_RUN:
        neither = "neither friction_force, which needs a strength, nor real_contact_area"
        raise Refused(f"{name}: column=: {column} is {neither}")
    return sampled(run, replace(asked, column=column), name)


def _own_result(trace: str | os.PathLike[str]) -> Run | None:
    """Open a result of ours; None for any other file."""
    path = os.fspath(trace)
    if not is_hdf5(path):
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
    return ": ".join(filter(None, (found.where, found.head.name)))


def _signal(found: Source, speed: float | None, unit: Any, zero: str) -> Signal:
    """Return a trace ready for inference; raises Refused for one without speed, unit or sense."""
    if found.along == "time" and speed is None:
        raise Refused('speed= is needed: the trace is over time, junctions live by distance; as in speed="1 mm/s"')
    if found.along != "time" and speed is not None:
        raise Refused("speed=: the trace is over sliding distance, which needs no speed")
    written = found.head.unit
    if unit is not None:
        keywords.check_own_unit(found, unit)
        written = keywords.unit_text(unit).removeprefix("1 ").removeprefix("1.0 ")
    if not written:
        raise Refused(f'{_named(found)}: no unit; unit="mN" names it, unit="V" one without a scale of force')
    scale, is_area, sign = keywords.scale_of(written, f"{_named(found)}: unit" if unit is None else "unit=")
    values = found.values if sign > 0.0 else -found.values
    _check_sensor(found, values, zero)
    return Signal(
        values=values,
        tick=found.step * (speed or 1.0),
        unit=str(written),
        scale=scale,
        is_area=is_area,
        left_out=found.left_out,
        notes=(*found.notes, *digits(found.values, found.head.unit)),
    )


def _check_sensor(found: Source, values: Doubles, zero: str) -> None:
    """Raise Refused for a saturated sensor, and for a force of the wrong sign."""
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


def _masked(mask: list[float], velocity: float, tick: float) -> tuple[tuple[float, float], ...]:
    """Return the masked ranges in cycles per um."""
    highest = 0.5 * velocity / tick
    if beyond := [each for each in mask if each > highest]:
        raise Refused(f"mask=: {beyond[0]:g} Hz is beyond half the rate of the samples, which is {highest:g} Hz")
    return tuple(((1.0 - _MASK) * each / velocity, (1.0 + _MASK) * each / velocity) for each in mask)


def _bootstrapped(found: InferenceResult, count: int, asked: dict[str, Any]) -> dict[str, Estimate]:
    """Return mean, standard deviation and middle 95 % of the estimates of traces simulated from those found."""
    samples: dict[str, list[float]] = {name: [] for name in found.estimates}
    for seed in range(1, count + 1):
        again = replace(found.signal, values=_simulated(found, seed))
        refit = infer_signal(again, law=found.law, tests=False, **asked)
        for name in samples.keys() & refit.estimates.keys():
            samples[name].append(refit.estimates[name].value)
    return {
        name: Estimate(
            value=float(np.mean(values)),
            standard_error=float(np.std(values)),
            interval=(float(np.quantile(values, 0.025)), float(np.quantile(values, 0.975))),
            unit=found.estimates[name].unit,
        )
        for name, values in samples.items()
        if values
    }


def _simulated(found: InferenceResult, seed: int) -> Doubles:
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

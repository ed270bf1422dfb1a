"""The assumptions of `infer`, read from texts with units."""

from dataclasses import replace
from math import ceil, floor, inf
from numbers import Integral
from typing import Any, Final

from rubnoise.api import keywords
from rubnoise.contact import off_centre
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.inference.inference import OTHER_OFFSETS, OTHER_SHAPES
from rubnoise.inference.signal import Signal
from rubnoise.inference.strokes import joined
from rubnoise.units import FREQUENCY, LENGTH, RATIO, TIME, QuantityError, quantity_of

_WIDEST: Final = 3.0
_MOST_OF_AN_END: Final = 0.45
_MOST_DIGITS: Final = 15
_ROUNDING: Final = 1e-12


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
    return off_centre.pulse_of(shape, offset)


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


def cut(signal: Signal, begin: Any, end: Any, strokes: Any, *, step: float, along: str) -> Signal:
    """Return the requested part of a signal, which lists what was left out.

    ``begin`` and ``end`` are samples, counted from 1, or a time or distance since the first one; ``strokes`` is the
    share of each stroke that is left out at either end. ``step`` is that of samples, in s or um.
    """
    n = signal.values.size
    first = 1 if begin is None else _sample("from_", begin, step, along, ceil)
    last = n if end is None else _sample("to", end, step, along, floor)
    if not 1 <= first < last:
        raise Refused(f"from_=: samples {first:,} to {last:,} are no part of the trace, which has {n:,}")
    if last > n:
        raise Refused(f"to=: sample {last:,} is beyond the last of the trace, which has {n:,}")
    if (first, last) != (1, n):
        said = f"left out: all but samples {first:,} to {last:,} of {n:,}"
        signal = replace(signal, values=signal.values[first - 1 : last], left_out=(said,))
    return signal if strokes is None else joined(signal, share("strokes", strokes, _MOST_OF_AN_END), first - 1)


def _sample(keyword: str, value: Any, step: float, along: str, rounded: Any) -> int:
    """Return the number of a sample from 1 on, given as such or by the time or distance since the first one."""
    if isinstance(value, Integral) and not isinstance(value, bool):
        return int(value)
    if isinstance(value, str) and value.strip().isdecimal() and len(value) <= _MOST_DIGITS:
        return int(value)
    kind = TIME if along == "time" else LENGTH
    try:
        number = float(quantity_of(value, kind))
    except QuantityError as problem:
        form = f'right form: {keyword}="7201" for a sample, {keyword}="{kind.example}"'
        raise Refused(f"{keyword}=: {keywords.shown(value)}: {problem}; {form}") from problem
    return int(rounded(number / step * (1.0 + _ROUNDING * (1.0 if rounded is floor else -1.0)))) + 1

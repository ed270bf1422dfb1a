"""The assumptions of `infer`, read from texts with units."""

from math import inf
from typing import Any, Final

from rubnoise.api import keywords
from rubnoise.contact import pulses
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.inference.inference import OTHER_OFFSETS, OTHER_SHAPES
from rubnoise.inference.signal import Signal
from rubnoise.units import FREQUENCY, RATIO, QuantityError, quantity_of

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

"""What `infer` is asked to take for granted, from text with units."""

from math import inf
from typing import Any, Final

from rubnoise.api import keywords
from rubnoise.contact.off_centre import OFF_CENTRE_LENS
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.errors import Refused
from rubnoise.inference.signal import Signal
from rubnoise.units import FREQUENCY, RATIO, QuantityError, quantity_of

_WIDEST: Final = 3.0


def share(keyword: str, value: Any, most: float) -> float:
    """Return a share of 0 % to ``most`` as a part of 1."""
    try:
        number = float(quantity_of(value, RATIO))
    except QuantityError as problem:
        form = f'right form: {keyword}="{RATIO.example}"'
        raise Refused(f"{keyword}=: {keywords.shown(value)}: {problem}; {form}") from problem
    if not 0.0 <= number <= most:
        raise Refused(f"{keyword}=: {keywords.shown(value)} is not from 0 % to {100.0 * most:g} %")
    return number


def strength_spread_of(value: Any, signal: Signal, *, both_known: bool) -> float:
    """Return the spread of strengths that is taken for granted; 0 where none is given."""
    if value is None:
        return 0.0
    if signal.is_area:
        raise Refused("strength_spread=: a trace of area has no strengths")
    if both_known:
        raise Refused("strength_spread=: with a known zero and a known strength the trace tells the spread itself")
    return share("strength_spread", value, _WIDEST)


def pulse_of(shape: str, offset: str) -> Pulse:
    """Return how the area of a junction rises and falls."""
    keywords.choice("pulse", shape, ("lens",))
    return LENS if keywords.choice("offset", offset, ("none", "uniform")) == "none" else OFF_CENTRE_LENS


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

"""What the options of `infer` say, from text with units; bad ones are refused by name."""

from math import inf
from typing import Final

from rubnoise.contact.off_centre import OFF_CENTRE_LENS
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.errors import Refused
from rubnoise.inference.signal import Signal
from rubnoise.units import RATIO, QuantityError, read_quantity

_WIDEST: Final = 3.0


def share(text: str, option: str, most: float) -> float:
    """Return a share of 0 % to ``most`` as a part of 1."""
    try:
        number = float(read_quantity(str(text), RATIO))
    except QuantityError as problem:
        raise Refused(f'{option}: {text}: {problem}; right form: "{RATIO.example}"') from problem
    if not 0.0 <= number <= most:
        raise Refused(f"{option}: {text} is not from 0 % to {100.0 * most:g} %")
    return number


def strength_spread_of(text: str | None, signal: Signal, *, both_known: bool) -> float:
    """Return the spread of strengths that is taken for granted; 0 where none is given."""
    if text is None:
        return 0.0
    if signal.is_area:
        raise Refused("--strength-spread: a trace of area has no strengths")
    if both_known:
        raise Refused("--strength-spread: with a known zero and a known strength the trace tells the spread itself")
    return share(text, "--strength-spread", _WIDEST)


def pulse_of(shape: str, offset: str) -> Pulse:
    """Return how the area of a junction rises and falls."""
    if shape != "lens":
        raise Refused(f"--pulse: {shape}: infer knows the lens alone")
    if offset not in {"none", "uniform"}:
        raise Refused(f"--offset: {offset} is neither none nor uniform")
    return LENS if offset == "none" else OFF_CENTRE_LENS


def bandwidth_of(hertz: float | None, poles: int, speed: float | None, along: str) -> float:
    """Return the corner of the sensor in cycles per um; inf without one."""
    if poles not in {1, 2}:
        raise Refused(f"--poles: {poles} is neither 1 nor 2")
    if hertz is None:
        if poles != 1:
            raise Refused('--poles: the poles of a filter need its corner, as in --bandwidth "200 Hz"')
        return inf
    if along != "time" or speed is None:
        raise Refused("--bandwidth: frequencies are of a trace over time")
    return hertz / speed

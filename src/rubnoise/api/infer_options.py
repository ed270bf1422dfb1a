"""What the options of `infer` say, from text with units; bad ones are refused by name."""

from typing import Final

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

"""Resample a record to another rate, without aliases."""

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import ceil
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles

MOST: Final = 4096
"""Numerator and denominator of a ratio of sample rates at most."""

CROSSINGS: Final = 64
"""Zero crossings of the filter on each side, at the lower of the two rates."""

PASSED: Final = 0.9
"""Share of the lower rate's half that passes within `RIPPLE`; what would fold is held down to `RIPPLE`."""

RIPPLE: Final = 2e-5
_SHAPE: Final = 10.06  # Kaiser's beta for 100 dB, 0.1102 (100 - 8.7)
_PIECE: Final = 1 << 18  # inputs or outputs at once, about


def rate_ratio(source: float, target: float) -> Fraction:
    """Return target over source as a fraction of two numbers up to 4096; 0 if the ratio is beyond 1/4096 ... 4096.

    The fraction is within 1 part in 4096, and exact if the ratio is such a fraction.
    """
    ratio = target / source
    if not 1.0 / MOST <= ratio <= MOST:
        return Fraction(0)
    if ratio >= 1.0:
        return Fraction(ratio).limit_denominator(max(1, int(MOST / ceil(ratio))))
    return 1 / rate_ratio(target, source)


def resampled(read: Callable[[int, int], Doubles], inputs: int, ratio: Fraction) -> Iterator[Doubles]:
    """Yield a record, of which ``read(first, stop)`` returns rows, at ``ratio`` times its rate, in pieces.

    y_n = sum_j x_j h(n q - j p), ratio = p/q. h is a sinc under a Kaiser window over 64 zero crossings on each side:
    up to 0.9 of the lower rate's half amplitudes are kept to 2e-5, from that half on they are held down to it. Output 0
    lies at input 0, the last at or before the last input; beyond its ends the record is taken as constant.
    Source: Oppenheim and Schafer, Discrete-Time Signal Processing (1989), chapters 3 and 7.
    """
    from scipy.signal import resample_poly

    up, down = ratio.numerator, ratio.denominator
    taps = _taps(up, down)
    reach = down * ceil(taps.size / (up * down))  # inputs beside a piece; a whole number of q, which keeps the phase
    step = down * ceil(_PIECE / max(up, down))
    for first in range(0, inputs, step):
        stop = min(first + step, inputs)
        values = read(max(first - reach, 0), min(stop + reach, inputs))
        ends = max(reach - first, 0), max(stop + reach - inputs, 0)
        wide = resample_poly(np.pad(values, ends, mode="edge"), up, down, window=taps)
        begin = reach // down * up
        count = step // down * up if stop < inputs else output_count(stop - first, ratio)
        yield wide[begin : begin + count]


def _taps(up: int, down: int) -> Doubles:
    """Return the filter at p times the rate of the inputs, whose sum is one."""
    half = CROSSINGS * max(up, down)
    edge = 0.5 * (1.0 + PASSED) / max(up, down)
    taps = np.sinc(edge * np.arange(-half, half + 1)) * np.kaiser(2 * half + 1, _SHAPE)
    return np.asarray(taps / taps.sum(), dtype=np.float64)


def output_count(inputs: int, ratio: Fraction) -> int:
    """Return the number of outputs for a number of inputs."""
    return 0 if inputs == 0 else int((inputs - 1) * ratio) + 1


def input_count(outputs: int, ratio: Fraction) -> int:
    """Return the least number of inputs for a number of outputs."""
    return 0 if outputs == 0 else ceil((outputs - 1) / ratio) + 1

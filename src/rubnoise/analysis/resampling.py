"""A record at another rate of samples, without what would fold back into it."""

from collections.abc import Iterable, Iterator
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
_OUTPUTS: Final = 65_536
_SPARED: Final = 4


def rate_ratio(source: float, target: float) -> Fraction:
    """Return target over source as a fraction of two numbers up to 4096; 0 where the ratio is beyond 1/4096 ... 4096.

    It is met to 1 part in 4096 at worst, and exactly where it is such a fraction.
    """
    ratio = target / source
    if not 1.0 / MOST <= ratio <= MOST:
        return Fraction(0)
    if ratio >= 1.0:
        return Fraction(ratio).limit_denominator(max(1, int(MOST / ceil(ratio))))
    return 1 / rate_ratio(target, source)


def resampled(chunks: Iterable[Doubles], ratio: Fraction) -> Iterator[Doubles]:
    """Yield a record that comes in chunks at ``ratio`` times its rate: y_n = sum_j x_j h(n q - j p), ratio = p/q.

    h is a sinc under a Kaiser window over 64 zero crossings on each side: up to 0.9 of the lower rate's half amplitudes
    are kept to 2e-5, from that half on they are held down to it. Output 0 lies at input 0, the last at or before the
    last input; beyond its ends the record is taken to stay as it is there. Outputs hardly depend on the chunks: by
    rounding alone. Source: Oppenheim and Schafer, Discrete-Time Signal Processing (1989), chapters 3 and 7.
    """
    stream = _Stream(ratio)
    for chunk in chunks:
        stream.take(chunk)
        yield from stream.ready()
    stream.end()
    yield from stream.ready()


def output_count(inputs: int, ratio: Fraction) -> int:
    """Return how many outputs so many inputs make."""
    return 0 if inputs == 0 else int((inputs - 1) * ratio) + 1


def input_count(outputs: int, ratio: Fraction) -> int:
    """Return the fewest inputs that make so many outputs."""
    return 0 if outputs == 0 else ceil((outputs - 1) / ratio) + 1


class _Stream:
    """Inputs that outputs still need, and how many of each there have been."""

    def __init__(self, ratio: Fraction) -> None:
        self._ratio = ratio
        self._half = CROSSINGS * max(ratio.numerator, ratio.denominator)
        self._reach = ceil(self._half / ratio.numerator)
        self._filter = _kernel(ratio, self._half)
        # Each filtering makes as many outputs more, at its ends, as the filter is long, which then fall away.
        self._at_once = max(_OUTPUTS, _SPARED * self._filter.size // ratio.denominator)
        self._held = np.empty(0)
        self._first = -self._reach
        self._inputs = 0
        self._outputs = 0
        self._ended = False

    def take(self, chunk: Doubles) -> None:
        """Hold the inputs that follow those before."""
        before = np.full(self._reach, chunk[0]) if self._inputs == 0 and chunk.size else chunk[:0]
        self._held = np.concatenate([self._held, before, chunk])
        self._inputs += chunk.size

    def end(self) -> None:
        """Let the last input stand for all after it."""
        self._held = np.concatenate([self._held, np.repeat(self._held[-1:], self._reach)])
        self._ended = True

    def ready(self) -> Iterator[Doubles]:
        """Yield the outputs whose inputs are all there, and forget the inputs that no later one needs."""
        known = self._inputs if self._ended else max(0, self._inputs - self._reach)
        last = output_count(known, self._ratio)
        while self._outputs < last:
            stop = min(last, self._outputs + self._at_once)
            yield self._filtered(self._outputs, stop)
            self._outputs = stop
            self._forget()

    def _filtered(self, start: int, stop: int) -> Doubles:
        from scipy.signal import upfirdn

        up, down = self._ratio.numerator, self._ratio.denominator
        # Zeros before the filter shift its taps, so that every so-manieth output falls on the place of one of ours.
        shift = (self._first * up - self._half) % down
        offset = (shift - self._first * up + self._half) // down
        last = (stop - 1) * down // up + self._reach + 1 - self._first
        outputs: Doubles = upfirdn(np.append(np.zeros(shift), self._filter), self._held[:last], up, down)
        return outputs[start + offset : stop + offset]

    def _forget(self) -> None:
        first = self._outputs * self._ratio.denominator // self._ratio.numerator - self._reach
        if first > self._first:
            self._held = self._held[first - self._first :]
            self._first = first


def _kernel(ratio: Fraction, half: int) -> Doubles:
    """Return the filter at p times the rate of the inputs, whose taps for any output add up to one."""
    from scipy.signal import firwin

    edge = 0.5 * (1.0 + PASSED) / max(ratio.numerator, ratio.denominator)
    taps: Doubles = ratio.numerator * firwin(2 * half + 1, edge, window=("kaiser", _SHAPE))
    return taps

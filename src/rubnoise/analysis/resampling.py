"""Resample a record to another rate, without aliases."""

from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import lru_cache
from math import ceil
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles, slices

MOST: Final = 4096
"""Numerator and denominator of a ratio of sample rates at most."""

CROSSINGS: Final = 64
"""Zero crossings of the filter on each side, at the lower of the two rates."""

PASSED: Final = 0.9
"""Share of the lower rate's half that passes within `RIPPLE`; what would fold is held down to `RIPPLE`."""

RIPPLE: Final = 2e-5
_SHAPE: Final = 10.06  # Kaiser's beta for 100 dB, 0.1102 (100 - 8.7)
_OUTPUTS: Final = 65_536
_PRODUCTS: Final = 1 << 16  # at once: what the cache of a processor holds


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


def resampled(chunks: Iterable[Doubles], ratio: Fraction) -> Iterator[Doubles]:
    """Yield a record, given in chunks, at ``ratio`` times its rate: y_n = sum_j x_j h(n q - j p), ratio = p/q.

    h is a sinc under a Kaiser window over 64 zero crossings on each side: up to 0.9 of the lower rate's half amplitudes
    are kept to 2e-5, from that half on they are held down to it. Output 0 lies at input 0, the last at or before the
    last input; beyond its ends the record is taken as constant. Outputs depend on the chunks by rounding only.
    Source: Oppenheim and Schafer, Discrete-Time Signal Processing (1989), chapters 3 and 7.
    """
    stream = _Stream(ratio)
    for chunk in chunks:
        stream.take(chunk)
        yield from stream.ready()
    stream.end()
    yield from stream.ready()


def output_count(inputs: int, ratio: Fraction) -> int:
    """Return the number of outputs for a number of inputs."""
    return 0 if inputs == 0 else int((inputs - 1) * ratio) + 1


def input_count(outputs: int, ratio: Fraction) -> int:
    """Return the least number of inputs for a number of outputs."""
    return 0 if outputs == 0 else ceil((outputs - 1) / ratio) + 1


class _Stream:
    """The inputs that later outputs need, and the numbers of inputs and outputs so far."""

    def __init__(self, ratio: Fraction) -> None:
        self._ratio = ratio
        self._half = CROSSINGS * max(ratio.numerator, ratio.denominator)
        self._reach = ceil(self._half / ratio.numerator)
        self._taps = _taps(ratio, self._half)
        self._held = np.empty(0)
        self._first = -self._reach
        self._inputs = 0
        self._outputs = 0
        self._ended = False

    def take(self, chunk: Doubles) -> None:
        """Add the next inputs."""
        before = np.full(self._reach, chunk[0]) if self._inputs == 0 and chunk.size else chunk[:0]
        self._held = np.concatenate([self._held, before, chunk])
        self._inputs += chunk.size

    def end(self) -> None:
        """Repeat the last input, as if the record continued with it."""
        self._held = np.concatenate([self._held, np.repeat(self._held[-1:], self._reach)])
        self._ended = True

    def ready(self) -> Iterator[Doubles]:
        """Yield the outputs whose inputs are complete, and drop the inputs that no later output needs."""
        known = self._inputs if self._ended else max(0, self._inputs - self._reach)
        last = output_count(known, self._ratio)
        while self._outputs < last:
            stop = min(last, self._outputs + _OUTPUTS)
            yield self._filtered(self._outputs, stop)
            self._outputs = stop
            self._forget()

    def _filtered(self, start: int, stop: int) -> Doubles:
        up, down = self._ratio.numerator, self._ratio.denominator
        width = self._taps.shape[1]
        windows = np.lib.stride_tricks.sliding_window_view(self._held, width)
        last, phase = np.divmod(np.arange(start, stop) * down + self._half, up)
        first = last - (width - 1) - self._first
        outputs = np.empty(stop - start)
        rows = max(1, _PRODUCTS // width)
        for block in slices(0, outputs.size, rows):
            np.einsum("ij,ij->i", windows[first[block]], self._taps[phase[block]], out=outputs[block])
        return outputs

    def _forget(self) -> None:
        first = self._outputs * self._ratio.denominator // self._ratio.numerator - self._reach
        if first > self._first:
            self._held = self._held[first - self._first :]
            self._first = first


@lru_cache(maxsize=2)
def _taps(ratio: Fraction, half: int) -> Doubles:
    """Return the filter at p times the rate of the inputs; a row for each of the p places of an output between inputs.

    A row has the order of the inputs. The p rows add up to p together.
    """
    # The package for signals is not used: it takes half a second to import, longer than a sound takes to make.
    edge = 0.5 * (1.0 + PASSED) / max(ratio.numerator, ratio.denominator)
    taps = np.sinc(edge * np.arange(-half, half + 1)) * np.kaiser(2 * half + 1, _SHAPE)
    taps *= ratio.numerator / taps.sum()
    taps = np.append(taps, np.zeros(-taps.size % ratio.numerator))
    return np.ascontiguousarray(taps.reshape(-1, ratio.numerator)[::-1].T)

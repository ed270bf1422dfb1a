"""A trace ready for inference, and findings before any fit: a clipped sensor, strokes to and fro, a first size."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles, Integers
from rubnoise.errors import Refused

_CLIPPED: Final = 1e-3
_PLATEAU: Final = 4
_RARER: Final = 2.0
_LEVELS: Final = 200
_OFF: Final = 1e-6
_HALF_OVER_FASTEST: Final = 1.3
_BETWEEN: Final = 0.05
_LEVEL_STEPS: Final = 4
_COURSE: Final = 60.0
_SEEN: Final = 1 << 20
_SHORTEST_STROKE: Final = 0.9
"""Part of the median stroke below which a stroke is left out: the first and the last are often cut short."""
_LEAST_WIDTHS: Final = 10.0  # half widths of the correlation in a stroke: chance crosses a level after one or two
_NAMED: Final = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Signal:
    """A trace ready for inference: values every ``tick`` um of sliding.

    ``scale`` turns its values into uN (for an area in um^2, whose junctions have the strength 1, ``is_area`` is true);
    None if the unit is of something else, such as V: then strengths are not identified. ``unit`` is the written one.
    ``ways`` is how many strokes of equal length go to and fro, turned one way; ``left_out`` says what was cut off,
    ``notes`` what is remarkable in the file.
    """

    values: Doubles = field(repr=False)
    tick: float
    unit: str
    scale: float | None
    is_area: bool = False
    ways: tuple[int, int] = (1, 0)
    left_out: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def clipped(values: Doubles, place: Callable[[int], str]) -> str:
    """Return what is said of a sensor at an end of its range, with the place of its first sample; empty for others.

    An end lasts: a trace of junctions has a kink at each maximum, and never a plateau. It may be at rest at 0, without
    a junction. Rounded values at an end are rarer than their neighbours. A constant trace was not clipped.
    """
    for end, turned in (("largest", values), ("smallest", -values)):
        top = float(turned.max())
        at_top = np.flatnonzero(turned == top)
        below = turned[turned < top]
        if not below.size or (top == 0.0 and end == "smallest"):
            continue
        if at_top.size <= max(10, _CLIPPED * values.size, _RARER * np.count_nonzero(below == below.max())):
            continue
        longest = max(run.size for run in np.split(at_top, np.flatnonzero(np.diff(at_top) > 1) + 1))
        if longest >= _PLATEAU:
            said = f"{at_top.size:,} samples are at the {end} value, {longest:,} in a row, first at {place(at_top[0])}"
            return f"the sensor was clipped: {said}; measure again with a wider range"
    return ""


def digits(values: Doubles, unit: str) -> tuple[str, ...]:
    """Return what is said of values with few digits, whose rounding adds noise of digit/sqrt(12)."""
    levels = np.unique(values[: _SEEN // 16])
    steps = np.diff(levels)
    digit = float(steps.min(initial=np.inf))
    if not 2 < levels.size < _LEVELS or np.abs(steps / digit - np.rint(steps / digit)).max() > _OFF:
        return ()
    return (f"digits of {digit:.4g} {unit}: rounding adds noise of {digit / sqrt(12.0):.2g} {unit}",)


def strokes(values: Doubles, zero: str) -> str:
    """Return a text if a trace has strokes both ways; empty if it has not.

    With a trusted zero the force changes its sign. Without one it jumps between two levels and is rarely between them,
    while a trace of junctions has no such gap.
    """
    if zero == "known":
        middle, half_gap = 0.0, 0.3 * float(np.median(np.abs(values[:: values.size // _SEEN + 1])))
    else:
        middle, half_gap = two_levels(values)
    beyond, sides, turns = _sides(values, middle, half_gap)
    above = float(np.mean(sides > 0)) if sides.size else 1.0
    rarer = min(above, 1.0 - above)
    between = 1.0 - sides.size / values.size
    if rarer > 0.02 and turns.size * 50 < sides.size and (zero == "known" or between < _BETWEEN * rarer):
        where = ", ".join(f"{sample + 1:,}" for sample in beyond[turns[:5] + 1].tolist())
        what = "changes its sign" if zero == "known" else "leaps between two levels"
        return (
            f"several strokes in one trace: the force {what} {turns.size} times, first at samples {where};"
            ' strokes="10 %" cuts there, and leaves out 10 % of each end'
        )
    if zero == "known" and float(values.mean()) <= 0.0:
        return "the mean is not positive, as the force of friction is with a known zero"
    return ""


def _sides(values: Doubles, middle: float, half_gap: float) -> tuple[Integers, NDArray[np.int8], Integers]:
    """Return the samples beyond a gap, on which side of it each is, and which of them are the last on their side."""
    side = (values > middle + half_gap).astype(np.int8) - (values < middle - half_gap).astype(np.int8)
    beyond = np.flatnonzero(side)
    sides = side[beyond]
    return beyond, sides, np.flatnonzero(np.diff(sides))


def two_levels(values: Doubles) -> tuple[float, float]:
    """Return the middle between the means of the values on its two sides, and a sixth of their distance."""
    seen = values[:: values.size // _SEEN + 1]
    low, high = float(seen.min()), float(seen.max())
    for _ in range(_LEVEL_STEPS):
        above = seen > 0.5 * (low + high)
        low, high = float(seen[~above].mean()), float(seen[above].mean())
    return 0.5 * (low + high), (high - low) / 6.0


def course(values: Doubles, half_width: float) -> Doubles:
    """Return the running mean of a drifting trace, over several half widths, which cover the lives of its junctions."""
    from scipy.ndimage import uniform_filter1d

    length = min(int(_COURSE * half_width) + 1, values.size)
    found: Doubles = uniform_filter1d(values, length, mode="nearest")
    return found


def ramp_of(values: Doubles) -> float:
    """Return the rise of the straight line of least squares over a trace.

    Of a trace whose mean of n samples has the variance S(0)/n, it has the variance 12 S(0)/n.
    """
    n = values.size
    return 12.0 * float((np.arange(n) - 0.5 * (n - 1)) @ values) / (n * n)


def half_width_of(values: Doubles) -> float:
    """Return the lag in ticks at which the autocovariance has fallen to half, Rabinowicz's way to a size."""
    seen = values[:_SEEN]
    covariance = autocovariance(seen, seen.size // 2)
    # White noise stands at lag 0 alone.
    top = float(covariance[1] + 0.5 * (covariance[1] - covariance[2]))
    below = covariance[1:] < 0.5 * top
    return float(np.argmax(below)) + 1.0 if below.any() else 0.25 * values.size


def half_width_under_drift(values: Doubles) -> float:
    """Return about the same lag in ticks for a trace with a random walk, whose own autocovariance falls slowly.

    The steps of a walk are uncorrelated, so the covariance of increments, summed from lag 2 on, shows only junctions.
    It is largest where their autocovariance falls fastest, a little before it has fallen to half.
    """
    steps = np.diff(values[:_SEEN])
    return _HALF_OVER_FASTEST * (int(np.argmax(np.cumsum(autocovariance(steps, steps.size // 2)[2:]))) + 2)


def autocovariance(values: Doubles, reach: int) -> Doubles:
    """Return the autocovariance of a record at lags of 0 to ``reach`` ticks, in the square of its unit.

    R_j = (1/n) sum over i of (x_i - mean)(x_(i+j) - mean) of n values: dividing by n and not by n - j keeps the noise
    of long lags small, and makes R_j smaller than its expectation by a part j/n, and by the variance of the mean.
    Source: Priestley, Spectral Analysis and Time Series, section 5.3.
    """
    # A power of two, whose transform is fast; numpy's has the bits of scipy's, whose import takes longer.
    size = 1 << (values.size + reach - 1).bit_length()
    power = np.square(np.abs(np.fft.rfft(values - values.mean(), size)))
    return np.asarray(np.fft.irfft(power, size)[: reach + 1] / values.size, dtype=np.float64)


# Strokes to and fro: cut at the reversals, turned one way, and joined; every cut is reported.
def reversals(values: Doubles) -> list[int]:
    """Return the samples at which strokes begin, from the first sample on, and the number of samples at the end.

    The force is on one side of the middle of two levels, and a third of the way to the next level beyond it. A reversal
    lies half-way between the last sample of one side and the first of the other.
    """
    beyond, _, turns = _sides(values, *two_levels(values))
    places = (beyond[turns] + beyond[turns + 1] + 1) // 2
    return [0, *places.tolist(), values.size]


def joined(signal: Signal, left_out: float, first: int = 0) -> Signal:
    """Return a signal whose strokes are turned one way, without ``left_out`` of each stroke at either end.

    The force is half the difference of the mean levels of both ways, and the zero of the sensor is half their sum,
    which is subtracted. All strokes keep as many samples as the shortest, from their middle. The signal reports that,
    and counts samples from ``first`` on. Raises Refused if a trace has no strokes both ways.
    """
    values, middle = signal.values, two_levels(signal.values)[0]
    edges = reversals(values)
    strokes = [(begin, values[begin:end], np.sign(values[begin:end].mean() - middle)) for begin, end in pairwise(edges)]
    usual = float(np.median(np.diff(edges)))
    kept = [(stroke, sign) for _, stroke, sign in strokes if stroke.size >= _SHORTEST_STROKE * usual]
    ways = [sum(sign == way for _, sign in kept) for way in (1, -1)]
    half_width = half_width_of(np.concatenate([sign * (stroke - middle) for _, stroke, sign in strokes]))
    if min(ways) == 0 or usual < _LEAST_WIDTHS * half_width:
        raise Refused("strokes=: the force leaps between two levels nowhere: the trace is one stroke")
    each = min(stroke.size - 2 * round(left_out * stroke.size) for stroke, _ in kept)
    if each < 1:
        raise Refused("strokes=: nothing is left of the strokes; less than 50 % of each end can be left out")
    parts = [(stroke[(stroke.size - each) // 2 :][:each], sign) for stroke, sign in kept]
    levels = [float(np.mean([part.mean() for part, sign in parts if sign == way])) for way in (1, -1)]
    zero = 0.5 * (levels[0] + levels[1])
    turned = np.concatenate([sign * (part - zero) for part, sign in parts])
    turns = [f"{first + edge + 1:,}" for edge in edges[1:-1]]
    named = ", ".join(turns[:_NAMED]) + (f" and {len(turns) - _NAMED} more" if len(turns) > _NAMED else "")
    short = [
        f"left out: a stroke from sample {first + begin + 1:,} to {first + begin + stroke.size:,}, too short"
        for begin, stroke, _ in strokes
        if stroke.size < _SHORTEST_STROKE * usual
    ]
    said = [
        f"{len(kept)} strokes fitted together, {ways[0]} one way and {ways[1]} the other, turned at samples {named}",
        f"zero of the sensor: {zero:.4g} {signal.unit}, in the middle of {levels[0]:.4g} and {levels[1]:.4g}",
        f"left out: {100.0 * left_out:.3g} % of each stroke at either end; {each:,} samples of each stay",
        *short,
        f"left out of all strokes: {values.size - turned.size:,} of {values.size:,} samples",
    ]
    return replace(signal, values=turned, ways=(int(ways[0]), int(ways[1])), left_out=(*signal.left_out, *said))

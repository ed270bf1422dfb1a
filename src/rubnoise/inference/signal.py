"""A trace ready for inference, and what shows before any fit: a clipped sensor, several strokes, a first size."""

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles

_CLIPPED: Final = 1e-3
_PLATEAU: Final = 4
_HALF_OVER_FASTEST: Final = 1.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Signal:
    """A trace ready for inference: values every ``tick`` um of sliding.

    ``scale`` turns its values into uN (for an area in um^2, whose junctions have the strength 1, ``is_area`` is true);
    None where the unit is of something else, such as V: then strengths cannot be told. ``unit`` is the written one.
    """

    values: Doubles = field(repr=False)
    tick: float
    unit: str
    scale: float | None
    is_area: bool = False


def clipped(values: Doubles) -> str:
    """Return what shows that a sensor was at its end; nothing where it was not.

    A maximum that lasts: a trace of junctions has a kink at each of its maxima, and never a plateau there.
    """
    at_top = values == values.max()
    runs = np.diff(np.flatnonzero(np.diff(np.concatenate([[0], at_top.view(np.int8), [0]]))))[::2]
    if int(at_top.sum()) > max(10, _CLIPPED * values.size) and int(runs.max()) >= _PLATEAU:
        first = int(np.argmax(at_top)) + 1
        return (
            f"the sensor was clipped: {int(at_top.sum())} samples are at the largest value, {int(runs.max())} of them"
            f" in a row, first at sample {first}; measure again with a wider range"
        )
    return ""


def strokes(values: Doubles, zero: str) -> str:
    """Return what shows that a trace with a trusted zero has strokes both ways; nothing where it has not."""
    if zero != "known":
        return ""
    level = float(np.median(np.abs(values)))
    side = np.sign(np.where(np.abs(values) > 0.3 * level, values, 0.0))
    sides = side[side != 0.0]
    turns = int(np.count_nonzero(np.diff(sides)))
    if min(np.mean(sides > 0.0), np.mean(sides < 0.0)) > 0.02 and turns * 50 < sides.size:
        where = np.flatnonzero(side != 0.0)[np.flatnonzero(np.diff(sides))[:5] + 1]
        return (
            f"several strokes in one trace: the force changes its sign {turns} times, first at samples"
            f" {', '.join(map(str, where.tolist()))}; give one stroke at a time"
        )
    if np.mean(values < 0.0) > 0.5:
        return "the mean is negative: with a known zero the force of friction is positive; check the sign of the speed"
    return ""


def half_width_of(values: Doubles) -> float:
    """Return the lag in ticks at which the autocovariance has fallen to half, Rabinowicz's way to a size."""
    covariance = _autocovariance(values)
    # White noise stands at lag 0 alone.
    top = float(covariance[1] + 0.5 * (covariance[1] - covariance[2]))
    below = covariance[1:] < 0.5 * top
    return float(np.argmax(below)) + 1.0 if below.any() else 0.25 * values.size


def half_width_under_drift(values: Doubles) -> float:
    """Return about the same lag in ticks for a trace with a random walk in it, whose own autocovariance falls slowly.

    The steps of a walk are uncorrelated, so that the covariance of increments, summed from lag 2 on, shows junctions
    alone. It is largest where their autocovariance falls fastest, a little before it has fallen to half.
    """
    fastest = int(np.argmax(np.cumsum(_autocovariance(np.diff(values))[2:]))) + 2
    return _HALF_OVER_FASTEST * fastest


def _autocovariance(values: Doubles) -> Doubles:
    from scipy.fft import irfft, next_fast_len, rfft

    part = values[: 1 << 20] - values[: 1 << 20].mean()
    length = next_fast_len(2 * part.size)
    transform = rfft(part, length)
    covariance: Doubles = irfft(np.square(transform.real) + np.square(transform.imag), length)[: part.size // 2]
    return covariance

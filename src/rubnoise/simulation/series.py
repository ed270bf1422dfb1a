"""Power series in time: the motion of a slider within a step, for compiled code.

``order`` is the last power. Callers give a constant, so that the compiler writes each loop out.
"""

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_within


@compiled_within
def value(series: Doubles, order: int, time: float) -> float:
    """Return the sum of the series at a time."""
    total = series[order]
    for n in range(order - 1, -1, -1):
        total = total * time + series[n]
    return total


@compiled_within
def value_and_rate(series: Doubles, order: int, time: float) -> tuple[float, float]:
    """Return the sum of the series and its first derivative at a time."""
    total, slope = series[order], 0.0
    for n in range(order - 1, -1, -1):
        slope = slope * time + total
        total = total * time + series[n]
    return total, slope


@compiled_within
def rate(series: Doubles, order: int, time: float) -> float:
    """Return the first derivative of the series at a time."""
    return value_and_rate(series, order, time)[1]


@compiled_within
def rate_of_rate(series: Doubles, order: int, time: float) -> float:
    """Return the second derivative of the series at a time."""
    total = order * (order - 1) * series[order]
    for n in range(order - 1, 1, -1):
        total = total * time + n * (n - 1) * series[n]
    return total

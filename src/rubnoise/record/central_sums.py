"""Sums of powers about the mean, in the least number of passes; compiled."""

from typing import Any

from numpy.typing import NDArray

from rubnoise.compiling import compiled_for_speed


@compiled_for_speed
def central_sums(values: NDArray[Any], powers: int) -> tuple[float, float, float, float]:
    """Return the mean and the sums of the second to fourth powers about it, the last two only on request."""
    count = len(values)
    mean = 0.0
    for n in range(count):
        mean += values[n]
    mean /= count
    second, third, fourth = 0.0, 0.0, 0.0
    if powers == 2:
        for n in range(count):
            away = values[n] - mean
            second += away * away
        return mean, second, third, fourth
    for n in range(count):
        away = values[n] - mean
        square = away * away
        second += square
        third += away * square
        fourth += square * square
    return mean, second, third, fourth

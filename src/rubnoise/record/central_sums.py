"""Sums of powers about the mean, in as few passes as there can be; compiled."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.compiling import compiled_for_speed


@compiled_for_speed
def central_sums(values: NDArray[np.float64], powers: int) -> tuple[float, float, float, float]:
    """Return the mean and the sums of the second to fourth powers about it, the last two only where asked for."""
    mean = 0.0
    for value in values:
        mean += value
    mean /= len(values)
    second, third, fourth = 0.0, 0.0, 0.0
    if powers == 2:
        for value in values:
            second += (value - mean) ** 2
        return mean, second, third, fourth
    for value in values:
        away = value - mean
        square = away * away
        second += square
        third += away * square
        fourth += square * square
    return mean, second, third, fourth

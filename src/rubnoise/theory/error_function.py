"""The complementary error function of arrays, without the time that importing scipy.special takes."""

from math import erfc

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]


def complementary_error(x: Doubles) -> Doubles:
    """Return erfc(x) for x of any shape, by the library of C one by one: right to rounding."""
    values = np.asarray(x, dtype=np.float64)
    return np.array([erfc(value) for value in values.ravel().tolist()], dtype=np.float64).reshape(values.shape)

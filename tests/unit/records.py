"""Records whose law is known, for the tests of estimators."""

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]


def white(count: int, seed: int) -> Doubles:
    """Return independent unit normals about 3."""
    return 3.0 + np.random.default_rng(seed).standard_normal(count)


def memory(count: int, seed: int, kept: float = 0.9) -> Doubles:
    """Return a stationary Gaussian record of unit variance whose autocorrelation at lag j is kept^j (AR(1))."""
    from scipy.signal import lfilter

    noise = np.random.default_rng(seed).standard_normal(count) * np.sqrt(1.0 - kept**2)
    start = np.random.default_rng(seed + 1).standard_normal()
    found: Doubles = lfilter([1.0], [1.0, -kept], noise, zi=np.array([kept * start]))[0]
    return found

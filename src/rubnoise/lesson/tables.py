"""What theory says of a life of unit diameter, as tables for the page of lessons: series in place of its formulas.

A table holds the transform a^(z) of a life about its middle, z = k d, or off the centre line the mean of |a^(z)|^2 over
offsets: Chebyshev series of it times (1 + z^2)^(fall/2) between ``EDGES``, and beyond, with x = 32/z, z^-fall times
level(x) + x^root sum of c_n(x) cos(n z) + s_n(x) sin(n z), whose parts are polynomials.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.polynomial.chebyshev import Chebyshev
from numpy.typing import NDArray
from scipy.special import j1

from rubnoise.contact.pulses import LENS, OFF_CENTRE_LENS, PARABOLA, TRIANGLE, Pulse
from rubnoise.theory.sizes import Function, panels
from rubnoise.theory.unit_pulse import amplitude, overlaps

EDGES: Final = (0.0, 8.0, 16.0, 24.0, 32.0)
LAGS: Final = (0.0, 0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.99, 1.0, 1.01, 1.05, 1.2, 1.5, 1.8, 1.95, 2.0)
"""Where the series of a transform and of an overlap end: an overlap has roots at lags of 0, 1 and 2."""

_ORDERS = 5  # of the polynomials in 32/z
_FAR = np.linspace(EDGES[-1], 160.0, 401)


def tables() -> dict[str, Any]:
    """Return the table of each pulse of the page by its name, and where its series end."""
    lives = {
        "lens": _life(LENS, lambda z: amplitude(LENS, z), fall=2, root=0.5, waves=1),
        "triangle": _life(TRIANGLE, lambda z: amplitude(TRIANGLE, z), fall=2, root=0.0, waves=1),
        "parabola": _life(PARABOLA, lambda z: amplitude(PARABOLA, z), fall=2, root=0.0, waves=1),
        "offCentre": _life(OFF_CENTRE_LENS, _off_centre, fall=5, root=0.5, waves=2),
    }
    return {"edges": EDGES, "lags": LAGS, "lives": lives}


def _life(pulse: Pulse, spectrum: Function, *, fall: int, root: float, waves: int) -> dict[str, Any]:
    x, far = EDGES[-1] / _FAR, spectrum(_FAR) * _FAR**fall
    swings = [x**root * swing(n * _FAR) for n in range(1, waves + 1) for swing in (np.cos, np.sin)]
    terms = [part * x**order for part in (np.ones_like(x), *swings) for order in range(_ORDERS)]
    level, *parts = np.linalg.lstsq(np.stack(terms, axis=-1), far)[0].reshape(-1, _ORDERS)
    return {
        "lifeIntegrals": [pulse.life_integral(power) for power in (1, 2, 3)],
        "lifeMean": pulse.life_mean(),
        "meanLife": pulse.mean_life,
        "tail": pulse.tail,
        "fall": fall,
        "root": root,
        "near": _pieces(lambda z: spectrum(z) * (1.0 + z * z) ** (0.5 * fall), EDGES, 24),
        "level": _short(level),
        "swings": [[_short(part) for part in parts[2 * n : 2 * n + 2]] for n in range(waves)],
        "overlap": _pieces(overlaps(pulse, 1, 1), LAGS, 12),
    }


def _off_centre(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of |a^(z)|^2 over offsets, (pi^3/2) int_0^inf (J_1(q/2)/q)^4 dp, q^2 = z^2 + p^2."""
    place, weight = panels(np.linspace(0.0, 2000.0, 501), 12)
    across = np.hypot(np.maximum(phase, 1e-6)[:, None], place)
    return np.asarray(0.5 * np.pi**3 * (j1(0.5 * across) / across) ** 4 @ weight, dtype=np.float64)


def _pieces(curve: Function, edges: Sequence[float], degree: int) -> list[list[float]]:
    return [_short(Chebyshev.interpolate(curve, degree, [low, high]).coef) for low, high in pairwise(edges)]


def _short(values: Any) -> list[float]:
    return [float(f"{value:.10g}") for value in np.asarray(values, dtype=np.float64).tolist()]

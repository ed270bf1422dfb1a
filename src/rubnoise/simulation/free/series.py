"""Power series of a step, in the time since its start, and the first time at which a function of it reaches 0.

While the same encounters are in contact with the same weights, the force is linear in z and quadratic in s (with impact
damping also bilinear in overlaps and their rates), so that each coefficient follows from those before. A step is so
short that the terms left out are below rounding. A first time is searched from the left: with f < 0 and f'' <= most, f
stays below 0 up to the root of f + f' x + most x^2/2, where the search continues. So no time is missed.
"""

from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_within
from rubnoise.simulation.series import rate, rate_of_rate, value

ORDER: Final = 16
"""Degree of the series."""

TURN: Final = 0.5
"""Largest value of Omega times a step: coefficients of the linear motion fall at least as Omega^n/n!, and the terms
left out are 1e-20."""

ROUNDING: Final = 2.0**-54

_MOST_TRIES: Final = 200


@compiled_within
def motion_series(
    velocity: float, sums: Doubles, powers: Doubles, per_live: float, drag: float, growth: float, series: Doubles
) -> None:
    """Fill the coefficients of z - z(0): z'' = (P_linear + growth sum delta delta')/N - 1 - drag z'.

    sums: coefficients of 1, t, t^2 of the weighted overlaps in contact with constant z, and the sum of weights; powers:
    four coefficients of their products with their rates.
    """
    series[0], series[1] = 0.0, velocity
    for n in range(ORDER - 1):
        force = -sums[3] * series[n]
        if n < 3:
            force += sums[n]
        if growth != 0.0:
            bent = 0.0
            for k in range(n + 2):
                bent += series[k] * series[n + 1 - k]
            mixed = 0.0
            for k in range(min(3, n + 2)):
                mixed += sums[k] * series[n + 1 - k]
            product = float(n + 1) * (0.5 * sums[3] * bent - mixed)
            if n < 4:
                product += powers[n]
            force += growth * product
        push = per_live * force - drag * float(n + 1) * series[n + 1]
        if n == 0:
            push -= 1.0
        series[n + 2] = push / float((n + 1) * (n + 2))


@compiled_within
def pushed_series(
    place: float,
    velocity: float,
    sums: Doubles,
    per_live: float,
    drag: float,
    spring: float,
    z: Doubles,
    series: Doubles,
) -> None:
    """Fill the coefficients of x, with x'' + drag x' + spring x = (1/N) sum of shares times overlaps."""
    series[0], series[1] = place, velocity
    for n in range(ORDER - 1):
        force = -sums[3] * z[n]
        if n < 3:
            force += sums[n]
        push = per_live * force - drag * float(n + 1) * series[n + 1] - spring * series[n]
        series[n + 2] = push / float((n + 1) * (n + 2))


@compiled_within
def shortened(series: Doubles, step: float) -> float:
    """Return the step, halved until the last two terms are lost in the rounding of the others."""
    for _ in range(60):
        power, size, last = step, 0.0, 0.0
        for n in range(1, ORDER + 1):
            term = abs(series[n]) * power
            size += term
            if n >= ORDER - 1:
                last += term
            power *= step
        if last <= ROUNDING * size:
            return step
        step *= 0.5
    return step


@compiled_within
def bounds(series: Doubles, step: float) -> tuple[float, float, float, float]:
    """Return bounds within a step: of z'' from below and above, of |z'''| and of |z''''|."""
    power, bend, third, fourth = 1.0, 0.0, 6.0 * abs(series[3]), 24.0 * abs(series[4])
    for n in range(3, ORDER + 1):
        size = abs(series[n]) * power
        bend += float(n * (n - 1)) * size * step
        if n > 3:
            third += float(n * (n - 1) * (n - 2)) * size
        if n > 4:
            fourth += float(n * (n - 1) * (n - 2) * (n - 3)) * (abs(series[n]) * (power / step))
        power *= step
    return 2.0 * series[2] - bend, 2.0 * series[2] + bend, third, fourth


@compiled_within
def _ahead(f: float, slope: float, most: float) -> float:
    """Return the smallest x > 0 at which f + slope x + most x^2/2 reaches 0 from f <= 0; 0 if f is 0 and grows."""
    if f >= 0.0:
        if slope > 0.0:
            return 0.0
        return -2.0 * slope / most if most > 0.0 else np.inf
    root = slope * slope - 2.0 * most * f
    if most > 0.0:
        root = np.sqrt(root)
        return -2.0 * f / (slope + root) if slope >= 0.0 else (root - slope) / most
    if slope <= 0.0 or root < 0.0:
        return np.inf
    return -2.0 * f / (slope + np.sqrt(root))


@compiled_within
def overlap_zero(
    overlap: float, ahead: float, speed: float, way: float, most: float, series: Doubles, step: float
) -> float:
    """Return when an overlap reaches 0 from below (way 1) or from above (way -1) within a step; inf if it does not.

    ahead: x - s at the start; most: an upper bound of the second derivative of way times the overlap.
    """
    time = 0.0
    for _ in range(_MOST_TRIES):
        f = way * (overlap + speed * time * (2.0 * ahead - speed * time) - value(series, ORDER, time))
        slope = way * (2.0 * speed * (ahead - speed * time) - rate(series, ORDER, time))
        x = _ahead(f, slope, most)
        time += x
        if time >= step:
            return np.inf
        if x <= ROUNDING * time or x == 0.0:
            break
    return time


@compiled_within
def rate_zero(
    ahead: float, level: float, speed: float, way: float, third: float, begin: float, series: Doubles, step: float
) -> float:
    """Return when way times (r - level) reaches 0 from below after ``begin`` in a step; r: the rate of an overlap."""
    time, most = begin, third
    if time >= step:
        return np.inf
    for _ in range(_MOST_TRIES):
        f = way * (2.0 * speed * (ahead - speed * time) - rate(series, ORDER, time) - level)
        slope = -way * (2.0 * speed * speed + rate_of_rate(series, ORDER, time))
        x = _ahead(f, slope, most)
        time += x
        if time >= step:
            return np.inf
        if x <= ROUNDING * time or x == 0.0:
            break
    return time

"""A step of a free slider: the encounters in contact, the power series that they make of it, and first times in it.

While the same encounters are in contact with the same weights, the force is linear in z and quadratic in s (with impact
damping also bilinear in overlaps and their rates), so that each coefficient follows from those before. A step is so
short that the terms left out are below rounding. A first time is searched from the left: with f < 0 and f'' <= most, f
stays below 0 up to the root of f + f' x + most x^2/2, where the search continues. So no time is missed.
"""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_within
from rubnoise.simulation.series import rate, rate_of_rate, value

ORDER: Final = 16  # degree of the series

TURN: Final = 0.5
"""Largest value of Omega times a step: coefficients of the linear motion fall at least as Omega^n/n!, and the terms
left out are 1e-20."""

ROUNDING: Final = 2.0**-54

_MOST_TRIES: Final = 200

OVERLAP, RATE = range(2)

Records = NDArray[Any]  # an array of records, of CONTACT and of the kinds in `motion`; compiled code knows their fields

CONTACT: Final = np.dtype(
    [(name, np.float64) for name in ("place", "height", "weight", "share", "made", "largest")]
    + [("number", np.int64), ("ago", np.int64)]
)
"""An encounter in contact: x (c) from the origin of the block, h (s_0), k, strength over the mean; where contact was
made (c, from the origin of its own block), and the largest overlap so far (s_0); its number, and how many blocks ago
that was."""


class Constants(NamedTuple):
    """Constants of a run, in the units c, s_0, 1/omega_c, W.

    v; 1/N; 2 zeta of the dashpot beside the contact; e^2; beta, 0 with restitution; drag and spring over mass of a
    slider along the surface, which is driven by (1/N) sum of strengths times overlaps; 0 if there is none.
    """

    speed: float
    per_live: float
    drag: float = 0.0
    unloaded: float = 1.0
    growth: float = 0.0
    own_drag: float = 0.0
    own_spring: float = 0.0


class Series(NamedTuple):
    """Powers of time in a step, of z and of x, and (3, 4) the sums over the encounters in contact they are made of.

    LOADS and SHARES: coefficients of 1, t, t^2 of the overlaps with constant z, and the sum of weights, weighted by k
    and by strength; POWERS: four coefficients of overlaps times rates, weighted by k, if there is impact damping.
    """

    z: Doubles
    x: Doubles
    sums: Doubles


LOADS, SHARES, POWERS = range(3)


@compiled_within
def overlap_of(contact: Any, s: float, z: float) -> float:
    """Return an overlap (s_0)."""
    off = s - contact.place
    return contact.height - off * off - z


@compiled_within
def rate_of(contact: Any, s: float, w: float, speed: float) -> float:
    """Return the rate at which an overlap grows."""
    return 2.0 * speed * (contact.place - s) - w


@compiled_within
def add_up(contacts: Records, count: int, s: float, z: float, law: Constants, sums: Doubles) -> None:
    """Sum the power series in time of the overlaps of the encounters in contact."""
    sums[:] = 0.0
    bend, powers = -law.speed * law.speed, sums[POWERS]
    for n in range(count):
        overlap, slope = overlap_of(contacts[n], s, z), 2.0 * law.speed * (contacts[n].place - s)
        for total, weight in ((sums[LOADS], contacts[n].weight), (sums[SHARES], contacts[n].share)):
            total[0] += weight * overlap
            total[1] += weight * slope
            total[2] += weight * bend
            total[3] += weight
        if law.growth > 0.0:
            k = contacts[n].weight
            powers[0] += k * overlap * slope
            powers[1] += k * (slope * slope + 2.0 * bend * overlap)
            powers[2] += 3.0 * k * bend * slope
            powers[3] += 2.0 * k * bend * bend


@compiled_within
def load_of(
    contacts: Records, count: int, sliding: int, s: float, z: float, w: float, law: Constants
) -> tuple[float, float, float]:
    """Return P (W), the sum of overlaps, and the sum of overlaps weighted by strength, all three divided by N."""
    load, overlaps, shared = 0.0, 0.0, 0.0
    for n in range(count):
        overlap = overlap_of(contacts[n], s, z)
        load += contacts[n].weight * overlap * (1.0 + law.growth * rate_of(contacts[n], s, w, law.speed))
        overlaps += overlap
        shared += contacts[n].share * overlap
    load *= law.per_live
    if sliding >= 0:  # z'' = -2 v^2 there
        load = 1.0 - 2.0 * law.speed * law.speed + law.drag * w
    return load, overlaps * law.per_live, shared * law.per_live


@compiled_within
def turned(contacts: Records, count: int, which: int, s: float, z: float, w: float, law: Constants) -> float:
    """Return the weight of an encounter whose overlap has stopped growing or shrinking; -1 if its rate stays 0.

    r' = -2 v^2 - z'' is lower with k = 1 than with k = e^2. If it is positive even with 1, the overlap grows; if it is
    negative even with e^2, the overlap shrinks; otherwise the rate stays 0 (Filippov, Differential Equations with
    Discontinuous Righthand Sides, 1988).
    """
    rest, overlap = 0.0, overlap_of(contacts[which], s, z)
    for n in range(count):
        if n != which:
            rest += contacts[n].weight * overlap_of(contacts[n], s, z)
    pull = 1.0 + law.drag * w - 2.0 * law.speed * law.speed
    if pull - (rest + overlap) * law.per_live >= 0.0:
        return 1.0
    if pull - (rest + law.unloaded * overlap) * law.per_live <= 0.0:
        return law.unloaded
    return -1.0


@compiled_within
def slides_until(
    contacts: Records, count: int, which: int, s: float, z: float, w: float, law: Constants
) -> tuple[float, float]:
    """Return for how long the rate of an overlap stays 0, and the weight of the encounter after that.

    Overlaps are linear in time meanwhile, because z'' = -2 v^2 is also the curvature of each summit.
    """
    square, live = law.speed * law.speed, 1.0 / law.per_live
    own = overlap_of(contacts[which], s, z)
    needed = live * (1.0 - 2.0 * square + law.drag * w)
    growth = -2.0 * live * law.drag * square
    for n in range(count):
        if n != which:
            needed -= contacts[n].weight * overlap_of(contacts[n], s, z)
            growth -= contacts[n].weight * rate_of(contacts[n], s, w, law.speed)
    if growth > 0.0:
        return max(own - needed, 0.0) / growth, 1.0
    if growth < 0.0:
        return max(needed - law.unloaded * own, 0.0) / -growth, law.unloaded
    return np.inf, 1.0


@compiled_within
def motion_series(
    start: tuple[float, float],
    sums: Doubles,
    law: Constants,
    holds: tuple[float, float, float],
    growth: float,
    series: Series,
    filled: Doubles,
) -> None:
    """Fill the coefficients of y: y'' = (sum of overlaps + growth sum delta delta')/N - weight - drag y' - spring y.

    y is z itself, or x if ``series.z`` has been filled. start: y, y'; sums: the row of ``series.sums`` by which the
    overlaps are weighted; holds: weight, drag, spring.
    """
    z, powers, (weight, drag, spring) = series.z, series.sums[POWERS], holds
    filled[0], filled[1] = start
    for n in range(ORDER - 1):
        force = -sums[3] * z[n]
        if n < 3:
            force += sums[n]
        if growth != 0.0:
            bent = 0.0
            for k in range(n + 2):
                bent += z[k] * z[n + 1 - k]
            mixed = 0.0
            for k in range(min(3, n + 2)):
                mixed += sums[k] * z[n + 1 - k]
            product = float(n + 1) * (0.5 * sums[3] * bent - mixed)
            if n < 4:
                product += powers[n]
            force += growth * product
        push = law.per_live * force - drag * float(n + 1) * filled[n + 1] - spring * filled[n]
        if n == 0:
            push -= weight
        filled[n + 2] = push / float((n + 1) * (n + 2))


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
def first_zero(
    what: int, offset: float, ahead: float, speed: float, way: float, most: float, begin: float, z: Doubles, step: float
) -> float:
    """Return when way times an OVERLAP or its RATE reaches 0 from below after ``begin`` in a step; inf if it does not.

    offset: the overlap at the start, or less a level of the rate; ahead: x - s at the start; most: an upper bound of
    the second derivative of way times it.
    """
    time = begin
    if time >= step:
        return np.inf
    for _ in range(_MOST_TRIES):
        growth = 2.0 * speed * (ahead - speed * time) - rate(z, ORDER, time)
        if what == RATE:
            f, slope = growth + offset, -(2.0 * speed * speed + rate_of_rate(z, ORDER, time))
        else:
            f, slope = offset + speed * time * (2.0 * ahead - speed * time) - value(z, ORDER, time), growth
        x = _ahead(way * f, way * slope, most)
        time += x
        if time >= step:
            return np.inf
        if x <= ROUNDING * time or x == 0.0:
            break
    return time


@compiled_within
def begin_fresh(f_slope: float, f_bend: float, third: float, fourth: float, step: float) -> float:
    """Return the time before which the rate of an overlap that has just turned cannot be 0 again."""
    begin = 1e-9 * step
    if f_slope < 0.0 and third > 0.0:
        begin = max(begin, -2.0 * f_slope / third)
    if f_slope <= 0.0 and f_bend < 0.0 and fourth > 0.0:
        begin = max(begin, -3.0 * f_bend / fourth)
    return begin

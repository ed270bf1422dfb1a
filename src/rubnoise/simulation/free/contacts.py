"""The encounters in contact: sums over their overlaps, and what follows when an overlap stops growing."""

from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare

PLACE, HEIGHT, WEIGHT, SHARE, NUMBER, MADE, LARGEST = range(7)
"""Rows of the encounters in contact: x (c) from the origin of the block, h (s_0), k, strength over the mean, number;
where contact was made (c, from the origin), and the largest overlap so far (s_0)."""
COLUMNS: Final = 7

RESTITUTION, IMPACT_DAMPING = range(2)

(LAW, SPEED, PER_LIVE, DRAG, UNLOADED, GROWTH, OWN_DRAG, OWN_SPRING, TICK) = range(9)
"""Constants: the law of loss; v; 1/N; 2 zeta; e^2; beta; drag and spring of the slider along the surface, over its mass
(spring 0: none); length of a tick (c)."""
CONSTANTS: Final = 9

S, Z, W, X, U = range(5)
"""Numbers of the motion: place from the origin of the block (c), z, z', and x, x' of the slider along the surface."""
NUMBERS: Final = 5


@compiled_bare
def overlap_of(contacts: Doubles, n: int, s: float, z: float) -> float:
    """Return an overlap (s_0)."""
    off = s - contacts[PLACE, n]
    return contacts[HEIGHT, n] - off * off - z


@compiled_bare
def rate_of(contacts: Doubles, n: int, s: float, w: float, speed: float) -> float:
    """Return the rate at which an overlap grows."""
    return 2.0 * speed * (contacts[PLACE, n] - s) - w


@compiled_bare
def add_up(
    contacts: Doubles,
    count: int,
    s: float,
    z: float,
    speed: float,
    growth: float,
    sums: Doubles,
    shares: Doubles,
    powers: Doubles,
) -> None:
    """Sum the power series in time of the overlaps of the encounters in contact, with constant z.

    sums: weighted by k; shares: weighted by strength; each has the coefficients of 1, t, t^2, then the sum of weights.
    powers: for the products of overlaps and their rates, weighted by k, if there is impact damping.
    """
    sums[:4] = 0.0
    shares[:4] = 0.0
    powers[:4] = 0.0
    bend = -speed * speed
    for n in range(count):
        overlap = overlap_of(contacts, n, s, z)
        slope = 2.0 * speed * (contacts[PLACE, n] - s)
        k, q = contacts[WEIGHT, n], contacts[SHARE, n]
        sums[0] += k * overlap
        sums[1] += k * slope
        sums[2] += k * bend
        sums[3] += k
        shares[0] += q * overlap
        shares[1] += q * slope
        shares[2] += q * bend
        shares[3] += q
        if growth != 0.0:
            powers[0] += k * overlap * slope
            powers[1] += k * (slope * slope + 2.0 * bend * overlap)
            powers[2] += 3.0 * k * bend * slope
            powers[3] += 2.0 * k * bend * bend


@compiled_bare
def load_of(
    contacts: Doubles, count: int, sliding: int, s: float, z: float, w: float, constants: Doubles
) -> tuple[float, float, float]:
    """Return P (W), the sum of overlaps, and the sum of overlaps weighted by strength, all three divided by N."""
    speed, load, overlaps, shared = constants[SPEED], 0.0, 0.0, 0.0
    for n in range(count):
        overlap = overlap_of(contacts, n, s, z)
        push = contacts[WEIGHT, n] * overlap
        if constants[LAW] == IMPACT_DAMPING:
            push *= 1.0 + constants[GROWTH] * rate_of(contacts, n, s, w, speed)
        load += push
        overlaps += overlap
        shared += contacts[SHARE, n] * overlap
    load *= constants[PER_LIVE]
    if sliding >= 0:  # z'' = -2 v^2 there
        load = 1.0 - 2.0 * speed * speed + constants[DRAG] * w
    return load, overlaps * constants[PER_LIVE], shared * constants[PER_LIVE]


@compiled_bare
def turned(contacts: Doubles, count: int, which: int, s: float, z: float, w: float, constants: Doubles) -> float:
    """Return the weight of an encounter whose overlap has stopped growing or shrinking; -1 if its rate stays 0.

    r' = -2 v^2 - z'' is lower with k = 1 than with k = e^2. If it is positive even with 1, the overlap grows; if it is
    negative even with e^2, the overlap shrinks; otherwise the rate stays 0 (Filippov, Differential Equations with
    Discontinuous Righthand Sides, 1988).
    """
    rest, overlap = 0.0, overlap_of(contacts, which, s, z)
    for n in range(count):
        if n != which:
            rest += contacts[WEIGHT, n] * overlap_of(contacts, n, s, z)
    pull = 1.0 + constants[DRAG] * w - 2.0 * constants[SPEED] * constants[SPEED]
    per_live, unloaded = constants[PER_LIVE], constants[UNLOADED]
    if pull - (rest + overlap) * per_live >= 0.0:
        return 1.0
    if pull - (rest + unloaded * overlap) * per_live <= 0.0:
        return unloaded
    return -1.0


@compiled_bare
def slides_until(
    contacts: Doubles, count: int, which: int, s: float, z: float, w: float, constants: Doubles
) -> tuple[float, float]:
    """Return for how long the rate of an overlap stays 0, and the weight of the encounter after that.

    Overlaps are linear in time meanwhile, because z'' = -2 v^2 is also the curvature of each summit.
    """
    speed, live = constants[SPEED], 1.0 / constants[PER_LIVE]
    own = overlap_of(contacts, which, s, z)
    needed = live * (1.0 - 2.0 * speed * speed + constants[DRAG] * w)
    growth = -2.0 * live * constants[DRAG] * speed * speed
    for n in range(count):
        if n != which:
            needed -= contacts[WEIGHT, n] * overlap_of(contacts, n, s, z)
            growth -= contacts[WEIGHT, n] * rate_of(contacts, n, s, w, speed)
    if growth > 0.0:
        return max(own - needed, 0.0) / growth, 1.0
    if growth < 0.0:
        return max(needed - constants[UNLOADED] * own, 0.0) / -growth, constants[UNLOADED]
    return np.inf, 1.0

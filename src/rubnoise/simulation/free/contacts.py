"""The encounters in contact: sums over their overlaps, and what follows when an overlap stops growing."""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_within
from rubnoise.simulation.free.series import ORDER

Records = NDArray[Any]
"""An array of records, of CONTACT and of the kinds in `motion`; compiled code knows their fields."""

CONTACT: Final = np.dtype(
    [(name, np.float64) for name in ("place", "height", "weight", "share", "made", "largest")]
    + [("number", np.int64), ("ago", np.int64)]
)
"""An encounter in contact: x (c) from the origin of the block, h (s_0), k, strength over the mean; where contact was
made (c, from the origin of its own block), and the largest overlap so far (s_0); its number, and how many blocks ago
that was."""


class Law(NamedTuple):
    """v; 1/N; 2 zeta; e^2; beta, 0 with restitution; drag and spring of a slider along the surface, over its mass."""

    speed: float
    per_live: float
    drag: float
    unloaded: float
    growth: float
    own_drag: float
    own_spring: float


class Sums(NamedTuple):
    """Coefficients of 1, t, t^2 of the overlaps in contact with constant z, then the sum of weights.

    loads: weighted by k; shares: weighted by strength; powers: four coefficients of the products of overlaps and their
    rates, weighted by k, if there is impact damping.
    """

    loads: Doubles
    shares: Doubles
    powers: Doubles


class Series(NamedTuple):
    """Powers of time in a step, of z and of x, and the sums that they are made of."""

    z: Doubles
    x: Doubles
    sums: Sums


def series_in_memory() -> Series:
    """Return memory for the series of a step."""
    return Series(np.zeros(ORDER + 1), np.zeros(ORDER + 1), Sums(np.zeros(4), np.zeros(4), np.zeros(4)))


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
def add_up(contacts: Records, count: int, s: float, z: float, law: Law, sums: Sums) -> None:
    """Sum the power series in time of the overlaps of the encounters in contact."""
    sums.loads[:] = 0.0
    sums.shares[:] = 0.0
    sums.powers[:] = 0.0
    bend = -law.speed * law.speed
    for n in range(count):
        overlap, slope = overlap_of(contacts[n], s, z), 2.0 * law.speed * (contacts[n].place - s)
        for total, weight in ((sums.loads, contacts[n].weight), (sums.shares, contacts[n].share)):
            total[0] += weight * overlap
            total[1] += weight * slope
            total[2] += weight * bend
            total[3] += weight
        if law.growth > 0.0:
            k = contacts[n].weight
            sums.powers[0] += k * overlap * slope
            sums.powers[1] += k * (slope * slope + 2.0 * bend * overlap)
            sums.powers[2] += 3.0 * k * bend * slope
            sums.powers[3] += 2.0 * k * bend * bend


@compiled_within
def load_of(
    contacts: Records, count: int, sliding: int, s: float, z: float, w: float, law: Law
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
def turned(contacts: Records, count: int, which: int, s: float, z: float, w: float, law: Law) -> float:
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
    contacts: Records, count: int, which: int, s: float, z: float, w: float, law: Law
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

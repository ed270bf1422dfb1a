"""Gauss-Legendre rules over panels and over any size law, and the complementary error function of arrays."""

from functools import cache, lru_cache
from math import erfc, exp, log

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.contact.laws.discrete import parts_of
from rubnoise.model import Model


def complementary_error(x: Doubles) -> Doubles:
    """Return erfc(x) for x of any shape, by the library of C one by one: right to rounding."""
    values = np.asarray(x, dtype=np.float64)
    return np.array([erfc(value) for value in values.ravel().tolist()], dtype=np.float64).reshape(values.shape)


HIGHEST_POWER = 13
"""Averages of d^n up to this n (the sixth cumulant's) are held to rounding."""

_NARROWEST = 1e-9  # spread over diameter of a law that counts as one size
_NARROW = 4.0  # largest over smallest diameter of a law that equal panels in d resolve
_NARROW_PANELS = 4
_LEFT_OUT = 1e-17  # share of an average that may lie outside the range
_SMOOTH = 2e-15  # share of an average by which a panel may differ from its halves
_TEST_NODES = 16


def distinct(values: ArrayLike) -> Doubles:
    """Return values in order, each once; numpy's own function would load its masked arrays for this."""
    ordered = np.sort(np.asarray(values, dtype=np.float64), axis=None)
    return ordered[np.append(True, np.diff(ordered) > 0.0)]


@cache
def _rule(count: int) -> tuple[Doubles, Doubles]:
    return np.polynomial.legendre.leggauss(count)


@cache
def _rooted_rule(count: int) -> tuple[Doubles, Doubles]:
    """Return the rule in t for x = -cos(pi t), which turns roots of 1 - x^2 into whole powers."""
    t, w = _rule(count)
    return np.sin(0.5 * np.pi * t), 0.5 * np.pi * w * np.cos(0.5 * np.pi * t)


def panels(edges: ArrayLike, count: int, *, rooted: bool = False) -> tuple[Doubles, Doubles]:
    """Return nodes and weights of a ``count``-point rule on each panel between consecutive edges.

    Edges may have leading axes, one set of panels each; nodes and weights gain a last axis of all panels in order.
    ``rooted``, the rule is for functions that may end like roots at the edges, as a life does at birth and death.
    """
    edge = np.asarray(edges, dtype=np.float64)
    x, w = _rooted_rule(count) if rooted else _rule(count)
    half = 0.5 * np.diff(edge, axis=-1)[..., None]
    middle = 0.5 * (edge[..., 1:] + edge[..., :-1])[..., None]
    shape = (*edge.shape[:-1], count * (edge.shape[-1] - 1))
    return (middle + half * x).reshape(shape), np.broadcast_to(half * w, (middle + half * x).shape).reshape(shape)


@lru_cache(maxsize=64)
def size_range(law: Law) -> tuple[float, float]:
    """Return the diameters in um between which averages of d g(d) are taken, g growing no faster than d^12.

    It is the law's support, longer where d^13 still has weight beyond it, and cut where d is too small to have any. A
    law too narrow to resolve sizes is drawn together to its middle: a spread of 1e-10 of the diameter changes no
    average by more than 1e-19, but its density is lost in rounding.
    """
    if parts := parts_of(law):
        ends = [size_range(part) for _, part in parts]
        return min(low for low, _ in ends), max(high for _, high in ends)
    low, high = law.support
    if high - low <= _NARROWEST * high:
        return (0.5 * (low + high),) * 2
    step = (high - low) / 16.0
    ends_hard = hard_ends(law)
    while ends_hard[1] is None and (
        _weight(law, high) * step > _LEFT_OUT or _weight(law, 2.0 * high) > _weight(law, high)
    ):
        high, step = high + step, 1.25 * step
    low = max(low, high * 2.0**-200)
    while _density(law, 2.0 * low) * 4.0 * low * low <= _LEFT_OUT * law.moment(1) and 4.0 * low < high:
        low *= 2.0
    return low, high


def is_one_size(law: Law) -> bool:
    """Return whether a law counts as a single size."""
    low, high = size_range(law)
    return low == high


def longest_life(model: Model) -> float:
    """Return 2 d of the largest diameter that counts, in um: beyond it nothing of the contact is left."""
    return 2.0 * size_range(model.sizes)[1]


def hard_ends(law: Law) -> tuple[float | None, float | None]:
    """Return the smallest and the largest diameter in um at which the density of a law jumps to 0; None if it fades.

    Averages of what swings with the diameter do not fade at such an end.
    """
    low, high = law.support
    if low == high or parts_of(law):
        return None, None
    below, above = (float(np.nextafter(end, far)) for end, far in ((low, -np.inf), (high, np.inf)))
    jumps = low > 0.0 and _density(law, below) == 0.0 < _density(law, low)
    return low if jumps else None, high if _density(law, above) == 0.0 < _density(law, high) else None


def size_rule(law: Law, count: int) -> tuple[Doubles, Doubles]:
    """Return diameters in um and their probabilities, so that E[g(d)] = sum of probability times g(diameter).

    For g that is smooth and vanishes with d as fast as d does. A single size needs one diameter; a narrow law has
    ``count`` of them, a wide one a quarter of that on each of its panels.
    """
    return cut_size_rule(law, np.empty(0), count // 4)


def cut_size_rule(law: Law, cuts: Doubles, count: int, *, rooted: bool = False) -> tuple[Doubles, Doubles]:
    """Return diameters in um and their probabilities as `size_rule`, for g that is smooth between cuts only.

    Cuts (um) lie along the last axis, in any order; leading axes have a rule each. There are ``count`` diameters on
    each panel between cuts and edges of the law, so also on the empty ones of cuts outside it. The probabilities are
    scaled to give E[d] exactly, which a law of little spread, with few digits in its density, needs. ``rooted``, g may
    end like a root at a cut.
    """
    if parts := parts_of(law):
        rules = [(weight, *cut_size_rule(part, cuts, count, rooted=rooted)) for weight, part in parts]
        diameters = np.concatenate([each for _, each, _ in rules], axis=-1)
        return diameters, np.concatenate([weight * each for weight, _, each in rules], axis=-1)
    edges, logarithmic = size_edges(law)
    if edges.size == 1:
        return np.broadcast_to(edges, (*cuts.shape[:-1], 1)), np.ones((*cuts.shape[:-1], 1))
    whole = np.broadcast_to(edges, (*cuts.shape[:-1], edges.size))
    ends = np.sort(np.concatenate([whole, np.clip(cuts, edges[0], edges[-1])], axis=-1), axis=-1)
    if logarithmic:
        places, weights = panels(np.log(ends), count, rooted=rooted)
        diameters = np.exp(places)
        weights = weights * diameters
    else:
        diameters, weights = panels(ends, count, rooted=rooted)
    shares = weights * law.density(diameters)
    return diameters, shares * (law.moment(1) / np.sum(shares * diameters, axis=-1, keepdims=True))


@lru_cache(maxsize=64)
def size_edges(law: Law) -> tuple[Doubles, bool]:
    """Return the edges in um of panels that resolve a law, and whether to take them in log d; one edge for one size.

    Panels in log d are halved until the averages of d, d^7 and d^13 of each agree with those of its halves.
    """
    low, high = size_range(law)
    if low == high:
        return np.array([high]), False
    if parts := parts_of(law):
        return distinct(np.concatenate([size_edges(part)[0] for _, part in parts])), True
    if high <= _NARROW * low:
        return np.linspace(low, high, _NARROW_PANELS + 1), False
    edges = np.log(np.array([low, high]))
    while True:
        coarse, fine = _shares(law, edges, 1), _shares(law, edges, 2)
        rough = np.max(np.abs(coarse - fine), axis=0) > _SMOOTH
        if not rough.any() or edges.size > 2 * HIGHEST_POWER * _TEST_NODES:
            return np.exp(edges), True
        middles = 0.5 * (edges[1:] + edges[:-1])
        edges = np.sort(np.concatenate([edges, middles[rough]]))


def _shares(law: Law, edges: Doubles, parts: int) -> Doubles:
    """Return the shares that panels in log d, cut into equal parts, have in E[d], E[d^7], E[d^13]: a row each."""
    steps = np.arange(parts) / parts
    ends = np.append((edges[:-1, None] + np.diff(edges)[:, None] * steps).ravel(), edges[-1])
    places, weights = panels(ends, _TEST_NODES)
    diameters = np.exp(places)
    mass = weights * diameters * law.density(diameters)
    rows = [mass * (diameters / law.moment(n) ** (1.0 / n)) ** n for n in (1, 7, HIGHEST_POWER)]
    return np.sum(np.reshape(rows, (len(rows), edges.size - 1, -1)), axis=-1)


def _density(law: Law, diameter: float) -> float:
    return float(law.density(np.array([diameter]))[0])


def _weight(law: Law, diameter: float) -> float:
    """Return the density of d^13 in 1/um over its average; by logarithms, since d^13 alone may overflow."""
    density = _density(law, diameter)
    if density == 0.0:
        return 0.0
    return exp(log(density) + HIGHEST_POWER * log(diameter) - log(law.moment(HIGHEST_POWER)))

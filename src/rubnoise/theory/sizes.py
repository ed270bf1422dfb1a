"""A law of sizes as diameters with probabilities, by Gauss's rule over log d; and rules over panels."""

from dataclasses import dataclass
from functools import cache, lru_cache
from math import ceil, inf, log

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.contact.laws.discrete import parts_of
from rubnoise.model import Model

FINE, COARSE = 160.0, 20.0
"""Diameters for a factor e of size: for averages right to 1e-8, and for errors of errors."""

_HARD = 6.0  # times as many for a law whose density jumps: its swings do not fade
_PANEL = 16
_PHASE = 110.0  # k times the width of a law to which FINE diameters follow the swing of a spectrum
_NARROWEST = 1e-6  # spread over diameter of a law that counts as one size
_LEFT_OUT = 1e-17
_CUT_PANELS, _CUT_NODES = 3.0, 16
_FEWEST = 8
_NARROW = 0.8  # logarithm of the factor that a narrow law counts as


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sizes:
    """Diameters in um with their probabilities.

    ``followed`` is the wavenumber in rad/um to which the rule follows the swing of a spectrum at each; inf for single
    sizes. From there on what fades over sizes is left out.
    """

    diameter: Doubles
    probability: Doubles
    followed: Doubles


@cache
def _rule(count: int) -> tuple[Doubles, Doubles]:
    return np.polynomial.legendre.leggauss(count)


def panels(edges: ArrayLike, count: int, *, rooted: bool = False) -> tuple[Doubles, Doubles]:
    """Return nodes and weights of a ``count``-point rule on each panel between consecutive edges.

    Edges may have leading axes, one set of panels each; nodes and weights gain a last axis of all panels in order.
    ``rooted``, the rule is for functions that may end like roots at the edges, as a life does at birth and death.
    """
    edge = np.asarray(edges, dtype=np.float64)
    x, w = _rule(count)
    if rooted:
        x, w = np.sin(0.5 * np.pi * x), 0.5 * np.pi * w * np.cos(0.5 * np.pi * x)
    half = 0.5 * np.diff(edge, axis=-1)[..., None]
    nodes = 0.5 * (edge[..., 1:] + edge[..., :-1])[..., None] + half * x
    shape = (*edge.shape[:-1], count * (edge.shape[-1] - 1))
    return nodes.reshape(shape), np.broadcast_to(half * w, nodes.shape).reshape(shape)


@lru_cache(maxsize=64)
def sizes_of(law: Law, per_factor: float = FINE) -> Sizes:
    """Return diameters and probabilities with which averages of d^n g(d) are sums, n from 1 to 12, g smooth."""
    if parts := parts_of(law):
        each = [(weight, sizes_of(part, per_factor)) for weight, part in parts]
        return Sizes(
            diameter=np.concatenate([of.diameter for _, of in each]),
            probability=np.concatenate([weight * of.probability for weight, of in each]),
            followed=np.concatenate([of.followed for _, of in each]),
        )
    low, high = size_range(law)
    finer = _HARD if any(end is not None for end in hard_ends(law)) else 1.0
    edges = _edges(law, finer * per_factor / _PANEL, ceil(_NARROW * per_factor / _PANEL))
    diameter, probability = _shared_out(law, edges, _PANEL, rooted=False)
    followed = inf if low == high else _PHASE * finer / (high - low)
    return Sizes(diameter=diameter, probability=probability, followed=np.full(diameter.size, followed))


def cut_sizes(law: Law, cuts: Doubles) -> tuple[Doubles, Doubles]:
    """Return diameters in um and probabilities for averages of what is smooth between cuts, or ends there as a root.

    Cuts (um) lie along the last axis; leading axes have a rule each, along a last axis of the same length.
    """
    if parts := parts_of(law):
        rules = [(weight, *cut_sizes(part, cuts)) for weight, part in parts]
        diameters = np.concatenate([each for _, each, _ in rules], axis=-1)
        return diameters, np.concatenate([weight * each for weight, _, each in rules], axis=-1)
    edges = _edges(law, _CUT_PANELS, _FEWEST)
    whole = np.broadcast_to(edges, (*cuts.shape[:-1], edges.size))
    inside = np.log(np.clip(cuts, np.exp(edges[0]), np.exp(edges[-1])))
    return _shared_out(law, np.sort(np.concatenate([whole, inside], axis=-1), axis=-1), _CUT_NODES, rooted=True)


def _edges(law: Law, panels_of_factor: float, fewest: int) -> Doubles:
    """Return the edges of panels in log d; one edge for one size."""
    low, high = size_range(law)
    count = max(fewest, ceil(panels_of_factor * log(high / low)))
    return np.linspace(log(low), log(high), (low < high) * count + 1)


def _shared_out(law: Law, edges: Doubles, count: int, *, rooted: bool) -> tuple[Doubles, Doubles]:
    """Return diameters and probabilities on panels in log d, scaled to give E[d] exactly.

    A law of little spread needs that: its density has few digits. The panels of one size are empty.
    """
    if is_one_size(law):
        return np.exp(edges[..., :1]), np.ones((*edges.shape[:-1], 1))
    place, weight = panels(edges, count, rooted=rooted)
    diameter = np.exp(place)
    share = weight * diameter * law.density(diameter)
    return diameter, share * (law.moment(1) / np.sum(share * diameter, axis=-1, keepdims=True))


@lru_cache(maxsize=64)
def size_range(law: Law) -> tuple[float, float]:
    """Return the diameters in um between which averages of d^n, n from 1 to 8, are taken; equal for one size."""
    if parts := parts_of(law):
        ends = [size_range(part) for _, part in parts]
        return min(low for low, _ in ends), max(high for _, high in ends)
    low, high = law.support
    if high - low <= _NARROWEST * high:
        return (0.5 * (low + high),) * 2

    def weight(diameter: float, power: int) -> float:
        return float(law.density(np.array([diameter]))[0]) * (diameter / law.mean) ** power * diameter

    step = (high - low) / 16.0
    while hard_ends(law)[1] is None and (weight(high, 8) > _LEFT_OUT or weight(2.0 * high, 8) > weight(high, 8)):
        high, step = high + step, 1.25 * step
    low = max(low, 2.0**-200 * high)
    while weight(2.0 * low, 1) <= _LEFT_OUT and 4.0 * low < high:
        low *= 2.0
    return low, high


def hard_ends(law: Law) -> tuple[float | None, float | None]:
    """Return the smallest and the largest diameter in um at which the density of a law jumps to 0; None if it fades."""
    low, high = law.support
    if low == high or parts_of(law):
        return None, None
    places = np.array([np.nextafter(low, -np.inf), low, high, np.nextafter(high, np.inf)])
    below, first, last, above = law.density(places).tolist()
    return low if low > 0.0 and below == 0.0 < first else None, high if above == 0.0 < last else None


def is_one_size(law: Law) -> bool:
    """Return whether a law counts as a single size."""
    return size_range(law)[0] == size_range(law)[1]


def longest_life(model: Model) -> float:
    """Return 2 d of the largest diameter that counts, in um: beyond it nothing of the contact is left."""
    return 2.0 * size_range(model.sizes)[1]

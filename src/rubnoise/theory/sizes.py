"""A law of sizes as diameters with probabilities, by Gauss's rule over log d; averages of g(x/d) and g(k d); tables."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from math import ceil, inf, log, log1p
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.distributions import Law, Mixture, leaves_of
from rubnoise.model import Model

Function = Callable[[Doubles], Any]

FINE, COARSE = 160.0, 20.0  # diameters for a factor e of size: for averages right to 1e-8, and for errors of errors
SETTLED = 160.0  # phase k d from which lives of many sizes swing against one another: nothing of the swing is left
_HARD = 6.0  # times as many for a law whose density jumps: its swings do not fade
_PANEL = 16
_PHASE = 110.0  # k times the width of a law to which FINE diameters follow the swing of a spectrum
_NARROWEST = 1e-6  # spread over diameter of a law that counts as one size
_LEFT_OUT, _UNSEEN, _SMALL = 1e-17, 1e-13, 1e-6  # shares that ranges, sums, and errors of errors leave out
_CUT_PANELS, _SPREADS, _FEWEST, _TABLE, _TURNS = 4.0, 1.8, 8, 150, 50  # panels: see `_gauss`, `_table_over_sizes`
_AT_ONCE, _PHASES_AT_ONCE = 1 << 12, 1 << 17  # more places than a table has
_rule = cache(np.polynomial.legendre.leggauss)


class Table:  # scipy has splines, but a command that loads them takes half as long again
    """A function as a polynomial of some powers on panels between ascending edges; outside it stays as at the ends."""

    def __init__(self, edges: ArrayLike, function: Callable[[Doubles], Any], count: int = 8) -> None:
        self._edges = np.asarray(edges, dtype=np.float64)
        values = np.asarray(function(panels(self._edges, count)[0])).reshape(-1, count)
        self._powers = np.linalg.solve(np.vander(_rule(count)[0], increasing=True), values.T)

    def __call__(self, place: Doubles) -> Any:
        """Return the values at places of any shape."""
        panel = np.interp(place, self._edges, np.arange(self._edges.size, dtype=np.float64))
        piece = np.minimum(panel.astype(np.intp), self._edges.size - 2)
        turned = 2.0 * (panel - piece) - 1.0
        found = self._powers[-1][piece]
        for power in self._powers[-2::-1]:
            found = found * turned + power[piece]
        return found


@dataclass(frozen=True, slots=True, eq=False)
class SizeRule:
    """Diameters in um, their probabilities, and the wavenumber in rad/um to which each follows a spectrum's swing."""

    diameter: Doubles
    probability: Doubles
    followed: Doubles


def panels(edges: ArrayLike, count: int, *, rooted: bool = False) -> tuple[Doubles, Doubles]:
    """Return a rule of ``count`` nodes between consecutive edges; ``rooted``, for functions like roots at the edges."""
    edge = np.asarray(edges, dtype=np.float64)
    x, w = _rule(count)
    if rooted:
        x, w = np.sin(0.5 * np.pi * x), 0.5 * np.pi * w * np.cos(0.5 * np.pi * x)
    half = 0.5 * np.diff(edge, axis=-1)[..., None]
    nodes = 0.5 * (edge[..., 1:] + edge[..., :-1])[..., None] + half * x
    shape = (*edge.shape[:-1], count * (edge.shape[-1] - 1))
    return nodes.reshape(shape), np.broadcast_to(half * w, nodes.shape).reshape(shape)


@lru_cache(maxsize=64)
def sizes_of(law: Law, per_factor: float = FINE) -> SizeRule:
    """Return diameters and probabilities with which averages of d^n g(d) are sums, n from 1 to 12, g smooth."""
    rules = []
    for weight, leaf in leaves_of(law):
        low, high = size_range(leaf)
        inside, outside = leaf.density(np.array(leaf.support)), leaf.density(np.nextafter(leaf.support, (-inf, inf)))
        jumps = (outside == 0.0) & (inside > 0.0) & (np.array(leaf.support) > 0.0)
        finer = _HARD if low < high and jumps.any() else 1.0
        diameter, probability = _gauss(leaf, finer * per_factor / _PANEL, per_factor / FINE)
        shares, small = (probability * diameter**n for n in (1, 12)), _UNSEEN if per_factor == FINE else _SMALL
        seen = np.flatnonzero(np.any([share > small * share.max() for share in shares], axis=0))
        kept = slice(seen[0], seen[-1] + 1)  # between low and high powers of a wide law all others count
        followed = inf if low == high else _PHASE * finer / (high - low)
        rules.append((diameter[kept], weight * probability[kept], np.full(diameter[kept].size, followed)))
    return SizeRule(*(np.concatenate(each) for each in zip(*rules, strict=True)))


def _gauss(leaf: Law, panels_of_factor: float, fine: float, cuts: Doubles | None = None) -> tuple[Doubles, Doubles]:
    """Return diameters and probabilities on panels in log d, at most 1.8 standard deviations wide, with E[d] exact."""
    (low, high), shape = size_range(leaf), () if cuts is None else cuts.shape[:-1]
    if low == high:
        return np.full((*shape, 1), low), np.ones((*shape, 1))
    spread = max(leaf.moment(2) / leaf.mean**2 - 1.0, 0.0) ** 0.5
    wanted = log(high / low) * max(panels_of_factor, fine / (_SPREADS * spread))
    edges = np.linspace(log(low), log(high), ceil(max(_FEWEST * fine, wanted)) + 1)
    if cuts is not None:
        whole = np.broadcast_to(edges, (*shape, edges.size))
        edges = np.sort(np.concatenate([whole, np.log(np.clip(cuts, low, high))], axis=-1), axis=-1)
    place, weight = panels(edges, _PANEL, rooted=cuts is not None)
    diameter = np.exp(place)
    share = weight * diameter * leaf.density(diameter)
    return diameter, share * (leaf.moment(1) / np.sum(share * diameter, axis=-1, keepdims=True))


@lru_cache(maxsize=64)
def size_range(law: Law) -> tuple[float, float]:
    """Return the diameters in um between which averages of d^n, n from 1 to 8, are taken; equal for one size."""
    if isinstance(law, Mixture):
        ends = [size_range(part) for part in law.laws]
        return min(low for low, _ in ends), max(high for _, high in ends)
    low, high = law.support
    if high - low <= _NARROWEST * high:
        return (0.5 * (low + high),) * 2

    def weight(diameter: float, power: int) -> float:
        return float(law.density(np.array([diameter]))[0]) * (diameter / law.mean) ** power * diameter

    step, beyond = (high - low) / 16.0, np.nextafter(high, inf)  # where a law that ends hard is 0
    while weight(beyond, 8) > _LEFT_OUT or weight(2.0 * beyond, 8) > weight(beyond, 8):
        beyond, high, step = high + step, high + step, 1.25 * step
    low = max(low, 2.0**-200 * high)
    for factor in (2.0, 1.1):
        while weight(factor * low, 1) <= _LEFT_OUT and factor**2 * low < high:
            low *= factor
    return low, high


def longest_life(model: Model) -> float:
    """Return 2 d of the largest diameter that counts, in um: beyond it nothing of the contact is left."""
    return 2.0 * size_range(model.sizes)[1]


def over_sizes(model: Model, unit: Function, power: int, x: Doubles) -> Doubles:
    """Return lam E[d^power unit(x/d)] at x >= 0 in um; for many places and sizes by a table."""
    if x.size > _AT_ONCE and sizes_of(model.sizes).diameter.size >= _FEWEST:
        return np.asarray(_table_over_sizes(model, unit, power)(x), dtype=np.float64)
    found = np.zeros(x.size)
    for share, leaf in leaves_of(model.sizes):
        for rows in np.array_split(np.arange(x.size), 1 + x.size // _AT_ONCE):
            some = x.ravel()[rows, None]
            diameter, probability = _gauss(leaf, _CUT_PANELS, 1.0, some * (0.5, 1.0))
            found[rows] += np.sum(unit(some / diameter) * (share * probability) * diameter**power, axis=-1)
    return model.birth_rate * found.reshape(x.shape)


@lru_cache(maxsize=64)
def _table_over_sizes(model: Model, unit: Function, power: int) -> Table:
    """Return a table of `over_sizes`, closer at 0, where lives begin, and far apart in the rare longest lives."""
    low, high = size_range(model.sizes)
    scale = 0.5 * model.sizes.moment(2) / model.sizes.moment(1)
    edges = scale * np.expm1(log1p(2.0 * high / scale) * np.square(np.linspace(0.0, 1.0, _TABLE + 1)))
    if high < 2.0 * low:  # lives of nearly equal sizes turn within a narrow stretch, and end in another
        turns = np.linspace(low, high, _TURNS)
        edges = np.unique(np.concatenate([edges, turns, 2.0 * turns]))
    return Table(edges, lambda x: over_sizes(model, unit, power, x))


def over_phases(law: Law, wavenumber: Doubles, unit: Callable[..., Any], power: int, exact: ArrayLike) -> Complexes:
    """Return E[d^power unit(k d, settled)], with the swing where diameters follow it; not ``exact``, to k d = 160."""
    sizes, k = sizes_of(law), wavenumber.ravel()
    share, weight = (sizes.probability * sizes.diameter**n for n in (2, power))  # the first in the tail of a spectrum
    seen = (share > _UNSEEN * share.max()) | (weight > _UNSEEN * weight.max())
    diameter, followed, weight = sizes.diameter[seen], sizes.followed[seen], weight[seen]
    found = np.zeros(k.size, dtype=np.complex128)
    follows = np.broadcast_to(exact, k.shape)
    for rows in np.array_split(np.arange(k.size), 1 + k.size * weight.size // _PHASES_AT_ONCE):
        some = k[rows, None]
        settled = np.where(follows[rows, None] & (some <= followed), inf, SETTLED)
        found[rows] = unit(some * diameter, settled) @ weight
    return found.reshape(wavenumber.shape)

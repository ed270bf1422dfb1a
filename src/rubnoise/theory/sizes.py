"""A law of sizes as diameters with probabilities, by Gauss's rule over log d; averages of g(x/d) and g(k d).

Beside them cubic splines: those of scipy are the same, but a command that loads them takes half as long again.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from math import ceil, inf, log, log1p
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.laws import Law
from rubnoise.contact.laws.discrete import parts_of
from rubnoise.model import Model

Function = Callable[[Doubles], Doubles]

FINE, COARSE = 160.0, 20.0
"""Diameters for a factor e of size: for averages right to 1e-8, and for errors of errors."""

SETTLED = 160.0
"""Phase k d from which lives of many sizes swing against one another, so that nothing of the swing is left."""

_HARD = 6.0  # times as many for a law whose density jumps: its swings do not fade
_PANEL = 16
_PHASE = 110.0  # k times the width of a law to which FINE diameters follow the swing of a spectrum
_NARROWEST = 1e-6  # spread over diameter of a law that counts as one size
_LEFT_OUT = 1e-17
_CUT_PANELS, _FEWEST = 3.0, 8
_NARROW = 0.8  # logarithm of the factor that a narrow law counts as
_AT_ONCE = 1 << 17
_rule = cache(np.polynomial.legendre.leggauss)
_TABLE, _TURNS = 2400, 400
_HALVINGS = 64


class Spline:
    """The cubic spline through values at ascending places, no knot at the second and last but one; then it stays."""

    def __init__(self, places: ArrayLike, values: ArrayLike, *, powers: Any = None) -> None:
        self.x = np.asarray(places, dtype=np.float64)
        self._powers = _powers(self.x, np.asarray(values)) if powers is None else powers
        step = np.diff(self.x)
        self._even = float(step[0]) if np.ptp(step) < 1e-9 * step[0] else 0.0

    def __call__(self, place: ArrayLike) -> Any:
        """Return the values at places of any shape: before the first by its first piece, from the last on its value."""
        x = np.minimum(np.asarray(place, dtype=np.float64), self.x[-1])
        if self._even:
            piece = ((x - self.x[0]) * (1.0 / self._even)).astype(np.intp)
        else:
            piece = np.searchsorted(self.x, x, side="right") - 1
        piece = np.clip(piece, 0, self.x.size - 1)
        past, found = x - self.x[piece], self._powers[-1][piece]
        for power in self._powers[-2::-1]:
            found = found * past + power[piece]
        return found

    def antiderivative(self) -> "Spline":
        """Return the integral from the first place on."""
        step, whole = np.diff(self.x), np.zeros(self.x.size - 1)
        powers = [power / (n + 1) for n, power in enumerate(self._powers)]
        for power in powers[::-1]:
            whole = (whole + power[:-1]) * step
        return Spline(self.x, self.x, powers=[np.append(0.0, np.cumsum(whole)), *powers])


def _powers(x: Doubles, y: Any) -> list[Any]:
    """Return the coefficients of each piece by its power; slopes follow from equal second derivatives at the knots."""
    step, rise = np.diff(x), np.diff(y) / np.diff(x)
    first, last, both = x[2] - x[0], x[-1] - x[-3], 2.0 * (step[:-1] + step[1:])
    inner = 3.0 * (step[1:] * rise[:-1] + step[:-1] * rise[1:])
    begin = ((step[0] + 2.0 * first) * step[1] * rise[0] + step[0] ** 2 * rise[1]) / first
    end = (step[-1] ** 2 * rise[-2] + (2.0 * last + step[-1]) * step[-2] * rise[-1]) / last
    s = np.append(rise, rise[-1])
    for _ in range(_HALVINGS):  # each turn halves what is missing
        s[1:-1] = (inner - step[1:] * s[:-2] - step[:-1] * s[2:]) / both
        s[0], s[-1] = (begin - first * s[1]) / step[1], (end - last * s[-2]) / step[-2]
    bend = (s[:-1] + s[1:] - 2.0 * rise) / step
    return [y, *(np.append(power, 0.0) for power in (s[:-1], (rise - s[:-1]) / step - bend, bend / step))]


@dataclass(frozen=True, slots=True, eq=False)
class Sizes:
    """Diameters in um with their probabilities.

    ``followed`` is the wavenumber in rad/um to which each follows the swing of a spectrum, inf for single sizes.
    """

    diameter: Doubles
    probability: Doubles
    followed: Doubles


def panels(edges: ArrayLike, count: int, *, rooted: bool = False) -> tuple[Doubles, Doubles]:
    """Return nodes and weights of a ``count``-point rule on each panel between consecutive edges.

    Edges may have leading axes. ``rooted``, the rule is for functions that may end like roots at the edges.
    """
    edge = np.asarray(edges, dtype=np.float64)
    x, w = _rule(count)
    if rooted:
        x, w = np.sin(0.5 * np.pi * x), 0.5 * np.pi * w * np.cos(0.5 * np.pi * x)
    half = 0.5 * np.diff(edge, axis=-1)[..., None]
    nodes = 0.5 * (edge[..., 1:] + edge[..., :-1])[..., None] + half * x
    shape = (*edge.shape[:-1], count * (edge.shape[-1] - 1))
    return nodes.reshape(shape), np.broadcast_to(half * w, nodes.shape).reshape(shape)


def _leaves(law: Law) -> list[tuple[float, Law]]:
    """Return the laws without parts of which a law is made, with their probabilities."""
    if parts := parts_of(law):
        return [(weight * share, leaf) for weight, part in parts for share, leaf in _leaves(part)]
    return [(1.0, law)]


@lru_cache(maxsize=64)
def sizes_of(law: Law, per_factor: float = FINE) -> Sizes:
    """Return diameters and probabilities with which averages of d^n g(d) are sums, n from 1 to 12, g smooth."""
    rules = []
    for weight, leaf in _leaves(law):
        low, high = size_range(leaf)
        finer = _HARD if any(_hard_ends(leaf)) else 1.0
        diameter, probability = _gauss(leaf, finer * per_factor / _PANEL, ceil(_NARROW * per_factor / _PANEL))
        followed = inf if low == high else _PHASE * finer / (high - low)
        rules.append((diameter, weight * probability, np.full(diameter.size, followed)))
    return Sizes(*(np.concatenate(each) for each in zip(*rules, strict=True)))


def cut_sizes(law: Law, cuts: Doubles) -> tuple[Doubles, Doubles]:
    """Return diameters in um and probabilities for averages of what is smooth between cuts, or ends there as a root.

    Cuts (um) lie along the last axis; leading axes have a rule each.
    """
    rules = [(weight, *_gauss(leaf, _CUT_PANELS, _FEWEST, cuts)) for weight, leaf in _leaves(law)]
    diameters = np.concatenate([diameter for _, diameter, _ in rules], axis=-1)
    return diameters, np.concatenate([weight * share for weight, _, share in rules], axis=-1)


def _gauss(leaf: Law, panels_of_factor: float, fewest: int, cuts: Doubles | None = None) -> tuple[Doubles, Doubles]:
    """Return diameters and probabilities on panels in log d, scaled to give E[d] exactly, as narrow laws need."""
    (low, high), shape = size_range(leaf), () if cuts is None else cuts.shape[:-1]
    if low == high:
        return np.full((*shape, 1), low), np.ones((*shape, 1))
    edges = np.linspace(log(low), log(high), max(fewest, ceil(panels_of_factor * log(high / low))) + 1)
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
    if parts := parts_of(law):
        ends = [size_range(part) for _, part in parts]
        return min(low for low, _ in ends), max(high for _, high in ends)
    low, high = law.support
    if high - low <= _NARROWEST * high:
        return (0.5 * (low + high),) * 2

    def weight(diameter: float, power: int) -> float:
        return float(law.density(np.array([diameter]))[0]) * (diameter / law.mean) ** power * diameter

    step = (high - low) / 16.0
    while not _hard_ends(law)[1] and (weight(high, 8) > _LEFT_OUT or weight(2.0 * high, 8) > weight(high, 8)):
        high, step = high + step, 1.25 * step
    low = max(low, 2.0**-200 * high)
    while weight(2.0 * low, 1) <= _LEFT_OUT and 4.0 * low < high:
        low *= 2.0
    return low, high


def _hard_ends(leaf: Law) -> tuple[bool, bool]:
    """Return whether the density of a law without parts jumps to 0 at its smallest and at its largest diameter."""
    low, high = leaf.support
    if low == high:
        return False, False
    places = np.array([np.nextafter(low, -np.inf), low, high, np.nextafter(high, np.inf)])
    below, first, last, above = leaf.density(places).tolist()
    return low > 0.0 and below == 0.0 < first, above == 0.0 < last


def is_one_size(law: Law) -> bool:
    """Return whether a law counts as a single size."""
    low, high = size_range(law)
    return low == high


def longest_life(model: Model) -> float:
    """Return 2 d of the largest diameter that counts, in um: beyond it nothing of the contact is left."""
    return 2.0 * size_range(model.sizes)[1]


def over_sizes(model: Model, unit: Function, power: int, x: Doubles) -> Doubles:
    """Return lam E[d^power unit(x/d)] at x >= 0 in um, sizes cut where x is the end or the middle of a life."""
    found = np.empty(x.size)
    for rows in np.array_split(np.arange(x.size), 1 + x.size // 4096):
        some = x.ravel()[rows, None]
        diameter, probability = cut_sizes(model.sizes, some * (0.5, 1.0))
        found[rows] = np.sum(unit(some / diameter) * probability * diameter**power, axis=-1)
    return model.birth_rate * found.reshape(x.shape)


@lru_cache(maxsize=64)
def table_over_sizes(model: Model, unit: Function, power: int) -> Function:
    """Return `over_sizes` as a function of x, for many sizes by a table; beyond the longest life it is constant.

    It is even in u, x = c (exp(b u^2) - 1): closer at 0, where lives begin, and far apart in the rare longest lives.
    """
    if sizes_of(model.sizes).diameter.size < _FEWEST:
        return lambda x: over_sizes(model, unit, power, x)
    low, high = size_range(model.sizes)
    scale = 0.5 * model.sizes.moment(2) / model.sizes.moment(1)
    octaves = log1p(2.0 * high / scale)

    def place(x: Doubles) -> Doubles:
        return np.sqrt(np.log1p(x / scale) / octaves)

    knots = np.linspace(0.0, 1.0, _TABLE + 1)
    if high < 2.0 * low:  # lives of nearly equal sizes turn within a narrow stretch, and end in another
        turns = np.linspace(low, high, _TURNS)
        knots = np.unique(np.concatenate([knots, place(turns), place(2.0 * turns)]))
    spline = Spline(knots, over_sizes(model, unit, power, scale * np.expm1(octaves * np.square(knots))))
    return lambda x: spline(place(x))


def over_phases(
    law: Law, wavenumber: Doubles, unit: Callable[..., Any], power: int, *, exact: ArrayLike = True
) -> Complexes:
    """Return E[d^power unit(k d, settled)], with the swing where diameters follow it; not ``exact``, to k d = 160."""
    sizes, k = sizes_of(law), wavenumber.ravel()
    weight, found = sizes.probability * sizes.diameter**power, np.zeros(k.size, dtype=np.complex128)
    follows = np.broadcast_to(exact, k.shape)
    for rows in np.array_split(np.arange(k.size), 1 + k.size * weight.size // _AT_ONCE):
        some = k[rows, None]
        settled = np.where(follows[rows, None] & (some <= sizes.followed), inf, SETTLED)
        found[rows] = unit(some * sizes.diameter, settled) @ weight
    return found.reshape(wavenumber.shape)

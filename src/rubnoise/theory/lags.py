"""Lags and weights that turn a covariance into the variance of a mean over a finite record, and how far it reaches."""

from math import ceil, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.quadrature import distinct, hard_ends, panels, size_range

_PANELS = 8
_NODES = 10
_FEW_TICKS = 64
_MOST_TICKS = 512
_WIDE = 2.0  # longest over typical life of a law whose lags are taken in octaves
_FINEST = 2.0**-6  # of a typical life


def longest_life(model: Model) -> float:
    """Return 2 d of the largest diameter that counts, in um: beyond it nothing of the contact is left."""
    return 2.0 * size_range(model.sizes)[1]


def _reach(model: Model) -> float:
    """Return the lag in um beyond which covariances have ended: the longest life, and what births remember."""
    return longest_life(model) + (model.births.memory if isfinite(model.births.memory) else 0.0)


def lag_rule(model: Model, distance: float | None = None) -> tuple[Doubles, Doubles]:
    """Return lags in um and weights, so that Var[mean of f(X)] = sum of weight times Cov[f(X(0)), f(X(lag))].

    The mean is over a continuous record of ``distance`` T um, weight (2/T)(1 - tau/T) dtau, or, without a distance,
    over the model's n = tick_count + 1 ticks h apart, weight (2/n)(1 - j/n) at tau = j h and 1/n at tau = 0. Lags end
    with the longest life: beyond it nothing of the contact is left. Many ticks a life are equivalent to a continuous
    record of n h, and are treated as one; so are the lags of few ticks a life beyond the 512th.
    """
    if distance is not None:
        return _continuous(model, 0.0, distance)
    ticks = model.tick_count + 1
    reach = min(ticks - 1, int(_reach(model) / model.tick))
    if reach > _FEW_TICKS and _typical_life(model) > _FEW_TICKS * model.tick:
        return _continuous(model, 0.0, ticks * model.tick)
    steps = np.arange(min(reach, _MOST_TICKS) + 1, dtype=np.float64)
    weights = (2.0 / ticks) * (1.0 - steps / ticks)
    weights[0] = 1.0 / ticks
    if reach <= _MOST_TICKS:
        return steps * model.tick, weights
    far, far_weights = _continuous(model, (_MOST_TICKS + 0.5) * model.tick, ticks * model.tick)
    return np.concatenate([steps * model.tick, far]), np.concatenate([weights, far_weights])


def _continuous(model: Model, start: float, distance: float) -> tuple[Doubles, Doubles]:
    end = min(distance, _reach(model))
    edges = distinct(np.clip(lag_edges(model, end), start, end))
    lags, weights = panels(edges, _NODES)
    return lags, weights * (2.0 / distance) * (1.0 - lags / distance)


def lag_edges(model: Model, end: float) -> Doubles:
    """Return edges in um of panels from 0 to an end: equal, or, for a wide law, in octaves beyond two typical lives.

    The shortest life of a law whose density jumps there is an edge too: covariances turn at it.
    """
    typical = _typical_life(model)
    parts: list[NDArray[Any]] = [np.linspace(0.0, min(end, _WIDE * typical), _PANELS + 1)]
    if 0.0 < model.births.memory < np.inf:
        parts.append(np.linspace(0.0, end, ceil(_PANELS * end / min(typical, 2.0 * model.births.memory))))
    if end > _WIDE * typical:
        parts += [typical * 2.0 ** np.arange(np.log2(_FINEST), np.log2(end / typical)), np.array([end])]
    shortest = hard_ends(model.sizes)[0]
    if shortest is not None and 2.0 * shortest < end:
        parts.append(np.array([2.0 * shortest]))
    return distinct(np.concatenate(parts))


def _typical_life(model: Model) -> float:
    """Return the longest life in um of a junction of the mean diameter found alive, 2 m_2/m_1."""
    return 2.0 * model.sizes.moment(2) / model.sizes.moment(1)


_PLACES = 17


def covariance_reach(model: Model, part: float) -> float:
    """Return a lag in um beyond which |R| is below a part of the variance: the longest life, or half of it, or less.

    A size law with a long tail has lives that hardly ever come, up to hundreds of mean lives: most lags up to them show
    nothing. Where R never falls so far, as with regular births of one size, it is the longest life.
    """
    reach, least = longest_life(model), part * float(autocovariance(model, 0.0))
    while np.all(np.abs(autocovariance(model, np.linspace(0.5 * reach, reach, _PLACES))) < least):
        reach *= 0.5
    return reach

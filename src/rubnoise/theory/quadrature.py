"""Gauss-Legendre rules: over panels, over the size law, and over the lags of a finite record."""

from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.contact.sizes import SizeLaw
from rubnoise.model import Model

Doubles = NDArray[np.float64]

_LAG_PANELS = 8
_LAG_NODES = 10
_FEW_TICKS = 64
_NARROWEST = 1e-9


@cache
def _rule(count: int) -> tuple[Doubles, Doubles]:
    return np.polynomial.legendre.leggauss(count)


def panels(edges: ArrayLike, count: int) -> tuple[Doubles, Doubles]:
    """Return nodes and weights of a ``count``-point rule on each panel between consecutive edges.

    Edges may have leading axes, one set of panels each; nodes and weights gain a last axis of all panels in order.
    """
    edge = np.asarray(edges, dtype=np.float64)
    x, w = _rule(count)
    half = 0.5 * np.diff(edge, axis=-1)[..., None]
    middle = 0.5 * (edge[..., 1:] + edge[..., :-1])[..., None]
    shape = (*edge.shape[:-1], -1)
    return (middle + half * x).reshape(shape), np.broadcast_to(half * w, (middle + half * x).shape).reshape(shape)


def size_range(law: SizeLaw) -> tuple[float, float]:
    """Return the law's support in um, drawn together to its middle where it is too narrow to tell sizes apart.

    A spread of 1e-10 of the diameter changes no average by more than 1e-19, but its density is lost in rounding.
    """
    low, high = law.support
    middle = 0.5 * (low + high)
    return (middle, middle) if high - low <= _NARROWEST * high else (low, high)


def size_rule(law: SizeLaw, count: int) -> tuple[Doubles, Doubles]:
    """Return diameters in um and their probabilities, so that E[g(d)] = sum of probability times g(diameter).

    A single size needs one diameter. For a law that is smooth on its support the rule converges exponentially. The
    probabilities are made to add up to 1, which a law of little spread, with few digits in its density, needs.
    """
    low, high = size_range(law)
    if low == high:
        return np.array([high]), np.ones(1)
    diameters, weights = panels([low, high], count)
    probabilities = weights * law.density(diameters)
    return diameters, probabilities / probabilities.sum()


def lag_rule(model: Model, distance: float | None = None) -> tuple[Doubles, Doubles]:
    """Return lags in um and weights, so that Var[mean of f(X)] = sum of weight times Cov[f(X(0)), f(X(lag))].

    The mean is over a continuous record of ``distance`` T um, weight (2/T)(1 - tau/T) dtau, or, without a distance,
    over the model's n = tick_count + 1 ticks h apart, weight (2/n)(1 - j/n) at tau = j h and 1/n at tau = 0. Lags end
    with the longest life: beyond it nothing of the contact is left. Many ticks a life are as good as a continuous
    record of n h, and are treated as one.
    """
    longest = 2.0 * model.sizes.support[1]
    if distance is None:
        ticks = model.tick_count + 1
        reach = min(ticks - 1, int(longest / model.tick))
        if reach <= _FEW_TICKS:
            steps = np.arange(reach + 1, dtype=np.float64)
            weights = (2.0 / ticks) * (1.0 - steps / ticks)
            weights[0] = 1.0 / ticks
            return steps * model.tick, weights
        distance = ticks * model.tick
    edges = np.linspace(0.0, min(distance, longest), _LAG_PANELS + 1)
    lags, weights = panels(edges, _LAG_NODES)
    return lags, weights * (2.0 / distance) * (1.0 - lags / distance)

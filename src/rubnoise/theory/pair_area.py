"""The area of two junctions found alive together: the law of a sum, with its cusps where one of them peaks."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rubnoise.theory.live_area import LiveArea
from rubnoise.theory.piecewise import NODES, Piecewise, series
from rubnoise.theory.quadrature import panels

Doubles = NDArray[np.float64]

_NODES = 24
_TOLERANCE = 1e-11
_NARROWEST = 1e-9


def pair_area(live: LiveArea) -> tuple[Piecewise, Piecewise]:
    """Return distribution function and density of the sum of two independent live areas, as functions of t = a^(1/3).

    From 0 to twice the largest area; within 1e-11 of their largest values, but for the density within 1e-9 of the
    largest area of equal sizes, where it has a cusp of power 2/3 (1e-6).
    """
    breaks = _breaks(live)
    return _adapted(lambda t: _pair(live, breaks, t**3), np.unique(np.cbrt(np.append(breaks, 2.0 * breaks))))


def _breaks(live: LiveArea) -> Doubles:
    """Return 0 and every second break, both ends among them, which is as close as this rule needs them."""
    return np.union1d([0.0, live.breaks[0]], live.breaks[::-2])


def _pair(live: LiveArea, breaks: Doubles, area: Doubles) -> Doubles:
    """Return P(a + b <= x) and its derivative, two rows, for independent live areas a and b.

    P = G(x/2)^2 + 2 int_0^(x/2) (G(x - a) - G(x/2)) dG(a): the smaller of the two is below x/2, so that only it comes
    near the singular 0. Cut wherever one of them passes a break.
    """
    whole = area[:, None]
    cuts = np.concatenate([np.broadcast_to(breaks, (area.size, breaks.size)), whole - breaks], axis=1)
    cuts = np.cbrt(np.sort(np.clip(cuts, 0.0, 0.5 * whole), axis=1))
    row, column = np.nonzero(np.diff(cuts, axis=1))
    t, weights = panels(np.stack([cuts[row, column], cuts[row, column + 1]], axis=-1), _NODES)
    other, weights = whole[row] - t**3, 2.0 * weights * live.rise(t)
    at_half = live.cdf(0.5 * area)
    parts = (live.cdf(other) - at_half[row, None], live.density(other))
    sums = [np.bincount(row, np.sum(weights * part, axis=1), area.size) for part in parts]
    return np.stack([np.square(at_half) + sums[0], sums[1]])


def _adapted(functions: Callable[[Doubles], Doubles], edges: Doubles) -> tuple[Piecewise, Piecewise]:
    """Return two functions on panels that are halved until their series have converged."""
    done: list[tuple[Doubles, Doubles]] = []
    largest = 0.0
    panel = np.stack([edges[:-1], edges[1:]], axis=-1)
    while panel.size:
        t, _ = panels(panel, NODES)
        values = functions(t.ravel()).reshape(2, *t.shape)
        found = series(values)
        largest = np.maximum(largest, np.max(np.abs(values), axis=(1, 2)))
        ready = np.all(np.max(np.abs(found[-3:]), axis=0) < _TOLERANCE * largest[:, None], axis=0)
        ready |= np.diff(panel, axis=1)[:, 0] < _NARROWEST * edges[-1]
        done.append((panel[ready, 0], found[:, :, ready]))
        middle = 0.5 * (panel[~ready, 0] + panel[~ready, 1])
        panel = np.stack([panel[~ready, 0], middle, middle, panel[~ready, 1]], axis=-1).reshape(-1, 2)
    starts, coefficients = (np.concatenate(parts, axis=-1) for parts in zip(*done, strict=True))
    order = np.argsort(starts)
    whole = np.append(starts[order], edges[-1])
    cdf, density = (Piecewise(edges=whole, coefficients=rows[:, order]) for rows in np.moveaxis(coefficients, 1, 0))
    return cdf, density

"""Functions of a positive distance as polynomials in its logarithm, also with sharp turns."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from rubnoise.arrays import Doubles, slices

_NODES = 20
_LAST = 4  # highest coefficients that have to be negligible
_MOST_HALVINGS = 40
_MOST_PANELS = 1024  # halved at once; more than that means noise
_AT_ONCE = 2**15
_NARROWEST = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class LogTable:
    """Functions f_1 ... f_m on [low, high] in um as Legendre series in log x on panels: (m, order, panel)."""

    edges: Doubles
    coefficients: Doubles

    def __call__(self, place: Doubles) -> Doubles:
        """Return all functions, the first axis, at places of any shape; 0 outside the table."""
        x = place.ravel()
        result = np.empty((self.coefficients.shape[0], x.size))
        for part in slices(0, x.size, _AT_ONCE):
            result[:, part] = self._values(x[part])
        return result.reshape(-1, *place.shape)

    def _values(self, x: Doubles) -> Doubles:
        inside = (x >= np.exp(self.edges[0])) & (x <= np.exp(self.edges[-1]))
        logs = np.log(np.where(inside, x, 1.0))
        panel = np.clip(np.searchsorted(self.edges, logs, side="right") - 1, 0, self.edges.size - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        local = (2.0 * logs - low - high) / (high - low)
        series = np.moveaxis(self.coefficients[:, :, panel], 1, 0)
        return np.where(inside, legendre.legval(local, series, tensor=False), 0.0)


def log_table(functions: Callable[[Doubles], Doubles], edges: Doubles, tolerance: Doubles) -> LogTable:
    """Return a table of functions, given with a leading axis, between the first and the last of edges in um.

    Panels are halved until the highest coefficients of each function are below its tolerance.
    """
    ends = np.log(edges)
    # Edges that differ by rounding alone would make a panel of no width, and be found in place of the one beside it.
    ends = ends[np.append(True, np.diff(ends) > _NARROWEST)]
    lows, highs = ends[:-1], ends[1:]
    kept_lows: list[Doubles] = []
    kept: list[Doubles] = []
    for halvings in range(_MOST_HALVINGS + 1):
        coefficients = _series(functions, lows, highs)
        rough = np.any(np.abs(coefficients[:, -_LAST:, :]).max(axis=1) > tolerance[:, None], axis=0)
        rough &= halvings < _MOST_HALVINGS and rough.sum() <= _MOST_PANELS
        kept_lows.append(lows[~rough])
        kept.append(coefficients[:, :, ~rough])
        if not rough.any():
            break
        middles = 0.5 * (lows + highs)[rough]
        lows, highs = np.concatenate([lows[rough], middles]), np.concatenate([middles, highs[rough]])
    starts = np.concatenate(kept_lows)
    order = np.argsort(starts)
    return LogTable(edges=np.append(starts[order], ends[-1]), coefficients=np.concatenate(kept, axis=2)[:, :, order])


def _series(functions: Callable[[Doubles], Doubles], lows: Doubles, highs: Doubles) -> Doubles:
    """Return the Legendre coefficients (function, order, panel)."""
    x, w = legendre.leggauss(_NODES)
    places = np.exp(0.5 * (lows + highs)[:, None] + 0.5 * (highs - lows)[:, None] * x)
    projection = legendre.legvander(x, _NODES - 1) * w[:, None] * (np.arange(_NODES) + 0.5)
    return np.einsum("fpn,no->fop", functions(places), projection)

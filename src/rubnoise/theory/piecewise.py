"""Smooth functions kept as polynomials on panels."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

NODES = 20
_AT_ONCE = 32_768


@dataclass(frozen=True, slots=True, kw_only=True)
class Piecewise:
    """A function on [edges[0], edges[-1]] as Legendre series, one column of coefficients for each panel."""

    edges: Doubles
    coefficients: Doubles

    def __call__(self, x: Doubles) -> Doubles:
        """Return the values at places of any shape; places outside are taken as the nearest end."""
        places = np.clip(x, self.edges[0], self.edges[-1]).ravel()
        result = np.empty_like(places)
        for first in range(0, places.size, _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            result[part] = self._values(places[part])
        return result.reshape(np.shape(x))

    def _values(self, x: Doubles) -> Doubles:
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.edges.size - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        local = (2.0 * x - low - high) / (high - low)
        return np.asarray(legendre.legval(local, self.coefficients[:, panel], tensor=False), dtype=np.float64)

    def integral(self) -> "Piecewise":
        """Return the antiderivative that is 0 at the first edge."""
        parts = 0.5 * np.diff(self.edges) * legendre.legint(self.coefficients, lbnd=-1, axis=0)
        parts[0, 1:] += np.cumsum(legendre.legval(1.0, parts))[:-1]
        return Piecewise(edges=self.edges, coefficients=parts)

    def scaled(self, factor: float) -> "Piecewise":
        """Return the function times a number."""
        return Piecewise(edges=self.edges, coefficients=factor * self.coefficients)


def series(values: Doubles) -> Doubles:
    """Return Legendre coefficients, a new first axis, of functions given at Gauss-Legendre nodes, their last axis."""
    x, w = legendre.leggauss(values.shape[-1])
    projection = legendre.legvander(x, x.size - 1).T * w * (np.arange(x.size) + 0.5)[:, None]
    return np.tensordot(projection, values, axes=(1, -1))

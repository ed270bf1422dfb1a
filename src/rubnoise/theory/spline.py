"""Cubic splines. Those of scipy are the same, but a command that loads them takes half as long again."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles


class Spline:
    """The cubic spline through real or complex values at ascending places, no knot at the second and last but one."""

    def __init__(self, places: ArrayLike, values: ArrayLike, *, powers: Any = None) -> None:
        self.x = np.asarray(places, dtype=np.float64)
        self._powers = _powers(self.x, np.asarray(values)) if powers is None else powers
        step = np.diff(self.x)
        self._even = float(step[0]) if np.ptp(step) < 1e-9 * step[0] else 0.0

    def __call__(self, place: ArrayLike) -> Any:
        """Return the values at places of any shape; beyond the ends its last pieces go on."""
        x = np.asarray(place, dtype=np.float64)
        if self._even:
            piece = ((x - self.x[0]) * (1.0 / self._even)).astype(np.intp)
        else:
            piece = np.searchsorted(self.x, x, side="right") - 1
        piece = np.clip(piece, 0, self.x.size - 2)
        past, found = x - self.x[piece], self._powers[-1][piece]
        for power in self._powers[-2::-1]:
            found = found * past + power[piece]
        return found

    def antiderivative(self) -> "Spline":
        """Return the integral from the first place on."""
        powers = [power / (n + 1) for n, power in enumerate(self._powers)]
        step, whole = np.diff(self.x), np.zeros(self.x.size - 1)
        for power in powers[::-1]:
            whole = (whole + power) * step
        return Spline(self.x, self.x, powers=[np.append(0.0, np.cumsum(whole)[:-1]), *powers])


def _powers(x: Doubles, y: Any) -> list[Any]:
    """Return the coefficients of each piece by its power; slopes follow from equal second derivatives at the knots."""
    step, first, last = np.diff(x), x[2] - x[0], x[-1] - x[-3]
    rise = np.diff(y) / step
    lower, middle, upper = np.append(step[1:], last), np.zeros(x.size), np.append(first, step[:-1])
    middle[1:-1], middle[0], middle[-1] = 2.0 * (step[:-1] + step[1:]), step[1], step[-2]
    right = np.zeros(x.size, dtype=rise.dtype)
    right[1:-1] = 3.0 * (step[1:] * rise[:-1] + step[:-1] * rise[1:])
    right[0] = ((step[0] + 2.0 * first) * step[1] * rise[0] + step[0] ** 2 * rise[1]) / first
    right[-1] = (step[-1] ** 2 * rise[-2] + (2.0 * last + step[-1]) * step[-2] * rise[-1]) / last
    slope, rest, pivot, below, above = right.tolist(), right.tolist(), middle.tolist(), lower.tolist(), upper.tolist()
    for n in range(1, x.size):
        share = below[n - 1] / pivot[n - 1]
        pivot[n] -= share * above[n - 1]
        rest[n] -= share * rest[n - 1]
    slope[-1] = rest[-1] / pivot[-1]
    for n in range(x.size - 2, -1, -1):
        slope[n] = (rest[n] - above[n] * slope[n + 1]) / pivot[n]
    s = np.array(slope)
    bend = (s[:-1] + s[1:] - 2.0 * rise) / step
    return [y[:-1], s[:-1], (rise - s[:-1]) / step - bend, bend / step]

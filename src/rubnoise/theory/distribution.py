"""The whole distribution of stationary real contact area, with its atom at 0.

If at most two junctions are alive the density has a singular birth and cusps, and is summed by hand; all that is
smoother comes from the characteristic function, see `rubnoise.theory.inversion`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from math import exp

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.laws import Law
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.real_numbers import at_each, real_numbers
from rubnoise.tables import fields_as_text
from rubnoise.theory.inversion import NOTHING, Window, area_tails, windows
from rubnoise.theory.live_area import NODES, LiveArea, Piecewise, live_area, series
from rubnoise.theory.occupancy import mean_count
from rubnoise.theory.quadrature import panels
from rubnoise.theory.regular_births import need_random_births

_NODES = 24
_TOLERANCE = 1e-11
_LOOSER = 1e-8  # where a live area is likeliest at its peak: nearer to it, the density of a pair has fewer digits
_NARROWEST = 1e-9


@lru_cache(maxsize=32)
def pair_area(live: LiveArea) -> tuple[Piecewise, Piecewise]:
    """Return distribution function and density of the sum of two independent live areas, as functions of t = a^(1/3).

    From 0 to twice the largest area; within 1e-11 of their largest values, but for the density within 1e-9 of the
    largest area of equal sizes, where it has a cusp of power 2/3 (1e-6).
    """
    # Every second break is as close as this rule needs them.
    breaks = np.union1d([0.0, live.breaks[0]], live.breaks[::-2])
    edges = np.unique(np.cbrt(np.append(breaks, 2.0 * breaks)))
    return _adapted(lambda t: _pair(live, breaks, t**3), edges, _LOOSER if live.rise.infinite else _TOLERANCE)


def _pair(live: LiveArea, breaks: Doubles, area: Doubles) -> Doubles:
    """Return P(a + b <= x) and its derivative, two rows, for independent live areas a and b.

    P = G(x/2)^2 + 2 int_0^(x/2) (G(x - a) - G(x/2)) dG(a): the smaller of the two is below x/2, so that only it comes
    near the singular 0. Cut wherever one of them passes a break.
    """
    whole = area[:, None]
    cuts = np.concatenate([np.broadcast_to(breaks, (area.size, breaks.size)), whole - breaks], axis=1)
    cuts = np.cbrt(np.sort(np.clip(cuts, 0.0, 0.5 * whole), axis=1))
    row, column = np.nonzero(np.diff(cuts, axis=1))
    t, weights = panels(
        np.stack([cuts[row, column], cuts[row, column + 1]], axis=-1), _NODES, rooted=live.rise.infinite
    )
    other, weights = whole[row] - t**3, 2.0 * weights * live.rise(t)
    at_half = live.cdf(0.5 * area)
    parts = (live.cdf(other) - at_half[row, None], live.density(other))
    sums = [np.bincount(row, np.sum(weights * part, axis=1), area.size) for part in parts]
    return np.stack([np.square(at_half) + sums[0], sums[1]])


def _adapted(functions: Callable[[Doubles], Doubles], edges: Doubles, tolerance: float) -> tuple[Piecewise, Piecewise]:
    """Return two functions as series on panels, which are halved until the series have converged."""
    done: list[tuple[Doubles, Doubles]] = []
    largest = 0.0
    panel = np.stack([edges[:-1], edges[1:]], axis=-1)
    while panel.size:
        t, _ = panels(panel, NODES)
        values = functions(t.ravel()).reshape(2, *t.shape)
        found = series(values)
        largest = np.maximum(largest, np.max(np.abs(values), axis=(1, 2)))
        ready = np.all(np.max(np.abs(found[-3:]), axis=0) < tolerance * largest[:, None], axis=0)
        ready |= np.diff(panel, axis=1)[:, 0] < _NARROWEST * edges[-1]
        done.append((panel[ready, 0], found[:, :, ready]))
        middle = 0.5 * (panel[~ready, 0] + panel[~ready, 1])
        panel = np.stack([panel[~ready, 0], middle, middle, panel[~ready, 1]], axis=-1).reshape(-1, 2)
    starts, coefficients = (np.concatenate(parts, axis=-1) for parts in zip(*done, strict=True))
    order = np.argsort(starts)
    whole = np.append(starts[order], edges[-1])
    cdf, density = (Piecewise(edges=whole, coefficients=rows[:, order]) for rows in np.moveaxis(coefficients, 1, 0))
    return cdf, density


@dataclass(frozen=True, slots=True, kw_only=True)
class FewLive:
    """The contributions of none, one and two live junctions, whose number is Poisson with mean ``mean_count``."""

    mean_count: float
    live: LiveArea
    pair_cdf: Piecewise
    pair_density: Piecewise

    def cdf(self, area: Doubles) -> Doubles:
        """Return P(A_r <= a, N <= 2) at areas in um^2."""
        n, a = self.mean_count, np.maximum(area, 0.0)
        known = 1.0 + n * (self.live.cdf(a) + 0.5 * n * self.pair_cdf(np.cbrt(a)))
        return np.where(area < 0.0, 0.0, exp(-n) * known)

    def density(self, area: Doubles) -> Doubles:
        """Return the derivative of it in 1/um^2 at a > 0, and 0 for a <= 0."""
        n, a = self.mean_count, np.clip(area, 0.0, 2.0 * self.live.largest)
        pair = np.where(a == area, self.pair_density(np.cbrt(a)), 0.0)
        return np.where(area > 0.0, exp(-n) * n * (self.live.density(area) + 0.5 * n * pair), 0.0)


_NAME = "the distribution of real contact area"
_POINTS = 2049
_HIDDEN = 24.0  # -ln of the probability beyond either end of the grid
_HALVINGS = 100
_AT_ONCE = 65_536
_ANGLES_AT_ONCE = 2**20


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Distribution:
    """The law of A_r: an atom at 0, where no junction is alive, and a density beside it.

    ``area`` are places in um^2, evenly spaced over all of the law but 1e-10 (but for very long tails), for a curve. The
    distribution function is right to 1e-10 everywhere. The density is right to 1e-9 of 1/std, but within
    5 % of pi d^2/4 of 0, and of pi d^2/4 and its double if sizes are equal, to 1e-5 of it. Of parabolas of one size
    the two are right to 1e-8 and 1e-7: their density grows without bound towards pi d^2/4.
    """

    area: Doubles
    atom_at_zero: float
    few: FewLive | None = field(repr=False)
    windows: tuple[Window, ...] = field(repr=False)

    def __repr__(self) -> str:
        return fields_as_text(self)

    def cdf(self, area: ArrayLike) -> Doubles:
        """Return P(A_r <= a) at areas in um^2 of any shape: the atom at 0, 0 below it, 1 far out."""
        return self._everywhere(area, self._cdf, 1.0, (0.0, 1.0))

    def density(self, area: ArrayLike) -> Doubles:
        """Return the density in 1/um^2 at areas in um^2 of any shape; without the atom, and 0 for a <= 0.

        It grows without bound towards 0 if lens pulses are born, as a^(-1/3), and jumps at pi d^2/4 for one size d.
        """
        return self._everywhere(area, self._density, np.inf, (0.0, 0.0))

    def quantile(self, probability: ArrayLike) -> Doubles:
        """Return the least areas in um^2 with P(A_r <= a) >= p, for p in [0, 1] of any shape; inf for p = 1.

        0 up to the atom; by bisection to rounding. Raises Refused for a p that is not a probability.
        """
        p = real_numbers(probability, "probability", "1")
        if not np.all((p >= 0.0) & (p <= 1.0)):
            raise Refused("a quantile needs probabilities from 0 to 1")
        low, high = np.zeros_like(p), np.full_like(p, self.windows[-1].end)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            reached = self.cdf(middle) >= p
            low, high = np.where(reached, low, middle), np.where(reached, middle, high)
        return np.where(p <= self.atom_at_zero, 0.0, np.where(p < 1.0, high, np.inf))

    def _everywhere(
        self, area: ArrayLike, function: Callable[[Doubles], Doubles], most: float, limits: tuple[float, float]
    ) -> Doubles:
        """Return a function at areas of any shape, between its bounds; some at a time, to limit memory."""

        def found(areas: Doubles) -> Doubles:
            parts = np.array_split(areas.ravel(), 1 + areas.size // _AT_ONCE)
            values = np.concatenate([function(part) for part in parts]).reshape(areas.shape)
            return np.clip(values, 0.0, most)

        return at_each(found, real_numbers(area, "area", "um^2"), "area", limits)

    def _cdf(self, area: Doubles) -> Doubles:
        known = np.zeros_like(area) if self.few is None else self.few.cdf(area)
        result = np.where(area > self.windows[-1].end, 1.0, known)
        for window, rows in self._shares(area):
            result[rows] += window.at(area[rows], window.cdf)
        return result

    def _density(self, area: Doubles) -> Doubles:
        result = np.zeros_like(area) if self.few is None else self.few.density(area)
        for window, rows in self._shares(area):
            result[rows] += window.at(area[rows], window.density)
        return result

    def _shares(self, area: Doubles) -> list[tuple[Window, NDArray[np.bool_]]]:
        """Return each window with the rows of the areas that no earlier window has."""
        before = [self.windows[0].start, *(window.end for window in self.windows)]
        return [(w, (area > low) & (area <= w.end)) for low, w in zip(before, self.windows, strict=False)]


def distribution(model: Model) -> Distribution:
    """Return the distribution of stationary real contact area, in um^2 and 1/um^2.

    log E[exp(i th A_r)] = lam E[int (exp(i th A(s)) - 1) ds] = N (E[exp(i th a)] - 1), N the mean count and a the area
    of one live junction; the atom at 0 is exp(-N). None, one and two live junctions, which hold what is singular, are
    summed directly; the rest is inverted by fast transforms. Raises Refused for births that are not Poisson.
    Source: Rice (1944), section 1.5, doi:10.1002/j.1538-7305.1944.tb00874.x.
    """
    need_random_births(model, _NAME)
    return _distribution(model.sizes, model.pulse, mean_count(model))


def characteristic_function(model: Model, wavenumber: ArrayLike) -> Complexes:
    """Return E[exp(i th A_r)] at th in 1/um^2 of any shape; symbols, errors and source as `distribution`."""
    need_random_births(model, _NAME)
    theta = np.asarray(wavenumber, dtype=np.float64)
    area, probability = live_area(model.sizes, model.pulse).rule(float(np.max(np.abs(theta), initial=0.0)))
    parts = np.array_split(theta.ravel(), 1 + theta.size * area.size // _ANGLES_AT_ONCE)
    less_one = np.concatenate([np.expm1(np.multiply.outer(1j * part, area)) @ probability for part in parts])
    return np.exp(mean_count(model) * less_one).reshape(theta.shape)


@lru_cache(maxsize=16)
def _distribution(sizes: Law, pulse: Pulse, count: float) -> Distribution:
    live = live_area(sizes, pulse)
    tails = area_tails(live, count)
    few = None
    if tails.lower(NOTHING) == 0.0:
        cdf, density = pair_area(live)
        few = FewLive(mean_count=count, live=live, pair_cdf=cdf, pair_density=density)
    found = windows(live, count, tails, above_two=few is not None)
    area = np.linspace(tails.lower(_HIDDEN), min(tails.upper(_HIDDEN), found[:2][-1].end), _POINTS)
    return Distribution(area=area, atom_at_zero=exp(-count), few=few, windows=found)

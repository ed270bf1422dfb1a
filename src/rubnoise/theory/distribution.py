"""The whole distribution of stationary real contact area, with its atom at 0."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import lru_cache
from math import exp
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.area_tails import area_tails
from rubnoise.theory.few_live import FewLive, few_live
from rubnoise.theory.inversion import NOTHING, Window, windows
from rubnoise.theory.live_area import live_area
from rubnoise.theory.occupancy import mean_count
from rubnoise.theory.random_births import need_random_births

Doubles = NDArray[np.float64]
Complexes = NDArray[np.complex128]

_NAME = "the distribution of real contact area"
_POINTS = 2049
_HIDDEN = 24.0  # -ln of the probability beyond either end of the grid
_HALVINGS = 100
_AT_ONCE = 65_536
_ANGLES_AT_ONCE = 2**20


@dataclass(frozen=True, slots=True, kw_only=True)
class Distribution:
    """The law of A_r: an atom at 0, where no junction is alive, and a density beside it.

    ``area`` are places in um^2, evenly spaced over all of the law but 1e-10 (but for very long tails), for a curve. The
    distribution function is right to 1e-10 wherever it is asked for. The density is right to 1e-9 of 1/std, but within
    5 % of pi d^2/4 of 0, and of pi d^2/4 and its double where sizes are equal, to 1e-5 of it.
    """

    area: Doubles
    atom_at_zero: float
    few: FewLive | None
    windows: tuple[Window, ...]

    def cdf(self, area: ArrayLike) -> Doubles:
        """Return P(A_r <= a) at areas in um^2 of any shape: the atom at 0, 0 below it, 1 far out."""
        return self._everywhere(area, self._cdf, 1.0)

    def density(self, area: ArrayLike) -> Doubles:
        """Return the density in 1/um^2 at areas in um^2 of any shape; without the atom, and 0 for a <= 0.

        It grows without bound towards 0 where lens pulses are born, as a^(-1/3), and jumps at pi d^2/4 for one size d.
        """
        return self._everywhere(area, self._density, np.inf)

    def quantile(self, probability: ArrayLike) -> Doubles:
        """Return the least areas in um^2 with P(A_r <= a) >= p, for p in [0, 1] of any shape; inf for p = 1.

        0 up to the atom; by bisection to rounding. Raises Refused for a p that is no probability.
        """
        p = np.asarray(probability, dtype=np.float64)
        if not np.all((p >= 0.0) & (p <= 1.0)):
            raise Refused("a quantile needs probabilities from 0 to 1")
        low, high = np.zeros_like(p), np.full_like(p, self.windows[-1].end)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            reached = self.cdf(middle) >= p
            low, high = np.where(reached, low, middle), np.where(reached, middle, high)
        return np.where(p <= self.atom_at_zero, 0.0, np.where(p < 1.0, high, np.inf))

    def _everywhere(self, area: ArrayLike, function: Callable[[Doubles], Doubles], most: float) -> Doubles:
        """Return a function at areas of any shape, between its bounds; few at a time, for memory's sake."""
        areas = np.asarray(area, dtype=np.float64)
        parts = np.array_split(areas.ravel(), 1 + areas.size // _AT_ONCE)
        values = np.concatenate([function(part) for part in parts]).reshape(areas.shape)
        return np.where(np.isnan(areas), np.nan, np.clip(values, 0.0, most))

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
        """Return each window with the rows of the areas that it is the first to hold."""
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
    return _distribution(cast("Hashable", model.sizes), cast("Hashable", model.pulse), mean_count(model))


def characteristic_function(model: Model, wavenumber: ArrayLike) -> Complexes:
    """Return E[exp(i th A_r)] at th in 1/um^2 of any shape; symbols, errors and source as `distribution`."""
    need_random_births(model, _NAME)
    theta = np.asarray(wavenumber, dtype=np.float64)
    area, probability = live_area(model.sizes, model.pulse).rule(float(np.max(np.abs(theta), initial=0.0)))
    parts = np.array_split(theta.ravel(), 1 + theta.size * area.size // _ANGLES_AT_ONCE)
    less_one = np.concatenate([np.expm1(np.multiply.outer(1j * part, area)) @ probability for part in parts])
    return np.exp(mean_count(model) * less_one).reshape(theta.shape)


@lru_cache(maxsize=16)
def _distribution(sizes: Any, pulse: Any, count: float) -> Distribution:
    live = live_area(sizes, pulse)
    tails = area_tails(live, count)
    few = few_live(live, count) if tails.lower(NOTHING) == 0.0 else None
    found = windows(live, count, tails, above_two=few is not None)
    area = np.linspace(tails.lower(_HIDDEN), min(tails.upper(_HIDDEN), found[:2][-1].end), _POINTS)
    return Distribution(area=area, atom_at_zero=exp(-count), few=few, windows=found)

"""The whole distribution of stationary real contact area, with its atom at 0: one compound-Poisson transform."""

from dataclasses import dataclass, field
from functools import cache, lru_cache
from math import exp, pi

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.real_numbers import at_each, real_numbers
from rubnoise.tables import fields_as_text
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.second_order import need_random_births
from rubnoise.theory.sizes import Function, table_over_sizes

_POINTS, _PEAK = 1 << 17, 0.25 * pi  # of the grid; the largest area of a life of unit diameter
_BELOW, _ABOVE = 12.0, 12.0  # standard deviations kept, the second times the skewness too
_TILT, _SHOWN, _HIDDEN = 8.0, 2049, 1e-10


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Distribution:
    """The law of A_r: an atom at 0, where no junction is alive, and a density beside it.

    ``area`` are even places in um^2 for a curve. Error of the distribution function 1e-7, at a cusp (about two live
    junctions) 5e-6; of the density 3e-5 of its largest value, but 1e-4 next to 0 and a cusp.
    """

    area: Doubles
    atom_at_zero: float
    grid: Doubles = field(repr=False)
    grid_cdf: Doubles = field(repr=False)
    grid_density: Doubles = field(repr=False)

    __repr__ = fields_as_text

    def cdf(self, area: ArrayLike) -> Doubles:
        """Return P(A_r <= a) at areas in um^2 of any shape: the atom at 0, 0 below it, 1 far out."""
        return self._at(area, self.grid_cdf, -np.inf, 1.0)

    def density(self, area: ArrayLike) -> Doubles:
        """Return the density in 1/um^2 at areas in um^2 of any shape; without the atom, and 0 for a <= 0."""
        return self._at(area, self.grid_density, 0.0, 0.0)

    def _at(self, area: ArrayLike, values: Doubles, least: float, last: float) -> Doubles:
        def seen(a: Doubles) -> Doubles:
            return np.interp(np.where(a > least, a, -1.0), self.grid, values, left=0.0, right=last)

        return at_each(seen, real_numbers(area, "area", "um^2"), "area", (0.0, last))

    def quantile(self, probability: ArrayLike) -> Doubles:
        """Return the least areas in um^2 with P(A_r <= a) >= p, for p in [0, 1] of any shape, else Refused."""
        p = real_numbers(probability, "probability", "1")
        if not np.all((p >= 0.0) & (p <= 1.0)):
            raise Refused("a quantile needs probabilities from 0 to 1")
        found = np.interp(p, self.grid_cdf, self.grid)
        return np.where(p <= self.atom_at_zero, 0.0, np.where(p < 1.0, found, np.inf))


@lru_cache(maxsize=16)
def distribution(model: Model) -> Distribution:
    """Return the distribution of stationary real contact area, in um^2 and 1/um^2; Refused unless births are Poisson.

    A_r is the sum of a Poisson number, N in the mean, of live areas a = d^2 a(u), u uniform over the life and d
    length-biased: E[exp(i th A_r)] = exp(N (E[exp(i th a)] - 1)), by one transform. The atom at 0 is exp(-N).
    Source: Rice (1944), section 1.5, doi:10.1002/j.1538-7305.1944.tb00874.x.
    """
    need_random_births(model, "the distribution of real contact area")
    area, count = area_cumulants(model), model.mean_live_junctions
    start = max(area.mean - _BELOW * area.std, 0.0)
    top = area.mean + (_BELOW + _ABOVE * max(area.skewness, 0.3)) * area.std
    step, atom = (top - start) / _POINTS, exp(-count) if start == 0.0 else 0.0
    place = round(start / step) + np.arange(_POINTS)
    # A fading factor keeps what lies beyond the grid from coming back at its begin.
    fade = np.exp(-(_TILT if start == 0.0 else 0.0) / _POINTS * np.arange(_POINTS))
    live = _live_mass(model, step)
    if start > 0.0:
        # Few steps lie in one life of so many, so that what sharing adds is taken away, and its mean square made exact.
        live -= (np.roll(live, 1) - 2.0 * live + np.roll(live, -1)) / 12.0
        steps = np.append(np.arange(_POINTS - 1.0), -1.0)
        missing = area.variance / (count * step**2) - float(live @ np.square(steps))
        live[:3] += 0.5 * missing * np.array([1.0, -2.0, 1.0])
    mass = (np.fft.irfft(np.exp(count * (np.fft.rfft(live * fade) - 1.0)), _POINTS) / fade)[place % _POINTS]
    mass[0] -= atom
    cdf = np.cumsum(mass) - 0.5 * mass + atom
    cdf[0] = atom
    cdf = np.maximum.accumulate(np.clip(cdf, atom, 1.0))
    grid = step * place.astype(np.float64)
    shown = np.interp([_HIDDEN, 1.0 - _HIDDEN], cdf, grid)
    return Distribution(
        area=np.linspace(shown[0], shown[1], _SHOWN),
        atom_at_zero=exp(-count),
        grid=grid,
        grid_cdf=cdf,
        grid_density=np.maximum(mass / step, 0.0),
    )


def _live_mass(model: Model, step: float) -> Doubles:
    """Return the probabilities of one live area on an even grid; larger ones are left out.

    Each area is shared over two neighbours, by second differences of E[min(a, x)] = E[d^3 g(x/d^2)]/E[d], g that of a
    life of unit diameter: the mean is kept.
    """
    capped = table_over_sizes(model, _capped(model.pulse), 3)(np.sqrt(step / _PEAK * np.arange(_POINTS + 1)))
    capped = np.append(-step, capped / (model.birth_rate * model.sizes.moment(1)))
    return -np.diff(capped, 2) / step


@cache
def _capped(pulse: Pulse) -> Function:
    """Return g(peak s^2), which turns at s = 1 as a life of diameter s does."""
    even = np.linspace(0.0, 1.0, 4 * _POINTS)
    share = even**3 * (10.0 - even * (15.0 - 6.0 * even))  # closer at birth and at mid-life
    area = pulse.area(share, 1.0) if pulse.offset == "none" else pulse.overlap(np.sqrt(1.0 - share))
    below = np.cumsum(np.append(0.0, 0.5 * (area[1:] + area[:-1]) * np.diff(share)))
    mean = pulse.life_integral(1) / pulse.mean_life
    capped = (area * (1.0 - share) + below) * (mean / below[-1])
    return lambda s: np.interp(_PEAK * s * s, area, capped)

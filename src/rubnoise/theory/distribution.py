"""The whole distribution of stationary real contact area, with its atom at 0: one compound-Poisson transform."""

from dataclasses import dataclass, field
from functools import cache, lru_cache
from math import exp

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.contact.laws.discrete import has_single_values
from rubnoise.contact.off_centre import overlap
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.real_numbers import at_each, real_numbers
from rubnoise.tables import fields_as_text
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.live_count import mean_count
from rubnoise.theory.second_order import need_random_births
from rubnoise.theory.sizes import FINE, Spline, is_one_size, sizes_of

_POINTS = 1 << 17
_PLACES = 1 << 12
_BELOW, _ABOVE = 12.0, 16.0  # standard deviations kept, the second times the skewness too
_TILT, _BEFORE = 8.0, _POINTS // 64
_SHOWN, _HIDDEN = 2049, 1e-10


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Distribution:
    """The law of A_r: an atom at 0, where no junction is alive, and a density beside it.

    ``area`` are even places in um^2 for a curve. Error of the distribution function 1e-7, at a cusp (about two live
    junctions) 5e-6; of the density 1e-4 of its largest value but next to 0 and a cusp, of few parabolas of nearly equal
    sizes a tenth.
    """

    area: Doubles
    atom_at_zero: float
    grid: Doubles = field(repr=False)
    grid_cdf: Doubles = field(repr=False)
    grid_density: Doubles = field(repr=False)

    def __repr__(self) -> str:
        return fields_as_text(self)

    def cdf(self, area: ArrayLike) -> Doubles:
        """Return P(A_r <= a) at areas in um^2 of any shape: the atom at 0, 0 below it, 1 far out."""

        def found(a: Doubles) -> Doubles:
            return np.where(a < 0.0, 0.0, np.interp(a, self.grid, self.grid_cdf, left=0.0, right=1.0))

        return at_each(found, real_numbers(area, "area", "um^2"), "area", (0.0, 1.0))

    def density(self, area: ArrayLike) -> Doubles:
        """Return the density in 1/um^2 at areas in um^2 of any shape; without the atom, and 0 for a <= 0."""

        def found(a: Doubles) -> Doubles:
            return np.where(a <= 0.0, 0.0, np.interp(a, self.grid, self.grid_density, left=0.0, right=0.0))

        return at_each(found, real_numbers(area, "area", "um^2"), "area", (0.0, 0.0))

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
    area, count = area_cumulants(model), mean_count(model)
    start = max(area.mean - _BELOW * area.std, 0.0)
    top = area.mean + (_BELOW + _ABOVE * max(area.skewness, 0.3)) * area.std
    step, atom = (top - start) / _POINTS, exp(-count)
    # From before the start on, where sharpened cells ring; a fading factor keeps what lies beyond the grid from coming
    # back at its begin.
    place = round(start / step) - _BEFORE + np.arange(_POINTS)
    order = place % _POINTS
    fade = np.empty(_POINTS)
    fade[order] = np.exp(-(_TILT if start == 0.0 else 0.0) / _POINTS * place)
    live = _live_mass(model.sizes, model.pulse, step)
    if start > 0.0:
        # Few steps of the grid lie in one life of so many: its mean square is made exact, which the width needs.
        signed = (np.arange(_POINTS) + _POINTS // 2) % _POINTS - _POINTS // 2
        missing = area.variance / (count * step**2) - float(live @ np.square(signed.astype(np.float64)))
        live[:3] += 0.5 * missing * np.array([1.0, -2.0, 1.0])
    mass = (np.fft.irfft(np.exp(count * (np.fft.rfft(live * fade) - 1.0)), _POINTS) / fade)[order]
    if start == 0.0:
        mass[_BEFORE] -= atom
    cdf = np.cumsum(mass) - 0.5 * mass + (atom if start == 0.0 else 0.0)
    grid = np.asarray(step * place[_BEFORE:], dtype=np.float64)
    cdf, mass = cdf[_BEFORE:], mass[_BEFORE:]
    cdf[0] = atom if start == 0.0 else 0.0
    cdf = np.maximum.accumulate(np.clip(cdf, cdf[0], 1.0))
    shown = np.interp([_HIDDEN, 1.0 - _HIDDEN], cdf, grid)
    return Distribution(
        area=np.linspace(shown[0], shown[1], _SHOWN),
        atom_at_zero=atom,
        grid=grid,
        grid_cdf=cdf,
        grid_density=np.maximum(mass / step, 0.0),
    )


def _has_combs(law: Law, pulse: Pulse) -> bool:
    """Whether peaks of single sizes, without bound for a parabola, would show in the density of a law that has none."""
    return pulse.shape == "parabola" and pulse.offset == "none" and not is_one_size(law) and not has_single_values(law)


def _live_mass(law: Law, pulse: Pulse, step: float) -> Doubles:
    """Return the probabilities of one live area on an even grid, which wraps around at its end.

    Each area is shared over two neighbours, by second differences of int_0^x P(a <= y) dy, and sharpened by what that
    takes from a transform: a contact of 1e6 junctions keeps its width.
    """
    sizes = sizes_of(law, (4.0 if _has_combs(law, pulse) else 1.0) * FINE)
    share = sizes.probability * sizes.diameter / float(sizes.probability @ sizes.diameter)
    unit, square = _unit_area(pulse), np.square(sizes.diameter)
    cells = np.ceil(np.minimum(unit.x[-1] * square / step, 2.0 * _POINTS)).astype(np.int64)
    peak, places = np.minimum(step * cells / square, unit.x[-1]), step * np.arange(cells.max() + 3)
    # From its largest area on the integral of each size is straight; below it is that of unit diameter.
    beyond = (share, share * square * (unit(peak) - peak))
    slope, level = (np.cumsum(np.bincount(cells, each, places.size)) for each in beyond)
    below = np.asarray(slope * places + level, dtype=np.float64)
    for each in np.flatnonzero(cells > 1).tolist():
        inside = slice(cells[each])
        below[inside] += share[each] * square[each] * unit(places[inside] / square[each])
    mass = np.diff(np.append(0.0, below), 2) / step
    around = np.bincount(np.arange(mass.size) % _POINTS, mass, _POINTS)
    return np.fft.irfft(np.fft.rfft(around) / np.sinc(np.fft.rfftfreq(_POINTS)) ** 2, _POINTS)


@cache
def _unit_area(pulse: Pulse) -> Spline:
    """Return int_0^x P(a <= y) dy of unit diameter up to its largest area, x v - int_0^v a."""
    even = np.linspace(0.0, 1.0, _PLACES)
    share = even**3 * (10.0 - even * (15.0 - 6.0 * even))  # closer at birth and at mid-life
    slope = 30.0 * np.square(even * (1.0 - even))
    area = pulse.area(share, 1.0) if pulse.offset == "none" else overlap(np.sqrt(1.0 - share), pulse)
    grown = Spline(even, area * slope).antiderivative()(even)
    kept = np.append(np.diff(area) > 0.0, True)
    return Spline(area[kept], (area * share - grown)[kept])

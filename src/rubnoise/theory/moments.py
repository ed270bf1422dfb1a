"""The law of stationary area and force: cumulants by Campbell's theorem, the whole distribution, single junctions."""

from dataclasses import dataclass, field
from functools import cache, lru_cache
from math import exp, nan, pi, sqrt
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles, at_each, real_numbers
from rubnoise.contact.births import GammaBirths, PoissonBirths
from rubnoise.contact.distributions import Law
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.tables import fields_as_text
from rubnoise.theory import second_order
from rubnoise.theory.motion import FORCE, covariances, strengths_of
from rubnoise.theory.sizes import Function, over_sizes

ORDERS: Final = 6
_UNKNOWN = (nan,) * (ORDERS - 2)
_QUANTILES = 1 << 15
_CONSTANT = 1e-12  # spread over mean of a constant, as equal triangles are that are born at regular places
_POINTS, _PEAK = 1 << 17, 0.25 * pi  # of the grid; the largest area of a life of unit diameter
_BELOW, _ABOVE = 12.0, 12.0  # standard deviations kept, the second times the skewness too
_TILT, _SHOWN, _HIDDEN = 8.0, 2049, 1e-10


@dataclass(frozen=True, slots=True, kw_only=True)
class Cumulants:
    """The first six cumulants of a stationary quantity, each in its unit to the power of its order; nan: not known."""

    values: tuple[float, ...]

    @property
    def mean(self) -> float:
        """kappa_1."""
        return self.values[0]

    @property
    def variance(self) -> float:
        """kappa_2."""
        return self.values[1]

    @property
    def std(self) -> float:
        """sqrt(kappa_2)."""
        return sqrt(self.values[1])

    @property
    def skewness(self) -> float:
        """kappa_3 / kappa_2^1.5; nan of a constant, which has no shape."""
        return self.values[2] / self.std**3 if self.variance > 0.0 else nan

    @property
    def excess_kurtosis(self) -> float:
        """kappa_4 / kappa_2^2; nan of a constant."""
        return self.values[3] / self.variance**2 if self.variance > 0.0 else nan


def area_cumulants(model: Model) -> Cumulants:
    """Return the cumulants of stationary real contact area in um^(2n), n = 1 ... 6; see `shot_cumulants`."""
    return shot_cumulants(model, second_order.AREA_ITSELF)


def force_cumulants(model: Model) -> Cumulants:
    """Return the cumulants of stationary friction force in uN^n, n to 6, 2 under a load; Refused without a strength."""
    psi = strengths_of(model)
    if model.separation is None:
        return shot_cumulants(model, psi)
    return Cumulants(values=(psi.mean * model.stationary_mean_area, covariances(model)[FORCE, FORCE], *_UNKNOWN))


@lru_cache(maxsize=16)
def shot_cumulants(model: Model, strengths: Law) -> Cumulants:
    """Return the cumulants of psi A at constant separation: lam c_n m_(2n+1) E[psi^n] for Poisson births.

    lam is the birth rate, c_n d^(2n+1) the integral of A^n over a life, m_n = E[d^n]. Other births have the same mean,
    the variance R(0), and no known others. Source: as `second_order` (Rice 1944, section 1.5).
    """
    if second_order.are_at_random(model):
        lives = (model.pulse.life_integral(n) * model.sizes.moment(2 * n + 1) for n in range(1, ORDERS + 1))
        return Cumulants(values=tuple(strengths.moment(n) * model.birth_rate * life for n, life in enumerate(lives, 1)))
    noise = second_order.area_noise(model, strengths)
    variance = float(noise.covariance(0.0))
    return Cumulants(values=(noise.mean, variance if variance > (_CONSTANT * noise.mean) ** 2 else 0.0, *_UNKNOWN))


def count_variance(model: Model) -> float:
    """Return Var[N]: the mean for Poisson births; x (1 - x), x the fraction in the count of equal regular ones."""
    return float(second_order.count_noise(model).covariance(0.0))


def expected_junction_rows(model: Model) -> float:
    """Return the expected number of junctions in a record: the births, and those alive at a stationary start."""
    return model.birth_rate * model.distance + (model.mean_live_junctions if model.start == "stationary" else 0.0)


def zero_share(model: Model) -> tuple[float, float, float]:
    """Return mean, standard error and skewness of the share of ticks at which N = 0, over the model's stationary ticks.

    N is 0 with p = exp(-E[N]), and again tau later with r = p exp(C(tau)), C the covariance of N: covariance p (r - p).
    With n ticks h apart, S_i = sum_k>=1 k^i (r(k h) - p) and B = S_0 - p/2, the number of empty ticks has the third
    cumulant 6 n (p/6 + p B + p B^2 + p^2 (p/12 - S_1)), for long records. Raises Refused unless births are Poisson.
    Source: recurrent events (Feller, An Introduction to Probability Theory and Its Applications I, chapter XIII).
    """
    second_order.need_random_births(model, "the share of ticks without a junction")
    ticks, alive = model.tick_count + 1, model.mean_live_junctions
    lags, weights = second_order.lag_rule(model)
    empty = exp(-alive)
    excess = np.exp(second_order.count_noise(model).single(lags) - alive) - empty
    per_empty = float(weights @ excess)
    if empty * per_empty <= 0.0:
        return empty, 0.0, 0.0
    pairs = 0.5 * (ticks * per_empty - 1.0)
    first = 0.5 * ticks * float(weights @ (excess * lags)) / model.tick
    # Both the third cumulant and the variance over p: of a dense contact p^1.5 is below the smallest number.
    third = 6.0 * (1.0 / 6.0 + pairs + pairs**2 + empty * (empty / 12.0 - first))
    error = sqrt(empty * per_empty)
    return empty, error, third / (ticks**2 * per_empty * error)


def share_of(what: Literal["sizes", "lives", "gaps"], model: Model, edges: Doubles) -> Doubles | None:
    """Return the probability of a size, a life or a gap (None if not drawn singly) between edges in um, to 3e-5."""
    even = (np.arange(_QUANTILES) + 0.5) / _QUANTILES
    if what != "gaps":
        places = np.sort(model.sizes.quantile(even)) * (1.0 if what == "sizes" else 2.0)
    elif isinstance(model.births, GammaBirths | PoissonBirths):
        places = np.sort(model.births.gaps(even))
    else:
        return None
    if what == "lives" and model.pulse.offset != "none":
        return -np.diff([float(np.sqrt(np.clip(1.0 - (edge / places) ** 2, 0.0, None)).mean()) for edge in edges])
    return np.diff(np.searchsorted(places, edges) / _QUANTILES)


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

        return at_each(seen, area, "area", "um^2", (0.0, last))

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
    second_order.need_random_births(model, "the distribution of real contact area")
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
    """Return the probabilities of one live area on an even grid, each shared over two neighbours; the mean is kept."""
    # By second differences of E[min(a, x)] = E[d^3 g(x/d^2)]/E[d], g that of a life of unit diameter.
    capped = over_sizes(model, _capped(model.pulse), 3, np.sqrt(step / _PEAK * np.arange(_POINTS + 1)))
    capped = np.append(-step, capped / (model.birth_rate * model.sizes.moment(1)))
    return -np.diff(capped, 2) / step


@cache
def _capped(pulse: Pulse) -> Function:
    """Return g(peak s^2), which turns at s = 1 as a life of diameter s does."""
    even = np.linspace(0.0, 1.0, 4 * _POINTS)
    share = even**3 * (10.0 - even * (15.0 - 6.0 * even))  # closer at birth and at mid-life
    area = pulse.area(share if pulse.offset == "none" else 1.0 + np.sqrt(1.0 - share), 1.0)
    below = np.cumsum(np.append(0.0, 0.5 * (area[1:] + area[:-1]) * np.diff(share)))
    mean = pulse.life_integral(1) / pulse.mean_life
    capped = (area * (1.0 - share) + below) * (mean / below[-1])
    return lambda s: np.interp(_PEAK * s * s, area, capped)

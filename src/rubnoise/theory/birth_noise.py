"""The part of births that are neither random nor regular in covariances and higher cumulants of a contact.

Births of density S_N(k) make the spectrum lam E[|A^|^2] + (S_N - lam) |E[A^]|^2, A^ about the birth. The first part is
that of births at random; this file has the rest.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import comb, nan, pi

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import BirthLaw, ClusteredBirths, JitteredBirths, PoissonBirths, RegularBirths
from rubnoise.contact.laws import Law
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model
from rubnoise.theory.mean_life import ORDERS, area_by_age, cumulants_by_age
from rubnoise.theory.quadrature import is_one_size, longest_life, size_range
from rubnoise.theory.transform import mean_energy, mean_life_transform, mean_transform

_MOST, _MOST_OF_ONE_SIZE = 2**14, 2**17
_FAINT = 6.3  # widths times wavenumber at which exp(-(k j)^2) is 1e-17
_FINEST = 1e-9  # of a wavenumber's step: where transforms are taken for k = 0


def has_noise_of_its_own(model: Model) -> bool:
    """Whether births are neither a Poisson process nor regular."""
    return not isinstance(model.births, PoissonBirths | RegularBirths)


def excess_density(model: Model, wavenumber: Doubles, *, exact: bool = True) -> Doubles:
    """Return (S_N(k) - lam) |E[A^(k)]|^2 in um^4 per rad/um, lines apart; not ``exact``, of one size without swing.

    Source: Bartlett's spectrum of a point process whose points are marked independently (Daley and Vere-Jones 2003,
    section 8.2).
    """
    if is_one_size(model.sizes):
        energy = mean_energy(model.sizes, model.pulse, wavenumber, exact=exact)
    else:
        energy = np.square(np.abs(mean_transform(model.sizes, model.pulse, wavenumber)))
    return model.birth_rate * model.births.excess(wavenumber) * energy


@dataclass(frozen=True, slots=True, kw_only=True)
class Excess:
    """The part of births in a covariance, beside that of random births: (1/2 pi) int excess exp(i k tau) dk.

    It is a sum over evenly spaced wavenumbers, exact for lags below ``reach`` um, where the covariance ends, except for
    the part beyond the last wavenumber. ``power`` is that of each, doubled except for the first.
    """

    wavenumber: Doubles
    power: Doubles
    reach: float
    _spline: Callable[[Doubles], Doubles]

    def covariance(self, lag: Doubles) -> Doubles:
        """Return the part at lags >= 0 in um of any shape, 0 beyond its reach."""
        return np.where(lag < self.reach, self._spline(np.minimum(lag, self.reach)), 0.0)


def excess_of_area(model: Model) -> Excess:
    """Return the part of births in the covariance of real contact area, in um^4; error about 1e-9 of the variance."""
    return _excess(model.sizes, model.births, model.pulse)


def excess_of_count(model: Model) -> Excess:
    """Return the part of births in the covariance of the live count; error about 1e-6 of it, since a count jumps."""
    return _excess(model.sizes, model.births, None)


@lru_cache(maxsize=16)
def _excess(sizes: Law, births: BirthLaw, pulse: Pulse | None) -> Excess:
    """Return the excess of the area, or of the count if no pulse is given."""
    from scipy.interpolate import CubicSpline

    reach = 2.0 * size_range(sizes)[1] + births.memory
    modes = _MOST_OF_ONE_SIZE if is_one_size(sizes) else _MOST
    k = pi / reach * np.arange(modes + 1, dtype=np.float64)
    k[0] = _FINEST * k[1]
    transform = mean_transform(sizes, pulse, k) if pulse else mean_life_transform(sizes, k)
    density = (1.0 / births.mean) * births.excess(k) * np.square(np.abs(transform))
    lags = reach / modes * np.arange(modes + 1, dtype=np.float64)
    values = np.fft.irfft(density, 2 * modes)[: modes + 1] * modes / reach
    power = density / reach
    power[0] *= 0.5
    return Excess(wavenumber=k, power=power, reach=reach, _spline=CubicSpline(lags, values))


def cumulants(model: Model, at_random: tuple[float, ...], strength_moments: tuple[float, ...]) -> tuple[float, ...]:
    """Return the cumulants of order 1 to 6 of sum psi A over live junctions in (MPa um^2)^n.

    Those of births ``at_random`` are given. The second follows from the spectrum of births. Those of clusters are
    kappa_n = (lam/mu) int E[X(u)^n] du, X(u) the sum over a cluster at distance u, whose cumulants are mu g_j,
    g_j = E[(psi A)^j] by age convolved with the normal law of the offsets; error some 1e-6. Gamma and jittered births
    have no closed form beyond the second order: nan.
    Source: the probability generating functional of Neyman and Scott (1958), doi:10.1111/j.2517-6161.1958.tb00272.x.
    """
    mean, variance = at_random[:2]
    variance += strength_moments[1] ** 2 * float(excess_of_area(model).covariance(np.zeros(1))[0])
    variance += strength_moments[1] ** 2 * 2.0 * float(jittered_lines(model, of_count=False)[1].sum())
    if not isinstance(model.births, ClusteredBirths):
        return mean, variance, *(nan,) * (ORDERS - 2)
    return mean, variance, *_of_clusters(model, model.births, strength_moments)[2:]


@lru_cache(maxsize=8)
def jittered_lines(model: Model, *, of_count: bool) -> tuple[Doubles, Doubles]:
    """Return wavenumbers in rad/um and powers of the lines under jitter, down to 1e-17 of their power without it.

    As `rubnoise.theory.regular_births.spectral_lines`, times the line share of the law of births.
    """
    if not isinstance(model.births, JitteredBirths):
        return np.empty(0), np.empty(0)
    first = 2.0 * pi * model.birth_rate
    k = first * np.arange(1.0, min(_FAINT / (model.births.width * first), _MOST) + 1.0)
    return k, model.births.line_share(k) * line_power(model, k, of_count=of_count)


def line_power(model: Model, wavenumber: Doubles, *, of_count: bool) -> Doubles:
    """Return lam^2 |E[A^(k)]|^2 in um^4, or that of the live count: the power in lines at k, births regular."""
    sizes, pulse = model.sizes, model.pulse
    transform = mean_life_transform(sizes, wavenumber) if of_count else mean_transform(sizes, pulse, wavenumber)
    return np.square(model.birth_rate * np.abs(transform))


def _of_clusters(model: Model, births: ClusteredBirths, strength_moments: tuple[float, ...]) -> list[float]:
    longest = longest_life(model)
    period, points = longest + 20.0 * births.width, 2**15
    step = period / points
    ages = step * np.arange(points, dtype=np.float64)
    alive = ages < longest
    own = np.zeros((ORDERS, points))
    moments = area_by_age(model.sizes, model.pulse, np.maximum(ages[alive], 1e-12 * longest))
    own[:, alive] = raw_moments(cumulants_by_age(moments, strength_moments))[1:]
    spread = np.exp(-0.5 * np.square(2.0 * pi * np.fft.rfftfreq(points, step) * births.width))
    together = births.cluster_size * np.fft.irfft(np.fft.rfft(own) * spread, points)
    return (raw_moments(together)[1:].sum(axis=-1) * step * model.birth_rate / births.cluster_size).tolist()


def raw_moments(cumulants_: Doubles) -> Doubles:
    """Return the raw moments of order 0 to 6, the first axis, that belong to cumulants of order 1 to 6."""
    rows = [np.ones_like(cumulants_[0])]
    for n in range(1, ORDERS + 1):
        terms = (comb(n - 1, i) * cumulants_[i] * rows[n - 1 - i] for i in range(n))
        rows.append(sum(terms, np.zeros_like(rows[0])))
    return np.array(rows)

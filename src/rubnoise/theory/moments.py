"""Moments: cumulants of real contact area and friction force by Campbell's theorem, and laws of single junctions.

The live count is a queue with infinitely many servers: its mean is that of a model, its covariances are in
`second_order`.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import exp, nan, sqrt
from typing import Final, Literal

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import GammaBirths, PoissonBirths
from rubnoise.contact.distributions import Law
from rubnoise.model import Model
from rubnoise.theory.motion import FORCE, covariances, strengths_of
from rubnoise.theory.second_order import (
    AREA_ITSELF,
    are_at_random,
    area_noise,
    count_noise,
    lag_rule,
    need_random_births,
)

ORDERS: Final = 6
_UNKNOWN = (nan,) * (ORDERS - 2)
_QUANTILES = 1 << 15
_CONSTANT = 1e-12  # spread over mean of a constant, as equal triangles are that are born at regular places


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
    return shot_cumulants(model, AREA_ITSELF)


def force_cumulants(model: Model) -> Cumulants:
    """Return the cumulants of stationary friction force in uN^n, n = 1 ... 6; see `shot_cumulants`.

    Under a load that weighs no more than two are known. Raises Refused without a strength.
    """
    psi = strengths_of(model)
    if model.separation is None:
        return shot_cumulants(model, psi)
    return Cumulants(values=(psi.mean * model.stationary_mean_area, covariances(model)[FORCE, FORCE], *_UNKNOWN))


@lru_cache(maxsize=16)
def shot_cumulants(model: Model, strengths: Law) -> Cumulants:
    """Return the cumulants of psi A at constant separation: lam c_n m_(2n+1) E[psi^n] for Poisson births.

    lam is the birth rate, c_n d^(2n+1) the integral of A^n over a life, m_n = E[d^n]. Other births have the same mean,
    the variance R(0), and no known others. Source: Campbell's theorem (Rice 1944, section 1.5,
    doi:10.1002/j.1538-7305.1944.tb00874.x).
    """
    if are_at_random(model):
        lives = (model.pulse.life_integral(n) * model.sizes.moment(2 * n + 1) for n in range(1, ORDERS + 1))
        return Cumulants(values=tuple(strengths.moment(n) * model.birth_rate * life for n, life in enumerate(lives, 1)))
    noise = area_noise(model, strengths)
    variance = float(noise.covariance(0.0))
    return Cumulants(values=(noise.mean, variance if variance > (_CONSTANT * noise.mean) ** 2 else 0.0, *_UNKNOWN))


def count_variance(model: Model) -> float:
    """Return Var[N]: the mean for Poisson births; x (1 - x), x the fraction in the count of equal regular ones."""
    return model.mean_live_junctions if are_at_random(model) else float(count_noise(model).covariance(0.0))


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
    need_random_births(model, "the share of ticks without a junction")
    ticks, alive = model.tick_count + 1, model.mean_live_junctions
    lags, weights = lag_rule(model)
    empty = exp(-alive)
    excess = np.exp(count_noise(model).single(lags) - alive) - empty
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
    """Return the probability that a size, a life or a gap of births is in each bin between edges in um, to 3e-5.

    None of gaps that are not drawn one by one, or equal.
    """
    even = (np.arange(_QUANTILES) + 0.5) / _QUANTILES
    if what == "gaps":
        if not isinstance(model.births, GammaBirths | PoissonBirths):
            return None
        places = np.sort(model.births.gaps(even))
    else:
        places = np.sort(model.sizes.quantile(even)) * (1.0 if what == "sizes" else 2.0)
    if what == "lives" and model.pulse.offset != "none":
        return -np.diff([float(np.sqrt(np.clip(1.0 - (edge / places) ** 2, 0.0, None)).mean()) for edge in edges])
    return np.diff(np.searchsorted(places, edges) / _QUANTILES)

"""Campbell's theorem: the exact cumulants of real contact area and friction force."""

from dataclasses import dataclass
from functools import lru_cache
from math import nan, sqrt
from typing import Final

from rubnoise.contact.laws import Law
from rubnoise.model import Model
from rubnoise.theory.motion import FORCE, covariances, strengths_of
from rubnoise.theory.second_order import AREA_ITSELF, are_at_random, area_noise

ORDERS: Final = 6
_UNKNOWN = (nan,) * (ORDERS - 2)
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
    return Cumulants(values=(psi.mean * model.stationary_mean_area, covariances(model).of(FORCE), *_UNKNOWN))


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

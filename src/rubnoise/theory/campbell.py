"""Campbell's theorem: the exact cumulants of real contact area and friction force."""

from dataclasses import dataclass
from functools import lru_cache
from math import nan, sqrt

from rubnoise.contact.laws import Law
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory import birth_noise
from rubnoise.theory.birth_noise import has_noise_of_its_own
from rubnoise.theory.mean_life import ORDERS
from rubnoise.theory.regular_births import are_at_random, regular_cumulants
from rubnoise.theory.response import force_variance


@dataclass(frozen=True, slots=True, kw_only=True)
class Cumulants:
    """The first six cumulants of a stationary quantity, each in its unit to the power of its order."""

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
    """Return the cumulants of stationary real contact area in um^(2n), n = 1 ... 6.

    kappa_n = lam c_n m_(2n+1) for Poisson births: lam is the birth rate, c_n d^(2n+1) the integral of A^n over a life,
    m_n = E[d^n]. Regular births have the same mean, and the rest from the law of total cumulance over their phase;
    others have the variance that `rubnoise.theory.birth_noise` adds, and clusters the rest. No closed form is nan.
    Source: Campbell's theorem (Rice 1944, section 1.5, doi:10.1002/j.1538-7305.1944.tb00874.x) for the model's pulse,
    such as that of paper Eq. (2).
    """
    return _cumulants(model, (1.0,) * (ORDERS + 1))


def force_cumulants(model: Model) -> Cumulants:
    """Return the cumulants of stationary friction force in uN^n, n = 1 ... 6.

    kappa_n = lam c_n m_(2n+1) E[psi^n] for Poisson births; strengths psi (MPa) are independent of sizes. Raises Refused
    without a strength. Under a load that weighs the variance is that of `force_variance`, and higher ones are nan: they
    are not known. Source: as `area_cumulants`, for the pulse psi A of paper Eq. (1).
    """
    psi = strengths_of(model)
    if model.separation is not None:
        return Cumulants(values=(psi.moment(1) * model.stationary_mean_area, force_variance(model), *[nan] * 4))
    return _cumulants(model, tuple(psi.moment(n) for n in range(ORDERS + 1)))


def strengths_of(model: Model) -> Law:
    """Return the law of shear strengths; raises Refused without one."""
    if model.strengths is None:
        raise Refused("the friction force needs a shear strength ([strength])")
    return model.strengths


@lru_cache(maxsize=16)
def _cumulants(model: Model, strength_moments: tuple[float, ...]) -> Cumulants:
    at_random = are_at_random(model)
    if not (at_random or has_noise_of_its_own(model)):
        return Cumulants(values=regular_cumulants(model, strength_moments))
    values = tuple(
        strength_moments[n] * (model.birth_rate * model.pulse.life_integral(n) * model.sizes.moment(2 * n + 1))
        for n in range(1, ORDERS + 1)
    )
    return Cumulants(values=values if at_random else birth_noise.cumulants(model, values, strength_moments))

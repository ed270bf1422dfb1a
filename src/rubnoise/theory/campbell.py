"""Campbell's theorem: the exact cumulants of real contact area and friction force."""

from dataclasses import dataclass
from math import sqrt

from rubnoise.errors import Refused
from rubnoise.model import Model


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
        """kappa_3 / kappa_2^1.5."""
        return self.values[2] / self.std**3

    @property
    def excess_kurtosis(self) -> float:
        """kappa_4 / kappa_2^2."""
        return self.values[3] / self.variance**2


def area_cumulants(model: Model) -> Cumulants:
    """Return the cumulants of stationary real contact area, kappa_n = lam c_n m_(2n+1) in um^(2n), n = 1 ... 6.

    lam is the birth rate, c_n d^(2n+1) the integral of A^n over a life, m_n = E[d^n]. Source: Campbell's theorem
    (Rice 1944, section 1.5, doi:10.1002/j.1538-7305.1944.tb00874.x) for the model's pulse, paper Eq. (2) or a triangle.
    """
    return Cumulants(values=tuple(_area_cumulant(model, order) for order in range(1, 7)))


def force_cumulants(model: Model) -> Cumulants:
    """Return the cumulants of stationary friction force, kappa_n = lam c_n m_(2n+1) E[psi^n] in uN^n, n = 1 ... 6.

    Strengths psi (MPa) are independent of sizes. Raises Refused without a strength. Source: as `area_cumulants`, for
    the pulse psi A of paper Eq. (1).
    """
    if model.strengths is None:
        raise Refused("the friction force needs a shear strength ([strength])")
    strengths = model.strengths
    return Cumulants(values=tuple(_area_cumulant(model, n) * strengths.moment(n) for n in range(1, 7)))


def _area_cumulant(model: Model, order: int) -> float:
    return model.birth_rate * model.pulse.life_integral(order) * model.sizes.moment(2 * order + 1)

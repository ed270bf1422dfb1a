"""Standard errors of what a finite record of real contact area or friction force shows, from the theory alone."""

from dataclasses import dataclass
from itertools import product
from math import comb, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.theory.campbell import Cumulants, area_cumulants, force_cumulants, strengths_of
from rubnoise.theory.correlation import Powers, joint_cumulants, unphased_covariance
from rubnoise.theory.lags import lag_rule
from rubnoise.theory.regular_births import need_random_births, resolved_error, spectral_lines, variance_of_line_mean

_ORDER = 4
_SIZES = 12  # an error of an error: seven digits are plenty


@dataclass(frozen=True, slots=True, kw_only=True)
class StandardErrors:
    """Standard errors of the moments of one record: mean and std in the quantity's unit, the others plain numbers."""

    mean: float
    std: float
    skewness: float
    excess_kurtosis: float


def variance_of_time_mean(model: Model, distance: float | None = None) -> float:
    """Return the variance in um^4 of the mean of A_r over a stationary record of T um, exact for every length.

    Over ``distance`` um, Var = (2/T^2) int_0^T (T - tau) R(tau) dtau, which tends to S(0)/T; without a distance, over
    the model's ticks. Regular births leave what `variance_of_line_mean` says.
    Source: Papoulis, Probability, Random Variables and Stochastic Processes, section 12-1.
    """
    return _variance_of_mean(model, distance, 1.0, 1.0)


def mean_area_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in um^2 of the mean of A_r over a stationary record, exact for every length.

    The root of `variance_of_time_mean`, and 0 below 1e-12 of the mean, where rounding decides.
    """
    return resolved_error(variance_of_time_mean(model, distance), area_cumulants(model).mean)


def variance_of_mean_force(model: Model, distance: float | None = None) -> float:
    """Return the variance in uN^2 of the mean friction force over a stationary record, exact for every length.

    Over ``distance`` um or the model's ticks, for strengths psi independent of sizes: E[psi^2] goes with what each
    junction brings, E[psi]^2 with what they bring on average. Under a load that weighs, of the deviations of strengths
    alone. Raises Refused without a strength.
    """
    psi = strengths_of(model)
    if model.separation is not None:
        return _variance_of_mean(model, distance, max(psi.moment(2) - psi.mean**2, 0.0), 0.0)
    return _variance_of_mean(model, distance, psi.moment(2), psi.mean**2)


def standard_errors(model: Model, distance: float | None = None) -> StandardErrors:
    """Return the standard errors of mean, std, skewness and excess kurtosis of A_r over a stationary record.

    The record is continuous over ``distance`` um or, without one, the model's ticks. The mean's is exact; the others
    are of first order in life/distance (trust them from some 100 lives on), as are the moments' biases that they leave
    out. Each estimate moves with the mean over the record of a polynomial f in z = (A_r - mean)/std, its influence
    function: (z^2 - 1)/2 times std; z^3 - g - 3z - (3/2) g (z^2 - 1); z^4 - b - 4 g z - 2 b (z^2 - 1), g the skewness
    and b the kurtosis; and Var = sum over lags of weight times Cov[f(0), f(tau)], from the joint cumulants of A_r(s)
    and A_r(s + tau). Raises Refused unless births are a Poisson process.
    Source: Hampel (1974), doi:10.1080/01621459.1974.10482962, with shot-noise cumulants.
    """
    return _standard_errors(model, distance, area_cumulants(model), (1.0,) * (2 * _ORDER + 1))


def force_standard_errors(model: Model, distance: float | None = None) -> StandardErrors:
    """Return the standard errors of mean, std, skewness and excess kurtosis of friction force, as `standard_errors`.

    The joint cumulants of psi A gain E[psi^(i + j)]. Raises Refused without a strength and for births not at random.
    """
    cumulants, psi = force_cumulants(model), strengths_of(model)
    return _standard_errors(model, distance, cumulants, tuple(psi.moment(n) for n in range(2 * _ORDER + 1)))


def _variance_of_mean(model: Model, distance: float | None, square: float, squared_mean: float) -> float:
    lags, weights = lag_rule(model, distance)
    variance = float(weights @ unphased_covariance(model, lags, square, squared_mean))
    return variance + squared_mean * variance_of_line_mean(model, spectral_lines(model), distance)


def _standard_errors(
    model: Model, distance: float | None, cumulants: Cumulants, strength_moments: tuple[float, ...]
) -> StandardErrors:
    need_random_births(model, "the standard error of a moment")
    lags, weights = lag_rule(model, distance)
    powers: tuple[Powers, ...] = tuple((i, j) for i in range(1, _ORDER + 1) for j in range(i, _ORDER + 1))
    joint = joint_cumulants(model, lags, powers, sizes=_SIZES)
    joint = {(i, j): strength_moments[i + j] * values for (i, j), values in joint.items()}
    covariances = np.tensordot(_moment_covariances(cumulants, joint), weights, axes=1)
    mean, std, skewness, kurtosis = (sqrt(float(f @ covariances @ f)) for f in _influence(cumulants))
    return StandardErrors(
        mean=mean * cumulants.std, std=std * cumulants.std, skewness=skewness, excess_kurtosis=kurtosis
    )


def _influence(cumulants: Cumulants) -> tuple[Doubles, ...]:
    """Return the coefficients of z, z^2, z^3, z^4 in the influence functions of the four moments."""
    g, b = cumulants.skewness, cumulants.excess_kurtosis + 3.0
    rows = ([1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [-3.0, -1.5 * g, 1.0, 0.0], [-4.0 * g, -2.0 * b, 0.0, 1.0])
    return tuple(np.array(row) for row in rows)


def _moment_covariances(cumulants: Cumulants, joint: dict[Powers, Doubles]) -> Doubles:
    """Return Cov[z(0)^i, z(tau)^j] for i, j = 1 ... 4, a last axis of lags, for z = (A_r - mean)/std."""
    scaled = {(i, j): k / cumulants.std ** (i + j) for (i, j), k in joint.items()}
    scaled |= {(j, i): k for (i, j), k in scaled.items()}
    lags = next(iter(scaled.values()))
    for order in range(1, _ORDER + 1):
        value = cumulants.values[order - 1] / cumulants.std**order if order > 1 else 0.0
        scaled[order, 0] = scaled[0, order] = np.full_like(lags, value)
    moments = _joint_moments(scaled)
    orders = range(1, _ORDER + 1)
    return np.array([[moments[i, j] - moments[i, 0] * moments[0, j] for j in orders] for i in orders])


def _joint_moments(cumulants: dict[Powers, Doubles]) -> dict[Powers, Doubles]:
    """Return E[x^i y^j] up to i = j = 4 from the joint cumulants kappa_ij.

    E[x^(i+1) y^j] = sum over a <= i, b <= j of C(i, a) C(j, b) kappa_(a+1, b) E[x^(i-a) y^(j-b)], and likewise in y
    (Smith 1995, doi:10.1080/00031305.1995.10476146).
    """
    none = np.zeros_like(cumulants[1, 1])
    moments: dict[Powers, Doubles] = {(0, 0): none + 1.0}
    for i, j in product(range(_ORDER + 1), repeat=2):
        if i:
            terms = ((a, b, comb(i - 1, a) * comb(j, b)) for a in range(i) for b in range(j + 1))
            moments[i, j] = sum((c * cumulants[a + 1, b] * moments[i - 1 - a, j - b] for a, b, c in terms), none)
        elif j:
            lower = (comb(j - 1, b) * cumulants[0, b + 1] * moments[0, j - 1 - b] for b in range(j))
            moments[0, j] = sum(lower, none)
    return moments

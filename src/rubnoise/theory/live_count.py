"""The live count, a queue with infinitely many servers, and laws of single junctions."""

from dataclasses import dataclass
from math import exp, sqrt

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.births import BirthLaw, GammaBirths, PoissonBirths
from rubnoise.model import Model
from rubnoise.theory.second_order import are_at_random, count_noise, lag_rule, need_random_births

_QUANTILES = 1 << 15  # sizes at even probabilities over which a share of births is right to 3e-5


def mean_count(model: Model) -> float:
    """Return E[N] = lam 2 m_1, (pi/2) m_1 off the centre line (Little's law); of Poisson births N is Poisson."""
    return model.mean_live_junctions


def length_biased_mean_diameter(model: Model) -> float:
    """Return the mean diameter in um of a junction found alive, m_2/m_1: its density is d f(d) / m_1."""
    return model.sizes.moment(2) / model.sizes.moment(1)


def count_covariance(model: Model, lag: ArrayLike) -> Doubles:
    """Return Cov[N(s), N(s + tau)] for lags tau in um (any shape): lam E[(life - |tau|)+] for Poisson births."""
    return count_noise(model).covariance(lag)


def count_variance(model: Model) -> float:
    """Return Var[N]: the mean for Poisson births; x (1 - x), x the fraction in the count of equal regular ones."""
    return mean_count(model) if are_at_random(model) else float(count_covariance(model, 0.0))


def expected_junction_rows(model: Model) -> float:
    """Return the expected number of junctions in a record: the births, and those alive at a stationary start."""
    return model.birth_rate * model.distance + (mean_count(model) if model.start == "stationary" else 0.0)


def mean_count_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error of the mean of N over ``distance`` um or the model's ticks, the start stationary."""
    return count_noise(model).error_of_mean(distance)


@dataclass(frozen=True, slots=True)
class ZeroShare:
    """The share of a record's ticks at which no junction is alive: expected value, standard error and skewness."""

    expected: float
    standard_error: float
    skewness: float


def zero_share(model: Model) -> ZeroShare:
    """Return the law of the share of ticks at which N = 0, over the model's ticks as a stationary record.

    N is 0 with p = exp(-E[N]), and again tau later with r = p exp(C(tau)), C the covariance of N: covariance p (r - p).
    With n ticks h apart, S_i = sum_k>=1 k^i (r(k h) - p) and B = S_0 - p/2, the number of empty ticks has the third
    cumulant 6 n (p/6 + p B + p B^2 + p^2 (p/12 - S_1)), for long records. Raises Refused unless births are Poisson.
    Source: recurrent events (Feller, An Introduction to Probability Theory and Its Applications I, chapter XIII).
    """
    need_random_births(model, "the share of ticks without a junction")
    ticks, alive = model.tick_count + 1, mean_count(model)
    lags, weights = lag_rule(model)
    empty = exp(-alive)
    excess = np.exp(count_noise(model).single(lags) - alive) - empty
    per_empty = float(weights @ excess)
    if empty * per_empty <= 0.0:
        return ZeroShare(empty, 0.0, 0.0)
    pairs = 0.5 * (ticks * per_empty - 1.0)
    first = 0.5 * ticks * float(weights @ (excess * lags)) / model.tick
    # Both the third cumulant and the variance over p: of a dense contact p^1.5 is below the smallest number.
    third = 6.0 * (1.0 / 6.0 + pairs + pairs**2 + empty * (empty / 12.0 - first))
    error = sqrt(empty * per_empty)
    return ZeroShare(empty, error, third / (ticks**2 * per_empty * error))


def share_of_sizes(model: Model, edges: Doubles) -> Doubles:
    """Return the probability that a junction is born with a diameter in each bin between edges in um."""
    return np.diff(np.searchsorted(_quantiles(model), edges) / _QUANTILES)


def share_of_lives(model: Model, edges: Doubles) -> Doubles:
    """Return the probability that the length of a life is in each bin between edges in um."""
    longest = 2.0 * _quantiles(model)
    if model.pulse.offset == "none":
        return np.diff(np.searchsorted(longest, edges) / _QUANTILES)
    return -np.diff([float(np.sqrt(np.clip(1.0 - (edge / longest) ** 2, 0.0, None)).mean()) for edge in edges])


def _quantiles(model: Model) -> Doubles:
    """Return diameters in um at even probabilities, in ascending order."""
    return np.sort(model.sizes.draw((np.arange(_QUANTILES) + 0.5) / _QUANTILES))


def share_of_gaps(births: BirthLaw, edges: Doubles) -> Doubles | None:
    """Return the probability that a gap is in each bin between edges in um; None if the law has no closed form."""
    from scipy.special import gammainc

    if not isinstance(births, GammaBirths | PoissonBirths):
        return None
    shape = births.shape if isinstance(births, GammaBirths) else 1.0
    return np.asarray(np.diff(gammainc(shape, shape * np.maximum(edges, 0.0) / births.mean)), dtype=np.float64)

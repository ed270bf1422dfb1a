"""The live count, a queue with infinitely many servers; and count and area after an empty start."""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, sqrt

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model
from rubnoise.theory import off_centre
from rubnoise.theory.birth_noise import excess_of_count, has_noise_of_its_own
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.correlation import lag_edges, lag_rule
from rubnoise.theory.quadrature import cut_size_rule, longest_life, panels
from rubnoise.theory.regular_births import (
    are_at_random,
    count_lines,
    line_covariance,
    need_random_births,
    phased_count_covariance,
    resolved_error,
    unphased_count_covariance,
    variance_of_line_mean,
)

_NODES = 24


@dataclass(frozen=True, slots=True, kw_only=True)
class ZeroShare:
    """The share of a record's ticks at which no junction is alive: expected value, standard error and skewness."""

    expected: float
    standard_error: float
    skewness: float


def mean_count(model: Model) -> float:
    """Return E[N] = lam 2 m_1 (Little's law); Poisson births have a Poisson number alive (M/G/infinity queue).

    Lives off the centre line last (pi/2) d on average, not 2d.
    """
    return model.birth_rate * model.pulse.mean_life * model.sizes.moment(1)


def length_biased_mean_diameter(model: Model) -> float:
    """Return the mean diameter in um of a junction found alive, m_2/m_1: its density is d f(d) / m_1."""
    return model.sizes.moment(2) / model.sizes.moment(1)


def count_covariance(model: Model, lag: ArrayLike) -> Doubles:
    """Return Cov[N(s), N(s + tau)] for lags tau in um (any shape): lam E[(2d - |tau|)+] for Poisson births.

    Regular births: less the part of each junction that the phase determines, plus that of all of them; see
    `rubnoise.theory.regular_births`.
    """
    reach = np.abs(np.asarray(lag, dtype=np.float64))
    if are_at_random(model):
        return _lives_left(model, reach)
    if has_noise_of_its_own(model):
        return _unphased(model, reach) + line_covariance(count_lines(model), reach)
    return unphased_count_covariance(model, reach) + phased_count_covariance(model, reach)


def count_variance(model: Model) -> float:
    """Return Var[N]: the mean for Poisson births; x (1 - x), x the fraction in the count of equal regular ones."""
    return mean_count(model) if are_at_random(model) else float(count_covariance(model, 0.0))


def count_from_empty(model: Model, distance: ArrayLike) -> Doubles:
    """Return E[N(s)] = lam E[min(s, life)] at distances s in um (any shape) after an empty start; 0 before it."""
    s = np.maximum(np.asarray(distance, dtype=np.float64), 0.0)[..., None]
    diameters, probabilities = cut_size_rule(model.sizes, 0.5 * s, _NODES)
    lived = diameters * (model.pulse.mean_life - model.pulse.lives_left(s / diameters))
    return model.birth_rate * np.sum(probabilities * lived, axis=-1)


def expected_births(model: Model) -> float:
    """Return lam T, the expected number of births while sliding the model's distance T (um)."""
    return model.birth_rate * model.distance


def expected_junction_rows(model: Model) -> float:
    """Return the expected number of junctions in a record: the births, and those alive at a stationary start."""
    alive = mean_count(model) if model.start == "stationary" else 0.0
    return alive + expected_births(model)


def mean_count_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error of the mean of N over a stationary record; 0 below 1e-12 of the mean, by rounding.

    Over ``distance`` um, or over the model's ticks: Var = (2/T^2) int_0^T (T - tau) Cov[N(0), N(tau)] dtau, plus
    the lines of regular births (to 1e-4 if ticks always meet the same phases, since a count jumps).
    """
    lags, weights = lag_rule(model, distance)
    if are_at_random(model):
        return sqrt(float(weights @ _lives_left(model, lags)))
    variance = float(weights @ _unphased(model, lags))
    variance += variance_of_line_mean(model, count_lines(model), distance)
    return resolved_error(variance, mean_count(model))


def zero_share(model: Model) -> ZeroShare:
    """Return the law of the share of ticks at which N = 0, over the model's ticks as a stationary record.

    N is 0 with p = exp(-2 lam m_1), and again a lag tau later with r(tau) = p exp(C), C = lam E[(2d - tau)+]: no birth
    fell into the union of two windows of 2d. So Cov[1{N(0) = 0}, 1{N(tau) = 0}] = p (r(tau) - p), exact for every
    length. An empty contact does not remember what came before: three ticks are empty with p r(tau_1) r(tau_2). With n
    ticks h apart, S_i = sum over k >= 1 of k^i (r(k h) - p) and B = S_0 - p/2, the number of empty ticks has the third
    cumulant 6 n (p/6 + p B + p B^2 + p^2 (p/12 - S_1)), for long records. Raises Refused unless births are Poisson.
    Source: empty ticks are recurrent events, whose number has its cumulants from their generating function (Feller, An
    Introduction to Probability Theory and Its Applications I, chapter XIII).
    """
    need_random_births(model, "the share of ticks without a junction")
    ticks, alive = model.tick_count + 1, mean_count(model)
    lags, weights = lag_rule(model)
    empty = exp(-alive)
    excess = np.exp(_lives_left(model, lags) - alive) - empty
    per_empty = float(weights @ excess)
    if empty * per_empty <= 0.0:
        return ZeroShare(expected=empty, standard_error=0.0, skewness=0.0)
    pairs = 0.5 * (ticks * float(weights @ excess) - 1.0)
    first = 0.5 * ticks * float(weights @ (excess * lags)) / model.tick
    # Both the third cumulant and the variance over p: of a dense contact p^1.5 is below the smallest number.
    third = 6.0 * (1.0 / 6.0 + pairs + pairs**2 + empty * (empty / 12.0 - first))
    error = sqrt(empty * per_empty)
    return ZeroShare(expected=empty, standard_error=error, skewness=third / (ticks**2 * per_empty * error))


def _unphased(model: Model, lag: Doubles) -> Doubles:
    """Return the covariance of the count without lines."""
    if has_noise_of_its_own(model):
        return _lives_left(model, lag) + excess_of_count(model).covariance(lag)
    return unphased_count_covariance(model, lag)


def _lives_left(model: Model, lag: Doubles) -> Doubles:
    """Return lam E[(life - tau)+]."""
    reach = lag[..., None]
    diameters, probabilities = cut_size_rule(model.sizes, 0.5 * reach, _NODES)
    return model.birth_rate * np.sum(probabilities * diameters * model.pulse.lives_left(reach / diameters), axis=-1)


_EMPTY_NODES = 24
_GROWTH_NODES = 16


def area_from_empty(model: Model, distance: ArrayLike) -> Doubles:
    """Return E[A_r(s)] = lam E[int_0^s A ds'] in um^2 at distances s in um (any shape) after an empty start.

    Source: Campbell's theorem for births since s = 0 alone (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x); it is
    the stationary mean from the longest life on.
    """
    s = np.asarray(distance, dtype=np.float64)[..., None]
    # Cut where a junction ends (d = s/2) and where it is at mid-life (d = s), so that each part is smooth in d.
    diameters, probabilities = cut_size_rule(model.sizes, s * (0.5, 1.0), _EMPTY_NODES, rooted=True)
    grown = diameters**3 * _area_so_far(model.pulse, s / diameters)
    return model.birth_rate * np.sum(probabilities * grown, axis=-1)


def expected_mean_area(model: Model, distance: float) -> float:
    """Return the expected mean of A_r in um^2 over the first ``distance`` um, from the model's start."""
    return _mean_from_start(model, distance, area_cumulants(model).mean, area_from_empty)


def expected_mean_count(model: Model, distance: float) -> float:
    """Return the expected mean of N over the first ``distance`` um, from the model's start."""
    return _mean_from_start(model, distance, mean_count(model), count_from_empty)


def _mean_from_start(
    model: Model, distance: float, settled: float, from_empty: Callable[[Model, Doubles], Doubles]
) -> float:
    if model.start == "stationary":
        return settled
    reach = min(distance, longest_life(model))
    s, weights = panels(lag_edges(model, reach), _GROWTH_NODES)
    return (float(weights @ from_empty(model, s)) + (distance - reach) * settled) / distance


def _area_so_far(pulse: Pulse, age: Doubles) -> Doubles:
    """Return the integral of a life of unit diameter up to an age, which grows after mid-life as it grew before.

    Off the centre line it is the mean over offsets.
    """
    if pulse.offset != "none":
        return off_centre.area_so_far(pulse, age)
    rising = pulse.area_so_far(1.0 - np.minimum(np.abs(1.0 - age), 1.0))
    return np.where(age < 1.0, rising, pulse.life_integral(1) - rising)

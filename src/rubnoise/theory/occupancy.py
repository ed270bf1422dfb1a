"""How many junctions are alive: an M/G/infinity queue in sliding distance."""

from math import sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.model import Model
from rubnoise.theory.lags import lag_rule
from rubnoise.theory.quadrature import cut_size_rule

Doubles = NDArray[np.float64]

_NODES = 24


def mean_count(model: Model) -> float:
    """Return E[N] = Var[N] = lam 2 m_1: the stationary number alive is Poisson (M/G/infinity queue, Little's law)."""
    return model.birth_rate * 2.0 * model.sizes.moment(1)


def length_biased_mean_diameter(model: Model) -> float:
    """Return the mean diameter in um of a junction found alive, m_2/m_1: its density is d f(d) / m_1."""
    return model.sizes.moment(2) / model.sizes.moment(1)


def count_covariance(model: Model, lag: ArrayLike) -> Doubles:
    """Return Cov[N(s), N(s + tau)] = lam E[(2d - |tau|)+] for lags tau in um (any shape)."""
    reach = np.abs(np.asarray(lag, dtype=np.float64))[..., None]
    diameters, probabilities = cut_size_rule(model.sizes, 0.5 * reach, _NODES)
    return model.birth_rate * np.sum(probabilities * np.maximum(2.0 * diameters - reach, 0.0), axis=-1)


def count_from_empty(model: Model, distance: ArrayLike) -> Doubles:
    """Return E[N(s)] = lam E[min(s, 2d)] at distances s in um (any shape) after an empty start."""
    s = np.asarray(distance, dtype=np.float64)[..., None]
    diameters, probabilities = cut_size_rule(model.sizes, 0.5 * s, _NODES)
    return model.birth_rate * np.sum(probabilities * np.minimum(2.0 * diameters, s), axis=-1)


def expected_births(model: Model) -> float:
    """Return lam T, the expected number of births while sliding the model's distance T (um)."""
    return model.birth_rate * model.distance


def expected_junction_rows(model: Model) -> float:
    """Return the expected number of junctions in a record: the births, and those alive at a stationary start."""
    alive = mean_count(model) if model.start == "stationary" else 0.0
    return alive + expected_births(model)


def mean_count_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error of the mean of N over a stationary record.

    Over ``distance`` um, or over the model's ticks: Var = (2/T^2) int_0^T (T - tau) Cov[N(0), N(tau)] dtau.
    """
    lags, weights = lag_rule(model, distance)
    return sqrt(float(weights @ count_covariance(model, lags)))

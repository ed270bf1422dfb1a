"""How the number of live junctions goes with itself a lag further on, where births are regular."""

from collections.abc import Hashable
from functools import lru_cache
from math import ceil, floor
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.laws import Law
from rubnoise.model import Model
from rubnoise.theory.lines import count_lines, line_covariance
from rubnoise.theory.log_table import LogTable, log_table
from rubnoise.theory.quadrature import cut_size_rule, size_edges, size_range

Doubles = NDArray[np.float64]

_NODES = 24
_YOUNGEST = 1e-13
_TOLERANCE = 4e-14
_SHARED_TOLERANCE = 2e-13
_WHOLE = 1e-12  # by which a number of equal lives may miss a whole number, as a part of itself
_MOST_SUMMED = 4096


def unphased_count_covariance(model: Model, lag: Doubles) -> Doubles:
    """Return lam E[(2d - tau)+] - lam int G(a) G(a + tau) da, G(a) = P(2d > a): the covariance given the phase.

    Lags tau >= 0 in um of any shape; 0 for one size, whose lives the phase tells whole.
    """
    if _one_size(model):
        return np.zeros_like(lag)
    reach = lag[..., None]
    diameters, probabilities = cut_size_rule(model.sizes, 0.5 * reach, _NODES)
    left = np.sum(probabilities * np.maximum(2.0 * diameters - reach, 0.0), axis=-1)
    return model.birth_rate * (left - _shared(model.sizes, lag))


def phased_count_covariance(model: Model, lag: Doubles) -> Doubles:
    """Return the covariance of E[N | phase] at lags tau >= 0 in um of any shape, of period one spacing.

    lam sum over all j of int G(a) G(a + |tau + j spacing|) da, less the square of the mean; one size has a whole number
    of lives and one more with probability f, and covariance max(0, f - t) + max(0, f - 1 + t) - f^2 at t spacings.
    Lives very long on the scale of a spacing are summed as lines, with B_2(t)/2 for the births.
    """
    turns = lag / model.births.mean
    part = turns - np.floor(turns)
    if _one_size(model):
        f = _fraction(2.0 * size_range(model.sizes)[1] / model.births.mean)
        return np.maximum(0.0, f - part) + np.maximum(0.0, f - 1.0 + part) - f * f
    most = ceil(2.0 * size_range(model.sizes)[1] / model.births.mean)
    if most > _MOST_SUMMED:
        return _from_lines(model, lag, part)
    total = np.zeros_like(lag)
    for j in range(-most - 1, most + 1):
        total += _shared(model.sizes, np.abs(part + j) * model.births.mean)
    mean = model.birth_rate * 2.0 * model.sizes.moment(1)
    return model.birth_rate * total - mean * mean


def _from_lines(model: Model, lag: Doubles, part: Doubles) -> Doubles:
    wavenumbers, power = count_lines(model)
    births = np.square(model.birth_rate / wavenumbers)
    sawtooth = 0.5 * (part * part - part + 1.0 / 6.0)
    return sawtooth + line_covariance((wavenumbers, power - births), lag)


def _fraction(lives: float) -> float:
    """Return what a number exceeds the whole number below by, 0 where only rounding tells it from a whole one."""
    nearest = round(lives)
    return 0.0 if abs(lives - nearest) <= _WHOLE * lives else lives - floor(lives)


def _shared(law: Law, lag: Doubles) -> Doubles:
    """Return int G(a) G(a + tau) da = E[min(2d, (2d' - tau)+)] in um, d and d' independent."""
    table = _shared_table(cast("Hashable", law))
    return np.asarray(table(np.maximum(lag, np.exp(table.edges[0])))[0])


@lru_cache(maxsize=8)
def _shared_table(law: Any) -> LogTable:
    edges = size_edges(law)[0]
    turns = np.append(_YOUNGEST * edges[0], np.union1d(edges, 2.0 * edges))
    mean = np.array([law.moment(1)])
    shorter = log_table(lambda x: _shorter(law, x)[None], turns, _TOLERANCE * mean)

    def shared(lag: Doubles) -> Doubles:
        diameters, probabilities = cut_size_rule(law, 0.5 * lag[..., None], _NODES)
        rest = np.maximum(2.0 * diameters - lag[..., None], 0.0)
        return np.sum(probabilities * shorter(rest)[0], axis=-1)[None]

    return log_table(shared, turns, _SHARED_TOLERANCE * mean)


def _shorter(law: Law, distance: Doubles) -> Doubles:
    """Return E[min(2d, x)]."""
    diameters, probabilities = cut_size_rule(law, 0.5 * distance[..., None], _NODES)
    return np.sum(probabilities * np.minimum(2.0 * diameters, distance[..., None]), axis=-1)


def _one_size(model: Model) -> bool:
    return size_edges(model.sizes)[0].size == 1

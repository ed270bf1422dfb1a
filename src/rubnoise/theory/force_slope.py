"""How steeply the friction force rises and falls along the sliding distance."""

from collections.abc import Callable
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.theory.campbell import strengths_of
from rubnoise.theory.lags import longest_life
from rubnoise.theory.log_table import log_table
from rubnoise.theory.phases import phase_rule
from rubnoise.theory.quadrature import cut_size_rule, size_edges
from rubnoise.theory.random_births import are_at_random

Doubles = NDArray[np.float64]

_SIZES = 24
_YOUNGEST = 1e-9  # age over diameter below which there is no junction to speak of
_TABLE_ERROR = 1e-12  # of the mean diameter
_ROUNDING = 1e-12  # of the variance for births at random, below which a variance is none


def force_slope_std(model: Model) -> float:
    """Return the standard deviation of F' = dF/ds in uN/um, F the stationary friction force; its mean is 0.

    Var F' = lam E[psi^2] b m_3, b d^3 the integral of A'^2 over a life, which is finite for the lens (A' ends as a
    root) and for the triangle (A' jumps). Regular births add E[psi]^2 times the mean over their phase of
    (sum g)^2 - sum g^2, g = E[A'] at the ages that the phase leaves. Raises Refused without a strength.
    Source: Campbell's theorem (Rice 1944, section 1.5, doi:10.1002/j.1538-7305.1944.tb00874.x) for the pulse psi A'.
    """
    psi = strengths_of(model)
    at_random = model.birth_rate * psi.moment(2) * model.pulse.squared_slope * model.sizes.moment(3)
    if are_at_random(model):
        return sqrt(at_random)
    variance = at_random + psi.mean**2 * _together(model)
    return sqrt(variance) if variance > _ROUNDING * at_random else 0.0


def _together(model: Model) -> float:
    """Return what the mean slopes of different junctions add to each other's squares, in um^2, births regular."""
    phases, probabilities = phase_rule(model)
    slope, spacing = _mean_slope(model), model.births.mean
    total, squares = np.zeros_like(phases), np.zeros_like(phases)
    for number in range(ceil(longest_life(model) / spacing)):
        each = slope(phases + number * spacing)
        total += each
        squares += np.square(each)
    return float(probabilities @ (np.square(total) - squares))


def _mean_slope(model: Model) -> Callable[[Doubles], Doubles]:
    """Return E[A'(a; d)] in um as a function of age a in um: that of one size, or a table."""
    law, pulse = model.sizes, model.pulse
    edges = size_edges(law)[0]
    if edges.size == 1:
        return lambda age: pulse.slope(age, edges[0])

    def slope(age: Doubles) -> Doubles:
        # Sizes are cut where the age is mid-life, and where it is the end.
        diameters, probabilities = cut_size_rule(law, age[..., None] * (0.5, 1.0), _SIZES, rooted=True)
        return np.sum(pulse.slope(age[..., None], diameters) * probabilities, axis=-1)[None]

    turns = np.append(_YOUNGEST * edges[0], np.union1d(edges, 2.0 * edges))
    table = log_table(slope, turns, np.array([_TABLE_ERROR * law.moment(1)]))
    return lambda age: table(age)[0]

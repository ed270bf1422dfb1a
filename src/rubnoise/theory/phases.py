"""Averages over the phase of regular births, which is uniform over one spacing."""

from collections.abc import Callable
from math import ceil

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.theory.error_function import complementary_error
from rubnoise.theory.mean_life import ORDERS, age_table, area_by_age, cumulants_by_age
from rubnoise.theory.quadrature import panels, size_edges, size_range

Doubles = NDArray[np.float64]

_NODES = 20
_WINDOW = 3.0  # width of the step that leaves old lives out, in spacings
_WINDOW_REACH = 9.0  # widths of the step from its middle to its end
_SMOOTH = 8.0  # spacings in a panel of the mean life that is smooth on the scale of one
_AT_ONCE = 2**16


def phase_rule(model: Model) -> tuple[Doubles, Doubles]:
    """Return phases in um, the age of the youngest junction there would be, and their probabilities.

    Panels end where a life begins, is at its middle or ends, or, for more than one size, at those edges of the mean
    life's panels that lie closer together than a spacing.
    """
    spacing = model.births.mean
    if _one_size(model):
        turns = 0.5 * _longest(model) * np.arange(3.0)
    else:
        ages = np.exp(age_table(model.sizes, model.pulse).edges)
        narrow = np.diff(ages) < spacing
        turns = ages[np.append(narrow, False) | np.append(False, narrow)]
    ends = np.unique(np.concatenate([[0.0], turns % spacing, [spacing]]))
    phases, weights = panels(ends, _NODES, rooted=True)
    return phases, weights / spacing


def mean_cumulants(model: Model, strength_moments: tuple[float, ...]) -> Doubles:
    """Return the means over the phase of the cumulants given it, lam int kappa_n[psi A(a; d)] da, n = 1 ... 6."""
    if _one_size(model):
        ages, weights = panels(0.5 * _longest(model) * np.arange(3.0), _NODES, rooted=True)
    else:
        logs, weights = panels(age_table(model.sizes, model.pulse).edges, _NODES)
        ages = np.exp(logs)
        weights = weights * ages
    moments = area_by_age(model.sizes, model.pulse, ages)
    return model.birth_rate * (cumulants_by_age(moments, strength_moments) @ weights)


def cumulant_ripple(model: Model, phases: Doubles, strength_moments: tuple[float, ...]) -> Doubles:
    """Return the cumulants of sum psi A given the phase up to a constant each, of order 1 to 6 the first axis.

    Given the phase, lives are independent: the one that began last has the phase for its age, the one before a spacing
    more, and so on. Ages from which on the mean life is smooth on the scale of a spacing add the same at every phase,
    and are left out along an error function three spacings wide, which turns the sum's ripple down by exp(-170).
    """
    sharp = _sharp_until(model)
    width = _WINDOW * model.births.mean
    if sharp + 2.0 * _WINDOW_REACH * width > _longest(model):
        return _summed(model, phases, strength_moments, reach=_longest(model), window=None)
    centre = sharp + _WINDOW_REACH * width

    def window(ages: Doubles) -> Doubles:
        return np.asarray(0.5 * complementary_error((ages - centre) / (np.sqrt(2.0) * width)), dtype=np.float64)

    return _summed(model, phases, strength_moments, reach=centre + _WINDOW_REACH * width, window=window)


def _summed(
    model: Model,
    phases: Doubles,
    strength_moments: tuple[float, ...],
    *,
    reach: float,
    window: Callable[[Doubles], Doubles] | None,
) -> Doubles:
    spacing = model.births.mean
    most, together = ceil(reach / spacing), max(1, _AT_ONCE // phases.size)
    total = np.zeros((ORDERS, phases.size))
    for first in range(0, most, together):
        ages = phases[:, None] + spacing * np.arange(first, min(first + together, most))
        terms = cumulants_by_age(area_by_age(model.sizes, model.pulse, ages), strength_moments)
        total += (terms if window is None else terms * window(ages)).sum(axis=-1)
    return total


def _sharp_until(model: Model) -> float:
    """Return the age in um beyond which the mean life has no feature as narrow as a spacing."""
    if _one_size(model):
        return _longest(model)
    ages = np.exp(age_table(model.sizes, model.pulse).edges)
    narrow = np.diff(ages) < _SMOOTH * model.births.mean
    return float(ages[1:][narrow].max(initial=0.0))


def _longest(model: Model) -> float:
    return 2.0 * size_range(model.sizes)[1]


def _one_size(model: Model) -> bool:
    return size_edges(model.sizes)[0].size == 1

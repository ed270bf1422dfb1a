"""The cumulants of real contact area and friction force where births are regular: a mixture over their phase."""

from math import comb

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.theory.lines import spectral_lines
from rubnoise.theory.phases import cumulant_ripple, mean_cumulants, phase_rule
from rubnoise.theory.quadrature import size_range

Doubles = NDArray[np.float64]

ORDERS = 6
CONSTANT = 1e-12
"""Standard deviation over mean below which a quantity is constant: what is left is rounding."""


def regular_cumulants(model: Model, strength_moments: tuple[float, ...]) -> tuple[float, ...]:
    """Return the cumulants of order 1 to 6 of sum psi A over live junctions in (MPa um^2)^n, births regular.

    E[psi^n], n = 0 ... 6, are given. With K_n(phase) the cumulants given the phase, sums over independent lives,
    kappa_n = E[K_n] + c_n, c_n the n-th cumulant of the mixture of K_n - E[K_n]; nothing cancels, and the mean is
    Campbell's. A ripple of one size below 1e-12 of the mean is taken for none.
    Source: the law of total cumulance, Brillinger (1969), doi:10.1007/BF02532246.
    """
    mean = strength_moments[1] * model.stationary_mean_area
    higher = mean_cumulants(model, strength_moments)[1:]
    if _ripples(model):
        phases, probabilities = phase_rule(model)
        ripple = cumulant_ripple(model, phases, strength_moments)
        higher += _mixture(ripple - (ripple @ probabilities)[:, None], probabilities)[1:]
    return (mean, *(float(value) for value in higher))


def _ripples(model: Model) -> bool:
    """Return whether the mean given the phase varies; lives of many sizes are not asked, since they vary anyhow."""
    if np.ptp(size_range(model.sizes)) > 0.0:
        return True
    return 2.0 * float(spectral_lines(model)[1].sum()) > (CONSTANT * model.stationary_mean_area) ** 2


def _mixture(cumulants: Doubles, probabilities: Doubles) -> Doubles:
    """Return the cumulants of a mixture of laws whose own cumulants of order 1 to 6 are the rows."""
    rows = [np.ones(probabilities.size)]
    for n in range(1, ORDERS + 1):
        rows.append(sum((comb(n - 1, i) * cumulants[i] * rows[n - 1 - i] for i in range(n)), np.zeros_like(rows[0])))
    moments = np.array(rows) @ probabilities
    found = np.zeros(ORDERS)
    for n in range(1, ORDERS + 1):
        found[n - 1] = moments[n] - sum(comb(n - 1, i) * found[i] * moments[n - 1 - i] for i in range(n - 1))
    return found

"""The mean area of a junction of a given age, and the cumulants about it, over all sizes."""

from functools import lru_cache
from math import comb

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.contact.pulses import Pulse
from rubnoise.theory.log_table import LogTable, log_table
from rubnoise.theory.quadrature import cut_size_rule, is_one_size, panels, size_edges, size_range

ORDERS = 6
_NODES = 24
_YOUNGEST = 1e-9  # age over diameter below which there is no area to speak of
_ROUNDING = 1e-12
_NOISE = 2e-14
_AT_ONCE = 2048
_LAGS_AT_ONCE = 64


def area_by_age(law: Law, pulse: Pulse, age: Doubles) -> Doubles:
    """Return E[A(a; d)] in um^2 and the central moments of A(a; d) of order 2 to 6, the first axis, by age a in um.

    Ages a >= 0 of any shape; a junction past its life has no area. Lives of one size have only the first moment.
    """
    if is_one_size(law):
        moments = np.zeros((ORDERS, *age.shape))
        moments[0] = pulse.area(age, size_range(law)[1])
        return moments
    return age_table(law, pulse)(age)


@lru_cache(maxsize=8)
def age_table(law: Law, pulse: Pulse) -> LogTable:
    """Return E[A] and central moments by age as a table, for a law of more than one size."""
    edges = size_edges(law)[0]
    turns = np.append(_YOUNGEST * edges[0], np.union1d(edges, 2.0 * edges))
    sample = np.abs(_moments(law, pulse, panels(turns, _NODES)[0])).max(axis=1)
    scale = np.maximum(sample, sample[1] ** (0.5 * np.arange(1, ORDERS + 1)))
    # Deviations from the mean area are differences of areas: their digits go with the spread of the sizes.
    noise = _NOISE * np.maximum(1.0, np.arange(ORDERS) * edges[-1] / (edges[-1] - edges[0]))
    return log_table(lambda age: _moments(law, pulse, age), turns, noise * scale)


def _moments(law: Law, pulse: Pulse, age: Doubles) -> Doubles:
    flat = age.ravel()
    parts = np.array_split(flat, 1 + flat.size // _AT_ONCE)
    return np.concatenate([_central(law, pulse, part) for part in parts], axis=1).reshape(ORDERS, *age.shape)


def _central(law: Law, pulse: Pulse, age: Doubles) -> Doubles:
    """Average over sizes, cut at mid-life and end; missing probability belongs to sizes near 0, which are dead."""
    diameters, probabilities = cut_size_rule(law, np.multiply.outer(age, (0.5, 1.0)), _NODES, rooted=True)
    areas = diameters**2 * pulse.area(age[:, None] / diameters, 1.0)  # of unit diameter, which keeps young digits
    mean = np.sum(areas * probabilities, axis=-1)
    missing = 1.0 - np.sum(probabilities, axis=-1)
    missing = np.where(missing > _ROUNDING, missing, 0.0)
    deviations = areas - mean[:, None]
    moments, powers = [mean], probabilities * deviations
    for order in range(2, ORDERS + 1):
        powers = powers * deviations
        moments.append(np.sum(powers, axis=-1) + missing * (-mean) ** order)
    return np.array(moments)


def mean_life_overlap(law: Law, pulse: Pulse, lag: Doubles) -> Doubles:
    """Return int E[A(s)] E[A(s + tau)] ds in um^5 for lags tau >= 0 in um of any shape, for more than one size."""
    table = age_table(law, pulse)
    mean = LogTable(edges=table.edges, coefficients=table.coefficients[:1])
    ends = np.exp(table.edges)
    flat, result = lag.ravel(), np.empty(lag.size)
    for rows in np.array_split(np.arange(flat.size), 1 + flat.size // _LAGS_AT_ONCE):
        # Cut where the earlier place meets an edge of the table, and where the later one does.
        later = np.clip(ends - flat[rows, None], ends[0], ends[-1])
        cuts = np.sort(np.concatenate([np.broadcast_to(ends, later.shape), later], axis=-1), axis=-1)
        logs, weights = panels(np.log(cuts), _NODES)
        ages = np.exp(logs)
        result[rows] = np.sum(weights * ages * mean(ages)[0] * mean(ages + flat[rows, None])[0], axis=-1)
    return result.reshape(lag.shape)


def cumulants_by_age(moments: Doubles, strength_moments: tuple[float, ...]) -> Doubles:
    """Return the cumulants of psi A of order 1 to 6 from `area_by_age`, psi independent with E[psi^n], n = 0 ... 6.

    psi A - E[psi] E[A] = psi (A - E[A]) + (psi - E[psi]) E[A], to the power n and averaged.
    """
    mean, psi = moments[0], strength_moments
    about = [np.ones_like(mean), np.zeros_like(mean), *moments[1:]]

    def central(n: int) -> Doubles:
        terms = (comb(n, i) * _mixed(psi, i, n - i) * about[i] * mean ** (n - i) for i in range(n + 1))
        return sum(terms, np.zeros_like(mean))

    m2, m3, m4, m5, m6 = (central(n) for n in range(2, ORDERS + 1))
    return np.array(
        [psi[1] * mean, m2, m3, m4 - 3 * m2**2, m5 - 10 * m3 * m2, m6 - 15 * m4 * m2 - 10 * m3**2 + 30 * m2**3]
    )


def _mixed(psi: tuple[float, ...], power: int, central: int) -> float:
    """Return E[psi^i (psi - E[psi])^j]; exactly 0 for j > 0 if all junctions are equally strong."""
    if psi[2] == psi[1] ** 2:
        return psi[power] if central == 0 else 0.0
    return sum(comb(central, j) * psi[power + j] * (-psi[1]) ** (central - j) for j in range(central + 1))

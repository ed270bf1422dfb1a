"""What a junction found alive at a random place looks like: the inspection paradox.

Long lives are met more often than short ones, so size and age of a junction that is seen are not those of one that is
born. All of it holds for every stationary law of births, since a place at random knows nothing of their phase.
Source: Feller, An Introduction to Probability Theory and Its Applications, volume II (1971), sections I.4 and XI.4.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.contact.laws import Law
from rubnoise.model import Model
from rubnoise.theory.quadrature import cut_size_rule, size_range

Doubles = NDArray[np.float64]

_NODES = 24


def live_diameter_density(law: Law, diameter: ArrayLike) -> Doubles:
    """Return the density d f(d) / m_1 in 1/um of the diameter d of a live junction, d in um of any shape.

    Of one size there is a point mass at it and no density: 0 everywhere.
    """
    d = np.asarray(diameter, dtype=np.float64)
    return np.maximum(d, 0.0) * law.density(d) / law.moment(1)


def live_diameter_distribution(law: Law, diameter: ArrayLike) -> Doubles:
    """Return P(D <= d) for the diameter D of a live junction, int_0^d x f(x) dx / m_1; a step for one size."""
    d = np.asarray(diameter, dtype=np.float64)[..., None]
    diameters, probabilities = cut_size_rule(law, d, _NODES)
    return np.minimum(np.sum(probabilities * diameters * (diameters <= d), axis=-1) / law.moment(1), 1.0)


def live_diameter_moment(law: Law, power: int) -> float:
    """Return E[D^n] = m_(n+1) / m_1 in um^n for the diameter D of a live junction."""
    return law.moment(power + 1) / law.moment(1)


def age_density(law: Law, age: ArrayLike) -> Doubles:
    """Return the density P(2d > a) / (2 m_1) in 1/um of the age a of a live junction, a in um of any shape.

    Given its diameter the age is uniform on the life, [0, 2d); so is what is left of the life, which therefore has the
    same density, though age and rest add up to a life. 0 for a < 0.
    """
    a = np.asarray(age, dtype=np.float64)
    return np.where(a < 0.0, 0.0, _longer(law, a)) / (2.0 * law.moment(1))


def age_distribution(law: Law, age: ArrayLike) -> Doubles:
    """Return P(age <= a) = E[min(a, 2d)] / (2 m_1), a in um of any shape; the rest of the life has the same law."""
    a = np.maximum(np.asarray(age, dtype=np.float64), 0.0)[..., None]
    diameters, probabilities = cut_size_rule(law, 0.5 * a, _NODES)
    return np.minimum(np.sum(probabilities * np.minimum(a, 2.0 * diameters), axis=-1) / (2.0 * law.moment(1)), 1.0)


def age_moment(law: Law, power: int) -> float:
    """Return E[age^n] = 2^n m_(n+1) / ((n + 1) m_1) in um^n; the mean age is m_2 / m_1, half the mean live life."""
    return 2.0**power / (power + 1.0) * live_diameter_moment(law, power)


def live_area_moment(model: Model, power: int) -> float:
    """Return E[A^n] = c_n m_(2n+1) / (2 m_1) in um^(2n) for the area A of a live junction."""
    law = model.sizes
    return model.pulse.life_integral(power) * law.moment(2 * power + 1) / (2.0 * law.moment(1))


def _longer(law: Law, age: Doubles) -> Doubles:
    """Return P(2d > a); what lies below the range of the law counts as shorter than every age there is."""
    a = age[..., None]
    diameters, probabilities = cut_size_rule(law, 0.5 * a, _NODES)
    longer = np.sum(probabilities * (2.0 * diameters > a), axis=-1)
    return np.where(age < 2.0 * size_range(law)[0], 1.0, np.minimum(longer, 1.0))

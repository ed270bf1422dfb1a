"""Fit number and strength together with size: scoring steps on bands and mean, weighted by their whole covariance.

The large junctions in a record move its bands and its mean together. This covariance is the shot noise of the junctions
themselves, so intervals need no bootstrap.
"""

from dataclasses import dataclass, field, replace
from math import sqrt
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.inference.fitting import Contact, Expected, FitProblem
from rubnoise.inference.passes import energies, first_integrals, offsets
from rubnoise.inference.populations import shot_sizes
from rubnoise.tables import fields_as_text

STEPS: Final = 25
_CLOSE = 1e-6  # in the chi-square of a step: a thousandth of a standard error
_RIDGE = 1e-10
_LONGEST_STEP = 0.5
RAMP_VARIANCE: Final = 12.0
"""Variance of the rise of a fitted line, over that of the mean."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """What is known besides the bands: the ``mean`` of the record over a trusted zero, the ``strength`` of junctions.

    Strength in the trace's unit per tick^2. ``births`` per tick is used if neither is known: it only determines the
    size of the shot noise. ``ramp`` is the rise of the record from end to end.
    ``inequality`` E[psi^2] / E[psi]^2 is given, unless mean and strength are both known.
    """

    mean: float | None
    strength: float | None
    births: float = 0.0
    inequality: float = 1.0
    ramp: float = 0.0

    @property
    def free(self) -> tuple[str, ...]:
        """Which of number, strength and inequality the record then shows."""
        if self.mean is None:
            return ("strength",) if self.strength is None else ("births",)
        return ("births", "strength") if self.strength is None else ("births", "inequality")


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Fit:
    """A fitted contact: the ``names`` of its parameters, whose logarithms have the ``covariance``.

    ``residual`` is that of the bands, ``scatter`` its covariance.
    """

    problem: FitProblem = field(repr=False)
    contact: Contact
    known: Given
    names: tuple[str, ...]
    covariance: Doubles
    expected: Expected
    residual: Doubles
    scatter: Doubles

    def __repr__(self) -> str:
        return fields_as_text(self)

    def error(self, powers: dict[str, float]) -> float:
        """Return the standard error of the logarithm of a product of powers of parameters."""
        vector = np.array([powers.get(name, 0.0) for name in self.names])
        return sqrt(max(float(vector @ self.covariance @ vector), 0.0))

    def moment(self, power: int) -> float:
        """Return E[x^n] of the sizes x of unit mean."""
        return self.problem.population.moment(power, self.contact.shape)

    def by_shape(self, power: int) -> float:
        """Return d ln E[x^n] / d ln s."""
        return self.problem.population.by_shape(power, self.contact.shape)


def covariance(problem: FitProblem, contact: Contact, bands: Doubles, ramp: float = 0.0) -> Doubles:
    """Return the covariance of the mean of the record (row 0) and of its bands, with the expectation ``bands``.

    Gaussian part: E[P]^2 over the weight of the band, on the diagonal. Shot noise: (lam / T) E[f f'] over single
    junctions, f = (psi A^(0), psi^2 |A^(k)|^2): the fourth cumulant between bands, raised by the taper as the other,
    the third between a band and the mean, the second for the mean itself, which is all of it. Unequal strengths are
    taken as lognormal, E[psi^n] = E[psi]^n w^(n (n - 1) / 2).
    Source: Brillinger, Time Series: Data Analysis and Theory (1981), theorem 5.10.1.
    """
    periodogram = problem.bands
    sizes, probability, step = shot_sizes(problem.population, contact.shape)
    diameters = contact.diameter * sizes
    widths = step + np.log((periodogram.last + 0.5) / (periodogram.first - 0.5))  # of bands in ln k, and of sizes
    phases = np.log(np.outer(periodogram.wavenumber, diameters))
    each = energies(problem.pulse, phases, widths[:, None]) * diameters[:, None] ** 6
    each = each.reshape(bands.size, -1)
    first = np.outer(diameters**3, first_integrals(problem.pulse)).ravel()
    chance = np.outer(probability, offsets(problem.pulse)[1]).ravel()
    # Scaled to the bands' own expectation, which knows of aliases, of the sensor and of the widths of bands.
    expected = problem.population_bands(contact)[0]
    each *= (expected / (each @ chance))[:, None]
    psi, w = contact.strength, contact.inequality
    f = np.vstack([psi * first, psi**2 * each])
    total = (contact.births / periodogram.span) * (f * chance) @ f.T
    total[1:, 1:] *= periodogram.variance_factor * w**6
    total[0, 1:] *= w**3
    total[1:, 0] *= w**3
    total[0, 0] = (total[0, 0] * w + contact.noise / periodogram.span) * periodogram.mean_variance
    # A walk from a trusted zero has the mean square q n / 3 on average over the record.
    total[0, 0] += (contact.drift or 0.0) * periodogram.span / 3.0
    # A ramp from a trusted zero at one end moves the mean by half of it; what of it chance brings is no drift.
    total[0, 0] += max(ramp**2 - RAMP_VARIANCE * problem.longest_waves(contact) / periodogram.span, 0.0) / 4.0
    rows = np.arange(1, bands.size + 1)
    total[rows, rows] += np.square(bands) / periodogram.weight
    return total


def score(problem: FitProblem, start: Contact, known: Given, *, steps: int = STEPS) -> Fit:
    """Return the contact whose quasi-score D' Sigma^-1 (z - E[z]) is zero, from a start near it.

    z are the bands, and the mean if it is known; D the derivatives of E[z], Sigma its covariance at the same
    point, so the estimate has the covariance (D' Sigma^-1 D)^-1. Without ``steps`` the contact is that of the start.
    Source: Godambe and Heyde (1987), doi:10.2307/1403403; a sandwich (Huber 1967) whose two slices are equal.
    """
    contact, bands = _begun(problem, start, known), problem.bands
    rows = slice(1 if known.mean is None else 0, None)
    for left in range(steps, -1, -1):
        expected = problem.expected(contact, known.free)
        names, by = expected.names, np.vstack([expected.level_by, expected.by])[rows]
        residual = np.concatenate([[(known.mean or 0.0) - expected.level], bands.energy - expected.mean])[rows]
        scatter = covariance(problem, contact, expected.mean, known.ramp)[rows, rows]
        scale = np.sqrt(scatter.diagonal())
        root = np.linalg.cholesky(scatter / np.outer(scale, scale) + _RIDGE * np.eye(scale.size))
        white = np.linalg.solve(root, np.column_stack([by, residual]) / scale[:, None])
        information = white[:, :-1].T @ white[:, :-1]
        inverse = np.linalg.pinv(information, rcond=1e-14, hermitian=True)
        pull = white[:, :-1].T @ white[:, -1]
        step = inverse @ pull
        if problem.is_widest(contact) and step[names.index("shape")] > 0.0:
            rest = np.array([name != "shape" for name in names])
            step = np.zeros(len(names))
            step[rest] = np.linalg.pinv(information[np.ix_(rest, rest)], rcond=1e-14, hermitian=True) @ pull[rest]
        step = np.clip(step, -_LONGEST_STEP, _LONGEST_STEP)
        if left == 0 or float(step @ information @ step) < _CLOSE:
            break
        contact = problem.moved(contact, names, step)
    of_bands = slice(residual.size - bands.energy.size, None)
    return Fit(
        problem=problem,
        contact=contact,
        known=known,
        names=names,
        covariance=inverse,
        expected=expected,
        residual=residual[of_bands],
        scatter=scatter[of_bands, of_bands],
    )


def _begun(problem: FitProblem, start: Contact, known: Given) -> Contact:
    """Return the contact with the bands of a start and with the known quantities."""
    w, strength = known.inequality, known.strength
    if known.mean is None:
        strength = sqrt(start.rate / (known.births * w)) if strength is None else strength
        return replace(start, births=start.rate / (strength**2 * w), strength=strength, inequality=w)
    third = problem.pulse.life_integral(1) * problem.population.moment(3, start.shape) * start.diameter**3
    sum_of_strengths = known.mean / third
    strength = start.rate / (sum_of_strengths * w) if strength is None else strength
    inequality = start.rate / (sum_of_strengths * strength)
    return replace(start, births=sum_of_strengths / strength, strength=strength, inequality=inequality)

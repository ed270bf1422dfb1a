"""Fit a population to bands of a periodogram: Levenberg steps from several starts, then weights with shot noise.

First Whittle's likelihood finds the optimum, as if bands were independent and gamma distributed about their means.
But the few large junctions of a record move all bands and the mean together. So scoring steps on bands and mean follow,
weighted by their whole covariance. It is the shot noise of the junctions themselves, so intervals need no bootstrap.
"""

from dataclasses import dataclass, field, replace
from math import inf, sqrt
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.inference.passes import OPEN, Sensor, energies, first_integrals, offsets
from rubnoise.inference.periodogram import Bands, Expectation
from rubnoise.inference.populations import NARROWEST, Population, energy_table, shot_sizes
from rubnoise.tables import fields_as_text

FLOOR: Final = 1e-13  # noise below this part of the largest band counts as none

_MOST_STEPS, _MOST_STEPS_BELOW = 60, 12
_CLOSE = 1e-6  # in the deviance, or in the chi-square of a step: a thousandth of a standard error
_STIFFEST = 1e8
_STARTS_REFINED = 2
_REACHES = (8.0, 30.0)  # of k d: the swing of equal sizes has a minimum of the deviance at each of its periods


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """A population with its number and strengths, lengths in ticks and the trace in its own unit.

    ``diameter`` is the mean one, ``shape`` that of the population, ``noise`` the variance of white noise, ``drift``
    that of the steps of a random walk. ``births`` is lam per tick, ``strength`` E[psi] (trace
    unit per tick^2), ``inequality`` E[psi^2] / E[psi]^2.
    """

    diameter: float
    shape: float
    noise: float
    drift: float = 0.0
    births: float
    strength: float = 1.0
    inequality: float = 1.0

    @property
    def rate(self) -> float:
        """Lam E[psi^2], which is all that bands show of the three."""
        return self.births * self.strength**2 * self.inequality


@dataclass(frozen=True, slots=True, kw_only=True)
class Expected:
    """The expected ``mean`` of each band and ``level`` of the record at a point.

    Their derivatives ``by`` (a row each) and ``level_by`` are those by the logarithms of the parameters ``names``.
    """

    mean: Doubles
    by: Doubles
    level: float
    level_by: Doubles
    names: tuple[str, ...]


_IN_BANDS = {"births": 1.0, "strength": 2.0, "inequality": 1.0}
_IN_LEVEL = {"births": 1.0, "strength": 1.0, "inequality": 0.0}


class FitProblem:
    """Bands and the population to be fitted, with the pulse of a life and the filter of the sensor."""

    def __init__(
        self, bands: Bands, population: Population, *, drift: bool, pulse: Pulse = LENS, sensor: Sensor = OPEN
    ) -> None:
        """Compute what does not change from step to step."""
        self.bands = bands
        self.population = population
        self.pulse = pulse
        self.sensor = sensor
        self.expectation = Expectation(bands, pulse, sensor)
        self.floor = FLOOR * float(bands.energy.max())
        self.walk = self.expectation.drift() if drift else None

    def population_bands(self, contact: Contact) -> Doubles:
        """Return the bands of junctions for lam E[psi^2] = 1, and their derivatives by ln d and by the shape."""
        table = energy_table(self.population.name, contact.shape, self.pulse)
        return self.expectation.population(table, contact.diameter)

    def expected(self, contact: Contact, free: tuple[str, ...] = ("births",)) -> Expected:
        """Return what is expected at a point; parameters at a bound have no derivatives.

        ``free`` are those of number, strength and inequality that are sought. The level is Campbell's mean of a record,
        lam E[psi] c_1 E[d^3].
        """
        population, shape = self.population, contact.shape
        energy, slope, by_shape = self.population_bands(contact) * contact.rate
        single = self.pulse.life_integral(1) * population.moment(3, shape) * contact.diameter**3
        level, mean = contact.births * contact.strength * single, energy + contact.noise
        by = {name: (_IN_LEVEL[name] * level, _IN_BANDS[name] * energy) for name in free}
        by["diameter"] = (3.0 * level, slope)
        if population.spread and shape > NARROWEST:
            by["shape"] = (level * population.by_shape(3, shape), by_shape * shape)
        if contact.noise > self.floor:
            by["noise"] = (0.0, np.full_like(mean, contact.noise))
        if self.walk is not None and contact.drift > 0.0:
            mean = mean + contact.drift * self.walk
            by["drift"] = (0.0, contact.drift * self.walk)
        levels, bands = zip(*by.values(), strict=True)
        return Expected(mean=mean, by=np.stack(bands, axis=-1), level=level, level_by=np.array(levels), names=tuple(by))

    def longest_waves(self, contact: Contact) -> float:
        """Return S(0) of junctions and noise, lam E[psi^2] E[(int A ds)^2] + noise: n times the variance of a mean."""
        sixth = self.population.moment(6, contact.shape) * contact.diameter**6
        return contact.rate * self.pulse.integral_moment(2) * sixth + contact.noise

    def is_widest(self, contact: Contact) -> bool:
        """Return whether the shape is at its upper bound, beyond which a step would move the others wrongly."""
        return self.population.spread and contact.shape >= self.population.widest

    def moved(self, contact: Contact, names: tuple[str, ...], step: Doubles) -> Contact:
        """Return the point one step in logarithms away, kept within bounds."""
        move = dict(zip(names, np.clip(step, -1.0, 1.0).tolist(), strict=True))
        there = replace(contact, **{name: getattr(contact, name) * float(np.exp(by)) for name, by in move.items()})
        shape, drift = there.shape, there.drift
        if self.population.spread:
            shape = min(max(shape, NARROWEST), self.population.widest)
        if self.walk is not None and drift * float(self.walk.max()) < self.floor:
            drift = 0.0
        return replace(there, shape=shape, drift=drift, noise=there.noise if there.noise > self.floor else 0.0)


def deviance(bands: Bands, mean: Doubles, weight: Doubles | None = None) -> float:
    """Return twice the Whittle log likelihood ratio of the bands themselves to their expected means.

    ``weight`` replaces that of the bands, if some are left out.
    """
    ratio = bands.energy / np.maximum(mean, 1e-300)
    worth = bands.weight if weight is None else weight
    return float(2.0 * np.sum(worth * (ratio - 1.0 - np.log(np.maximum(ratio, 1e-300)))))


def climb(problem: FitProblem, start: Contact, reach: float = inf) -> tuple[Contact, float]:
    """Return the point of least Whittle deviance near a start, and the deviance: scoring with Levenberg's damping.

    Bands beyond ``reach`` of k d are left out; the others cannot show the noise, which then stays constant.
    Source: Whittle (1953); Levenberg (1944); Marquardt (1963), doi:10.1137/0111030.
    """
    bands, contact, damping = problem.bands, start, 1e-2
    within, found = _within(problem, start, reach), problem.expected(start)
    best = deviance(bands, found.mean, within)
    for _ in range(_MOST_STEPS if reach == inf else _MOST_STEPS_BELOW):
        weights = within / np.square(found.mean)
        pull = found.by.T @ (weights * (bands.energy - found.mean))
        still = {"noise"} if reach < inf else set()
        if problem.is_widest(contact) and pull[found.names.index("shape")] > 0.0:
            still.add("shape")
        moving = [number for number, name in enumerate(found.names) if name not in still]
        names, by, slope = tuple(found.names[each] for each in moving), found.by[:, moving], pull[moving]
        information = (by.T * weights) @ by
        sizes = information.diagonal()
        before, trial, there = best, contact, found
        while True:
            damped = information + np.diag(sizes * damping + 1e-12 * sizes.max())
            step: Doubles = np.asarray(np.linalg.solve(damped, slope), dtype=np.float64)
            # Half of what the step promises.
            if damping >= _STIFFEST or float(step @ slope) < _CLOSE * max(1.0, before):
                return contact, before
            trial = problem.moved(contact, names, step)
            there = problem.expected(trial)
            best = deviance(bands, there.mean, within)
            if best <= before:
                break
            damping *= 10.0
        contact, found, damping = trial, there, max(0.1 * damping, 1e-12)
        if before - best < _CLOSE * max(1.0, best):
            break
    return contact, best


def _within(problem: FitProblem, contact: Contact, reach: float) -> Doubles:
    """Return the weights of the bands up to a reach of k d, and of at least a tenth of all bands."""
    bands = problem.bands
    kept = bands.wavenumber * contact.diameter <= reach
    kept[: max(8, bands.energy.size // 10)] = True
    return np.where(kept, bands.weight, 0.0)


def starts(problem: FitProblem, diameter: float, noise: float) -> list[Contact]:
    """Return the starts of the search: each shape, with diameters about a rough estimate.

    ``births`` is chosen so that the low bands have their measured energy.
    """
    bands = problem.bands
    low = bands.energy[: max(3, bands.energy.size // 12)]
    weights, found = bands.weight[: low.size], []
    drift = 0.0 if problem.walk is None else 1e-3 * float(low.mean()) / float(problem.walk[0])
    for shape in problem.population.starts:
        moments = problem.population.moment
        # The spectrum falls at a wavenumber that goes with sqrt(m8 / m6), not with the mean.
        size = diameter / sqrt(moments(8, shape) / moments(6, shape))
        for factor in (0.7, 1.3):
            start = Contact(births=1.0, diameter=factor * size, shape=shape, noise=noise, drift=drift)
            energy = problem.population_bands(start)[0, : low.size]
            found.append(replace(start, births=float(np.sum(weights * low) / np.sum(weights * energy))))
    return found


def whittle(problem: FitProblem, diameter: float, noise: float) -> tuple[Contact, float]:
    """Return the best point of several starts, and its deviance.

    Each search uses the low bands first and adds the rest as it comes closer: far from the right diameter the
    oscillation of the high bands leads to a wrong period.
    """

    def first_worth(start: Contact) -> float:
        return deviance(problem.bands, problem.expected(start).mean, _within(problem, start, _REACHES[0]))

    arrived = []
    for found in sorted(starts(problem, diameter, noise), key=first_worth)[:_STARTS_REFINED]:
        for reach in (*_REACHES, inf):
            found, worth = climb(problem, found, reach)  # noqa: PLW2901  (each stage begins where the last one ended)
        arrived.append((found, worth))
    return min(arrived, key=lambda each: each[1])


STEPS: Final = 25
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

    __repr__ = fields_as_text

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
    total[0, 0] += contact.drift * periodogram.span / 3.0
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

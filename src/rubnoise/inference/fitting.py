"""Fit a population to bands of a periodogram: Levenberg steps from several starts, then weights with shot noise.

First Whittle's likelihood finds the optimum, as if bands were independent and gamma distributed about their means.
But the few large junctions of a record move all bands and the mean together. So `scoring` continues with weights that
account for this.
"""

from dataclasses import dataclass, replace
from math import inf, log
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.inference.passes import OPEN, Sensor
from rubnoise.inference.periodogram import Bands, Expectation
from rubnoise.inference.populations import NARROWEST, EnergyTable, Population, energy_table

FLOOR: Final = 1e-13
"""Noise below this part of the largest band counts as none."""

_MOST_STEPS, _MOST_STEPS_BELOW = 60, 12
_CLOSE = 1e-6  # in the deviance: a thousandth of a standard error
_STIFFEST = 1e8
_STARTS_REFINED = 2
_SAME = 0.01  # of the diameter and of the shape
_REACHES = (8.0, 30.0)  # of k d: the swing of equal sizes has a minimum of the deviance at each of its periods


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """A population with its number and strengths, lengths in ticks and the trace in its own unit.

    ``diameter`` is the mean one, ``shape`` that of the population, ``noise`` the variance of white noise, ``drift``
    that of the steps of a random walk (None if none is fitted). ``births`` is lam per tick, ``strength`` E[psi] (trace
    unit per tick^2), ``inequality`` E[psi^2] / E[psi]^2.
    """

    diameter: float
    shape: float
    noise: float
    drift: float | None = None
    births: float
    strength: float = 1.0
    inequality: float = 1.0

    @property
    def rate(self) -> float:
        """Lam E[psi^2], which is all that bands show of the three."""
        return self.births * self.strength**2 * self.inequality


@dataclass(frozen=True, slots=True, kw_only=True)
class Expected:
    """The expected bands at a point, and their derivatives by the logarithms of the parameters (columns ``names``)."""

    mean: Doubles
    by: Doubles
    names: tuple[str, ...]


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

    def table(self, shape: float) -> EnergyTable:
        """Return the energies of the population with a shape."""
        return energy_table(self.population.name, shape, self.pulse)

    def expected(self, contact: Contact) -> Expected:
        """Return the expected bands at a point; parameters at a bound have no derivatives."""
        energy, slope, by_shape = (
            self.expectation.population(self.table(contact.shape), contact.diameter) * contact.rate
        )
        mean = energy + contact.noise
        names, by = ["births", "diameter"], [energy, slope]
        if self.population.spread and contact.shape > NARROWEST:
            names.append("shape")
            by.append(by_shape * contact.shape)
        if contact.noise > self.floor:
            names.append("noise")
            by.append(np.full_like(mean, contact.noise))
        if self.walk is not None and contact.drift is not None:
            mean = mean + contact.drift * self.walk
            if contact.drift > 0.0:
                names.append("drift")
                by.append(contact.drift * self.walk)
        return Expected(mean=mean, by=np.stack(by, axis=-1), names=tuple(names))

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
        if drift is not None and self.walk is not None and drift * float(self.walk.max()) < self.floor:
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
    bands, contact = problem.bands, start
    within = _within(problem, start, reach)
    found = problem.expected(contact)
    best = deviance(bands, found.mean, within)
    damping = 1e-2
    for _ in range(_MOST_STEPS if reach == inf else _MOST_STEPS_BELOW):
        weights = within / np.square(found.mean)
        pull = found.by.T @ (weights * (bands.energy - found.mean))
        still = {"noise"} if reach < inf else set()
        if problem.is_widest(contact) and pull[found.names.index("shape")] > 0.0:
            still.add("shape")
        moving = [number for number, name in enumerate(found.names) if name not in still]
        by, score = found.by[:, moving], pull[moving]
        information = (by.T * weights) @ by
        accepted = False
        while damping < _STIFFEST:
            diagonal = np.diag(information.diagonal() * damping + 1e-12 * information.diagonal().max())
            step: Doubles = np.asarray(np.linalg.solve(information + diagonal, score), dtype=np.float64)
            if float(step @ score) < _CLOSE * max(1.0, best):  # half of what the step promises
                break
            trial = problem.moved(contact, tuple(found.names[number] for number in moving), step)
            there = problem.expected(trial)
            worth = deviance(bands, there.mean, within)
            if worth <= best:
                accepted = True
                break
            damping *= 10.0
        if not accepted:
            break
        gain, best, contact, found = best - worth, worth, trial, there
        damping = max(0.1 * damping, 1e-12)
        if gain < _CLOSE * max(1.0, best):
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
    weights = bands.weight[: low.size]
    found = []
    for shape in problem.population.starts:
        moments = problem.population.moment
        # The spectrum falls at a wavenumber that goes with sqrt(m8 / m6), not with the mean.
        typical = (moments(8, shape) / moments(6, shape)) ** 0.5
        for factor in (0.7, 1.3):
            size = factor * diameter / typical
            energy = problem.expectation.population(problem.table(shape), size)[0]
            level = float(np.sum(weights * low) / np.sum(weights * energy[: low.size]))
            drift = None if problem.walk is None else 1e-3 * float(low.mean()) / float(problem.walk[0])
            found.append(Contact(births=level, diameter=size, shape=shape, noise=noise, drift=drift))
    return found


def whittle(problem: FitProblem, diameter: float, noise: float) -> tuple[Contact, float]:
    """Return the best point of several starts, and its deviance.

    Each search uses the low bands first and adds the rest as it comes closer: far from the right diameter the
    oscillation of the high bands leads to a wrong period.
    """

    def first_worth(start: Contact) -> float:
        return deviance(problem.bands, problem.expected(start).mean, _within(problem, start, _REACHES[0]))

    arrived: list[Contact] = []
    for found in sorted(starts(problem, diameter, noise), key=first_worth)[:_STARTS_REFINED]:
        for reach in _REACHES:
            found, _ = climb(problem, found, reach)  # noqa: PLW2901  (each stage begins where the last one ended)
        # within a small part of a period of the oscillation, two points lead to one minimum
        if not any(
            abs(log(found.diameter / other.diameter)) < _SAME and abs(found.shape - other.shape) <= _SAME * other.shape
            for other in arrived
        ):
            arrived.append(found)
    return min((climb(problem, found) for found in arrived), key=lambda each: each[1])

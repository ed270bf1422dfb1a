"""Laws of junction sizes for a fit: of unit mean, with one shape parameter, and with tables of their energy spectra.

A fit needs the mean energy of a life some hundred times, each time for another shape. In the logarithm of the diameter
it is a convolution, so two fast transforms give it at all wavenumbers at once.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from math import log, sqrt
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import Law
from rubnoise.contact.laws import LAWS
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.theory.unit_pulse import energy as unit_energy

STEP: Final = 1.0 / 1024.0
"""Of ln(k d) and of ln d. At k d = 300 a swing of the transform has ten places."""

_LOWEST, _HIGHEST = -7.0, 6.5  # of ln(k E[d])
_SMALLEST, _LARGEST = -6.0, 8.0  # of ln(d / E[d])
_SETTLED = 700.0  # phase z = k d until which the oscillation of a^(z)^2 fades out
_BALANCE = 3.0  # power of k d that keeps all places of the convolution within the digits of a double
NARROWEST: Final = 0.005
"""The smallest shape that is looked for."""

_SHAPE_STEP = 1e-3
_NEGLIGIBLE = 1e-9
_TINY = 1e-304
_SHOT_NODES = 64
_SHOT_POWER = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Population:
    """A law of diameters of unit mean with one shape parameter s.

    The shape of the normal law is std over centre before drawing again, of the others std over mean; it is to be found,
    up to ``widest``, or the one of ``starts``.
    """

    name: str
    widest: float = 0.0
    starts: tuple[float, ...] = (0.08, 0.25, 0.6)

    @property
    def spread(self) -> bool:
        """Whether there is a shape to be found, from `NARROWEST` on."""
        return self.widest > 0.0

    def law(self, mean: float, shape: float) -> Law:
        """Return the law of `rubnoise.contact.laws` with this mean in um."""
        make: Callable[..., Law] = LAWS[self.name].make
        centre = mean / make(1.0, shape, {}).mean
        return make(centre, shape * centre, {})

    def moment(self, power: int, shape: float) -> float:
        """Return E[d^n]."""
        return self.law(1.0, shape).moment(power)

    def moment_slope(self, power: int, shape: float) -> float:
        """Return dE[d^n]/ds, by a central difference; 0 if the shape is not fitted."""
        if not self.spread:
            return 0.0
        change = _SHAPE_STEP * shape
        return (self.moment(power, shape + change) - self.moment(power, shape - change)) / (2.0 * change)

    def by_shape(self, power: int, shape: float) -> float:
        """Return d ln E[d^n] / d ln s."""
        return shape * self.moment_slope(power, shape) / self.moment(power, shape)

    def relative_spread(self, shape: float) -> float:
        """Return std over mean of the law as it is drawn."""
        return sqrt(max(self.moment(2, shape) - 1.0, 0.0))


POPULATIONS: Final[dict[str, Population]] = {
    each.name: each
    for each in (
        Population(name="fixed", starts=(0.0,)),
        Population(name="normal", widest=2.0),
        Population(name="lognormal", widest=1.2),
        Population(name="exponential", starts=(1.0,)),
        Population(name="gamma", widest=1.6),
    )
}
"""The laws that a fit may choose from, by their names in a scenario."""


_LOG_DIAMETERS: Final = np.arange(_SMALLEST, _LARGEST, STEP)
_LOG_PHASES: Final = np.arange(_LOWEST, _HIGHEST, STEP)


@cache
def _single_energies(pulse: Pulse) -> tuple[Doubles, Doubles]:
    """Return all phases k d that the tables meet, at even steps of their logarithm, and a^(k d)^2 there."""
    places = _LOG_PHASES.size + _LOG_DIAMETERS.size - 1
    phases = np.exp(_LOWEST + _SMALLEST + STEP * np.arange(places))
    return phases, unit_energy(pulse, phases, _SETTLED)


@cache
def _balanced_transform(pulse: Pulse) -> tuple[Doubles, int]:
    """Return the Fourier transform of e^(3y) a^(e^y)^2 over all ln(k d), and its length in places."""
    from scipy.fft import next_fast_len, rfft

    phases, energies = _single_energies(pulse)
    length = next_fast_len(phases.size)
    return rfft(energies * phases**_BALANCE, length), length


@cache
def _energy_integral(pulse: Pulse) -> Doubles:
    """Return the integral of a^(z)^2 (1 + z^p) over y = ln z up to each phase of `_single_energies`.

    It is constant at its ends, so that differences keep their digits.
    """
    phases, energies = _single_energies(pulse)
    level = energies * (1.0 + phases ** pulse.tail[1])
    return np.concatenate([[0.0], np.cumsum(0.5 * STEP * (level[1:] + level[:-1]))])


def mean_life_energy(log_phase: Doubles, width: Doubles, pulse: Pulse = LENS) -> Doubles:
    """Return a^(z)^2 at each ``log_phase``, averaged over ``width`` of ln z, without the oscillation within it.

    Below and above the tables it is constant; ``width`` is at least two of their steps.
    """
    integral = _energy_integral(pulse)
    places = _LOWEST + _SMALLEST + STEP * np.arange(integral.size)
    half = np.maximum(0.5 * width, STEP)
    inside = np.clip(log_phase, places[0] + half, places[-1] - half)
    within = np.interp(inside + half, places, integral) - np.interp(inside - half, places, integral)
    return within / (2.0 * half) / (1.0 + np.exp(pulse.tail[1] * log_phase))


def _density(population: Population, shape: float, log_diameters: Doubles) -> Doubles:
    """Return the density of ln d, d of unit mean."""
    x = np.exp(log_diameters)
    with np.errstate(under="ignore"):
        return np.maximum(population.law(1.0, shape).density(x), _TINY) * x


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyTable:
    """The mean energy e(z) = E[x^6 a^(z x)^2] of sizes x of unit mean, at z = k E[d].

    ``rows`` are e, its first and second derivative by ln z, and its derivative by the shape, times 1 + z^p, as cubic
    splines with even steps of ln z; ``zero`` is e(0), and e goes as ``tail`` / z^p, p the ``power``: of the lens
    (4/9) E[x^6], 4 E[x^2] and 4.
    """

    rows: Doubles
    zero: float
    tail: float
    power: int
    zero_by_shape: float
    tail_by_shape: float

    def at(self, phase: Doubles) -> Doubles:
        """Return e, de/dln z, d2e/dln z^2 and de/ds at phases (a row each), beyond the table as at its end."""
        from scipy.ndimage import map_coordinates

        place = (np.log(np.maximum(phase, 1e-300)) - _LOWEST) / STEP
        found = [map_coordinates(row, place[None], order=3, mode="nearest", prefilter=False) for row in self.rows]
        return np.stack(found) / (1.0 + phase**self.power)


@lru_cache(maxsize=64)
def energy_table(name: str, shape: float, pulse: Pulse = LENS) -> EnergyTable:
    """Return the mean energies of a population with a shape."""
    from scipy.ndimage import spline_filter1d

    population = POPULATIONS[name]
    z = np.exp(_LOG_PHASES)
    if name == "fixed":
        energy, by_shape = unit_energy(pulse, z, _SETTLED), np.zeros_like(z)
    else:
        change = _SHAPE_STEP * shape
        shapes = (shape, shape - change, shape + change)
        here, below, above = (STEP * _density(population, each, _LOG_DIAMETERS) for each in shapes)
        energy, by_shape = _averaged(np.stack([here, (above - below) / (2.0 * change)]), pulse)
        energy = np.maximum(energy, 0.0)
    factor, power = pulse.tail
    raised = z**power
    scaled = energy * (1.0 + raised)
    first = _slope(scaled) - power * raised / (1.0 + raised) * scaled
    second = (1.0 + raised) * _slope(first / (1.0 + raised))
    rows = np.stack([scaled, first, second, by_shape * (1.0 + raised)])
    return EnergyTable(
        rows=spline_filter1d(rows, order=3, axis=1, mode="mirror"),
        zero=pulse.integral_moment(2) * population.moment(6, shape),
        tail=factor * population.moment(6 - power, shape),
        power=power,
        zero_by_shape=pulse.integral_moment(2) * population.moment_slope(6, shape),
        tail_by_shape=factor * population.moment_slope(6 - power, shape),
    )


def _averaged(weights: Doubles, pulse: Pulse) -> Doubles:
    """Return E[x^6 a^(z x)^2] at every phase of the table, one row for each row of probabilities or their slopes."""
    from scipy.fft import irfft, rfft

    transform, length = _balanced_transform(pulse)
    balanced = weights * np.exp((6.0 - _BALANCE) * _LOG_DIAMETERS)
    sums = irfft(transform * np.conj(rfft(balanced, length, axis=-1)), length, axis=-1)[:, : _LOG_PHASES.size]
    averaged: Doubles = sums * np.exp(-_BALANCE * _LOG_PHASES)
    return averaged


def _slope(values: Doubles) -> Doubles:
    """Return the derivative by ln z, by differences of fourth order."""
    slope: Doubles = np.gradient(values, STEP)
    slope[2:-2] = (8.0 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])) / (12.0 * STEP)
    return slope


def shot_sizes(population: Population, shape: float) -> tuple[Doubles, Doubles, float]:
    """Return sizes of unit mean, their probabilities and their step in ln x, for averages over single junctions.

    Averages go up to x^12, so the sizes reach further than those in most traces. They are too far apart for the
    oscillation of an energy at large k d: `mean_life_energy` over a step leaves it out.
    """
    if population.name == "fixed":
        return np.ones(1), np.ones(1), 0.0
    logs = np.log(np.maximum(STEP * _density(population, shape, _LOG_DIAMETERS), 1e-300))
    first, last = (logs + power * _LOG_DIAMETERS for power in (1, _SHOT_POWER))
    lowest = _LOG_DIAMETERS[first > first.max() + log(_NEGLIGIBLE)][0]
    highest = _LOG_DIAMETERS[last > last.max() + log(_NEGLIGIBLE)][-1]
    places = np.linspace(lowest, highest, _SHOT_NODES)
    probability = _density(population, shape, places)
    return np.exp(places), probability / probability.sum(), float(places[1] - places[0])

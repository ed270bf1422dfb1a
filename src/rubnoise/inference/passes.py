"""The sensor's filter, and single passes of junctions at each offset behind it, of which shot noise consists.

The sensor has equal analogue poles before sampling, and white noise after it.

Averages over offsets have closed forms, single offsets have none. Here a few offsets represent all; their values are
found by sums, and scaled so that their average is the closed form.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import inf, isinf, pi
from typing import Final

import numpy as np

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.pulses import Pulse, area_of, half_life
from rubnoise.inference.populations import mean_life_energy

_OFFSETS: Final = 8
_PLACES: Final = 400  # along half a pass
_LOG_PHASES: Final = np.linspace(np.log(0.05), np.log(80.0), 1200)
_SMOOTHED: Final = 24  # of these phases: a tenth of ln z
_GRID: Final = 2048
_DECAYS: Final = 16.0
_SLOWEST: Final = 1.0  # of the decay of the sensor over d: smaller junctions bring next to nothing

_PIECE: Final = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """A filter |H|^2 = 1/(1 + (k/kc)^2)^p with ``corner`` kc in rad per tick and ``poles`` p; inf passes everything."""

    corner: float = inf
    poles: int = 1

    @property
    def is_open(self) -> bool:
        """Whether it passes everything."""
        return isinf(self.corner)

    def energy(self, wavenumber: Doubles) -> Doubles:
        """Return |H|^2."""
        return (1.0 + np.square(wavenumber / self.corner)) ** -self.poles

    def slopes(self, wavenumber: Doubles) -> tuple[Doubles, Doubles]:
        """Return the first and second derivative of |H|^2 by ln k: with x = (k/kc)^2, -2 p x and 4 p x (p x - 1)."""
        x, p = np.square(wavenumber / self.corner), self.poles
        whole = (1.0 + x) ** (-p - 2.0)
        return -2.0 * p * x * (1.0 + x) * whole, 4.0 * p * x * (p * x - 1.0) * whole

    def response(self, wavenumber: Doubles) -> Complexes:
        """Return H = 1/(1 + i k/kc)^p, a causal filter."""
        return np.asarray((1.0 + 1j * wavenumber / self.corner) ** -self.poles, dtype=np.complex128)

    def filtered(self, values: Doubles) -> Doubles:
        """Return a trace after the filter; it wraps round at its ends."""
        return _through(self.response, values)

    def mirrored(self, values: Doubles) -> Doubles:
        """Return a trace without the delay of the filter, |H|/H, in which a life is its own mirror image again.

        It is done in parts, to limit memory; white noise stays white.
        """
        if self.is_open:
            return values

        def undelayed(wavenumber: Doubles) -> Complexes:
            seen = self.response(wavenumber)
            return np.asarray(np.abs(seen) / seen)

        found, parts = np.empty_like(values), -(-values.size // _PIECE)
        for part, into in zip(np.array_split(values, parts), np.array_split(found, parts), strict=True):
            into[:] = _through(undelayed, part)
        return found


def _through(response: Callable[[Doubles], Complexes], values: Doubles) -> Doubles:
    from scipy.fft import irfft, rfft

    k = 2.0 * np.pi * np.arange(values.size // 2 + 1) / values.size
    found: Doubles = irfft(rfft(values) * response(k), values.size)
    return found


OPEN: Final = Sensor()  # a sensor that passes everything


@cache
def offsets(pulse: Pulse) -> tuple[Doubles, Doubles]:
    """Return offsets b over d that represent all, and their probabilities; only 0 for passes through both centres."""
    if pulse.offset == "none":
        return np.zeros(1), np.ones(1)
    place, weight = np.polynomial.legendre.leggauss(_OFFSETS)
    return 0.5 * (place + 1.0), 0.5 * weight


@cache
def first_integrals(pulse: Pulse) -> Doubles:
    """Return int a ds of unit diameter at each offset; their mean is c_1."""
    found = _transforms(pulse, np.zeros(1))[:, 0]
    mean = float(offsets(pulse)[1] @ found)
    return np.asarray(found * (pulse.life_integral(1) / mean), dtype=np.float64)


def energies(pulse: Pulse, log_phase: Doubles, width: Doubles) -> Doubles:
    """Return |a^(z; b)|^2 at each phase and each offset (the last axis), its level over ``width`` of ln z."""
    mean = mean_life_energy(log_phase, width, pulse)
    return np.stack([mean * np.interp(log_phase, _LOG_PHASES, each) for each in _shares(pulse)], axis=-1)


@cache
def _shares(pulse: Pulse) -> Doubles:
    """Return the energy at each offset over the mean of all, without its oscillation; constant beyond the ends."""
    from scipy.ndimage import uniform_filter1d

    level = uniform_filter1d(np.square(_transforms(pulse, np.exp(_LOG_PHASES))), _SMOOTHED, axis=1, mode="nearest")
    return np.asarray(level / (offsets(pulse)[1] @ level), dtype=np.float64)


def _transforms(pulse: Pulse, phases: Doubles) -> Doubles:
    """Return a^(z; b) about the middle of a pass of unit diameter, a row for each offset."""
    nodes, weights = np.polynomial.legendre.leggauss(_PLACES)
    rows = []
    for offset in offsets(pulse)[0].tolist():
        half = float(half_life(np.ones(1), np.full(1, offset))[0])
        x = 0.5 * half * (nodes + 1.0)
        area = area_of(pulse, half + x, 1.0, offset)
        rows.append(half * (np.cos(np.outer(phases, x)) @ (weights * area)))
    return np.stack(rows)


def life_integrals(pulse: Pulse, sensor: Sensor, diameters: Doubles) -> tuple[Doubles, Doubles]:
    """Return int g^2 ds and int g^3 ds, g the area after the sensor, at each diameter (rows) and offset, in ticks.

    Without a filter and through both centres they are c_2 d^5 and c_3 d^7.
    """
    scale = diameters[:, None]
    if pulse.offset == "none" and sensor.is_open:
        return np.asarray(pulse.life_integral(2) * scale**5), np.asarray(pulse.life_integral(3) * scale**7)
    decay = np.minimum(1.0 / (sensor.corner * diameters), _SLOWEST)
    length = 2.0 + _DECAYS * float(decay.max())
    step = length / _GRID
    area = np.stack([area_of(pulse, step * np.arange(_GRID), 1.0, each) for each in offsets(pulse)[0]])
    waves: Doubles = 2.0 * pi / length * np.arange(_GRID // 2 + 1, dtype=np.float64)
    slow = np.maximum(decay, 1e-9).tolist()
    seen = np.stack([Sensor(corner=1.0 / each, poles=sensor.poles).response(waves) for each in slow])
    behind = np.fft.irfft(np.fft.rfft(area)[None] * seen[:, None], _GRID)
    second = step * np.sum(np.square(behind), axis=-1) * scale**5
    third = step * np.sum(behind**3, axis=-1) * scale**7
    return second, third


def passed(pulse: Pulse, sensor: Sensor, diameters: Doubles, probability: Doubles) -> tuple[float, float]:
    """Return the shares of the second and third cumulants of a population that pass the sensor."""
    weights = np.outer(probability, offsets(pulse)[1])
    seen, whole = (np.stack(life_integrals(pulse, each, diameters)) for each in (sensor, OPEN))
    second, third = ((weights * seen).sum((1, 2)) / (weights * whole).sum((1, 2))).tolist()
    return second, third

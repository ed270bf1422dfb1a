"""Friction traces whose junctions are known, made with numpy alone: they share no code with rubnoise, and judge it.

Junctions of one diameter d are born at random along the sliding distance. Each adds its strength times the overlap of
two circles of diameter d. The sum goes through the sensor: a filter of one or two poles, then white noise. Lengths are
in um, forces in uN. `tools/studies inference` fits these traces; tests take single ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]

_OVERSAMPLED = 8
_AT_ONCE = 512
_TURN = 0.01
"""Part of a stroke in which the force turns round."""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """What makes a trace.

    ``count`` junctions at a time of ``diameter`` and mean ``strength``, lognormal with ``strength_spread`` over it;
    ``off_centre`` passes miss the centre line by an offset uniform on (-d, d). ``per_life`` samples lie on 2 d of
    sliding, ``lives`` times 2 d is a stroke. ``bandwidth`` is the corner of each of ``poles`` in cycles per 2 d (none
    without one). ``noise`` and ``drift`` (a ramp over the trace) are in standard deviations of the force. ``strokes``
    go to and fro about the ``zero`` of the sensor, in means of the force.
    """

    count: float = 20.0
    diameter: float = 5.5
    strength: float = 250.0
    strength_spread: float = 0.0
    off_centre: bool = False
    per_life: int = 64
    lives: int = 450
    bandwidth: float | None = None
    poles: int = 1
    noise: float = 0.05
    drift: float = 0.0
    strokes: int = 1
    zero: float = 0.0

    @property
    def tick(self) -> float:
        """The distance between samples in um."""
        return 2.0 * self.diameter / self.per_life

    @property
    def mean_life(self) -> float:
        """The mean life in um: 2 d, off the centre the mean chord (pi/2) d."""
        return (np.pi / 2.0 if self.off_centre else 2.0) * self.diameter


def trace(contact: Contact, rng: np.random.Generator) -> Doubles:
    """Return the friction force in uN at every tick."""
    sensor = contact.bandwidth is not None
    fine = _OVERSAMPLED if sensor else 1
    samples = contact.lives * contact.per_life * fine
    before = 4 * contact.per_life * fine if sensor else 0
    parts = []
    for number in range(contact.strokes):
        force = _stroke(contact, samples + (before if number == 0 else 0), contact.tick / fine, rng)
        if number:
            ramp = np.clip(np.arange(force.size) / (_TURN * force.size), 0.0, 1.0)
            force *= 2.0 * ramp - 1.0
        parts.append(force if number % 2 == 0 else -force)
    scale = parts[0][before:]
    spread, mean = float(scale.std()), float(scale.mean())
    force = np.concatenate(parts) + contact.zero * mean
    if contact.bandwidth is not None:
        corner = 2.0 * np.pi * contact.bandwidth / (contact.per_life * fine)
        force = filtered(force, corner, contact.poles)[before::fine]
    force += contact.noise * spread * rng.standard_normal(force.size)
    return force + contact.drift * spread * np.linspace(0.0, 1.0, force.size)


def _stroke(contact: Contact, samples: int, tick: float, rng: np.random.Generator) -> Doubles:
    """Return the force of one stroke: junctions born from one life before it until its end."""
    d, life = contact.diameter, 2.0 * contact.diameter
    length = samples * tick + life
    births = rng.poisson(contact.count / contact.mean_life * length)
    middle = rng.uniform(-0.5 * life, samples * tick + 0.5 * life, births)
    missed = rng.uniform(-d, d, births) if contact.off_centre else np.zeros(births)
    strength = np.full(births, contact.strength)
    if contact.strength_spread:
        variance = np.log1p(contact.strength_spread**2)
        strength *= np.exp(rng.normal(-0.5 * variance, np.sqrt(variance), births))
    force = np.zeros(samples)
    steps = np.arange(int(life / tick) + 2)
    for begin in range(0, births, _AT_ONCE):
        chunk = slice(begin, begin + _AT_ONCE)
        place = np.floor((middle[chunk] - d) / tick).astype(np.int64)[:, None] + steps
        x = place * tick - middle[chunk, None]
        area = d * d * overlap(np.hypot(x, missed[chunk, None]) / d)
        seen = (place >= 0) & (place < samples)
        force += np.bincount(place[seen], weights=(area * strength[chunk, None])[seen], minlength=samples)
    return force


def overlap(apart: Doubles) -> Doubles:
    """Return the area common to two circles of unit diameter whose centres are so far apart."""
    r = np.minimum(apart, 1.0)
    return np.asarray(0.5 * (np.arccos(r) - r * np.sqrt(1.0 - r * r)), dtype=np.float64)


def filtered(force: Doubles, corner: float, poles: int) -> Doubles:
    """Return the force behind equal poles at a corner in rad per sample, 1/(1 + i w/wc) each.

    It wraps round: the beginning is that of the end, and is left out.
    """
    w = 2.0 * np.pi * np.arange(force.size // 2 + 1) / force.size
    return np.fft.irfft(np.fft.rfft(force) / (1.0 + 1j * w / corner) ** poles, force.size)


def without_junctions(kind: str, samples: int, rng: np.random.Generator) -> Doubles:
    """Return a trace of mean 5 and standard deviation 1 that no junctions make: "ar1", "pink" (1/f), or "sawtooth"."""
    if kind == "ar1":
        kernel = 0.95 ** np.arange(400)
        values = np.convolve(rng.standard_normal(samples + 400), kernel)[400 : samples + 400]
    elif kind == "pink":
        white = np.fft.rfft(rng.standard_normal(samples))
        values = np.fft.irfft(white / np.sqrt(np.maximum(np.arange(white.size), 1.0)), samples)
    elif kind == "sawtooth":
        values = (np.arange(samples) + rng.integers(200)) % 200 / 200.0 + 0.02 * rng.standard_normal(samples)
    else:
        raise ValueError(f"no kind {kind}")
    return 5.0 + (values - values.mean()) / values.std()

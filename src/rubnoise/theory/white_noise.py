"""Kilburn's model beside the contact's own: a mean force and white noise of the same level at low frequency."""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.drive import drive_of
from rubnoise.theory.spectrum import force_spectral_density, half_power_wavenumber


@dataclass(frozen=True, slots=True, kw_only=True)
class WhiteNoise:
    """White noise S_F in uN^2 s (two-sided, per rad/s), and the spread of a slider that it drives, in um and um/s.

    ``wavenumber`` in rad/um is where the contact's own spectrum has fallen to a half, ``life_phase`` that times the
    mean life; both are None if the spectrum has no such corner.
    """

    force_density: float
    displacement_std: float
    velocity_std: float
    wavenumber: float | None
    life_phase: float | None


def white_noise(model: Model) -> WhiteNoise:
    """Return white noise that matches the contact's force at low frequency, S_F = S_force(0)/V, and what it drives.

    For Poisson births S_force(0) is E[psi^2] S_A(0). Exact: Var x = S_F/(2 c k), Var x' = S_F/(2 c m), inf without
    damping. Raises Refused without slider, strength or speed.
    Source: Kilburn (1974); Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    density, slider = _level(model), drive_of(model).slider
    still = 2.0 * slider.damping
    try:
        corner = half_power_wavenumber(model)
    except Refused:
        corner = None
    return WhiteNoise(
        force_density=density,
        displacement_std=sqrt(density / (still * slider.stiffness)) if still else inf,
        velocity_std=sqrt(density / (still * slider.mass)) if still else inf,
        wavenumber=corner,
        life_phase=None if corner is None else corner * model.mean_life_distance,
    )


def white_displacement_spectrum(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F / ((k - m w^2)^2 + (c w)^2), the two-sided density in um^2 per rad/s that white noise would leave.

    w in rad/s of any shape; w^2 times it is that of the velocity. Errors and source as `white_noise`.
    """
    slider, w = drive_of(model).slider, np.asarray(angular_frequency, dtype=np.float64)
    still = np.square(slider.stiffness - slider.mass * w * w) + np.square(slider.damping * w)
    return np.asarray(_level(model) / still, dtype=np.float64)


def white_force_spectrum(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F in uN^2 per rad/s at every w in rad/s; errors and source as `white_noise`."""
    return np.full_like(angular_frequency, _level(model))


def _level(model: Model) -> float:
    drive = drive_of(model)
    return float(force_spectral_density(model, drive.strengths, 0.0)) / drive.speed

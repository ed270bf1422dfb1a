"""The spectra of the one-way slider's displacement and velocity."""

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.drive import Drive, drive_of
from rubnoise.theory.spectrum import force_spectral_density

Doubles = NDArray[np.float64]


def displacement_spectrum(model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return the two-sided spectral density S_x(w) of the slider's displacement in um^2 per rad/s, w in rad/s.

    S_x(w) = S_F(w/V)/V / |k - m w^2 + i c w|^2, S_F the spectrum of the force, E[psi^2] S for Poisson births;
    Cov[x(t), x(t + u)] = (1/2 pi) int S_x exp(i w u) dw, so that Var x = (1/pi) int_0^inf S_x dw. Of regular births it
    is the continuous part, beside lines at w = V k_n. Any shape of w. Raises Refused without slider, strength or speed,
    and without damping, where nothing is stationary.
    Source: paper Eq. (1) and Fig. 5; Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    drive = _damped_drive(model)
    k = np.abs(np.asarray(angular_frequency, dtype=np.float64)) / drive.speed
    return force_spectral_density(model, drive.strengths, k) / drive.speed * drive.gain(k)


def velocity_spectrum(model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return S_v(w) = w^2 S_x(w) in (um/s)^2 per rad/s, the spectral density of the velocity; see above."""
    w = np.asarray(angular_frequency, dtype=np.float64)
    return np.square(w) * displacement_spectrum(model, w)


def displacement_spectrum_per_hertz(model: Model, frequency: ArrayLike) -> Doubles:
    """Return the one-sided density 2 S_x(2 pi f) in um^2 per Hz at f >= 0 in Hz, so that int_0^inf df gives Var x."""
    return 2.0 * displacement_spectrum(model, 2.0 * pi * np.asarray(frequency, dtype=np.float64))


def _damped_drive(model: Model) -> Drive:
    drive = drive_of(model)
    if drive.slider.damping == 0.0:
        raise Refused("without damping the slider's motion is not stationary and has no spectrum")
    return drive

"""The response of the one-way slider: the spectra of displacement and velocity, and their integrals."""

from dataclasses import dataclass
from functools import lru_cache
from math import inf, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.drive import Drive, drive_of, motion_drive_of, separation_of
from rubnoise.theory.quadrature import distinct, panels, size_range
from rubnoise.theory.regular_births import spectral_lines
from rubnoise.theory.spectrum import force_spectral_density
from rubnoise.theory.transform import largest_swinging_wavenumber

Rule = tuple[Doubles, Doubles]

_NODES = 16
_SWING = 8.0  # phase k d of a panel that still follows the swing, which has period pi
_RESOLVED = 4000.0  # phase to which every swing is followed; beyond it the swing holds less than 1e-8 of any integral
_SETTLED = 256.0  # the same for a slider too slow for such phases, by which it has nearly come to rest
_ABOVE = 100.0  # and for a faster one so many times its last corner; what is not followed there is below 1e-12
_AROUND = 2000.0  # phase on either side of a far and sharp resonance to which the swing is followed
_SHARP = 30.0  # half-width of the resonance, as a phase, above which it averages over the swing by itself


def response_rules(model: Model, drive: Drive) -> tuple[Rule, Rule]:
    """Return nodes and weights over k > 0 in rad/um: on panels that resolve the oscillation of S(k), and on wider ones.

    Panels grow by octaves from far below to far above every corner, by octaves of distance from the resonance
    (beginning at half its half-width), and never exceed a phase of 8 where the swing counts. Under a load that weighs
    they are those for its resonance, too.
    """
    edges = response_edges(model, drive)
    if model.separation is not None:
        edges = distinct(np.append(edges, response_edges(model, drive_of(separation_of(model)))))
    follows = np.diff(edges) * size_range(model.sizes)[1] <= 1.001 * _SWING
    nodes, weights = (part.reshape(-1, _NODES) for part in panels(edges, _NODES))
    return (nodes[follows].ravel(), weights[follows].ravel()), (nodes[~follows].ravel(), weights[~follows].ravel())


def response_edges(model: Model, drive: Drive) -> Doubles:
    """Return the ends of all panels in rad/um, in order, from 0 on."""
    reach = size_range(model.sizes)[1]
    swinging = largest_swinging_wavenumber(model.sizes)
    breadth = max(1.0, 2.0 * drive.slider.damping_ratio)
    settled = max(_SETTLED, _ABOVE * drive.resonance * breadth * reach)
    resolved = min(min(_RESOLVED, settled) / reach, swinging)
    lowest = 1e-3 * min(1.0 / reach, drive.resonance / breadth)
    highest = 1e4 * max(resolved, drive.resonance * breadth)
    parts = [
        np.zeros(1),
        _octaves(lowest, highest),
        np.arange(0.0, resolved, _SWING / reach),
        _around_resonance(drive),
    ]
    half_width = drive.slider.damping_ratio * drive.resonance
    if resolved < drive.resonance < swinging and half_width * reach < _SHARP:
        parts.append(drive.resonance + np.arange(-_AROUND, _AROUND, _SWING) / reach)
    return distinct(np.concatenate(parts))


def _octaves(lowest: float, highest: float) -> Doubles:
    return lowest * 2.0 ** np.arange(0.0, np.ceil(np.log2(highest / lowest)) + 1.0)


def _around_resonance(drive: Drive) -> Doubles:
    half_width = drive.slider.damping_ratio * drive.resonance
    if half_width >= drive.resonance:
        return np.array([drive.resonance])
    distances = np.minimum(_octaves(0.5 * half_width, drive.resonance), drive.resonance)
    return np.concatenate([drive.resonance - distances, [drive.resonance], drive.resonance + distances])


def displacement_spectrum(model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return the two-sided spectral density S_x(w) of the slider's displacement in um^2 per rad/s, w in rad/s.

    S_x(w) = S_F(w/V)/V / |k - m w^2 + i c w|^2, S_F the spectrum of the force, E[psi^2] S for Poisson births;
    Cov[x(t), x(t + u)] = (1/2 pi) int S_x exp(i w u) dw, so that Var x = (1/pi) int_0^inf S_x dw. Of regular births it
    is the continuous part, beside lines at w = V k_n. Any shape of w. Raises Refused without slider, strength or speed,
    and without damping, if nothing is stationary.
    Source: paper Eq. (1) and Fig. 5; Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    drive = motion_drive_of(model)
    if drive.slider.damping == 0.0:
        raise Refused("without damping the slider's motion is not stationary and has no spectrum")
    k = np.abs(np.asarray(angular_frequency, dtype=np.float64)) / drive.speed
    return force_spectral_density(model, drive.strengths, k) / drive.speed * drive.gain(k)


def velocity_spectrum(model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return S_v(w) = w^2 S_x(w) in (um/s)^2 per rad/s, the spectral density of the velocity; see above."""
    w = np.asarray(angular_frequency, dtype=np.float64)
    return np.square(w) * displacement_spectrum(model, w)


def displacement_spectrum_per_hertz(model: Model, frequency: ArrayLike) -> Doubles:
    """Return the one-sided density 2 S_x(2 pi f) in um^2 per Hz at f >= 0 in Hz, so that int_0^inf df gives Var x."""
    return 2.0 * displacement_spectrum(model, 2.0 * pi * np.asarray(frequency, dtype=np.float64))


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Stationary motion of the one-way slider: displacement in um, velocity in um/s."""

    mean_displacement: float
    displacement_std: float
    velocity_std: float
    sliding_speed: float

    @property
    def one_way_validity(self) -> float:
        """Spread of x' over V: one-way coupling assumes that it is small; above 0.1 results get a warning."""
        return self.velocity_std / self.sliding_speed


def mean_displacement(model: Model) -> float:
    """Return the mean of x in um, E[psi] mean A_r / k: the static deflection, or the mean of a base."""
    drive = motion_drive_of(model)
    still = drive.strengths.moment(1) * model.stationary_mean_area
    return still if drive.slider.excitation == "base" else still / drive.slider.stiffness


@lru_cache(maxsize=8)
def response(model: Model) -> Response:
    """Return the exact stationary mean and spread of the one-way slider's displacement, and the spread of its velocity.

    S_x(w) = S_F(w/V)/V / |k - m w^2 + i c w|^2, S_F the spectrum of the force, E[psi^2] S for Poisson births;
    Var x = (1/pi) int_0^inf S_x dw, Var x' = (1/pi) int_0^inf w^2 S_x dw, mean x = E[psi] mean A_r / k; inf without
    damping. Over a base the density is (k^2 + c^2 w^2) S_y, y in place of the force. The lines of regular births add
    2 E[psi]^2 power / |k - m w^2 + i c w|^2 each at w = V k_n. Relative error below 1e-8, 1e-12 in ordinary cases.
    Raises Refused without slider, strength or speed.
    Source: paper Eq. (1) and Fig. 5; Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    drive = motion_drive_of(model)
    displacement, velocity = inf, inf
    if drive.slider.damping > 0.0:
        displacement, velocity = (sqrt(variance) for variance in _variances(model, drive))
    return Response(
        mean_displacement=mean_displacement(model),
        displacement_std=displacement,
        velocity_std=velocity,
        sliding_speed=drive.speed,
    )


def _variances(model: Model, drive: Drive) -> tuple[float, float]:
    """Return Var x in um^2 and Var x' in (um/s)^2."""
    variances = np.zeros(2)
    for (k, weights), exact in zip(response_rules(model, drive), (True, False), strict=True):
        density = force_spectral_density(model, drive.strengths, k, exact=exact)
        variances += _moved(drive, k, weights * density / pi)
    k, power = spectral_lines(model)
    variances += _moved(drive, k, 2.0 * drive.strengths.mean**2 * power)
    return float(variances[0]), float(variances[1])


@lru_cache(maxsize=8)
def force_variance(model: Model) -> float:
    """Return the variance of friction force in uN^2 under a load that weighs, (1/pi) int_0^inf S_F dk."""
    drive = drive_of(separation_of(model))
    strengths, variance = model.strengths or drive.strengths, 0.0
    for (k, weights), exact in zip(response_rules(model, drive), (True, False), strict=True):
        variance += float(weights @ force_spectral_density(model, strengths, k, exact=exact)) / pi
    return variance


def _moved(drive: Drive, wavenumber: Doubles, force: Doubles) -> Doubles:
    """Return the variances of displacement and velocity due to variances of the force at wavenumbers."""
    displacement = force * drive.gain(wavenumber)
    return np.array([displacement.sum(), displacement @ np.square(drive.speed * wavenumber)])

"""What the friction force moves, one-way: the drive of a slider, and spectra and spreads by one rule over frequencies.

Every stationary spread is (1/pi) int_0^inf S(k) |h(k)|^2 dk, plus lines, S the spectrum of the area. A covariance
equation in time would lose the digits of a slow slider, whose resonance holds 1e-8 of the force.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.laws import Fixed, Law
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.second_order import area_noise
from rubnoise.theory.sizes import panels, size_range, sizes_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """A slider, the strengths of the junctions that drive it, and the speed (um/s) that turns distance into time."""

    slider: Slider
    strengths: Law
    speed: float

    @property
    def resonance(self) -> float:
        """The natural angular frequency as a wavenumber, sqrt(k/m)/V in rad/um."""
        return self.slider.natural_angular_frequency / self.speed

    def compliance(self, wavenumber: Doubles) -> Complexes:
        """Return 1 / (k - m w^2 + i c w) in um/uN at w = V times the wavenumbers (rad/um), for signs of exp(i w t)."""
        slider, natural = self.slider, self.slider.natural_angular_frequency
        frequency = self.speed * wavenumber
        spring = slider.mass * (natural - frequency) * (natural + frequency)
        return np.asarray(1.0 / (spring + 1.0j * slider.damping * frequency), dtype=np.complex128)

    def borne(self, wavenumber: Doubles) -> Complexes:
        """Return (-m w^2 + i c w) / (k - m w^2 + i c w), the part of the force that mass and damping bear."""
        frequency, slider = self.speed * wavenumber, self.slider
        return (1.0j * slider.damping - slider.mass * frequency) * frequency * self.compliance(wavenumber)

    def gain(self, wavenumber: Doubles) -> Doubles:
        """Return 1 / |k - m w^2 + i c w|^2 in um^2/uN^2; of a base, which drives by k y + c y', times k^2 + c^2 w^2."""
        gain = np.square(np.abs(self.compliance(wavenumber)))
        if self.slider.excitation == "friction":
            return gain
        return gain * (self.slider.stiffness**2 + np.square(self.slider.damping * self.speed * wavenumber))


def drive_of(model: Model) -> Drive:
    """Return the drive of a model; raises Refused if slider, strength or sliding speed is missing."""
    if model.slider is not None and model.slider.excitation != "friction":
        raise Refused(f'the slider is not driven by friction but by slider.excitation = "{model.slider.excitation}"')
    if model.slider is None or model.strengths is None or model.sliding_speed is None:
        raise Refused("the slider's response needs [slider], a shear strength ([strength]) and sliding.speed")
    return Drive(slider=model.slider, strengths=model.strengths, speed=model.sliding_speed)


def motion_drive_of(model: Model) -> Drive:
    """Return the drive of a model; of a base its height per area in um per um^2 takes the place of strengths.

    Raises Refused as `drive_of` does, and for a base whose lives are not triangles of one size.
    """
    if model.slider is None or model.sliding_speed is None or model.slider.excitation != "base":
        return drive_of(model)
    if not isinstance(model.sizes, Fixed):
        raise Refused("excitation by the base is known for equal diameters alone (diameter.law)")
    if model.pulse != TRIANGLE:
        raise Refused('the slider is driven by a base of triangles, which lives are with pulse.shape = "triangle"')
    return Drive(slider=model.slider, strengths=Fixed(value=model.base_per_area), speed=model.sliding_speed)


def separation_of(model: Model) -> Model:
    """Return the model whose slider is the separation s_0 + z, driven by the hardness; Refused without a load."""
    if model.separation is None:
        raise Refused("the separation moves under a load that weighs alone ([load])")
    strengths = Fixed(value=model.separation.hardness)
    return replace(model, slider=model.separation.oscillator, strengths=strengths, separation=None)


_NODES = 16
_SWING = 8.0  # phase k d of a panel that still follows the swing of the spectrum, which has period pi
_RESOLVED = 4000.0  # phase to which every swing is followed; beyond it the swing holds less than 1e-8 of any integral
_SETTLED, _ABOVE = 256.0, 100.0  # the same for a slower slider, and for a faster one so many times its last corner
_AROUND, _SHARP = 2000.0, 30.0  # phases about a far resonance to which it is followed, if narrower than the second


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frequencies:
    """Wavenumbers k in rad/um with weights over k/pi, and both parts of the spectrum of the area in um^4 per rad/um."""

    wavenumber: Doubles
    weight: Doubles
    alone: Doubles
    together: Doubles

    def force(self, model: Model, strengths: Law) -> Doubles:
        """Return the variance of force at each wavenumber, in uN^2."""
        return self.weight * _force_density(model, strengths, self.wavenumber, self.alone, self.together)


@lru_cache(maxsize=8)
def frequencies(model: Model) -> Frequencies:
    """Return the rule for all motions of a model: its slider's and its separation's."""
    drives = [] if model.slider is None else [motion_drive_of(model)]
    if model.separation is not None:
        drives.append(drive_of(separation_of(model)))
    edges = np.unique(np.concatenate([response_edges(model, drive) for drive in drives]))
    k, weight = panels(edges, _NODES)
    follows = np.repeat(np.diff(edges) * size_range(model.sizes)[1] <= 1.001 * _SWING, _NODES)
    noise, parts = area_noise(model), np.zeros((2, k.size))
    for exact in (True, False):
        some = follows == exact
        parts[:, some] = noise.alone(k[some], exact=exact), noise.together(k[some], exact=exact)
    return Frequencies(wavenumber=k, weight=weight / pi, alone=parts[0], together=parts[1])


def response_edges(model: Model, drive: Drive) -> Doubles:
    """Return the ends of panels in rad/um: octaves, no wider than a phase of 8 where the spectrum's swing counts.

    About the resonance they are octaves of the distance from it, from half of its half-width on.
    """
    reach, swinging = size_range(model.sizes)[1], float(sizes_of(model.sizes).followed.max())
    half_width = drive.slider.damping_ratio * drive.resonance
    breadth = max(1.0, 2.0 * drive.slider.damping_ratio)
    resolved = min(min(_RESOLVED, max(_SETTLED, _ABOVE * drive.resonance * breadth * reach)) / reach, swinging)
    lowest = 1e-3 * min(1.0 / reach, drive.resonance / breadth)
    apart = np.minimum(_octaves(0.5 * min(half_width, drive.resonance), drive.resonance), drive.resonance)
    parts = [
        _octaves(lowest, 1e4 * max(resolved, drive.resonance * breadth)),
        np.arange(0.0, resolved, _SWING / reach),
        drive.resonance - apart,
        drive.resonance + np.append(0.0, apart),
    ]
    if resolved < drive.resonance < swinging and half_width * reach < _SHARP:
        parts.append(drive.resonance + np.arange(-_AROUND, _AROUND, _SWING) / reach)
    return np.unique(np.concatenate(parts))


def _octaves(lowest: float, highest: float) -> Doubles:
    return np.asarray(lowest * 2.0 ** np.arange(0.0, np.ceil(np.log2(highest / lowest)) + 1.0), dtype=np.float64)


def force_spectral_density(model: Model, strengths: Law, wavenumber: ArrayLike, *, exact: bool = True) -> Doubles:
    """Return the two-sided spectral density of friction force in uN^2 per rad/um between lines; k in rad/um."""
    k, noise = np.abs(np.asarray(wavenumber, dtype=np.float64)), area_noise(model)
    return _force_density(model, strengths, k, noise.alone(k, exact=exact), noise.together(k, exact=exact))


def _force_density(model: Model, strengths: Law, k: Doubles, alone: Doubles, together: Doubles) -> Doubles:
    """Return the density of force by parts of that of area; under a load a junction brings psi + (r - 1) E[psi]."""
    if model.separation is None:
        return strengths.moment(2) * alone + strengths.mean**2 * together
    borne = np.square(np.abs(drive_of(separation_of(model)).borne(k)))
    return alone * (spread_of(strengths) + strengths.mean**2 * borne)


def spread_of(strengths: Law) -> float:
    """Return the variance of strengths in MPa^2."""
    return max(strengths.moment(2) - strengths.mean**2, 0.0)


def displacement_spectrum(model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return the two-sided spectral density S_x(w) of the slider's displacement in um^2 per rad/s, w in rad/s.

    S_x(w) = S_F(w/V)/V / |k - m w^2 + i c w|^2, S_F that of the force, between lines at w = V k_n. Raises Refused as
    `motion_drive_of`, and without damping, if nothing is stationary.
    Source: paper Eq. (1) and Fig. 5; Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    drive = motion_drive_of(model)
    if drive.slider.damping == 0.0:
        raise Refused("without damping the slider's motion is not stationary and has no spectrum")
    k = np.abs(np.asarray(angular_frequency, dtype=np.float64)) / drive.speed
    return force_spectral_density(model, drive.strengths, k) / drive.speed * drive.gain(k)


def velocity_spectrum(model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return S_v(w) = w^2 S_x(w) in (um/s)^2 per rad/s, the spectral density of the velocity."""
    w = np.asarray(angular_frequency, dtype=np.float64)
    return np.square(w) * displacement_spectrum(model, w)


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

    @property
    def upcrossing_rate(self) -> float:
        """How often x passes its mean upwards in a second if it is Gaussian, std x'/(2 pi std x) (Rice 1945)."""
        return self.velocity_std / (2.0 * pi * self.displacement_std)


def mean_displacement(model: Model) -> float:
    """Return the mean of x in um, E[psi] mean A_r / k: the static deflection, or the mean of a base."""
    drive = motion_drive_of(model)
    still = drive.strengths.moment(1) * model.stationary_mean_area
    return still if drive.slider.excitation == "base" else still / drive.slider.stiffness


@lru_cache(maxsize=8)
def response(model: Model) -> Response:
    """Return the stationary mean and spread of the one-way slider's displacement, and the spread of its velocity.

    Var x = (1/pi) int_0^inf S_x dw, Var x' = (1/pi) int_0^inf w^2 S_x dw, to 1e-8; lines add 2 E[psi]^2 power times the
    gain. inf without damping. Raises Refused as `motion_drive_of`. Source: as above.
    """
    drive = motion_drive_of(model)
    spreads = (inf, inf)
    if drive.slider.damping > 0.0:
        rule, (lines, power) = frequencies(model), area_noise(model).lines
        k = np.concatenate([rule.wavenumber, lines])
        force = np.concatenate([rule.force(model, drive.strengths), 2.0 * drive.strengths.mean**2 * power])
        moved = force * drive.gain(k)
        spreads = (sqrt(float(moved.sum())), sqrt(float(moved @ np.square(drive.speed * k))))
    return Response(
        mean_displacement=mean_displacement(model),
        displacement_std=spreads[0],
        velocity_std=spreads[1],
        sliding_speed=drive.speed,
    )

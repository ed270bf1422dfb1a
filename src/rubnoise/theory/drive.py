"""The friction force on a one-way slider: the inputs of the response, collected and checked once."""

from dataclasses import dataclass, replace

import numpy as np

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.laws import Fixed, Law
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider


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

    def gain(self, wavenumber: Doubles) -> Doubles:
        """Return 1 / |k - m w^2 + i c w|^2 in um^2/uN^2 at w = V times the wavenumbers (rad/um).

        k - m w^2 is taken as m (w_0 - w)(w_0 + w), which keeps its digits in a sharp resonance. Of a base, which drives
        by k y + c y', it is (k^2 + c^2 w^2) times as large, and has no unit.
        """
        slider, natural = self.slider, self.slider.natural_angular_frequency
        frequency = self.speed * wavenumber
        spring = slider.mass * (natural - frequency) * (natural + frequency)
        resisted = np.square(slider.damping * frequency)
        passed = 1.0 if self.slider.excitation == "friction" else np.square(slider.stiffness) + resisted
        return passed / (np.square(spring) + resisted)

    def compliance(self, wavenumber: Doubles) -> Complexes:
        """Return 1 / (k - m w^2 + i c w) in um/uN, for signs of exp(i w t)."""
        slider, natural = self.slider, self.slider.natural_angular_frequency
        frequency = self.speed * wavenumber
        spring = slider.mass * (natural - frequency) * (natural + frequency)
        impedance: Complexes = spring + 1.0j * slider.damping * frequency
        return 1.0 / impedance

    def borne(self, wavenumber: Doubles) -> Complexes:
        """Return (-m w^2 + i c w) / (k - m w^2 + i c w): the part of the force that mass and damping bear.

        The spring bears the rest. Of a separation it is P/W - 1 over what that would be at constant separation.
        """
        frequency = self.speed * wavenumber
        slider = self.slider
        return (1.0j * slider.damping - slider.mass * frequency) * frequency * self.compliance(wavenumber)


def drive_of(model: Model) -> Drive:
    """Return the drive of a model; raises Refused if slider, strength or sliding speed is missing."""
    if model.slider is not None and model.slider.excitation != "friction":
        raise Refused(f'the slider is not driven by friction but by slider.excitation = "{model.slider.excitation}"')
    if model.slider is None or model.strengths is None or model.sliding_speed is None:
        raise Refused("the slider's response needs [slider], a shear strength ([strength]) and sliding.speed")
    return Drive(slider=model.slider, strengths=model.strengths, speed=model.sliding_speed)


def motion_drive_of(model: Model) -> Drive:
    """Return the drive of a model, also of a base: its height per area in um per um^2 takes the place of strengths.

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
    """Return the model whose slider is the separation: s_0 + z in um, driven by the hardness in place of strengths.

    Raises Refused without a load that weighs.
    """
    if model.separation is None:
        raise Refused("the separation moves under a load that weighs alone ([load])")
    separation = model.separation
    strengths = Fixed(value=separation.hardness)
    return replace(model, slider=separation.oscillator, strengths=strengths, separation=None)


def force_power(model: Model, strengths: Law, wavenumber: Doubles) -> Doubles:
    """Return the power of friction force over that of area, in MPa^2.

    E[psi^2] at constant separation. Under a load a junction brings psi - E[psi] + r E[psi], r being `Drive.borne` of
    the separation: Var[psi] + E[psi]^2 |r|^2.
    """
    if model.separation is None:
        return np.full_like(wavenumber, strengths.moment(2))
    spread = max(strengths.moment(2) - strengths.mean**2, 0.0)
    return spread + strengths.mean**2 * np.square(np.abs(drive_of(separation_of(model)).borne(wavenumber)))


def force_terms(model: Model, strengths: Law, wavenumber: Doubles) -> Doubles:
    """Return the factors of one junction's |A^|^2 in the friction force: a row for each power of its strength.

    At constant separation only psi^2 has one. Under a load, with q = psi - E[psi], they are those of q^2, q and 1.
    """
    one = np.ones_like(wavenumber)
    if model.separation is None:
        return one[None]
    mean = strengths.mean * drive_of(separation_of(model)).borne(wavenumber)
    return np.stack([one, 2.0 * mean.real, np.square(np.abs(mean))])


def squared_strengths(strengths: Law, terms: Doubles) -> Doubles:
    """Return the mean over strengths of the square of integrated rows of `force_terms`."""
    if len(terms) == 1:
        return strengths.moment(4) * np.square(terms[0])
    mean, square, cube, fourth = (strengths.moment(n) for n in (1, 2, 3, 4))
    spread = max(square - mean**2, 0.0)
    third = cube - 3.0 * mean * square + 2.0 * mean**3
    kurtosis = fourth - 4.0 * mean * cube + 6.0 * mean**2 * square - 3.0 * mean**4
    own, mixed, same = terms
    return kurtosis * own**2 + 2.0 * third * own * mixed + spread * (mixed**2 + 2.0 * own * same) + same**2

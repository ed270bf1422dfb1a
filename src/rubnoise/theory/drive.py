"""The friction force on a one-way slider: what the response needs, gathered and checked once."""

from dataclasses import dataclass

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
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

        k - m w^2 is taken as m (w_0 - w)(w_0 + w), which keeps its digits in a sharp resonance.
        """
        slider, natural = self.slider, self.slider.natural_angular_frequency
        frequency = self.speed * wavenumber
        spring = slider.mass * (natural - frequency) * (natural + frequency)
        return 1.0 / (np.square(spring) + np.square(slider.damping * frequency))


def drive_of(model: Model) -> Drive:
    """Return the drive of a model; raises Refused where slider, strength or sliding speed is missing."""
    if model.slider is None or model.strengths is None or model.sliding_speed is None:
        raise Refused("the slider's response needs [slider], a shear strength ([strength]) and sliding.speed")
    if model.slider.excitation != "friction":
        raise Refused(f'the slider is not driven by friction but by slider.excitation = "{model.slider.excitation}"')
    return Drive(slider=model.slider, strengths=model.strengths, speed=model.sliding_speed)

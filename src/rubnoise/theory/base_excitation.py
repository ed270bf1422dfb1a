"""Rice and Moslehy's excitation: asperities that lift the base of the slider, m x'' + c x' + k x = c y' + k y.

y is a sum of triangles, one for each junction, that last as long as its life and are as high as the asperity.
"""

from dataclasses import dataclass, replace
from math import inf, pi, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.drive import Drive
from rubnoise.theory.regular_births import spectral_lines
from rubnoise.theory.response import response_rules
from rubnoise.theory.spectrum import force_spectral_density


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseResponse:
    """Stationary motion over a base: mean and spread of the base and of the slider in um, of its velocity in um/s."""

    base_mean: float
    base_std: float
    displacement_std: float
    velocity_std: float


def base_response(model: Model) -> BaseResponse:
    """Return how far and how fast the slider is moved by its base; the mean of x is that of y.

    A triangle of height r d is 4 r/(pi d) times the area of a triangular life of one size d, and so is y of the area;
    S_x(w) = S_y(w/V)/V (k^2 + c^2 w^2) / |k - m w^2 + i c w|^2. Infinite without damping. Raises Refused for a slider
    that is not driven so, and for unequal sizes. Source: Rice and Moslehy (1997); Crandall and Mark (1963).
    """
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None or slider.excitation != "base":
        raise Refused('this needs slider.excitation = "base" with its asperity_height')
    if not isinstance(model.sizes, Fixed):
        raise Refused("excitation by the base is known for equal diameters alone (diameter.law)")
    triangles = replace(model, pulse=TRIANGLE, strengths=Fixed(value=1.0))
    height = 4.0 * slider.asperity_height / (pi * model.sizes.value)
    area = area_cumulants(triangles)
    moved = np.full(2, inf)
    if slider.damping > 0.0:
        drive = Drive(slider=slider, strengths=Fixed(value=height), speed=speed)
        moved = np.sqrt(_variances(triangles, drive))
    return BaseResponse(
        base_mean=height * area.mean,
        base_std=height * sqrt(area.variance),
        displacement_std=float(moved[0]),
        velocity_std=float(moved[1]),
    )


def _variances(triangles: Model, drive: Drive) -> Doubles:
    """Return Var x in um^2 and Var x' in (um/s)^2."""
    total = np.zeros(2)

    def add(k: Doubles, base: Doubles) -> Doubles:
        frequency = drive.speed * k
        through = np.square(drive.slider.stiffness) + np.square(drive.slider.damping * frequency)
        place = base * through * drive.gain(k)
        return np.array([place.sum(), place @ np.square(frequency)])

    for (k, weights), exact in zip(response_rules(triangles, drive), (True, False), strict=True):
        total += add(k, weights * force_spectral_density(triangles, drive.strengths, k, exact=exact) / pi)
    k, power = spectral_lines(triangles)
    return total + add(k, 2.0 * drive.strengths.mean**2 * power)

"""Rice and Moslehy's excitation: asperities that lift the base of the slider, m x'' + c x' + k x = c y' + k y.

y is a sum of triangles, one for each junction, that last as long as its life and are as high as the asperity.
"""

from dataclasses import dataclass, replace

from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.response import response


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseResponse:
    """Stationary motion over a base: mean and spread of the base and of the slider in um, of its velocity in um/s."""

    base_mean: float
    base_std: float
    displacement_std: float
    velocity_std: float


def base_response(model: Model) -> BaseResponse:
    """Return the stationary motion of a slider that its base drives; the mean of x is that of y.

    A triangle of height r d is 4 r/(pi d) times the area of a triangular life of one size d, and so is y of the area;
    S_x(w) = S_y(w/V)/V (k^2 + c^2 w^2) / |k - m w^2 + i c w|^2. Infinite without damping. Raises Refused for a slider
    without a base, and for unequal sizes. Source: Rice and Moslehy (1997); Crandall and Mark (1963).
    """
    slider = model.slider
    if slider is None or model.sliding_speed is None or slider.excitation != "base":
        raise Refused('this needs slider.excitation = "base" with its asperity_height')
    triangles = replace(model, pulse=TRIANGLE)
    motion, area = response(triangles), area_cumulants(triangles)
    return BaseResponse(
        base_mean=model.base_per_area * area.mean,
        base_std=model.base_per_area * area.std,
        displacement_std=motion.displacement_std,
        velocity_std=motion.velocity_std,
    )

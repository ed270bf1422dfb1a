"""Models for the tests of the theory, built from the laws directly, and the score of a sample variance."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.calibration import calibrated_diameter
from rubnoise.contact.laws import Fixed, Law, Spread, law_for
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.model import Model, Slider

FIG5_SLIDER = Slider(mass=0.005, stiffness=300.0, damping=0.05)


def model_of(
    sizes: Law,
    mean_diameter: float,
    mean_count: float = 20.0,
    slider: Slider | None = None,
    speed: float = 1000.0,
    distance: float = 40_000.0,
    tick: float = 0.05,
    pulse: Pulse = LENS,
) -> Model:
    """Return a model with N_jm/(2 d_m) births per um and a strength of 250 MPa."""
    return Model(
        mean_real_contact_area=200.0,
        mean_junction_count=mean_count,
        calibration="paper",
        calibrated_diameter=mean_diameter,
        sizes=sizes,
        births=PoissonBirths(mean_spacing=2.0 * mean_diameter / mean_count),
        strengths=Fixed(value=250.0),
        sliding_speed=speed,
        distance=distance,
        start="stationary",
        slider=slider,
        tick=tick,
        tick_count=round(distance / tick),
        pulse=pulse,
    )


def paper_model(
    mean_area: float = 200.0,
    mean_count: float = 20.0,
    spread: float = 0.2,
    calibration: str = "paper",
    slider: Slider | None = FIG5_SLIDER,
    speed: float = 1000.0,
) -> Model:
    """Return the model of the paper's Fig. 5, or a neighbour of it."""
    law = Spread(absolute=spread)
    diameter = calibrated_diameter(calibration, mean_area, mean_count, law)
    return model_of(law_for(diameter, law), diameter, mean_count, slider=slider, speed=speed)


def one_size(diameter: float = 5.53, slider: Slider | None = None, speed: float = 1000.0) -> Model:
    """Return a contact of junctions of one diameter."""
    return model_of(Fixed(value=diameter), diameter, slider=slider, speed=speed)


def excess(values: NDArray[np.float64], error: float) -> float:
    """Return z of the sample variance of estimates against error^2, its spread from their own fourth moment."""
    ratio = values.var(ddof=1) / error**2
    kurtosis = np.mean((values - values.mean()) ** 4) / values.var() ** 2
    return float((ratio - 1.0) / np.sqrt((kurtosis - 1.0) / values.size))

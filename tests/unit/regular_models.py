"""Contacts with regular births, and draws from them that know nothing of the theory."""

from dataclasses import replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Fixed, Law, Normal
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.model import Model, Slider
from tests.unit.theory_models import model_of

Doubles = NDArray[np.float64]

DIAMETER = 5.53


def regular(
    mean_count: float,
    spread: float = 0.0,
    pulse: Pulse = LENS,
    slider: Slider | None = None,
    sizes: Law | None = None,
) -> Model:
    """Return a contact with births at a spacing of one life over the mean count."""
    equal = Fixed(value=DIAMETER) if spread == 0.0 else Normal(centre=DIAMETER, std=spread)
    model = model_of(sizes or equal, DIAMETER, mean_count, pulse=pulse, slider=slider)
    return replace(model, births=RegularBirths(mean_spacing=2.0 * DIAMETER / mean_count))


def drawn(model: Model, lags: list[float], draws: int, generator: np.random.Generator) -> tuple[Doubles, Doubles]:
    """Return friction force per strength drawn (or area) and count, a row each lag, at places of independent phase."""
    spacing, longest = model.births.mean, 2.0 * model.sizes.support[1]
    phase = generator.uniform(0.0, spacing, draws)
    area, count = np.zeros((len(lags), draws)), np.zeros((len(lags), draws))
    for number in range(-ceil(max(lags) / spacing) - 1, ceil(longest / spacing) + 1):
        diameter = model.sizes.draw(generator.random(draws))
        strength = 1.0 if model.strengths is None else model.strengths.draw(generator.random(draws))
        for row, lag in enumerate(lags):
            age = phase + number * spacing + lag
            area[row] += strength * model.pulse.area(age, diameter)
            count[row] += (age >= 0.0) & (age < 2.0 * diameter)
    return area, count

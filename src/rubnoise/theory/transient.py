"""What an empty start costs: real contact area and live count while the first junctions grow up."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model
from rubnoise.theory import off_centre
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.lags import lag_edges, longest_life
from rubnoise.theory.occupancy import count_from_empty, mean_count
from rubnoise.theory.quadrature import cut_size_rule, panels

_NODES = 24
_GROWTH_NODES = 16


def area_from_empty(model: Model, distance: ArrayLike) -> Doubles:
    """Return E[A_r(s)] = lam E[int_0^s A ds'] in um^2 at distances s in um (any shape) after an empty start.

    Source: Campbell's theorem for births since s = 0 alone (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x); it is
    the stationary mean from the longest life on.
    """
    s = np.asarray(distance, dtype=np.float64)[..., None]
    # Cut where a junction ends (d = s/2) and where it is at mid-life (d = s), so that each part is smooth in d.
    diameters, probabilities = cut_size_rule(model.sizes, s * (0.5, 1.0), _NODES, rooted=True)
    grown = diameters**3 * _area_so_far(model.pulse, s / diameters)
    return model.birth_rate * np.sum(probabilities * grown, axis=-1)


def expected_mean_area(model: Model, distance: float) -> float:
    """Return the expected mean of A_r in um^2 over the first ``distance`` um, from the model's start."""
    return _mean_from_start(model, distance, area_cumulants(model).mean, area_from_empty)


def expected_mean_count(model: Model, distance: float) -> float:
    """Return the expected mean of N over the first ``distance`` um, from the model's start."""
    return _mean_from_start(model, distance, mean_count(model), count_from_empty)


def _mean_from_start(
    model: Model, distance: float, settled: float, from_empty: Callable[[Model, Doubles], Doubles]
) -> float:
    if model.start == "stationary":
        return settled
    reach = min(distance, longest_life(model))
    s, weights = panels(lag_edges(model, reach), _GROWTH_NODES)
    return (float(weights @ from_empty(model, s)) + (distance - reach) * settled) / distance


def _area_so_far(pulse: Pulse, age: Doubles) -> Doubles:
    """Return the integral of a life of unit diameter up to an age, which grows after mid-life as it grew before.

    Off the centre line it is the mean over offsets.
    """
    if pulse.offset != "none":
        return off_centre.area_so_far(pulse, age)
    rising = pulse.area_so_far(1.0 - np.minimum(np.abs(1.0 - age), 1.0))
    return np.where(age < 1.0, rising, pulse.life_integral(1) - rising)

"""The joint cumulants of the one-way slider's displacement and velocity: filtered shot noise is not Gaussian."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.drive import Drive, drive_of
from rubnoise.theory.junction_response import Powers, junction_response, panels_of_half_a_life
from rubnoise.theory.quadrature import cut_size_rule, size_range
from rubnoise.theory.random_births import need_random_births
from rubnoise.theory.response import mean_displacement

_NODES = 24
_PANEL_PHASE = 8.0  # of the slider across one panel of diameters; a fourth power has four times that
_AT_ONCE = 20_000
_ASKED: tuple[Powers, ...] = ((2, 0), (0, 2), (3, 0), (1, 2), (0, 3), (4, 0), (2, 2), (0, 4))


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionCumulants:
    """Stationary displacement x (um) and velocity x' (um/s): mean, stds, and cumulants of x/std x and x'/std x'.

    ``ratio(i, j)`` is kappa_ij / (std x^i std x'^j). Those with one x' (kappa_11, kappa_21, kappa_31) vanish.
    """

    mean: float
    displacement_std: float
    velocity_std: float
    ratios: dict[Powers, float]

    @property
    def skewness(self) -> float:
        """Skewness of the displacement."""
        return self.ratios[3, 0]

    @property
    def excess_kurtosis(self) -> float:
        """Excess kurtosis of the displacement."""
        return self.ratios[4, 0]


@lru_cache(maxsize=8)
def motion_cumulants(model: Model) -> MotionCumulants:
    """Return kappa_ij = lam V E[psi^(i+j)] E[int y^i y'^j dt], i + j up to 4, y the response to one junction of 1 MPa.

    Exact to a relative 1e-8 or so. Raises Refused without slider, strength, speed or damping, unless births are a
    Poisson process, and where the slider swings too often in one life (see `junction_response`).
    Source: cumulants of filtered shot noise (Rice 1944, section 1.5, doi:10.1002/j.1538-7305.1944.tb00874.x).
    """
    need_random_births(model, "the joint law of displacement and velocity")
    drive = drive_of(model)
    if drive.slider.damping == 0.0:
        raise Refused("without damping the slider's motion is not stationary")
    rate = model.birth_rate * drive.speed
    averages = zip(_ASKED, _averages(model, drive), strict=True)
    values = {(i, j): rate * drive.strengths.moment(i + j) * average for (i, j), average in averages}
    displacement, velocity = values[2, 0] ** 0.5, values[0, 2] ** 0.5
    return MotionCumulants(
        mean=mean_displacement(model),
        displacement_std=displacement,
        velocity_std=velocity,
        ratios={(i, j): value / (displacement**i * velocity**j) for (i, j), value in values.items()},
    )


def _averages(model: Model, drive: Drive) -> list[float]:
    """Return E[int y^i y'^j dt] for the powers asked for, with diameters close enough to follow the slider's phase."""
    low, high = size_range(model.sizes)
    cuts = np.linspace(low, high, 1 + int(drive.resonance * (high - low) / _PANEL_PHASE))[1:-1]
    diameters, probabilities = cut_size_rule(model.sizes, cuts, _NODES)
    batches = 1 + diameters.size * panels_of_half_a_life(drive, high) // _AT_ONCE
    total = np.zeros(len(_ASKED))
    for some in np.array_split(np.arange(diameters.size), batches):
        response = junction_response(model.pulse, drive, diameters[some])
        total += [response.integrals(powers) @ probabilities[some] for powers in _ASKED]
    return [float(value) for value in total]

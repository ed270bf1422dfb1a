"""superposed-pulses, the package on the index for shot noise, with the junction's life as its pulse; then lsim."""

import os

os.environ.setdefault("TQDM_DISABLE", "1")  # its progress bar costs time, and is not the point

import numpy as np
from superposedpulses.forcing import Forcing
from superposedpulses.point_model import PointModel
from superposedpulses.pulse_shape import ShortPulseGenerator

from bench.case import Case, Doubles
from bench.peers.naive_numpy import move
from bench.peers.tables import maker


class Lens(ShortPulseGenerator):  # type: ignore[misc]
    """The area over d^2 of a junction of diameter d, told from its mid-life."""

    def __init__(self, tick: float) -> None:
        """Remember the tick: the package's slices end a tick early."""
        super().__init__()
        self.tick = tick

    def get_pulse(self, times: Doubles, duration: float) -> Doubles:
        """Return the pulse at distances from mid-life."""
        x = np.minimum(np.abs(times) / duration, 1.0)
        return 0.5 * (np.arccos(x) - x * np.sqrt(1.0 - x * x))

    def get_cutoff(self, duration: float) -> float:
        """Return how far the pulse reaches on each side."""
        return duration + self.tick


class Junctions:
    """Poisson births in place of the package's fixed number of arrivals; all that its model asks a generator for."""

    def __init__(self, birth: Doubles, diameter: Doubles) -> None:
        """Hand out these junctions."""
        self.forcing = Forcing(birth.size, birth + diameter, diameter * diameter, diameter)

    def get_forcing(self, times: Doubles, waiting_time: float) -> Forcing:  # noqa: ARG002
        """Return all junctions, whatever the times."""
        return self.forcing


def superpose(case: Case, birth: Doubles, diameter: Doubles) -> tuple[Doubles, Doubles]:
    """Return the real contact area (um^2) and the number of junctions at the ticks, which the package does not tell."""
    model = PointModel(case.mean_gap, case.distance, case.tick)
    model.set_pulse_shape(Lens(case.tick))
    model.set_custom_forcing_generator(Junctions(birth, diameter))
    deaths = np.sort(birth + 2.0 * diameter)
    born, dead = (np.searchsorted(events, case.ticks, side="right") for events in (birth, deaths))
    return model.make_realization()[1], (born - dead).astype(np.float64)


run = maker(superpose, move)

"""superposed-pulses, the package on the index for shot noise, with the junction's life as its pulse; then lsim."""

import os
from pathlib import Path

os.environ.setdefault("TQDM_DISABLE", "1")  # its progress bar costs time, and is not the point

import numpy as np
from superposedpulses.forcing import Forcing
from superposedpulses.point_model import PointModel
from superposedpulses.pulse_shape import ShortPulseGenerator

from bench.case import Case, Doubles, Draws, Output
from bench.peers.naive_numpy import move
from bench.peers.tables import write


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


def superpose(case: Case, birth: Doubles, diameter: Doubles) -> Doubles:
    """Return the real contact area (um^2) at the ticks."""
    model = PointModel(case.mean_gap, case.distance, case.tick)
    model.set_pulse_shape(Lens(case.tick))
    model.set_custom_forcing_generator(Junctions(birth, diameter))
    return model.make_realization()[1]


def count_of(case: Case, birth: Doubles, diameter: Doubles) -> Doubles:
    """Return the number of junctions at the ticks, which the package does not tell."""
    ticks = case.ticks
    return (
        np.searchsorted(birth, ticks, side="right")
        - np.searchsorted(np.sort(birth + 2.0 * diameter), ticks, side="right")
    ).astype(np.float64)


def area_alone(case: Case, draws: Draws) -> Output:
    """Return births and the trace of the area."""
    birth, diameter = draws.rows()
    return Output(area=superpose(case, birth, diameter), birth=birth, death=birth + 2.0 * diameter)


def run(case: Case, draws: Draws, path: Path) -> Output:
    """Make area and motion, and write them."""
    birth, diameter = draws.rows()
    area = superpose(case, birth, diameter)
    displacement, velocity = move(case, area)
    write(path, case, birth, diameter, area, count_of(case, birth, diameter), displacement, velocity)
    return Output(area=area, displacement=displacement, birth=birth, death=birth + 2.0 * diameter)

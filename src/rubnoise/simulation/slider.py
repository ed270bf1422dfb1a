"""The slider driven by the friction force: its motion through one panel after another."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.simulation.area import ForceMoments, Sample, force_moments
from rubnoise.simulation.kernels import Room
from rubnoise.simulation.panels import Panel
from rubnoise.simulation.propagator import Propagator
from rubnoise.simulation.recurrence import advance_slider
from rubnoise.simulation.state import LiveRows


class SliderMotion:
    """A slider on its way: ``displacement`` (um) and ``velocity`` (um/s) at the last finished tick."""

    def __init__(self, model: Model, constants: Propagator, room: Room, displacement: float, velocity: float) -> None:
        """Start from a state; ``room`` is for the moments of cells that are not ticks."""
        self._model = model
        self._constants = constants
        self._room = room
        self.displacement = displacement
        self.velocity = velocity

    def through(self, panel: Panel, rows: LiveRows, sample: Sample) -> dict[str, NDArray[Any]]:
        """Move through a panel's cells and return the columns of /slider at its ticks."""
        every = self._constants.cells_per_tick
        force = self._force(panel, rows, sample)
        displacement = np.empty(force.moments.shape[1] // every + 1)
        velocity = np.empty_like(displacement)
        displacement[0], velocity[0] = self.displacement, self.velocity
        gains = self._constants.gains * force.unit
        advance_slider(force.moments, self._constants.transition, gains, every, displacement, velocity)
        self.displacement, self.velocity = float(displacement[-1]), float(velocity[-1])
        trace = sample.columns
        at_ticks = slice(displacement.size - trace["distance"].size, None)
        return {
            "time": trace["distance"] / self._model.sliding_speed,
            "distance": trace["distance"],
            "friction_force": trace["friction_force"],
            "displacement": displacement[at_ticks],
            "velocity": velocity[at_ticks],
        }

    def _force(self, panel: Panel, rows: LiveRows, sample: Sample) -> ForceMoments:
        if sample.force is None:
            return force_moments(self._model, rows, panel, self._constants.cells_per_tick, self._room)
        if panel.first == 0:
            # No cell ends where the run begins.
            return replace(sample.force, moments=sample.force.moments[:, 1:])
        return sample.force

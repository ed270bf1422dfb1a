"""The slider driven by the friction force: its motion through one panel after another."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import Pulse
from rubnoise.record.sink import Columns
from rubnoise.simulation.area import force_integrals
from rubnoise.simulation.panels import Panel
from rubnoise.simulation.propagator import Propagator
from rubnoise.simulation.recurrence import advance_slider
from rubnoise.simulation.state import LiveRows


class SliderMotion:
    """A slider on its way: ``displacement`` (um) and ``velocity`` (um/s) at the last finished tick."""

    def __init__(self, pulse: Pulse, constants: Propagator, speed: float, displacement: float, velocity: float) -> None:
        """Start from a state; speed is the sliding speed in um/s, pulse the shape of every junction's force."""
        self._pulse = pulse
        self._constants = constants
        self._speed = speed
        self.displacement = displacement
        self.velocity = velocity

    def through(self, panel: Panel, rows: LiveRows, trace: Columns) -> dict[str, NDArray[Any]]:
        """Move through a panel's cells and return the columns of /slider at its ticks."""
        every = self._constants.cells_per_tick
        force = force_integrals(self._pulse, rows, panel, self._constants)
        displacement = np.empty((force.positions.size - 1) // every + 1)
        velocity = np.empty_like(displacement)
        displacement[0], velocity[0] = self.displacement, self.velocity
        advance_slider(
            force.positions,
            force.integrals,
            force.corrections,
            self._constants.transition,
            self._constants.gains,
            every,
            displacement,
            velocity,
        )
        self.displacement, self.velocity = float(displacement[-1]), float(velocity[-1])
        at_ticks = slice(displacement.size - trace["distance"].size, None)
        return {
            "time": trace["distance"] / self._speed,
            "distance": trace["distance"],
            "friction_force": trace["friction_force"],
            "displacement": displacement[at_ticks],
            "velocity": velocity[at_ticks],
        }

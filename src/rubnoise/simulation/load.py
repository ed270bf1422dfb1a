"""The separation that moves under its load, and a slider: their exact motion through tick ranges, of first order in z.

The area at constant separation drives the separation z by its moments over the cells, as a force drives a slider. The
friction force, less what it loses when the separation grows, drives the slider. Both together are one linear system of
four numbers.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, fused
from rubnoise.model import Model, Separation
from rubnoise.simulation.area import Sample
from rubnoise.simulation.slider import Propagator, Rows, linear_propagator


def load_propagator(model: Model, held: Separation, cells_per_tick: int) -> Propagator:
    """Return the constants of (x, x', z, z') under a load; without a slider, x is constant.

    The equations are m_z z'' + c_z z' + (W/s_0) z = H (A - A_rm) and
    m x'' + c x' + k x = sum of psi A - E[psi] A_rm z/s_0. The inputs are A - A_rm and the sum of psi A.
    """
    inertia, height = Fraction(held.mass), Fraction(held.height_scale)
    spring, dashpot = Fraction(held.load) / height / inertia, Fraction(held.damping) / inertia
    of_separation: Rows = [[0, 0, 0, 1], [0, 0, -spring, -dashpot]]
    of_slider: Rows = [[0, 0, 0, 0], [0, 0, 0, 0]]
    push = Fraction(0)
    if model.slider is not None and model.strengths is not None:
        push = 1 / Fraction(model.slider.mass)
        lost = Fraction(model.strengths.mean) * Fraction(model.mean_real_contact_area) / height
        stiffness, damping = Fraction(model.slider.stiffness), Fraction(model.slider.damping)
        of_slider = [[0, 1, 0, 0], [-stiffness * push, -damping * push, -lost * push, 0]]
    inputs: Rows = [[0, 0], [0, push], [0, 0], [Fraction(held.hardness) / inertia, 0]]
    speed = model.sliding_speed or 0.0
    return linear_propagator([*of_slider, *of_separation], inputs, speed, model.tick, cells_per_tick)


@compiled_bare
def advance_load(
    areas: Doubles, forces: Doubles, mean: float, transition: Doubles, gains: Doubles, every: int, states: Doubles
) -> None:
    """Step slider and separation through cells with the exact propagator.

    areas, forces (3, cells): Legendre moments over each cell; gains (4, 6): what a moment of 1 adds to the state; mean:
    A_rm in the unit of areas. states (4, ticks + 1): x, x', z, z' (um, um/s), with those before the first cell in
    column 0; the other columns receive those after every ``every``-th cell.
    """
    x, v, z, w = states[0, 0], states[1, 0], states[2, 0], states[3, 0]
    x_x, x_v, x_z, x_w = transition[0, 0], transition[0, 1], transition[0, 2], transition[0, 3]
    v_x, v_v, v_z, v_w = transition[1, 0], transition[1, 1], transition[1, 2], transition[1, 3]
    z_z, z_w, w_z, w_w = transition[2, 2], transition[2, 3], transition[3, 2], transition[3, 3]
    x_0, x_1, x_2, x_3, x_4, x_5 = gains[0, 0], gains[0, 1], gains[0, 2], gains[0, 3], gains[0, 4], gains[0, 5]
    v_0, v_1, v_2, v_3, v_4, v_5 = gains[1, 0], gains[1, 1], gains[1, 2], gains[1, 3], gains[1, 4], gains[1, 5]
    z_0, z_1, z_2, w_0, w_1, w_2 = gains[2, 0], gains[2, 1], gains[2, 2], gains[3, 0], gains[3, 1], gains[3, 2]
    cell = 0
    for tick in range(1, areas.shape[1] // every + 1):
        for _ in range(every):
            a, b, c = areas[0, cell] - mean, areas[1, cell], areas[2, cell]
            f, g, h = forces[0, cell], forces[1, cell], forces[2, cell]
            push_x = x_0 * a + x_1 * b + x_2 * c + x_3 * f + x_4 * g + x_5 * h
            push_v = v_0 * a + v_1 * b + v_2 * c + v_3 * f + v_4 * g + v_5 * h
            push_x = fused(x_z, z, push_x) + x_w * w
            push_v = fused(v_z, z, push_v) + v_w * w
            next_x = fused(x_x, x, x) + fused(x_v, v, push_x)
            v = fused(v_v, v, v) + fused(v_x, x, push_v)
            x = next_x
            next_z = fused(z_z, z, z) + fused(z_w, w, z_0 * a + z_1 * b + z_2 * c)
            w = fused(w_w, w, w) + fused(w_z, z, w_0 * a + w_1 * b + w_2 * c)
            z = next_z
            cell += 1
        states[0, tick] = x
        states[1, tick] = v
        states[2, tick] = z
        states[3, tick] = w


@dataclass(slots=True)
class MovingSeparation:
    """A moving separation and its slider: their positions (um) and velocities (um/s) at the last finished tick."""

    model: Model
    held: Separation
    constants: Propagator
    displacement: float
    velocity: float
    separation: float
    separation_velocity: float

    def through(self, sample: Sample) -> Sample:
        """Move through the cells of a tick range; return its sample after that, with columns of /slider and /load."""
        areas, forces = sample.area, sample.force
        if areas is None or forces is None:
            raise ValueError("a sample without the moments that drive the separation")
        every = self.constants.cells_per_tick
        states = np.empty((4, areas.moments.shape[1] // every + 1))
        states[:, 0] = self.displacement, self.velocity, self.separation, self.separation_velocity
        gains = self.constants.gains * np.repeat([areas.unit, forces.unit], 3)
        advance_load(
            areas.moments,
            forces.moments,
            self.model.mean_real_contact_area,
            self.constants.transition,
            gains,
            every,
            states,
        )
        self.displacement, self.velocity, self.separation, self.separation_velocity = states[:, -1].tolist()
        distance = sample.columns["distance"]
        return self._columns(sample, states[:, states.shape[1] - distance.size :])

    def _columns(self, sample: Sample, states: Doubles) -> Sample:
        model, held, trace = self.model, self.held, dict(sample.columns)
        x, v, z, w = states
        area, time = trace["real_contact_area"], trace["distance"] / model.sliding_speed
        live = trace["junction_count"].astype(np.float64)
        alone = held.height_scale * model.mean_junction_count / model.mean_real_contact_area
        overlap = np.full(live.size, np.nan)
        np.divide(alone * area, live, out=overlap, where=live > 0.0)
        moved: dict[str, dict[str, NDArray[Any]]] = {
            "load": {
                "time": time,
                "separation": z.copy(),
                "velocity": w.copy(),
                "load": held.hardness * area - held.stiffness * z,
                "live_overlap": overlap,
            }
        }
        if model.strengths is not None:
            lost = model.strengths.mean * model.mean_real_contact_area / held.height_scale
            trace["friction_force"] = trace["friction_force"] - lost * z
        if model.slider is not None:
            moved["slider"] = {
                "time": time,
                "distance": trace["distance"],
                "friction_force": trace["friction_force"],
                "displacement": x.copy(),
                "velocity": v.copy(),
            }
        return replace(sample, columns=trace, moved=moved)

"""Motions that the contact drives and that do not change it: slider, base and load, as one linear system.

From top to bottom: the equations, the exact step through a cell, whose constants are a matrix exponential, and the
motion through one tick range after another. What a cell does to it is three moments of the area or of the force.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import fsum

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled
from rubnoise.model import Model, Separation, Slider
from rubnoise.record.rows import Columns
from rubnoise.simulation.area import Drive, has_one_strength, sample
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import cells_per_tick


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearSystem:
    """Equations of motion y' = rates y + inputs (f - means) of positions (um) and velocities (um/s), body by body.

    No body moves those before it. drives: the sum over all lives that each column of ``inputs`` is for, the area in
    um^2 or the force in uN; means: the part of it that does not drive.
    """

    rates: Doubles
    inputs: Doubles
    drives: tuple[Drive, ...]
    means: tuple[float, ...]


def linear_system(model: Model) -> LinearSystem | None:
    """Return the equations of separation and slider; None if nothing moves, or if its motion changes the contact.

    m z'' + c z' + (W/s_0) z = H (A - A_rm), and m x'' + c x' + k x = F, less `force_lost` times z under a load. Over a
    base y = lift A it is m x'' + c x' + k x = c y' + k y. The slope of y is not needed if the second number is
    u = x' - c y/m, the velocity that the slider carries: x' = u + (c/m) y, u' = -(k/m) x - (c/m) u + (k/m - c^2/m^2) y.
    """
    held, slider, lift = model.separation, model.slider, model.base_per_area
    bodies: list[tuple[Slider, Drive, list[float], float]] = []
    if held is not None:
        bodies.append((held.oscillator, "area", [0.0, held.hardness / held.mass], model.mean_real_contact_area))
    if slider is not None and lift:
        dashpot = slider.damping / slider.mass
        inputs = [lift * dashpot, lift * (slider.stiffness / slider.mass - dashpot * dashpot)]
        bodies.append((slider, "area", inputs, 0.0))
    elif slider is not None:
        bodies.append((slider, "force", [0.0, 1.0 / slider.mass], 0.0))
    if not bodies or model.sliding_speed is None or model.is_two_way or model.free is not None:
        return None
    count = len(bodies)
    rates, pushes = np.zeros((2 * count, 2 * count)), np.zeros((2 * count, count))
    for number, (body, _, inputs, _) in enumerate(bodies):
        pair = slice(2 * number, 2 * number + 2)
        rates[pair, pair] = [[0.0, 1.0], [-body.stiffness / body.mass, -body.damping / body.mass]]
        pushes[pair, number] = inputs
    if held is not None and slider is not None:
        rates[3, 0] = -force_lost(model) / slider.mass
    _, drives, _, means = zip(*bodies, strict=True)
    return LinearSystem(rates=rates, inputs=pushes, drives=drives, means=means)


def force_lost(model: Model) -> float:
    """Return what the friction force loses for each um by which a load's separation grows, in uN."""
    if model.separation is None or model.strengths is None:
        return 0.0
    return model.strengths.mean * model.mean_real_contact_area / model.separation.height_scale


@dataclass(frozen=True, slots=True, kw_only=True)
class Propagator:
    """Constants of a step through a cell: the state grows by transition @ state + gains @ (moments of the cell).

    transition: the free motion over a cell minus the identity, so that rounding does not shift the phase of a lightly
    damped slider; gains: for each sum that drives the motion three columns, factors of its Legendre moments over the
    distance, int f P_i(2y - 1) ds.
    """

    system: LinearSystem
    transition: Doubles
    gains: Doubles
    cells_per_tick: int


@lru_cache(maxsize=8)
def slider_constants(model: Model) -> Propagator | None:
    """Return the constants of the exact step of slider and separation; None if the run does not use this step."""
    system, speed = linear_system(model), model.sliding_speed
    return None if system is None or speed is None else propagator(system, speed, model.tick, cells_per_tick(model))


def named_constants(model: Model) -> dict[str, float]:
    """Return all of them by their names in a result, `transition_01` for row 0, column 1; none without a motion."""
    constants = slider_constants(model)
    if constants is None:
        return {}
    named = {"cells_per_tick": float(constants.cells_per_tick)}
    for name, matrix in (("transition", constants.transition), ("gain", constants.gains)):
        named |= {f"{name}_{row}{column}": float(value) for (row, column), value in np.ndenumerate(matrix)}
    return named


def propagator(system: LinearSystem, speed: float, tick: float, cells_per_tick: int = 1) -> Propagator:
    """Return the constants of y' = rates y + inputs f at a speed (um/s) for ticks (um) of ``cells_per_tick`` cells.

    With h the time of a cell and M = rates h, int_0^1 exp(M (1 - y)) y^n dy = n! phi_(n+1)(M). These stand side by side
    in the exponential of a larger matrix (Al-Mohy and Higham 2011, doi:10.1137/100788860), and exp(M) - 1 is
    M phi_1(M). Powers of two make the rows and columns of M alike before.
    """
    from scipy.linalg import expm, matrix_balance  # takes long to load, and only motions need it

    size, step = len(system.rates), tick / speed / cells_per_tick
    moved = step * system.rates
    balanced, (scale, _) = matrix_balance(moved, permute=False, separate=True)
    chain = np.eye(4 * size, k=size)
    chain[:size, :size] = balanced
    blocks = expm(chain)[:size].reshape(size, 4, size) * scale[:, None, None] / scale
    first, second, third = blocks[:, 1], blocks[:, 2], blocks[:, 3]
    legendre = np.stack([first, 3.0 * (2.0 * second - first), 5.0 * (12.0 * third - 6.0 * second + first)])
    gains = np.einsum("iab,bc->aci", legendre, system.inputs) / speed
    transition, gains = moved @ first, gains.reshape(size, -1)
    return Propagator(system=system, transition=transition, gains=gains, cells_per_tick=cells_per_tick)


@compiled
def advance(push: Doubles, transition: Doubles, states: Doubles) -> None:
    """Step a position and its velocity through cells: states (2, cells + 1) are before the cells and after them."""
    pushes, kicks = push
    positions, velocities = states
    x, v = positions[0], velocities[0]
    x_from_x, x_from_v, v_from_x, v_from_v = transition[0, 0], transition[0, 1], transition[1, 0], transition[1, 1]
    for cell in range(len(pushes)):
        # Two short chains of operations for each, which the processor computes at the same time.
        next_x = (x + x_from_x * x) + (pushes[cell] + x_from_v * v)
        v = (v + v_from_v * v) + (kicks[cell] + v_from_x * x)
        x = next_x
        positions[cell + 1] = x
        velocities[cell + 1] = v


def begin(model: Model, live: LiveRows) -> Doubles:
    """Return the state at the start: at rest, with the slider at the model's displacement.

    Over a base at y the slider carries the velocity -c y/m (`over_base`).
    """
    separation = [] if model.separation is None else [0.0, 0.0]
    if model.slider is None:
        return np.array(separation)
    velocity = 0.0
    if model.base_per_area:
        risen = np.minimum(-live.birth, live.birth + 2.0 * live.diameter)
        area = fsum((0.25 * np.pi * live.diameter * risen).tolist())
        velocity = -model.slider.damping / model.slider.mass * model.base_per_area * area
    return np.array([*separation, model.equilibrium_displacement, velocity])


class LinearMotion:
    """Slider and separation as they move through a run; ``state`` is that at the last finished tick."""

    def __init__(self, model: Model, constants: Propagator, live: LiveRows) -> None:
        """Begin among the junctions alive at the start."""
        self._model, self._constants = model, constants
        self.cells_per_tick, drives = constants.cells_per_tick, constants.system.drives
        width, psi = model.tick / self.cells_per_tick, 1.0
        if model.strengths is not None and has_one_strength(model):
            psi = model.strengths.mean
        units = np.repeat([width if drive == "area" else width * psi for drive in drives], 3)
        self.state: Doubles = begin(model, live)
        self._gains = (constants.gains * units).reshape(self.state.size // 2, 2, len(drives), 3)

    def through(self, rows: LiveRows, ticks: range) -> dict[str, Columns]:
        """Move through the cells of a tick range; return the columns of /trace, /slider and /load at its ticks.

        rows: include every junction alive in it.
        """
        every, drives = self.cells_per_tick, self._constants.system.drives
        columns, moments = sample(self._model, rows, ticks, every, drives)
        trace, states = dict(columns), np.ascontiguousarray(self._moved(moments)[:, ::every])
        self.state = states[:, -1].copy()
        states = states[:, states.shape[1] - trace["distance"].size :]
        moved: dict[str, Columns] = {"trace": trace}
        held, slider = self._model.separation, self._model.slider
        if held is not None:
            if "friction_force" in trace:
                trace["friction_force"] = trace["friction_force"] - force_lost(self._model) * states[0]
            moved["load"] = self._of_load(held, trace, states[0], states[1])
        if slider is not None:
            moved["slider"] = self._of_slider(slider, trace, states[-2], states[-1])
        return moved

    def _moved(self, moments: Sequence[Doubles]) -> Doubles:
        """Return the states before and after every cell; each body is moved by the contact and those before it."""
        size, cells = len(self.state), moments[0].shape[1]
        states = np.zeros((size, cells + 1))
        states[:, 0] = self.state
        transition, gains = self._constants.transition, self._gains
        steady = np.add.accumulate(-gains[..., 0] * self._constants.system.means, axis=2)[..., -1:]
        for body in range(size // 2):
            pair = slice(2 * body, 2 * body + 2)
            # no bit of these sums depends on threads, as one of a product of matrices may
            pushes = (np.einsum("ij,jk->ik", gains[body, :, n], drive) for n, drive in enumerate(moments))
            push = sum(pushes, start=steady[body])
            if body:
                push += np.einsum("ij,jk->ik", transition[pair, :2], states[:2, :-1])
            advance(push, transition[pair, pair].copy(), states[pair])
        return states

    def _of_slider(self, slider: Slider, trace: Columns, displacement: Doubles, velocity: Doubles) -> Columns:
        columns = {"time": trace["distance"] / self._model.sliding_speed, "distance": trace["distance"]}
        if "friction_force" in trace:
            columns["friction_force"] = trace["friction_force"]
        columns |= {"displacement": displacement, "velocity": velocity}
        if self._model.base_per_area:
            base = self._model.base_per_area * trace["real_contact_area"]
            # Over a base the state carries x' - c y/m.
            columns |= {"base_displacement": base, "velocity": velocity + slider.damping / slider.mass * base}
        return columns

    def _of_load(self, held: Separation, trace: Columns, separation: Doubles, velocity: Doubles) -> Columns:
        model = self._model
        area, live = trace["real_contact_area"], trace["junction_count"].astype(np.float64)
        alone = held.height_scale * model.mean_junction_count / model.mean_real_contact_area
        overlap = np.full(live.size, np.nan)
        np.divide(alone * area, live, out=overlap, where=live > 0.0)
        return {
            "time": trace["distance"] / model.sliding_speed,
            "separation": separation,
            "velocity": velocity,
            "load": held.hardness * area - held.stiffness * separation,
            "live_overlap": overlap,
        }

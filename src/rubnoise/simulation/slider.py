"""The slider driven by the friction force, coupled one way: its exact motion through one range of ticks after another.

Read it from above: how finely a tick must be divided so that the motion is right to 1e-9, the constants of one step
through such a cell, the compiled recurrence over the cells, and the slider on its way.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, fused
from rubnoise.model import Model, Slider
from rubnoise.simulation.area import ForceMoments, Sample, force_moments
from rubnoise.simulation.kernels import Scratch
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import TickRange

_DIGITS = 150
_DOUBLE_ROOT_SPLIT = "1e-60"
_MOMENTS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Propagator:
    """Constants of one step of the slider: (x, x') gains transition @ (x, x') + gains @ (force moments of the cell).

    transition (2, 2): free motion over a cell less the identity, so that rounding does not turn the phase of a lightly
    damped slider; gains (2, 3): what Legendre moments of the force over distance, int F P_i(2y - 1) ds (uN um), add.
    """

    transition: NDArray[np.float64]
    gains: NDArray[np.float64]
    cells_per_tick: int

    def named(self) -> dict[str, float]:
        """Return every constant by the name that it has in a result: `transition_01` is that in row 0, column 1."""
        named = {"cells_per_tick": float(self.cells_per_tick)}
        for name, matrix in (("transition", self.transition), ("gain", self.gains)):
            for (row, column), value in np.ndenumerate(matrix):
                named[f"{name}_{row}{column}"] = float(value)
        return named


def propagator(slider: Slider, speed: float, tick: float, cells_per_tick: int = 1) -> Propagator:
    """Return the constants of a one-way slider at a sliding speed (um/s) for ticks (um) of so many cells each.

    With the roots L of m L^2 + c L + k = 0, the impulse response g(t) = (e^(L1 t) - e^(L2 t)) / (L1 - L2) and h the
    time of a cell: x(h) = x (L1 e2 - L2 e1)/(L1 - L2) + x' g(h), and the i-th gain of x is
    (2i + 1)/(m V) int_0^1 g(h (1 - y)) P_i(2y - 1) dy; for x' the same with g'.
    At 150 digits, since near critical damping and for short ticks these differences cancel, and rounded once.
    """
    import mpmath

    with mpmath.workdps(_DIGITS):
        step = mpmath.mpf(tick) / mpmath.mpf(speed) / cells_per_tick
        one, two = _roots(slider)
        first, second = mpmath.exp(one * step), mpmath.exp(two * step)
        impulse = (first - second) / (one - two)
        transition = [
            [(one * second - two * first) / (one - two) - 1, impulse],
            [-one * two * impulse, (one * first - two * second) / (one - two) - 1],
        ]
        gains: list[list[Any]] = [[], []]
        for i, (a, b) in enumerate(zip(_legendre(one * step), _legendre(two * step), strict=True)):
            weight = (2 * i + 1) / (mpmath.mpf(slider.mass) * mpmath.mpf(speed) * (one - two))
            gains[0].append(weight * (a - b))
            gains[1].append(weight * (one * a - two * b))
        return Propagator(
            transition=_real(transition),
            gains=_real(gains),
            cells_per_tick=cells_per_tick,
        )


def _roots(slider: Slider) -> tuple[Any, Any]:
    """Return the two roots of m L^2 + c L + k = 0; a double one is split by a relative 1e-60, far below rounding."""
    import mpmath

    decay = mpmath.mpf(slider.damping) / (2 * mpmath.mpf(slider.mass))
    square = decay**2 - mpmath.mpf(slider.stiffness) / mpmath.mpf(slider.mass)
    spread = mpmath.sqrt(square) if square != 0 else decay * mpmath.mpf(_DOUBLE_ROOT_SPLIT)
    return -decay + spread, -decay - spread


def _legendre(z: Any) -> list[Any]:
    """Return int_0^1 e^(z (1 - y)) P_i(2y - 1) dy for i = 0, 1, 2, from powers of y: m_n = (n m_(n-1) - 1) / z."""
    import mpmath

    powers = [(mpmath.exp(z) - 1) / z]
    for n in range(1, _MOMENTS):
        powers.append((n * powers[-1] - 1) / z)
    return [powers[0], 2 * powers[1] - powers[0], 6 * powers[2] - 6 * powers[1] + powers[0]]


def _real(rows: list[list[Any]]) -> NDArray[np.float64]:
    return np.array([[float(value.real) for value in row] for row in rows])


@compiled_bare
def advance_slider(
    moments: Doubles, transition: Doubles, gains: Doubles, every: int, displacement: Doubles, velocity: Doubles
) -> None:
    """Step the slider through cells, exactly in the propagator.

    moments (3, cells): Legendre moments of the force over each cell, in units in which gains (2, 3) are what they add
    to x and x'. transition (2, 2) is the free motion over a cell less the identity. displacement (um) and velocity
    (um/s) begin with the state before the first cell and receive the state after every ``every``-th one.
    """
    x, v = displacement[0], velocity[0]
    # By name, since the compiler can't know that none of them is among the numbers written.
    x_from_x, x_from_v, v_from_x, v_from_v = transition[0, 0], transition[0, 1], transition[1, 0], transition[1, 1]
    x_mean, x_slope, x_bend = gains[0, 0], gains[0, 1], gains[0, 2]
    v_mean, v_slope, v_bend = gains[1, 0], gains[1, 1], gains[1, 2]
    means, slopes, bends = moments[0], moments[1], moments[2]
    cell = 0
    for tick in range(1, len(means) // every + 1):
        for _ in range(every):
            push_x = x_mean * means[cell] + x_slope * slopes[cell] + x_bend * bends[cell]
            push_v = v_mean * means[cell] + v_slope * slopes[cell] + v_bend * bends[cell]
            # Two short chains for each: nothing else has to be waited for.
            next_x = fused(x_from_x, x, x) + fused(x_from_v, v, push_x)
            v = fused(v_from_v, v, v) + fused(v_from_x, x, push_v)
            x = next_x
            cell += 1
        displacement[tick] = x
        velocity[tick] = v


class SliderMotion:
    """A slider on its way: ``displacement`` (um) and ``velocity`` (um/s) at the last finished tick."""

    def __init__(
        self, model: Model, constants: Propagator, scratch: Scratch, displacement: float, velocity: float
    ) -> None:
        """Start from a state; ``scratch`` is for the moments of cells that are not ticks."""
        self._model = model
        self._constants = constants
        self._scratch = scratch
        self.displacement = displacement
        self.velocity = velocity

    def through(self, tick_range: TickRange, rows: LiveRows, sample: Sample) -> dict[str, NDArray[Any]]:
        """Move through a tick range's cells and return the columns of /slider at its ticks."""
        every = self._constants.cells_per_tick
        force = self._force(tick_range, rows, sample)
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

    def _force(self, tick_range: TickRange, rows: LiveRows, sample: Sample) -> ForceMoments:
        if sample.force is None:
            return force_moments(self._model, rows, tick_range, self._constants.cells_per_tick, self._scratch)
        if tick_range.first == 0:
            # No cell ends where the run begins.
            return replace(sample.force, moments=sample.force.moments[:, 1:])
        return sample.force

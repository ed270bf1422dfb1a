"""The one-way slider, driven by the friction force: its exact motion through one tick range after another.

From top to bottom: the constants of one step through a cell, the compiled recurrence over the cells, and the moving
slider. `ticks` says into how many cells each tick is divided.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, fused
from rubnoise.model import Model, Slider
from rubnoise.simulation.area import CellMoments, Sample

_DIGITS: Final = 150
_MOMENTS: Final = 3

Rows = Sequence[Sequence[Fraction | int]]
"""A matrix of exact numbers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Propagator:
    """Constants of a slider's step: (x, x') grows by transition @ (x, x') + gains @ (force moments of the cell).

    transition (2, 2): the free motion over a cell minus the identity, so that rounding does not shift the phase of a
    lightly damped slider; gains (2, 3): factors of the Legendre moments of the force over distance,
    int F P_i(2y - 1) ds (uN um). If the separation moves, too, the state is (x, x', z, z'), and gains (4, 6) are
    factors of the moments of area (um^2 um), then of force.
    """

    transition: NDArray[np.float64]
    gains: NDArray[np.float64]
    cells_per_tick: int

    def named(self) -> dict[str, float]:
        """Return every constant under its name in a result: `transition_01` is the one in row 0, column 1."""
        named = {"cells_per_tick": float(self.cells_per_tick)}
        for name, matrix in (("transition", self.transition), ("gain", self.gains)):
            for (row, column), value in np.ndenumerate(matrix):
                named[f"{name}_{row}{column}"] = float(value)
        return named


def propagator(slider: Slider, speed: float, tick: float, cells_per_tick: int = 1) -> Propagator:
    """Return the constants of a one-way slider at a sliding speed (um/s) for ticks (um) of ``cells_per_tick`` cells.

    The equation is m x'' + c x' + k x = F, or over a base y, m x'' + c x' + k x = c y' + k y. The base needs no slope
    of y if the state is x and u = x' - c y/m: x' = u + (c/m) y, u' = -(k/m) x - (c/m) u + (k/m - c^2/m^2) y.
    """
    mass = Fraction(slider.mass)
    spring, dashpot = Fraction(slider.stiffness) / mass, Fraction(slider.damping) / mass
    inputs: Rows = [[0], [1 / mass]] if slider.excitation == "friction" else [[dashpot], [spring - dashpot * dashpot]]
    return linear_propagator([[0, 1], [-spring, -dashpot]], inputs, speed, tick, cells_per_tick)


def linear_propagator(rates: Rows, inputs: Rows, speed: float, tick: float, cells_per_tick: int) -> Propagator:
    """Return the constants of y' = rates y + inputs f at a speed (um/s) for ticks (um) of ``cells_per_tick`` cells.

    With h the time of a cell, transition = exp(rates h) - 1, and the i-th gain of an input b is
    (2i + 1)/V int_0^1 exp(rates h (1 - y)) b P_i(2y - 1) dy, from int exp(rates h (1 - y)) b y^n dy = n! phi_(n+1) b
    in the exponential of a larger matrix (Al-Mohy and Higham 2011, doi:10.1137/100788860). They are computed with 150
    digits, because differences cancel near critical damping and for short ticks, and rounded once.
    """
    import mpmath

    size = len(rates)
    with mpmath.workdps(_DIGITS):
        step = mpmath.mpf(tick) / mpmath.mpf(speed) / cells_per_tick
        gains: list[list[Any]] = [[] for _ in range(size)]
        for column in range(len(inputs[0])):
            larger = mpmath.zeros(size + _MOMENTS)
            for row in range(size):
                for other, rate in enumerate(rates[row]):
                    larger[row, other] = _exact(rate) * step
                larger[row, size] = _exact(inputs[row][column])
            for n in range(1, _MOMENTS):
                larger[size + n - 1, size + n] = 1
            grown = mpmath.expm(larger, method="taylor")
            for row in range(size):
                mean, slope, bend = (grown[row, size + n] * mpmath.factorial(n) for n in range(_MOMENTS))
                legendre = (mean, 2 * slope - mean, 6 * bend - 6 * slope + mean)
                gains[row] += [(2 * i + 1) * each / mpmath.mpf(speed) for i, each in enumerate(legendre)]
        free = [[grown[row, other] - (row == other) for other in range(size)] for row in range(size)]
        return Propagator(
            transition=np.array(free, dtype=np.float64),
            gains=np.array(gains, dtype=np.float64),
            cells_per_tick=cells_per_tick,
        )


def _exact(number: Fraction | int) -> Any:
    import mpmath

    return mpmath.mpf(number.numerator) / number.denominator


@compiled_bare
def advance_slider(
    moments: Doubles, transition: Doubles, gains: Doubles, every: int, displacement: Doubles, velocity: Doubles
) -> None:
    """Step the slider through cells with the exact propagator.

    moments (3, cells): Legendre moments of the force over each cell; gains (2, 3): what a moment of 1 adds to x and x';
    transition (2, 2): the free motion over a cell minus the identity. displacement (um) and velocity (um/s) have the
    state before the first cell at index 0; the other entries receive the state after every ``every``-th cell.
    """
    x, v = displacement[0], velocity[0]
    # Scalars, because the compiler cannot know that the arrays written do not overlap these.
    x_from_x, x_from_v, v_from_x, v_from_v = transition[0, 0], transition[0, 1], transition[1, 0], transition[1, 1]
    x_mean, x_slope, x_bend = gains[0, 0], gains[0, 1], gains[0, 2]
    v_mean, v_slope, v_bend = gains[1, 0], gains[1, 1], gains[1, 2]
    means, slopes, bends = moments[0], moments[1], moments[2]
    cell = 0
    for tick in range(1, len(means) // every + 1):
        for _ in range(every):
            push_x = x_mean * means[cell] + x_slope * slopes[cell] + x_bend * bends[cell]
            push_v = v_mean * means[cell] + v_slope * slopes[cell] + v_bend * bends[cell]
            # Two short chains of operations for each, which the processor computes at the same time.
            next_x = fused(x_from_x, x, x) + fused(x_from_v, v, push_x)
            v = fused(v_from_v, v, v) + fused(v_from_x, x, push_v)
            x = next_x
            cell += 1
        displacement[tick] = x
        velocity[tick] = v


class SliderMotion:
    """A moving slider: ``displacement`` (um) and ``velocity`` (um/s) at the last finished tick.

    Over a base y, the velocity that it carries is x' - c y/m, while rows have x'.
    """

    def __init__(
        self,
        model: Model,
        constants: Propagator,
        displacement: float,
        velocity: float,
        separation: float = 0.0,
        separation_velocity: float = 0.0,
    ) -> None:
        """Start from a state; the separation is constant."""
        self._model = model
        self._constants = constants
        self.displacement = displacement
        self.velocity = velocity
        self.separation, self.separation_velocity = separation, separation_velocity

    def through(self, sample: Sample) -> dict[str, NDArray[Any]]:
        """Move through the cells of a tick range and return the columns of /slider at its ticks."""
        every = self._constants.cells_per_tick
        force = self._force(sample)
        displacement = np.empty(force.moments.shape[1] // every + 1)
        velocity = np.empty_like(displacement)
        displacement[0], velocity[0] = self.displacement, self.velocity
        gains = self._constants.gains * force.unit
        advance_slider(force.moments, self._constants.transition, gains, every, displacement, velocity)
        self.displacement, self.velocity = float(displacement[-1]), float(velocity[-1])
        trace = sample.columns
        at_ticks = slice(displacement.size - trace["distance"].size, None)
        columns = {"time": trace["distance"] / self._model.sliding_speed, "distance": trace["distance"]}
        if "friction_force" in trace:
            columns["friction_force"] = trace["friction_force"]
        columns |= {"displacement": displacement[at_ticks], "velocity": velocity[at_ticks]}
        slider = self._model.slider
        if slider is not None and slider.excitation == "base":
            base = self._model.base_per_area * trace["real_contact_area"]
            columns |= {"base_displacement": base, "velocity": velocity[at_ticks] + slider.damping / slider.mass * base}
        return columns

    def _force(self, sample: Sample) -> CellMoments:
        driving = sample.force if self._model.base_per_area == 0.0 else sample.area
        if driving is None:
            raise ValueError("a sample without the moments that drive the slider")
        if self._model.base_per_area == 0.0:
            return driving
        return replace(driving, unit=driving.unit * self._model.base_per_area)

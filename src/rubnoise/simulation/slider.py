"""The slider driven by the friction force, coupled one way: its exact motion through one range of ticks after another.

Read it from above: how finely a tick must be divided so that the motion is right to 1e-9, the constants of one step
through such a cell, the compiled recurrence over the cells, and the slider on its way.
"""

from cmath import sqrt
from dataclasses import dataclass, replace
from math import hypot
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, fused
from rubnoise.contact.births import RegularBirths
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.simulation.area import ForceMoments, Sample, force_moments
from rubnoise.simulation.kernels import Scratch
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import TickRange

TARGET = 3e-10
"""Error aimed at, relative to the largest displacement, by a rule that is an envelope: the median is 5 times less."""

COEFFICIENT = 8e-4
"""Of the error's envelope over the measured cases (docs/model.md)."""

VELOCITY_SHARE = 0.3
"""Weight of the velocity's error, relative to the largest velocity: 1e-9 is enough for it."""

WIDEST_CELL = 0.25
"""Largest width of a cell over the calibrated diameter."""

MOST_CELLS = 4096
"""Cells of a tick at most; what would need more is refused."""

FINENESS = 100.0
"""Cells of a two-way motion to a diameter at least: from 96 on the kernels sum lives as series."""


def coupled_spacing(model: Model) -> float:
    """Return the width in um of a cell of the grid that a two-way motion uses: the tick times a power of two."""
    width = model.tick
    while width * FINENESS > model.calibrated_diameter:
        width *= 0.5
    while 2.0 * width * FINENESS <= model.calibrated_diameter:
        width *= 2.0
    return width


def cells_per_tick(model: Model) -> int:
    """Return the number of equal cells of a tick, a power of two, that the slider's step needs.

    The step holds three exact moments of the force over a cell; what it leaves out is
    err = 8e-4 / sqrt(N_jm) q min(r h, 6)^3.5, with q the cell over d_m and r h the rate of a mode of the slider times
    the cell's time. The power laws are those of the third moment at a mid-life kink; the coefficient is an envelope
    over some 11 500 measured cases. The fast mode of an over-damped slider counts by sqrt(r_slow / r_fast): its share
    in the displacement is r_slow / r_fast. In the velocity it is 1; and where the slider follows the force,
    r_slow d_m > V, its largest velocity is smaller by r_slow h / q, so that the relative error is larger by as much.
    So it is with regular births, whose force hardly varies.
    The triangle is straight beside its kinks, which are no steeper than the lens's: the same envelope holds.
    Raises Refused where more than 4096 cells would be needed.
    """
    if model.slider is None or model.tick_duration is None or model.is_two_way:
        return 1  # a two-way motion has cells of its own
    cells = 1
    while _error(model, model.slider, cells) > TARGET or model.tick / model.calibrated_diameter / cells > WIDEST_CELL:
        cells *= 2
        if cells > MOST_CELLS:
            raise Refused(
                f"sliding.speed: at {model.sliding_speed:g} um/s the slider moves so fast within a tick of "
                f"{model.tick:g} um that its motion would need over {MOST_CELLS} steps a tick; "
                "a faster speed, a shorter output.tick or a softer, heavier or less damped slider is needed"
            )
    return cells


def narrow(model: Model, cells: int) -> bool:
    """Whether cells are so narrow that differences of integrals lose what a divided tick was to gain."""
    return cells > 1 and model.tick / cells < model.calibrated_diameter / 128.0


def _error(model: Model, slider: Slider, cells: int) -> float:
    width = model.tick / model.calibrated_diameter / cells
    duration = (model.tick_duration or 0.0) / cells
    slow, fast = _rates(slider)
    steepness = max(
        min(slow * duration, 6.0) ** 3.5,
        (slow / fast) ** 0.5 * min(fast * duration, 6.0) ** 3.5,
        VELOCITY_SHARE / _liveliness(model) * max(1.0, slow * duration / width) * min(fast * duration, 6.0) ** 3.5,
    )
    return COEFFICIENT / model.mean_junction_count**0.5 * width * steepness


def _liveliness(model: Model) -> float:
    """Return about how much the force varies beside one of Poisson births.

    With regular births of equal sizes by 1/(2 N_jm^1.5): 1/(sqrt(3) N_jm^2) for the triangle and an odd number, where
    Poisson births have 2/sqrt(3 N_jm); and with the spread of their sizes.
    """
    if not isinstance(model.births, RegularBirths):
        return 1.0
    spread = max(model.sizes.moment(2) / model.sizes.moment(1) ** 2 - 1.0, 0.0) ** 0.5
    return min(hypot(spread, 0.5 * model.mean_junction_count**-1.5), 1.0)


def _rates(slider: Slider) -> tuple[float, float]:
    """Return the moduli of the two roots of m L^2 + c L + k = 0 in 1/s, the smaller first."""
    decay = slider.damping / (2.0 * slider.mass)
    fast = abs(decay + sqrt(decay**2 - slider.natural_angular_frequency**2))
    return slider.stiffness / slider.mass / fast, fast


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

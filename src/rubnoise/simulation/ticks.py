"""Ticks: into how many cells the slider divides each, and tick ranges, each computed and written in one go."""

from cmath import sqrt
from collections.abc import Iterator
from math import ceil, floor, hypot, log2

from rubnoise.errors import Refused
from rubnoise.model import Model, Slider

TARGET = 3e-10
"""Error that the rule for cells allows, relative to the largest displacement. The rule is an upper envelope: the median
error is 5 times smaller."""

COEFFICIENT = 8e-4  # coefficient of this envelope over the measured cases (docs/reproducibility.md)

VELOCITY_SHARE = 0.3
"""Weight of the velocity's error, relative to the largest velocity: an error of 1e-9 is good enough."""

WIDEST_CELL = 0.04
"""Largest width of a cell divided by the calibrated diameter: from 50 cells a life on the motion has nine digits."""

MOST_CELLS = 4096  # largest number of cells in a tick; a run that needs more is refused


def coupled_spacing(model: Model) -> float:
    """Return the width (um) of the cells in two-way motion, the tick times a power of two."""
    widest = model.calibrated_diameter / (1 if model.slider is None else model.slider.cells)
    return float(model.tick * 2.0 ** floor(log2(widest / model.tick)))


def cells_per_tick(model: Model) -> int:
    """Return the number of equal cells, a power of two, into which the slider's step must divide a tick.

    The step uses three exact moments of the force over a cell. The error of leaving out all others is
    err = 8e-4 / sqrt(N_jm) q min(r h, 6)^3.5, where q is the cell's width over d_m, and r h is the rate of a mode of
    the slider times the cell's time. The power laws are those of the third moment at a mid-life kink; the coefficient
    is an envelope over some 11 500 measured cases. The fast mode of an over-damped slider is weighted by
    sqrt(r_slow / r_fast) in the displacement, where its share is r_slow / r_fast, and by 1 in the velocity. If the
    slider follows the force, r_slow d_m > V, its largest velocity is smaller by the factor r_slow h / q, so its
    relative error is larger by that factor. The same happens with regular births, whose force hardly varies.
    A base also drives the velocity, whose error is then larger by a factor of up to 1 + c r_fast/k.
    A triangle is straight between its kinks, which are no steeper than those of the lens: the same envelope holds.
    A separation under a load counts as a slider. Raises Refused if more than 4096 cells would be needed.
    """
    moving = [] if model.slider is None else [model.slider]
    moving += [] if model.separation is None else [model.separation.oscillator]
    if not moving or model.tick_duration is None or model.is_two_way or model.free is not None:
        return 1  # these motions have steps of their own
    cells, widest = 1, WIDEST_CELL * model.calibrated_diameter
    while max(_error(model, each, cells) for each in moving) > TARGET or model.tick / cells > widest:
        cells *= 2
        if cells > MOST_CELLS:
            raise Refused(
                f"sliding.speed: at {model.sliding_speed:g} um/s the slider moves so fast within a tick of "
                f"{model.tick:g} um that its motion would need over {MOST_CELLS} steps a tick; "
                "a faster speed, a shorter output.tick or a softer, heavier or less damped slider is needed"
            )
    return cells


def _error(model: Model, slider: Slider, cells: int) -> float:
    width = model.tick / model.calibrated_diameter / cells
    duration = (model.tick_duration or 0.0) / cells
    slow, fast = _rates(slider)
    steepness = max(
        min(slow * duration, 6.0) ** 3.5,
        (slow / fast) ** 0.5 * min(fast * duration, 6.0) ** 3.5,
        VELOCITY_SHARE / _liveliness(model) * max(1.0, slow * duration / width) * min(fast * duration, 6.0) ** 3.5,
    )
    if slider.excitation == "base":
        steepness *= 1.0 + slider.damping * fast / slider.stiffness
    return COEFFICIENT / model.mean_junction_count**0.5 * width * steepness


def _liveliness(model: Model) -> float:
    """Return about how much the force varies, relative to the force with Poisson births.

    For regular births of equal sizes this is 1/(2 N_jm^1.5): the triangle with an odd number has the relative deviation
    1/(sqrt(3) N_jm^2), and with Poisson births 2/sqrt(3 N_jm). A spread of sizes adds to it. Other laws of births lie
    between, according to their dispersion.
    """
    if model.births.dispersion >= 1.0:
        return 1.0
    spread = max(model.sizes.moment(2) / model.sizes.moment(1) ** 2 - 1.0, 0.0) ** 0.5
    even = hypot(spread, 0.5 * model.mean_junction_count**-1.5)
    return min(hypot(even, model.births.dispersion**0.5), 1.0)


def _rates(slider: Slider) -> tuple[float, float]:
    """Return the moduli of the two roots of m L^2 + c L + k = 0 in 1/s, the smaller first."""
    decay = slider.damping / (2.0 * slider.mass)
    fast = abs(decay + sqrt(decay**2 - slider.natural_angular_frequency**2))
    return slider.stiffness / slider.mass / fast, fast


LARGEST_TICK_RANGE = 294_912
"""Largest number of positions in a range. A thin contact, whose blocks are long, then needs no more memory."""


def tick_ranges(model: Model, begin: int, next_birth: float, cells_per_tick: int) -> Iterator[range]:
    """Yield the ranges of ticks from ``begin`` up to the next block's first birth (um) or the end of the run."""
    end = first_tick_at_or_after(model, next_birth)
    size = max(LARGEST_TICK_RANGE // cells_per_tick, 1)
    for first in range(begin, end, size):
        yield range(first, min(first + size, end))


def first_tick_at_or_after(model: Model, distance: float) -> int:
    """Return the first tick at or after a distance (um); one beyond the last tick if the run is over there."""
    if distance > model.distance:
        return model.tick_count + 1
    tick = max(ceil(distance / model.tick) - 1, 0)
    while float(tick) * model.tick < distance:
        tick += 1
    return min(tick, model.tick_count + 1)

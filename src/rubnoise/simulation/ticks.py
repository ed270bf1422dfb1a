"""Ticks: into how many cells the slider divides each, and their ranges, which are computed and written at one go."""

from cmath import sqrt
from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, hypot

from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.simulation.draws import BlockBirths
from rubnoise.simulation.state import State

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
    in the displacement is r_slow / r_fast. In the velocity it is 1; and if the slider follows the force,
    r_slow d_m > V, its largest velocity is smaller by r_slow h / q, so that the relative error is larger by as much.
    So it is with regular births, whose force hardly varies.
    A base drives the velocity, too: its error is larger by up to 1 + c r_fast/k.
    The triangle is straight beside its kinks, which are no steeper than the lens's: the same envelope holds.
    A separation under a load is such a slider, too. Raises Refused if more than 4096 cells would be needed.
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
    if slider.excitation == "base":
        steepness *= 1.0 + slider.damping * fast / slider.stiffness
    return COEFFICIENT / model.mean_junction_count**0.5 * width * steepness


def _liveliness(model: Model) -> float:
    """Return about how much the force varies beside one of Poisson births.

    With regular births of equal sizes by 1/(2 N_jm^1.5): 1/(sqrt(3) N_jm^2) for the triangle and an odd number, where
    Poisson births have 2/sqrt(3 N_jm); and with the spread of their sizes. Others lie between by their dispersion.
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
"""Positions in a range at most, so that a thin contact, whose blocks are long, needs no more memory than others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TickRange:
    """Ticks ``first`` ... ``end`` - 1, ``tick`` um apart."""

    first: int
    end: int
    tick: float

    @property
    def last_distance(self) -> float:
        """The distance of the last tick in um."""
        return float(self.end - 1) * self.tick

    @property
    def wake(self) -> float:
        """Where the range is sampled among events (um): half a tick late, so that all at its last tick has happened."""
        return self.last_distance + 0.5 * self.tick


def tick_ranges(model: Model, state: State, births: BlockBirths, cells_per_tick: int) -> Iterator[TickRange]:
    """Yield the tick ranges of blocks, up to the next block's first birth or the end of the run."""
    end = first_tick_at_or_after(model, births.next_birth)
    size = max(LARGEST_TICK_RANGE // cells_per_tick, 1)
    for first in range(state.ticks, end, size):
        yield TickRange(first=first, end=min(first + size, end), tick=model.tick)


def first_tick_at_or_after(model: Model, distance: float) -> int:
    """Return the first tick that does not lie before a distance in um: one beyond the last if the run is over."""
    if distance > model.distance:
        return model.tick_count + 1
    tick = max(ceil(distance / model.tick) - 1, 0)
    while float(tick) * model.tick < distance:
        tick += 1
    return min(tick, model.tick_count + 1)

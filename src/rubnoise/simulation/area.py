"""The sum of the live junctions: real contact area, count and force at the ticks of a range, and over its cells."""

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import Fixed
from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.simulation.kernel import count_live, sum_at_places, sum_over_cells
from rubnoise.simulation.state import LiveRows

Drive = Literal["area", "force"]  # what moves a slider or a load: the real contact area or the friction force


def has_one_strength(model: Model) -> bool:
    """Whether the friction force is the area times one strength, if there is a force."""
    return model.strengths is None or isinstance(model.strengths, Fixed)


def sample(
    model: Model, rows: LiveRows, ticks: range, cells_per_tick: int = 1, drives: Sequence[Drive] = ()
) -> tuple[Columns, list[Doubles]]:
    """Return the columns of /trace for a range of ticks, and the moments of what drives a motion through it.

    rows: include every junction alive in the range; cells_per_tick: into how many cells the motion divides each tick, a
    power of two. Moments (3, cells) are Legendre moments over the width of the cells that end at the ticks, in um^2 and
    uN; of a force of one strength, over that too. At the first tick of the run no cell ends.
    """
    first, end, tick, equal = ticks.start, ticks.stop, model.tick, has_one_strength(model)
    square = rows.diameter * rows.diameter
    moves = "area" in drives or (equal and bool(drives))
    area, moments = _summed(model, rows, square, ticks, cells_per_tick if moves else 0)
    columns: dict[str, NDArray[Any]] = {
        "distance": np.arange(first, end) * tick,
        "real_contact_area": area,
        "junction_count": count_live(first, end, tick, rows.birth, rows.death),
    }
    driving = {"area": moments, "force": moments}
    if not equal:
        moves = "force" in drives
        columns["friction_force"], driving["force"] = _summed(
            model, rows, rows.strength * square, ticks, cells_per_tick if moves else 0
        )
    elif model.strengths is not None:
        columns["friction_force"] = model.strengths.mean * area
    return columns, [driving[drive] for drive in drives]


def _summed(
    model: Model, rows: LiveRows, weight: Doubles, ticks: range, cells_per_tick: int
) -> tuple[Doubles, Doubles]:
    """Return the weighted sum of all lives at the ticks, and its moments over the cells that end at them, if any."""
    first, end, shape = ticks.start, ticks.stop, model.pulse.shape
    if cells_per_tick == 0:
        return sum_at_places(shape, rows, weight, first, end, model.tick), np.empty((3, 0))
    before = max(first - 1, 0)
    low, high = before * cells_per_tick, (end - 1) * cells_per_tick
    total, moments = sum_over_cells(shape, rows, weight, low, high, model.tick / cells_per_tick)
    return total[(first - before) * cells_per_tick :: cells_per_tick], moments

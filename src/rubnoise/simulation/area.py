"""The sum of the live junctions: real contact area, count and force at the ticks of a range."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.simulation.kernels import Grid, Scratch, count_live, deposit
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import TickRange


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceMoments:
    """The friction force over the cells of a tick range: Legendre moments (3, cells), in units of ``unit`` uN um."""

    moments: Doubles
    unit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """The columns of /trace for a range of ticks, and the moments of the force over its ticks if they were wanted.

    ``moved``: the columns of /load and /slider, after `MovingSeparation` has moved through the range.
    """

    columns: Columns
    force: ForceMoments | None = None
    moved: Mapping[str, Columns] = field(default_factory=dict)


def sample(model: Model, rows: LiveRows, tick_range: TickRange, scratch: Scratch | None) -> Sample:
    """Return the columns of /trace for a tick range, from rows that include every junction alive in it.

    ``scratch``: memory for the moments of the force, if a slider moves through the cells that end at its ticks; they
    are valid until the next tick range.
    """
    grid = Grid.around(tick_range.first, tick_range.end, tick_range.tick)
    distance = grid.position[grid.wanted]
    count = np.empty(distance.size, dtype=np.uint32)
    count_live(distance, rows.birth, rows.departure, count)
    constant = model.strengths is None or isinstance(model.strengths, Fixed)
    square = rows.diameter * rows.diameter
    deposited = deposit(model.pulse.shape, grid, rows, square, scratch if constant else None)
    area, moments = deposited.total, deposited.moments
    columns: dict[str, NDArray[Any]] = {"distance": distance, "real_contact_area": area, "junction_count": count}
    unit = tick_range.tick
    if model.strengths is None:
        return Sample(columns=columns, force=None if scratch is None else ForceMoments(moments=moments, unit=unit))
    if constant:
        columns["friction_force"] = model.strengths.mean * area
        unit = tick_range.tick * model.strengths.mean
    else:
        deposited = deposit(model.pulse.shape, grid, rows, rows.strength * square, scratch)
        columns["friction_force"], moments = deposited.total, deposited.moments
    return Sample(columns=columns, force=None if scratch is None else ForceMoments(moments=moments, unit=unit))


def cell_moments(
    model: Model, rows: LiveRows, weight: Doubles, tick_range: TickRange, cells_per_tick: int, scratch: Scratch
) -> ForceMoments:
    """Return the moments of the weighted sum of all lives over the cells that end in a tick range.

    They are exact even in cells with births and deaths. The weight psi d^2 gives the force, d^2 the area. The number of
    cells per tick is a power of two, so that each tick has the same bits however it is divided.
    """
    first = max(tick_range.first - 1, 0) * cells_per_tick + 1
    grid = Grid.around(first, (tick_range.end - 1) * cells_per_tick + 1, tick_range.tick / cells_per_tick)
    moments = deposit(model.pulse.shape, grid, rows, weight, scratch, areas=False).moments
    return ForceMoments(moments=moments, unit=grid.spacing)


def over_cells(sample: Sample, tick_range: TickRange) -> ForceMoments | None:
    """Return the moments of a sample over the cells that end in a tick range, or None if it has no moments.

    At the first tick of the run no cell ends.
    """
    if sample.force is None or tick_range.first > 0:
        return sample.force
    return replace(sample.force, moments=sample.force.moments[:, 1:])

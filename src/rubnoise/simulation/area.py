"""The sum of the live junctions: real contact area, count and force at the ticks of a range, and over its cells."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import Fixed
from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.simulation.kernel import count_live, sum_at_places, sum_over_cells
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import TickRange


@dataclass(frozen=True, slots=True, kw_only=True)
class CellMoments:
    """Area or force over the cells of a tick range: Legendre moments (3, cells), in units of ``unit``."""

    moments: Doubles
    unit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """The columns of /trace for a range of ticks, and what drives a motion through the cells that end at them.

    area, force: their moments (um^2 um, uN um), None if nothing moves. At the first tick of the run no cell ends.
    """

    columns: Columns
    area: CellMoments | None = None
    force: CellMoments | None = None


def sample(model: Model, rows: LiveRows, tick_range: TickRange, cells_per_tick: int) -> Sample:
    """Return the sample of a tick range, from rows that include every junction alive in it.

    ``cells_per_tick``: into how many cells a motion divides each tick, a power of two; 0 if nothing moves.
    """
    first, end, tick = tick_range.first, tick_range.end, tick_range.tick
    equal = model.strengths is None or isinstance(model.strengths, Fixed)
    by_area = equal or model.separation is not None or model.base_per_area > 0.0
    square = rows.diameter * rows.diameter
    area, areas = _summed(model, rows, square, tick_range, cells_per_tick if by_area else 0)
    columns: dict[str, NDArray[Any]] = {
        "distance": np.arange(first, end) * tick,
        "real_contact_area": area,
        "junction_count": count_live(first, end, tick, rows.birth, rows.departure),
    }
    forces = areas
    if not equal:
        force, forces = _summed(model, rows, rows.strength * square, tick_range, cells_per_tick)
        columns["friction_force"] = force
    elif model.strengths is not None:
        columns["friction_force"] = model.strengths.mean * area
        if areas is not None:
            forces = CellMoments(moments=areas.moments, unit=areas.unit * model.strengths.mean)
    return Sample(columns=columns, area=areas, force=forces)


def _summed(
    model: Model, rows: LiveRows, weight: Doubles, tick_range: TickRange, cells_per_tick: int
) -> tuple[Doubles, CellMoments | None]:
    """Return the weighted sum of all lives at the ticks, and its moments over the cells that end at them."""
    first, end, shape = tick_range.first, tick_range.end, model.pulse.shape
    if cells_per_tick == 0:
        return sum_at_places(shape, rows, weight, first, end, tick_range.tick), None
    width, before = tick_range.tick / cells_per_tick, max(first - 1, 0)
    low, high = before * cells_per_tick, (end - 1) * cells_per_tick
    total, moments = sum_over_cells(shape, rows, weight, low, high, width)
    return total[(first - before) * cells_per_tick :: cells_per_tick], CellMoments(moments=moments, unit=width)

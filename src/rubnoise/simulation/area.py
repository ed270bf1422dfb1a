"""The sum of the live junctions: area, count and force at ticks and over cells, and the force they can bear, G(s)."""

from collections.abc import Mapping, Sequence
from typing import Any, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled_within
from rubnoise.contact.distributions import Fixed
from rubnoise.contact.pulses import Shape
from rubnoise.model import Model
from rubnoise.record.rows import Columns
from rubnoise.simulation.kernel import QUARTER_TURN, count_live, sum_at_places, sum_over_cells
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


# The force that a two-way slider meets, G(s).
KINKS: Final[Mapping[Shape, tuple[tuple[float, float], ...]]] = {
    "lens": ((1.0, -2.0),),
    "triangle": ((0.0, QUARTER_TURN), (1.0, -2.0 * QUARTER_TURN), (2.0, QUARTER_TURN)),
    "parabola": ((0.0, 2.0 * QUARTER_TURN), (2.0, 2.0 * QUARTER_TURN)),
}
"""Where in a life the slope of the area jumps, in half lives from its birth, and by how much, over the diameter."""


class ForceCells(NamedTuple):
    """G over cells of a width (um) from the cell ``first`` on, for compiled code.

    cubics (cells, 4): coefficients of 1, y, y^2, y^3 in uN, y being the place in the cell over its width; kinks
    (2, kinks): their y, and change of slope in uN for each cell; begins (cells + 1): the first kink of each cell.
    """

    first: int
    width: float
    cubics: Doubles
    kinks: Doubles
    begins: Integers


def force_cells(shape: Shape, rows: LiveRows, first: int, end: int, width: float) -> ForceCells:
    """Return G over the cells ``first`` ... ``end`` - 1 from rows that include all who live there."""
    weight = rows.strength * rows.diameter * rows.diameter
    edges, moments = sum_over_cells(shape, rows, weight, first, end, width)
    place = np.concatenate([rows.birth + halves * rows.diameter for halves, _ in KINKS[shape]])
    slope = np.concatenate([rows.strength * rows.diameter * change * width for _, change in KINKS[shape]])
    order = np.argsort(place, kind="stable")
    order = order[np.searchsorted(place[order], first * width) : np.searchsorted(place[order], end * width)]
    cell = np.clip(np.floor(place[order] / width).astype(np.int64), first, end - 1)
    y, slope = np.clip(place[order] / width - cell, 0.0, 1.0), slope[order]
    rest = 1.0 - y
    at = cell - first
    jumps = rest, rest**2 / 2.0, rest**2 / 2.0 - rest**3 / 3.0  # what a kink adds to the end, mean and tilt of its cell
    ends, mean, tilt = (
        values - np.bincount(at, slope * part, end - first)
        for values, part in zip((edges[1:], *moments[:2]), jumps, strict=True)
    )
    line, begin = 3.0 * tilt, edges[:-1]
    bend, twist = 0.5 * (begin + ends) - mean, 0.5 * (ends - begin) - line
    cubics = [
        mean - line + bend - twist,
        2.0 * line - 6.0 * bend + 12.0 * twist,
        6.0 * bend - 30.0 * twist,
        20.0 * twist,
    ]
    return ForceCells(
        first=first,
        width=width,
        cubics=np.ascontiguousarray(np.array(cubics).T),
        kinks=np.array([y, slope]),
        begins=np.append(0, np.cumsum(np.bincount(at, minlength=end - first))),
    )


@compiled_within
def expand(cells: ForceCells, cell: int, y: float, way: float, piece: Doubles) -> float:
    """Fill in the powers (4) of G about a place, for distances in um; return the next border ahead, as its y.

    Borders are kinks and the edges of the cell.
    """
    row, border = cell - cells.first, 1.0 if way > 0.0 else 0.0
    c0, c1, c2, c3 = cells.cubics[row, 0], cells.cubics[row, 1], cells.cubics[row, 2], cells.cubics[row, 3]
    value, slope = c0 + y * (c1 + y * (c2 + y * c3)), c1 + y * (2.0 * c2 + 3.0 * y * c3)
    for n in range(cells.begins[row], cells.begins[row + 1]):
        place, change = cells.kinks[0, n], cells.kinks[1, n]
        if place < y or (place == y and way > 0.0):
            value += change * (y - place)
            slope += change
        if way * (place - y) > 0.0 and way * (border - place) > 0.0:
            border = place
    per = 1.0 / cells.width
    piece[0], piece[1], piece[2], piece[3] = value, slope * per, (c2 + 3.0 * y * c3) * per * per, c3 * per * per * per
    return border

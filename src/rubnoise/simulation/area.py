"""The sum of the live junctions: real contact area, count and force at the ticks of a panel."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.laws import Fixed
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.simulation import kernels, kernels_triangle
from rubnoise.simulation.grid import Grid
from rubnoise.simulation.kernels_fine import FINEST, deposit_fine_lives
from rubnoise.simulation.kernels_panels import cell_weights
from rubnoise.simulation.panels import LARGEST_PANEL, Panel
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import count_live

Doubles = NDArray[np.float64]

_CELL_WEIGHTS = cell_weights().ravel()
_NO_MOMENTS = np.empty(0)

_AT_ONCE = 12 * LARGEST_PANEL
"""Numbers of room that are asked for, most of which are never touched. Usual systems take back what lies free at the
end of the heap where it is more than twice the largest piece ever freed: after a run, all arrays of a panel, which the
next one would have to be given anew."""

_LONG = 1024
"""Cells that cost as much as to look at two stretches of lives, and not at one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceMoments:
    """The friction force over the cells of a panel: Legendre moments (3, cells), in units of ``unit`` uN um."""

    moments: Doubles
    unit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """The columns of /trace for a panel, and the moments of the force over its ticks where they have been asked for."""

    columns: Columns
    force: ForceMoments | None = None


class Room:
    """Memory for moments that is used again from panel to panel: new memory would cost more than what is done in it."""

    def __init__(self) -> None:
        self._moments = np.empty(0)

    def numbers(self, count: int) -> Doubles:
        """Return so many numbers, whatever they are, in place of those returned before."""
        if self._moments.size < count:
            self._moments = np.empty(max(count, _AT_ONCE))
        return self._moments[:count]


def sample(model: Model, rows: LiveRows, panel: Panel, room: Room | None) -> Sample:
    """Return the columns of /trace for a panel, from rows that cover everything alive in it.

    ``room``: for the force's moments, where a slider is to be moved through the cells that end at its ticks; they hold
    until the next panel.
    """
    grid = Grid.around(panel.first, panel.end, panel.tick)
    distance = grid.position[grid.wanted]
    count = np.empty(distance.size, dtype=np.uint32)
    count_live(distance, rows.birth, rows.departure, count)
    constant = isinstance(model.strengths, Fixed)
    square = rows.diameter * rows.diameter
    area, moments = _weighted(model.pulse, grid, rows, square, room if constant else None)
    columns: dict[str, NDArray[Any]] = {"distance": distance, "real_contact_area": area, "junction_count": count}
    if model.strengths is None:
        return Sample(columns=columns)
    unit = panel.tick
    if constant:
        columns["friction_force"] = model.strengths.mean * area
        unit = panel.tick * model.strengths.mean
    else:
        force, moments = _weighted(model.pulse, grid, rows, rows.strength * square, room)
        columns["friction_force"] = force
    return Sample(columns=columns, force=None if room is None else ForceMoments(moments=moments, unit=unit))


def force_moments(model: Model, rows: LiveRows, panel: Panel, cells_per_tick: int, room: Room) -> ForceMoments:
    """Return the force over the cells that end in a panel, exact through births, mid-lives and deaths.

    The number of cells per tick is a power of two, so that every tick lies at the same bits however it is divided.
    """
    first = max(panel.first - 1, 0) * cells_per_tick + 1
    grid = Grid.around(first, (panel.end - 1) * cells_per_tick + 1, panel.tick / cells_per_tick)
    weight = rows.strength * (rows.diameter * rows.diameter)
    _, moments = _weighted(model.pulse, grid, rows, weight, room)
    return ForceMoments(moments=moments, unit=grid.spacing)


def _weighted(pulse: Pulse, grid: Grid, rows: LiveRows, weight: Doubles, room: Room | None) -> tuple[Doubles, Doubles]:
    """Return the sum over all rows of weight times area over d^2 at the positions wanted, and its moments, (3, cells).

    The moments are those over the cell that ends at a position, in units of the spacing; there are none without room.
    """
    size = grid.position.size
    total = np.empty(size)
    flat = _NO_MOMENTS if room is None else room.numbers(3 * size)
    if pulse.shape == "triangle":
        total[:], flat[:] = 0.0, 0.0
        rest = np.arange(len(rows))
    else:
        rest = _add_fine(grid, rows, weight, total, flat)
    moments = flat.reshape(3, -1)
    if rest.size:
        _add_rest(pulse, grid, rows.at(rest), weight[rest], total, moments)
    return total[grid.wanted], moments if room is None else moments[:, grid.wanted]


def _add_fine(grid: Grid, rows: LiveRows, weight: Doubles, total: Doubles, moments: Doubles) -> NDArray[np.int64]:
    """Begin with lives of many positions that take their course; return the rows of the others."""
    return deposit_fine_lives(
        grid.position,
        grid.origin,
        grid.spacing,
        grid.wanted.start,
        grid.wanted.stop,
        rows.birth,
        rows.diameter,
        rows.departure,
        weight,
        _CELL_WEIGHTS,
        total,
        moments,
    )


def _add_rest(pulse: Pulse, grid: Grid, rows: LiveRows, weight: Doubles, total: Doubles, moments: Doubles) -> None:
    """Add any lives, position by position."""
    lives = (rows.birth, rows.diameter, rows.departure)
    at = grid.wanted
    deposit = kernels_triangle.deposit_areas if pulse.shape == "triangle" else kernels.deposit_areas
    deposit(grid.position[at], *lives, weight, total[at])
    for some in _apart(grid, rows) if moments.size else ():
        crowd = rows.part(some.start, some.stop)
        edges = _edges_in_reach(grid, crowd)
        found = _moments_of_rest(pulse, grid, grid.position[edges], crowd, weight[some])
        moments[:, edges.start + 1 : edges.stop] += found[:, 1:] / grid.spacing


def _apart(grid: Grid, rows: LiveRows) -> Iterator[slice]:
    """Yield the rows by stretches between which nothing lives for long.

    A few lives, as where some are coarser than others, should not cost a pass over all cells.
    """
    last_death = np.maximum.accumulate(rows.death)
    borders = np.flatnonzero(rows.birth[1:] - last_death[:-1] > _LONG * grid.spacing) + 1
    for first, end in pairwise([0, *borders.tolist(), len(rows)]):
        yield slice(first, end)


def _edges_in_reach(grid: Grid, rows: LiveRows) -> slice:
    """Return the indices of the edges of those cells wanted in which any of the lives can be."""
    cells = grid.cells()
    edges = grid.position[cells]
    first = max(int(np.searchsorted(edges, rows.birth.min())) - 1, 0)
    end = min(int(np.searchsorted(edges, rows.death.max())) + 1, edges.size)
    return slice(cells.start + first, cells.start + max(end, first + 1))


def _moments_of_rest(pulse: Pulse, grid: Grid, edges: Doubles, rows: LiveRows, weight: Doubles) -> Doubles:
    """Return the moments (um times the weight's unit) over the cells that end at the edges."""
    moments = np.zeros((3, edges.size))
    strength = weight / (rows.diameter * rows.diameter)
    lives = (rows.birth, rows.diameter, rows.departure, strength)
    if pulse.shape == "triangle":
        kernels_triangle.deposit_moments(edges, grid.spacing, *lives, moments)
        return moments
    # Where a cell is a small part of a life, differences of the integrals over it lose what the cell is to gain.
    narrow = rows.diameter >= FINEST * grid.spacing
    for kept, deposit in ((~narrow, kernels.deposit_moments), (narrow, kernels.deposit_fine_moments)):
        if kept.any():
            deposit(edges, *(column[kept] for column in lives), moments)
    return moments

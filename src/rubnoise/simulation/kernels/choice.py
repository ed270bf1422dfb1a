"""The choice of the method by which lives are summed; all compiled loops are called from here."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from types import ModuleType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.off_centre import half_life
from rubnoise.contact.overlap import max_area
from rubnoise.contact.pulses import Shape
from rubnoise.simulation.kernels import off_centre, off_centre_series, parabola, triangle
from rubnoise.simulation.kernels.coarse import deposit_coarse_lives
from rubnoise.simulation.kernels.fine import FINEST, deposit_fine_lives
from rubnoise.simulation.kernels.grid import Grid
from rubnoise.simulation.kernels.lens import deposit_fine_moments
from rubnoise.simulation.kernels.taylor import cell_weights
from rubnoise.simulation.state import LiveRows

_CELL_WEIGHTS: Final = cell_weights().ravel()
_NOTHING: Final = np.empty(0)

_Way = Callable[[Grid, LiveRows, Doubles, Doubles, Doubles, "Scratch"], None]

_LONG: Final = 1024
"""Cells that cost about as much as summing two stretches of lives instead of one."""


class Scratch:
    """Memory that is used again for each tick range: new memory would cost more than the work done in it."""

    def __init__(self, at_once: int) -> None:
        """Allocate nothing yet; the first use allocates at least ``at_once`` numbers."""
        self._at_once = at_once
        self._moments = np.empty(0)
        self._zeros = np.empty(0)

    def numbers(self, count: int) -> Doubles:
        """Return ``count`` numbers of any value; they share the memory of those returned before."""
        if self._moments.size < count:
            self._moments = np.empty(max(count, self._at_once))
        return self._moments[:count]

    def zeros(self, count: int) -> Doubles:
        """Return ``count`` zeros in the memory of those returned before; the caller must leave them zero."""
        if self._zeros.size < count:
            self._zeros = np.zeros(max(count, self._at_once))
        return self._zeros[:count]


@dataclass(frozen=True, slots=True, kw_only=True)
class Deposited:
    """Sums over lives at the positions wanted of a grid.

    total: the sum of weight times area over d^2 at each; moments (3, positions): the Legendre moments of that sum,
    int sum P_i(2y - 1) dy, over the cell that ends there, in units of the spacing. An array that is not wanted is
    empty.
    """

    total: Doubles
    moments: Doubles


def deposit(
    shape: Shape, grid: Grid, rows: LiveRows, weight: Doubles, scratch: Scratch | None, *, areas: bool = True
) -> Deposited:
    """Sum lives of one shape, each with its weight, in order of birth.

    With the weight d^2 the total is the real contact area (um^2), with psi d^2 (MPa um^2) the friction force (uN). A
    life counts while birth <= s < departure. ``scratch``: memory for the moments, if they are wanted; they are valid
    until it is used again. ``areas``: whether the total is wanted.
    """
    size = grid.position.size
    total = np.empty(size if areas else 0)
    flat = _NOTHING if scratch is None else scratch.numbers(3 * size)
    way = (_WAYS if rows.offset is None else _OFF_CENTRE_WAYS)[shape]
    way(grid, rows, weight, total, flat, scratch or Scratch(0))
    wanted = grid.wanted
    return Deposited(
        total=total[wanted] if areas else total, moments=flat.reshape(3, -1)[:, wanted] if scratch else flat
    )


def _deposit_lenses(
    grid: Grid, rows: LiveRows, weight: Doubles, total: Doubles, moments: Doubles, scratch: Scratch
) -> None:
    """Sum whole lives of many positions as series, and all others position by position."""
    if not np.any(rows.diameter >= FINEST * grid.spacing):
        total[:] = 0.0
        _deposit_coarse(grid, grid.cells(), rows, weight, total, moments, scratch, added=0)
        return
    rest = _deposit_fine(grid, rows, weight, total, moments)
    if rest.size:
        others, other_weight = rows.at(rest), weight[rest]
        # A series cannot end early, so the areas of fine lives that were ended early are summed like the others.
        narrow = others.diameter >= FINEST * grid.spacing
        if narrow.any():
            _deposit_with_narrow(grid, others, other_weight, narrow, total, moments, scratch)
            return
        for some in _apart(grid, others):
            crowd = others.part(some.start, some.stop)
            _deposit_coarse(grid, _edges_in_reach(grid, crowd), crowd, other_weight[some], total, moments, scratch)


def _deposit_fine(grid: Grid, rows: LiveRows, weight: Doubles, total: Doubles, moments: Doubles) -> NDArray[np.int64]:
    """Start the sums with the whole lives of many positions; return the rows of the others."""
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


def _deposit_coarse(
    grid: Grid,
    edges: slice,
    rows: LiveRows,
    weight: Doubles,
    total: Doubles,
    moments: Doubles,
    scratch: Scratch,
    *,
    unit: float | None = None,
    added: int = 1,
) -> None:
    """Add lives position by position, in the cells between ``edges``; unit: of the moments, else the spacing."""
    deposit_coarse_lives(
        grid.position,
        unit or grid.spacing,
        edges.start + 1,
        edges.stop,
        rows.birth,
        rows.diameter,
        rows.departure,
        weight,
        scratch.zeros(6 * grid.position.size) if moments.size else _NOTHING,
        total,
        moments,
        added,
    )


def _deposit_with_narrow(
    grid: Grid,
    rows: LiveRows,
    weight: Doubles,
    narrow: NDArray[np.bool_],
    total: Doubles,
    moments: Doubles,
    scratch: Scratch,
) -> None:
    """Add lives; those marked ``narrow`` have many positions and were ended early: their moments come from quadrature.

    A cell is so small a part of such a life that differences of its integrals would lose too many digits.
    """
    if total.size:
        _deposit_coarse(grid, grid.cells(), rows, weight, total, _NOTHING, scratch)
    if moments.size:
        found, edges = np.zeros_like(moments), grid.cells()
        wide, few = np.flatnonzero(~narrow), rows.at(np.flatnonzero(narrow))
        _deposit_coarse(grid, edges, rows.at(wide), weight[wide], _NOTHING, found, scratch, unit=1.0)
        cells = np.ascontiguousarray(found.reshape(3, -1)[:, edges])
        strength = weight[narrow] / (few.diameter * few.diameter)
        deposit_fine_moments(grid.position[edges], few.birth, few.diameter, few.departure, strength, cells)
        moments.reshape(3, -1)[:, grid.wanted] += cells[:, 1:] / grid.spacing


def _polynomial(lives: ModuleType) -> _Way:
    """Return the method for lives that are polynomials except at kinks; it works at any position and in any cell."""

    def deposit_polynomials(
        grid: Grid, rows: LiveRows, weight: Doubles, total: Doubles, moments: Doubles, scratch: Scratch
    ) -> None:
        lived = (rows.birth, rows.diameter, rows.departure)
        if total.size:
            at = grid.wanted
            total[at] = 0.0
            lives.deposit_areas(grid.position[at], *lived, weight, total[at])
        if moments.size:
            strength = weight / (rows.diameter * rows.diameter)
            chords = scratch.zeros(2 * grid.position.size).reshape(2, -1)
            moments[:] = 0.0
            lives.deposit_moments(grid.position, grid.spacing, *lived, strength, chords, moments.reshape(3, -1))
            moments /= grid.spacing

    return deposit_polynomials


def _deposit_chords(
    grid: Grid, rows: LiveRows, weight: Doubles, total: Doubles, moments: Doubles, scratch: Scratch
) -> None:
    """Sum parabolas off the centre line: they are centred parabolas of smaller diameters, sqrt(d^2 - b^2)."""
    chord = rows.half_life
    share = weight * (chord / rows.diameter) * (chord / rows.diameter)
    _WAYS["parabola"](grid, replace(rows, diameter=chord, offset=None), share, total, moments, scratch)


def _deposit_off_centre(
    grid: Grid, rows: LiveRows, weight: Doubles, total: Doubles, moments: Doubles, scratch: Scratch
) -> None:
    """Sum lenses off the centre line: as series far from ends and turns, position by position elsewhere.

    Areas of lives of few positions are also summed position by position; series only give their moments.
    """
    del scratch
    if rows.offset is None:
        raise ValueError("rows have no offsets")
    begin, end, finest = grid.wanted.start, grid.wanted.stop, off_centre_series.FINEST * grid.spacing
    half_life = rows.half_life
    at = (grid.position, grid.origin, grid.spacing, begin, end)
    lives = (rows.birth, rows.diameter, rows.offset, half_life, rows.departure, weight)
    total[:], moments[:] = 0.0, 0.0
    if total.size:
        off_centre.deposit_areas(*at, *lives, finest, total)
    if moments.size:
        off_centre.deposit_moments(*at, *lives, off_centre.FINE_NODES, moments)
    whole, fine = rows.departure >= rows.birth + 2.0 * half_life, rows.diameter >= finest
    for some, areas in ((whole & fine, total), (whole & ~fine, _NOTHING)):
        if (areas.size or moments.size) and some.any():
            chosen = (rows.birth[some], rows.diameter[some], rows.offset[some], half_life[some], weight[some])
            off_centre_series.deposit_series(*at, *chosen, _CELL_WEIGHTS, areas, moments)


def _apart(grid: Grid, rows: LiveRows) -> Iterator[slice]:
    """Yield the rows in stretches, with long gaps between them in which none of them lives.

    So a few lives, for example when only some are coarse, do not cost a pass over all cells.
    """
    last_death = np.maximum.accumulate(rows.death)
    borders = np.flatnonzero(rows.birth[1:] - last_death[:-1] > _LONG * grid.spacing) + 1
    for first, end in pairwise([0, *borders.tolist(), len(rows)]):
        yield slice(first, end)


def _edges_in_reach(grid: Grid, rows: LiveRows) -> slice:
    """Return the indices of the edges of those wanted cells in which any of the lives can be."""
    cells = grid.cells()
    edges = grid.position[cells]
    first = max(int(np.searchsorted(edges, rows.birth.min())) - 1, 0)
    end = min(int(np.searchsorted(edges, rows.death.max())) + 1, edges.size)
    return slice(cells.start + first, cells.start + max(end, first + 1))


_WAYS: Final[dict[Shape, _Way]] = {
    "lens": _deposit_lenses,
    "triangle": _polynomial(triangle),
    "parabola": _polynomial(parabola),
}
_OFF_CENTRE_WAYS: Final[dict[Shape, _Way]] = {"lens": _deposit_off_centre, "parabola": _deposit_chords}


def peak_areas(shape: Shape, diameter: Doubles, offset: Doubles) -> Doubles:
    """Return the areas at mid-life in um^2 of passes off the centre line, of diameters and offsets in um."""
    if shape == "parabola":
        return max_area(half_life(diameter, offset))
    return off_centre.peak_areas(diameter, offset)

"""The sum of the live junctions: real contact area, count and force at the ticks of a panel."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.simulation import kernels
from rubnoise.simulation.panels import Panel
from rubnoise.simulation.propagator import Propagator
from rubnoise.simulation.state import LiveRows

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceIntegrals:
    """The friction force over the cells of a panel, held as running integrals at the cells' edges.

    positions (um): the edges; integrals (3, edges): sums of psi d^3 J1, psi d^4 J2, psi d^5 J3; corrections (3, edges):
    what their differences leave out of the Legendre moments of the cell that ends at an edge.
    """

    positions: Doubles
    integrals: Doubles
    corrections: Doubles


def sample(model: Model, rows: LiveRows, panel: Panel) -> dict[str, NDArray[Any]]:
    """Return the columns of /trace for a panel, from rows that cover everything alive in it."""
    distance = panel.distance
    area = np.zeros(distance.size)
    change = np.zeros(distance.size, dtype=np.int64)
    kernels.deposit_areas(distance, rows.birth, rows.diameter, rows.departure, area, change)
    columns: dict[str, NDArray[Any]] = {
        "distance": distance,
        "real_contact_area": area,
        "junction_count": np.cumsum(change).astype(np.uint32),
    }
    if model.strengths is not None:
        columns["friction_force"] = model.strengths.mean * area
    return columns


def force_integrals(rows: LiveRows, panel: Panel, constants: Propagator) -> ForceIntegrals:
    """Return the force over the cells that end in a panel, exact through births, mid-lives and deaths."""
    positions = panel.positions(constants.cells_per_tick)
    integrals = np.zeros((3, positions.size))
    corrections = np.zeros((3, positions.size))
    lives = (rows.birth, rows.diameter, rows.departure, rows.strength)
    if constants.narrow_cells:
        kernels.deposit_fine_moments(positions, *lives, corrections)
    else:
        kernels.deposit_moments(positions, *lives, integrals, corrections)
    return ForceIntegrals(positions=positions, integrals=integrals, corrections=corrections)

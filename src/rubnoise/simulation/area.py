"""The sum of the live junctions: real contact area, count and force at the ticks of a panel."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import Pulse
from rubnoise.contact.strengths import ConstantStrength
from rubnoise.model import Model
from rubnoise.simulation import kernels, kernels_triangle
from rubnoise.simulation.panels import Panel
from rubnoise.simulation.propagator import Propagator
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import deposit_counts

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
    change = np.zeros(distance.size, dtype=np.int64)
    deposit_counts(distance, rows.birth, rows.departure, change)
    area = _weighted_areas(model.pulse, distance, rows, rows.diameter * rows.diameter)
    columns: dict[str, NDArray[Any]] = {
        "distance": distance,
        "real_contact_area": area,
        "junction_count": np.cumsum(change).astype(np.uint32),
    }
    if isinstance(model.strengths, ConstantStrength):
        columns["friction_force"] = model.strengths.mean * area
    elif model.strengths is not None:
        weight = rows.strength * (rows.diameter * rows.diameter)
        columns["friction_force"] = _weighted_areas(model.pulse, distance, rows, weight)
    return columns


def force_integrals(pulse: Pulse, rows: LiveRows, panel: Panel, constants: Propagator) -> ForceIntegrals:
    """Return the force over the cells that end in a panel, exact through births, mid-lives and deaths."""
    positions = panel.positions(constants.cells_per_tick)
    integrals = np.zeros((3, positions.size))
    corrections = np.zeros((3, positions.size))
    lives = (rows.birth, rows.diameter, rows.departure, rows.strength)
    if pulse.shape == "triangle":
        kernels_triangle.deposit_moments(positions, *lives, corrections)
    elif constants.narrow_cells:
        kernels.deposit_fine_moments(positions, *lives, corrections)
    else:
        kernels.deposit_moments(positions, *lives, integrals, corrections)
    return ForceIntegrals(positions=positions, integrals=integrals, corrections=corrections)


def _weighted_areas(pulse: Pulse, distance: Doubles, rows: LiveRows, weight: Doubles) -> Doubles:
    """Return the sum over all rows of weight times area over d^2 at distances in um."""
    total = np.zeros(distance.size)
    deposit = kernels_triangle.deposit_areas if pulse.shape == "triangle" else kernels.deposit_areas
    deposit(distance, rows.birth, rows.diameter, rows.departure, weight, total)
    return total

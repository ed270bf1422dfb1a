"""Compiled sums for the triangle: what every junction adds to area and force moments, tick by tick.

The force of a triangle is straight except for three kinks: its slope changes by psi pi d/4 at birth, by minus twice
that at mid-life, and by psi pi d/4 at death. Over a cell it is the chord between the edges plus the deviations that
the kinks make: short polynomials of the place in the cell, in which nothing cancels, however narrow the cell.
"""

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_bare
from rubnoise.simulation.kernels.grid import first_at_or_after
from rubnoise.simulation.kernels.kinks import add_fall, add_kink

_SLOPE = 0.25 * np.pi


@compiled_bare
def deposit_areas(
    positions: Doubles, birth: Doubles, diameter: Doubles, departure: Doubles, weight: Doubles, total: Doubles
) -> None:
    """Add every junction's weighted area fraction, (pi/4) (1 - |1 - s/d|), to the ticks at which it lives.

    As for the lens: with the weight d^2 the total is the area in um^2, with psi d^2 the force in uN.
    """
    for row in range(len(birth)):
        born = birth[row]
        size = diameter[row]
        first = first_at_or_after(positions, born)
        last = first_at_or_after(positions, min(departure[row], born + 2.0 * size))
        _add_areas(positions[first:last], born, size, _SLOPE * weight[row] / size, total[first:last])


@compiled_bare
def _add_areas(positions: Doubles, born: float, size: float, slope: float, total: Doubles) -> None:
    for tick in range(len(positions)):
        s = positions[tick] - born
        total[tick] += slope * max(min(s, 2.0 * size - s), 0.0)


@compiled
def deposit_moments(
    positions: Doubles,
    width: float,
    birth: Doubles,
    diameter: Doubles,
    departure: Doubles,
    strength: Doubles,
    chords: Doubles,
    moments: Doubles,
) -> None:
    """Add every junction's Legendre moments of the force to the cells between positions.

    ``width`` of the cells (um) is given, because positions far from the start are rounded, and their differences more.
    moments (3, positions) receives int F P_i(2y - 1) ds for the cell that ends at a position, i = 0, 1, 2 (uN um).
    chords (2, positions) are zeros before and after.
    """
    force = chords[0]
    deposit_areas(positions, birth, diameter, departure, strength * diameter * diameter, force)
    for cell in range(1, len(positions)):
        moments[0, cell] += width * (force[cell] + force[cell - 1]) / 2.0
        moments[1, cell] += width * (force[cell] - force[cell - 1]) / 6.0
    force[:] = 0.0
    for row in range(len(birth)):
        slope = _SLOPE * strength[row] * diameter[row]
        _add_kinks(positions, width, birth[row], diameter[row], departure[row], slope, moments)


@compiled_bare
def _add_kinks(
    positions: Doubles, width: float, born: float, size: float, departure: float, slope: float, moments: Doubles
) -> None:
    """Add the deviations of one life from its chords; a life that is ended early falls to zero there."""
    if departure <= born:
        return
    add_kink(positions, width, born, 0.0, slope, moments)
    age = departure - born
    if age > size:
        add_kink(positions, width, born, size, -2.0 * slope, moments)
    if departure >= born + 2.0 * size:
        add_kink(positions, width, born, 2.0 * size, slope, moments)
    else:
        add_kink(positions, width, born, age, slope if age > size else -slope, moments)
        add_fall(positions, width, departure, slope * max(min(age, 2.0 * size - age), 0.0), moments)

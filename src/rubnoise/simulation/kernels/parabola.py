"""Compiled sums for the parabola: what every junction adds to area and force moments, tick by tick.

The force of a parabola has the constant curvature -psi pi/2 over its life, and its slope changes by psi pi d/2 at birth
and again at death. Over a cell it is the chord between the edges plus the deviations that curvature and kinks make:
short polynomials of the place in the cell, in which nothing cancels, however narrow the cell.
"""

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled, compiled_bare
from rubnoise.simulation.kernels.grid import first_at_or_after
from rubnoise.simulation.kernels.kinks import add_fall, add_kink, add_turn

_QUARTER_TURN = 0.25 * np.pi


@compiled_bare
def deposit_areas(
    positions: Doubles, birth: Doubles, diameter: Doubles, departure: Doubles, weight: Doubles, total: Doubles
) -> None:
    """Add every junction's weighted area fraction, (pi/4) (1 - (1 - s/d)^2), to the ticks at which it lives.

    As for the lens: with the weight d^2 the total is the area in um^2, with psi d^2 the force in uN.
    """
    for row in range(len(birth)):
        born = birth[row]
        size = diameter[row]
        first = first_at_or_after(positions, born)
        last = first_at_or_after(positions, min(departure[row], born + 2.0 * size))
        share = _QUARTER_TURN * weight[row] / (size * size)
        _add_areas(positions[first:last], born, 2.0 * size, share, total[first:last])


@compiled_bare
def _add_areas(positions: Doubles, born: float, life: float, share: float, total: Doubles) -> None:
    for tick in range(len(positions)):
        s = positions[tick] - born
        total[tick] += share * max(s * (life - s), 0.0)


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
    chords (2, positions) are zeros before and after: new memory would cost more than the work done in it.
    """
    force, bend = chords[0], chords[1]
    deposit_areas(positions, birth, diameter, departure, strength * diameter * diameter, force)
    for row in range(len(birth)):
        _add_bend(positions, width, birth[row], diameter[row], departure[row], strength[row], bend, moments)
    cube = width * width * width
    for cell in range(1, len(positions)):
        moments[0, cell] += width * (force[cell] + force[cell - 1]) / 2.0 + cube * bend[cell] / 12.0
        moments[1, cell] += width * (force[cell] - force[cell - 1]) / 6.0
        moments[2, cell] -= cube * bend[cell] / 60.0
    chords[:] = 0.0


@compiled_bare
def _add_bend(
    positions: Doubles,
    width: float,
    born: float,
    size: float,
    departure: float,
    strength: float,
    bend: Doubles,
    moments: Doubles,
) -> None:
    """Add the deviations of one life from its chords; a life that is ended early falls to zero there."""
    if departure <= born:
        return
    bent = 2.0 * _QUARTER_TURN * strength
    whole = departure >= born + 2.0 * size
    end = 2.0 * size if whole else departure - born
    for cell in range(
        first_at_or_after(positions, born) + 1, min(first_at_or_after(positions, born + end) + 1, len(bend))
    ):
        bend[cell] += bent
    add_kink(positions, width, born, 0.0, bent * size, moments)
    add_turn(positions, width, born, 0.0, -bent, moments)
    add_kink(positions, width, born, end, bent * (end - size), moments)
    add_turn(positions, width, born, end, bent, moments)
    if not whole:
        add_fall(positions, width, departure, 0.5 * bent * max(end * (2.0 * size - end), 0.0), moments)

"""How far a change of slope, curvature or height takes the force off the chord of its cell: Legendre moments.

They have a closed form. The chord joins the forces at both edges of a cell. y is the place in the cell over its width
w, r the part of the cell behind the change. moments (3, positions): int F P_i(2y - 1) ds for the cell that ends at a
position, i = 0, 1, 2.
"""

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare
from rubnoise.simulation.kernels.grid import first_at_or_after


@compiled_bare
def add_kink(positions: Doubles, width: float, born: float, age: float, slope: float, moments: Doubles) -> None:
    """Add a change of slope (uN/um) at an age (um): slope w ((y - 1 + r)+ - r y), r the part of its cell behind it."""
    cell = first_at_or_after(positions, born + age)
    if cell == 0 or cell == len(positions):
        return
    # Birth and age are subtracted one after the other, because their sum would be rounded.
    r = min(max((positions[cell] - born - age) / width, 0.0), 1.0)
    beside = slope * width * width * r * (1.0 - r)
    moments[0, cell] -= beside / 2.0
    moments[1, cell] -= beside * (1.0 - 2.0 * r) / 6.0
    moments[2, cell] += beside * r * (1.0 - r) / 2.0


@compiled_bare
def add_turn(positions: Doubles, width: float, born: float, age: float, bend: float, moments: Doubles) -> None:
    """Add a change of curvature (uN/um^2) at an age (um): bend w^2/2 (((y - 1 + r)+)^2 - r^2 y)."""
    cell = first_at_or_after(positions, born + age)
    if cell == 0 or cell == len(positions):
        return
    r = min(max((positions[cell] - born - age) / width, 0.0), 1.0)
    beside = bend * width * width * width * r * r
    moments[0, cell] -= beside * (3.0 - 2.0 * r) / 12.0
    moments[1, cell] -= beside * (1.0 - r) * (1.0 - r) / 12.0
    moments[2, cell] += beside * r * (10.0 + r * (6.0 * r - 15.0)) / 60.0


@compiled_bare
def add_fall(positions: Doubles, width: float, place: float, height: float, moments: Doubles) -> None:
    """Add a fall by a height (uN) at a place (um): height (y - (y > 1 - r)), r the part of its cell behind it."""
    cell = first_at_or_after(positions, place)
    if cell == 0 or cell == len(positions):
        return
    r = (positions[cell] - place) / width
    moments[0, cell] += height * width * (0.5 - r)
    moments[1, cell] += height * width * (1.0 / 6.0 - r * (1.0 - r))
    moments[2, cell] -= height * width * (r * (1.0 - r) * (1.0 - 2.0 * r))

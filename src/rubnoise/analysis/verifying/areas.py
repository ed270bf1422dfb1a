"""Real contact area and friction force summed anew from rows, not by the simulation's formulas; compiled."""

from collections.abc import Callable

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled
from rubnoise.contact.pulses import Pulse, Shape


def add_areas(
    pulse: Pulse,
    positions: Doubles,
    lives: tuple[Integers, Integers],
    shapes: tuple[Doubles, Doubles, Doubles],
    area: Doubles,
    force: Doubles,
) -> None:
    """Add what junctions have of area in um^2 and of force in uN at the positions in um at which they live.

    ``lives`` holds the first position of each junction and the one after its last, ``shapes`` birth, diameter (um) and
    strength (MPa).
    """
    _ADDED[pulse.shape](positions, *lives, *shapes, area, force)


@compiled
def lens_fraction(u: float) -> float:
    """Return the area of the lens over d^2 at the distance u d from the nearer end of the life, 0 <= u <= 1.

    Half of t - sin t cos t with cos t = 1 - u (paper Eq. 2); t = 2 asin(sqrt(u/2)) keeps its digits as u goes to 0, and
    what the difference then loses is 2^-53 of t, not of the area.
    """
    return 0.5 * (2.0 * np.arcsin(np.sqrt(0.5 * u)) - (1.0 - u) * np.sqrt(u * (2.0 - u)))


@compiled
def _add_lenses(
    positions: Doubles,
    first: Integers,
    last: Integers,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles,
    area: Doubles,
    force: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d, psi = birth[row], diameter[row], strength[row]
        for tick in range(first[row], last[row]):
            age = positions[tick] - born
            each = d * d * lens_fraction(max(min(age, 2.0 * d - age), 0.0) / d)
            area[tick] += each
            force[tick] += psi * each


@compiled
def _add_triangles(
    positions: Doubles,
    first: Integers,
    last: Integers,
    birth: Doubles,
    diameter: Doubles,
    strength: Doubles,
    area: Doubles,
    force: Doubles,
) -> None:
    for row in range(len(birth)):
        born, d, psi = birth[row], diameter[row], strength[row]
        for tick in range(first[row], last[row]):
            age = positions[tick] - born
            each = 0.25 * np.pi * d * max(min(age, 2.0 * d - age), 0.0)
            area[tick] += each
            force[tick] += psi * each


_ADDED: dict[Shape, Callable[..., None]] = {"lens": _add_lenses, "triangle": _add_triangles}

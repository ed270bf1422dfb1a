"""The area of any junction over its life, in words and as a table that any tool can interpolate."""

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import OFF_CENTRE, PULSES, Pulse, Shape

_WHERE: Final = (
    " with d = diameter, x = |d - (s - birth_distance)|, for birth_distance <= s < death_distance, and 0 elsewhere"
)
_WHERE_OFF_CENTRE: Final = (
    " with d = diameter, b = lateral_offset, x = s - birth_distance - sqrt(d^2 - b^2), r = sqrt(x^2 + b^2), for"
    " birth_distance <= s < death_distance, and 0 elsewhere"
)
JUNCTION_AREA_FORMULAS: Final = {
    **{name: f"A(s) = {pulse.formula}{_WHERE}" for name, pulse in PULSES.items()},
    **{pulse.name: f"A(s) = {pulse.formula}{_WHERE_OFF_CENTRE}" for pulse in OFF_CENTRE.values()},
}
"""The area of a junction in words, by the name of its pulse."""

TOUCH_AREA_FORMULA: Final = (
    "A = max_area * overlap/max_overlap; the overlap follows the separation: h - (s - x)^2 height_scale/c^2 - z of a"
    " summit of height h at x, c^2 = 4 mean_real_contact_area/(pi mean_junction_count)"
)
"""The area of a junction under a slider that may leave its contact."""


HALF_POINTS = 512
CURVE_ROWS = 2 * HALF_POINTS + 1
TABLE_STEPS = 32
TABLE_ROWS = (2 * TABLE_STEPS + 1) * (TABLE_STEPS + 1)


def life_tables(pulse: Pulse) -> dict[str, dict[str, NDArray[np.float64]]]:
    """Return the group of columns that describes the area of any life of a pulse, by its name."""
    if pulse.offset == "none":
        return {"life_curve": life_curve(pulse.shape)}
    return {"life_table": life_table(pulse.shape)}


@cache
def life_table(shape: Shape) -> dict[str, NDArray[np.float64]]:
    """Return ``u``, ``offset_fraction`` and ``area_fraction`` so that A(s) = d^2 interp(u, |b|/d), within 1e-3 d^2.

    u is the distance since birth over half of the life, h = sqrt(d^2 - b^2), in [0, 2]; every value of |b|/d in [0, 1]
    follows for each u. Both go by t^2 (3 - 2t), so that points are close where the area is a power 3/2 and where it has
    its tip, at u = 1 and b = 0.
    """
    steps = [t * t * (3 * TABLE_STEPS - 2 * t) / TABLE_STEPS**3 for t in range(TABLE_STEPS + 1)]
    b, half = np.array(steps), np.array(steps)[:, None]
    apart = np.sqrt(b * b + (1.0 - b * b) * (1.0 - half) ** 2)  # of the centres, for unit diameter
    rising = PULSES[shape].overlap(apart)
    u = [*steps, *(2.0 - each for each in reversed(steps[:-1]))]
    return {
        "u": np.repeat(u, len(steps)),
        "offset_fraction": np.tile(steps, len(u)),
        "area_fraction": np.concatenate([rising, rising[-2::-1]]).ravel(),
    }


@cache
def life_curve(shape: Shape) -> dict[str, NDArray[np.float64]]:
    """Return ``u`` and ``area_fraction`` so that A(s) = d^2 interp(u), u = (s - birth)/d in [0, 2], within 1e-6 d^2.

    The pulse's own area over d^2 at u = (i/n)^2 and its mirror image: the squares put the points where the lens is a
    power 3/2 and leave a linear interpolation at most 0.15/n^2 off.
    """
    squares = [(i * i) / (HALF_POINTS * HALF_POINTS) for i in range(HALF_POINTS + 1)]
    rising = PULSES[shape].overlap(1.0 - np.array(squares))
    mirrored = [2.0 - u for u in reversed(squares[:-1])]
    return {"u": np.array(squares + mirrored), "area_fraction": np.concatenate([rising, rising[-2::-1]])}

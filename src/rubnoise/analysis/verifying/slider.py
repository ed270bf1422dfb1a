"""The slider of a run held against its force: every tick from the one before it."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.analysis.verifying.forces import force_moments
from rubnoise.analysis.verifying.motion import CellMotion, cell_motion
from rubnoise.analysis.verifying.reading import PANEL_ROWS, Ahead, Window, panels
from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.record.reader import Rows

SHARE: Final = 5e-10
"""Of the largest displacement or velocity: what a tick may be away from where the one before it leads."""

STILL: Final = 2.0**-44
"""Of the fastest rate times the largest displacement: velocities that are rounding alone, where the force is steady."""

PLACES: Final = 2.0
"""Roundings of a place: a force F that comes or goes so much earlier moves the velocity by F/(m V) times that."""

LONG: Final = 8.0
"""Mean lives of the longest lives: those born so long before the run have places as far out as its own."""


def slider_checks(model: Model, rows: Rows, cells: int) -> list[Check]:
    """Return whether /slider tells its times and the forces of /trace at its places, and moves as they make it move.

    Row i of a one-way slider lies at the time i tick / V, when it has slid by i ticks.

    ``cells`` is into how many equal parts a tick is divided, in each of which the force is known by three moments.
    """
    return [_columns_check(model, rows), _motion_check(model, rows, cells)]


def _columns_check(model: Model, rows: Rows) -> Check:
    notes = Notes("slider_columns")
    for panel in panels(rows, "slider"):
        distance = np.arange(panel.first, panel.end, dtype=np.float64) * model.tick
        notes.equal("/slider/distance", panel.first, panel["distance"], distance)
        notes.equal("/slider/time", panel.first, panel["time"], distance / (model.sliding_speed or 1.0))
        notes.equal("/slider/friction_force", panel.first, panel["friction_force"], _force_at(distance, model, rows))
    return notes.check()


def _force_at(distance: Doubles, model: Model, rows: Rows) -> NDArray[Any]:
    """Return the force of /trace at distances in um one tick apart."""
    first = round(float(distance[0]) / model.tick) if distance.size else 0
    return rows.column("trace", "friction_force", first, first + distance.size)


def _motion_check(model: Model, rows: Rows, cells: int) -> Check:
    notes, ahead = Notes("motion"), Ahead(rows)
    for name, begin in (("displacement", model.equilibrium_displacement), ("velocity", 0.0)):
        notes.equal(f"/slider/{name}", 0, rows.column("slider", name, 0, 1), begin)
    motion, largest = _motion(model, cells), {name: _largest(rows, name) for name in ("displacement", "velocity")}
    for first, end, moments in _moments(model, rows, cells):
        before = (ahead.column("slider", name, first - 1, end - 1) for name in largest)
        with np.errstate(invalid="ignore", over="ignore"):
            led = motion.through(moments, *before)
            allowed = _allowed(model, motion, largest, np.arange(first, end, dtype=np.float64) * model.tick)
        for name, expected, limit in zip(largest, led, allowed, strict=True):
            notes.near(f"/slider/{name}", first, ahead.column("slider", name, first, end), expected, limit)
    return notes.check()


def _allowed(
    model: Model, motion: CellMotion, largest: dict[str, float], distance: Doubles
) -> tuple[float, float | Doubles]:
    """Return what displacement (um) and velocity (um/s) may be away at ticks from where those before them lead."""
    if model.slider is None or model.sliding_speed is None:
        return 0.0, 0.0
    moved, fast = largest["displacement"], largest["velocity"]
    pushed = model.slider.natural_angular_frequency**2 * moved / model.sliding_speed
    place = np.spacing(distance + LONG * model.mean_life_distance)
    return SHARE * moved, SHARE * fast + STILL * motion.fastest * moved + PLACES * place * pushed


def _motion(model: Model, cells: int) -> CellMotion:
    if model.slider is None or model.sliding_speed is None:
        raise ValueError("a model without a slider has no motion")
    return cell_motion(model.slider, model.sliding_speed, model.tick / cells)


def _moments(model: Model, rows: Rows, cells: int) -> Iterator[tuple[int, int, Doubles]]:
    """Yield first and last ticks with the moments (3, ticks, cells) of the force in the cells that end with them."""
    window, total, size = Window(rows), rows.rows("slider"), max(PANEL_ROWS // cells, 1)
    width = model.tick / cells
    for first in range(1, total, size):
        end = min(first + size, total)
        edges = np.arange((first - 1) * cells, (end - 1) * cells + 1).astype(np.float64) * width
        moments = np.zeros((3, edges.size - 1))
        for each in window.until(float(edges[-1])):
            shapes = (each.birth, each.diameter, each.death, each.strength)
            moments += force_moments(model.pulse, edges, width, shapes)
        yield first, end, moments.reshape(3, end - first, cells)


def _largest(rows: Rows, name: str) -> float:
    """Return the largest modulus of a column's finite numbers."""
    found = 0.0
    for panel in panels(rows, "slider"):
        finite = panel[name][np.isfinite(panel[name])]
        found = max(found, float(np.abs(finite).max(initial=0.0)))
    return found

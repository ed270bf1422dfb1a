"""Where a run has its largest: its largest junction, its largest force, its longest stick, its hardest impact."""

from typing import Any, Final

import numpy as np

from rubnoise.analysis.stick_slip import StickSlip
from rubnoise.record.reader import Reader, chunks
from rubnoise.record.rows import ContactKind

FORCES: Final = ("friction_force", "real_contact_area")
"""What is largest: the force on the contact, or the area of one whose strength is not known."""


def extremes(file: Reader, tick: float) -> dict[str, Any]:
    """Return the extremes of a whole run, read in chunks; of equal ones the first.

    ``junction``: the row of the largest diameter; ``force``: the column of /trace, its value, and the distance in um of
    that tick; ``stick``, of a slider that sticks: begin and end in s, and the distance in um at which it stands;
    ``impact``, of one that leaves the surface: time in s, distance in um and speed in um/s.
    """
    leaves = "encounter" in file.columns["junctions"]
    name = next(each for each in FORCES if each in file.columns["trace"])
    row, value = _largest(file, "trace", name)
    return {
        "junction": _largest(file, "junctions", "diameter")[0] if file.rows("junctions") else None,
        "force": {"name": name, "distance": row * tick, "value": value},
        "stick": _longest_stick(file) if "landmarks" in file.columns and not leaves else None,
        "impact": _hardest_impact(file) if leaves else None,
    }


def _largest(file: Reader, group: str, name: str) -> tuple[int, float]:
    best, where = -np.inf, 0
    for chunk in chunks(file, group):
        row = int(np.argmax(chunk[name]))
        if chunk[name][row] > best:
            best, where = float(chunk[name][row]), chunk.first + row
    return where, best


def _hardest_impact(file: Reader) -> dict[str, float] | None:
    best: dict[str, float] | None = None
    for chunk in chunks(file, "landmarks"):
        speed = np.where(chunk["kind"] == ContactKind.CONTACT_MADE, chunk["impact_speed"], -np.inf)
        row = int(np.argmax(speed))
        if speed[row] > (-np.inf if best is None else best["speed"]):
            best = {name: float(chunk[name][row]) for name in ("time", "distance")} | {"speed": float(speed[row])}
    return best


def _longest_stick(file: Reader) -> dict[str, float] | None:
    rows = file.rows("slider")
    end = float(file.column("slider", "time", rows - 1, rows)[0])
    sticks = StickSlip.of(file, 0.0, end)
    if not sticks.stick_begin.size:
        return None
    longest = int(np.argmax(sticks.stick_end - sticks.stick_begin))
    begin, end = float(sticks.stick_begin[longest]), float(sticks.stick_end[longest])
    row = min(round(0.5 * (begin + end) * (rows - 1) / file.column("slider", "time", rows - 1, rows)[0]), rows - 1)
    return {"begin": begin, "end": end, "distance": float(file.column("slider", "distance", row, row + 1)[0])}

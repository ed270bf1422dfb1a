"""The junctions of a run, as the page of lessons replays them."""

from base64 import b64encode
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.api.column_group import Columns
from rubnoise.api.result import Run
from rubnoise.record.rows import JunctionState

MOST_ROWS: Final = 50_000
"""Junctions that go into a page: two megabytes with their strengths."""


def record_of(run: Run) -> dict[str, Any]:
    """Return the junctions of a run as base64 of little-endian doubles, its tick, and their end in um.

    A longer run is cut where the first junction is born that does not fit; ``note`` says so in words.
    """
    junctions = run.groups()["junctions"]
    rows = min(len(junctions), MOST_ROWS)
    whole = float(run.scenario.sliding.distance)
    distance = whole if rows == len(junctions) else float(junctions["birth_distance"][rows])
    record = {
        "birth": _text(junctions["birth_distance"][:rows]),
        "diameter": _text(junctions["diameter"][:rows]),
        "tick": float(run.scenario.output.tick),
        "distance": distance,
        "note": _note(run, rows, distance, whole),
    }
    for name, column in {"strength": "shear_strength", "offset": "lateral_offset"}.items():
        if column in junctions:
            record[name] = _text(junctions[column][:rows])
    return record | _early_deaths(junctions, rows)


def _early_deaths(junctions: Columns, rows: int) -> dict[str, str]:
    """Return where junctions ended, for a run in which an intervention ended some."""
    if not np.any(junctions["state"][:rows] & JunctionState.ENDED_EARLY):
        return {}
    return {"death": _text(junctions["death_distance"][:rows])}


def _note(run: Run, rows: int, distance: float, whole: float) -> str:
    sentence = f"This is {run.path.name}, seed {run.scenario.run.seed}: its junctions, row by row."
    if distance < whole:
        sentence += f" Of {whole:g} um the page holds the first {distance:g}, {rows} junctions."
    return f"{sentence} A control of the contact leaves it for a run of the page's own; reset brings it back."


def _text(values: NDArray[np.float64]) -> str:
    return b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode("ascii")

"""What a file says of its origin, held against its scenario: seed, diameter, rows, columns, constants of the slider."""

import json
from typing import Any, Final

import numpy as np

from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.analysis.verifying.motion import cell_motion
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.record.reader import HashedReader, Reader
from rubnoise.scenario import Scenario
from rubnoise.storage.layout import features_of, stored_columns, stored_groups
from rubnoise.streams import STREAM_VERSION

CONSTANTS: Final = "/provenance propagator_constants"
CELLS: Final = tuple(2.0**n for n in range(13))
"""Into how many equal parts the slider's step may divide a tick."""

_CLOSE: Final = 2.0**-40
"""Of its scale: how far a constant may be from what another derivation gives. Gains have that of the largest."""

_ROUNDED: Final = 2.0**-8
"""Scale of what is left of a 1 when 1 is taken away."""


def layout_check(model: Model, run: HashedReader) -> Check:
    """Return whether a file has the groups, columns and ticks that a run of its scenario has."""
    notes, features = Notes("layout"), features_of(model)
    for group in stored_groups(features):
        expected = tuple(column.name for column in stored_columns(group, features))
        notes.say(f"/{group.name}", found=tuple(run.columns.get(group.name, ())), expected=expected)
    notes.say("/trace rows", found=run.rows("trace"), expected=model.tick_count + 1)
    if model.slider_rows and "slider" in run.columns:
        notes.say("/slider rows", found=run.rows("slider"), expected=model.slider_rows)
    return notes.check()


def origin_check(scenario: Scenario, run: Reader) -> Check:
    """Return whether seed, calibrated diameter and constants of the slider are those of the scenario in the file."""
    notes, origin, model = Notes("origin"), run.provenance, scenario.model()
    diameter = origin["calibrated_diameter"]
    notes.say("/provenance seed", found=origin["seed"], expected=scenario.run.seed)
    notes.say("/provenance calibrated_diameter", found=diameter, expected=model.calibrated_diameter)
    told = stored_constants(run)
    expected = _constants(model, cells_per_tick(run))
    notes.say(CONSTANTS, found=sorted(told), expected=sorted(expected))
    for name in sorted(expected.keys() & told.keys()):
        value, allowed = expected[name]
        right = abs(told[name] - value) <= allowed
        notes.say(f"{CONSTANTS} {name}", found=told[name], expected=told[name] if right else value)
    return notes.check()


def need_same_streams(run: Reader) -> None:
    """Raise Refused for a file whose seed stands for other numbers than it does here."""
    version = run.provenance["stream_version"]
    if version != STREAM_VERSION:
        raise Refused(
            f"has random streams of version {version}, which can't be drawn again: this rubnoise draws version"
            f" {STREAM_VERSION}, and {run.attributes['source']} wrote the file; leave --regenerate away"
        )


def stored_constants(run: Reader) -> dict[str, float]:
    """Return the constants of the slider's step that a file tells, by name; none where it tells something else."""
    try:
        told: Any = json.loads(str(run.provenance["propagator_constants"]))
        return {str(name): float(value) for name, value in told.items()}
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
        return {}


def cells_per_tick(run: Reader) -> int:
    """Return into how many cells the slider's step divides a tick, as the file says; 1 where it says nothing of use."""
    cells = stored_constants(run).get("cells_per_tick", 1.0)
    return int(cells) if cells in CELLS else 1


def _constants(model: Model, cells: int) -> dict[str, tuple[float, float]]:
    """Return every constant by name with what it may be off by; none without a slider."""
    if model.slider is None or model.sliding_speed is None or model.is_two_way:
        return {}
    found = {"cells_per_tick": (float(cells), 0.0)}
    for name, (matrix, scale) in _matrices(model.slider, model.sliding_speed, model.tick / cells).items():
        for (row, column), value in np.ndenumerate(matrix):
            found[f"{name}_{row}{column}"] = (float(value), _CLOSE * float(scale[row, column]))
    return found


def _matrices(slider: Slider, speed: float, width: float) -> dict[str, tuple[Any, Any]]:
    """Return the free motion over a cell less the identity, and the gains of moments, each with its scale."""
    motion = cell_motion(slider, speed, width)
    transition = motion.free - np.eye(2)
    largest = np.abs(motion.gains).max(axis=1, keepdims=True)
    return {
        "transition": (transition, np.maximum(np.abs(transition), _ROUNDED * np.eye(2))),
        "gain": (motion.gains, np.broadcast_to(largest, motion.gains.shape)),
    }

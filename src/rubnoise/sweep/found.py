"""Results that are there without anybody having written down that they are."""

import json
from pathlib import Path
from typing import Any

from rubnoise.errors import RunFileRefused
from rubnoise.scenario.points import Point
from rubnoise.storage.reader import open_run
from rubnoise.streams import STREAM_VERSION
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.rows import Row


def found_run(point: Point, *, root: Path) -> Row | None:
    """Return the row of a run whose finished result lies where it belongs, or None.

    All of it is read, and compared with its hashes: a power cut may have come before the disk had it.
    It is that of the point where its scenario, seed and stream version are; title and engine have no part in that.
    """
    folder = SweepFolder(root)
    path = folder.run(point.run_id)
    if not path.exists():
        return None
    try:
        with open_run(path) as file:
            origin, summary, damaged = file.provenance, file.summary, file.damaged()
    except RunFileRefused:
        return None
    if damaged or not summary or not origin["finished"] or origin["stream_version"] != STREAM_VERSION:
        return None
    if _told(json.loads(str(origin["scenario_resolved"]))) != _told(point.scenario.resolved()):
        return None
    figures = {name: float(value) for name, value in summary.items() if isinstance(value, int | float)}
    return Row(run_id=point.run_id, file=folder.relative(point.run_id), figures=figures)


def _told(resolved: dict[str, Any]) -> dict[str, Any]:
    """Return a scenario as far as it counts for the bits of its run."""
    run = {key: value for key, value in resolved["run"].items() if key != "engine"}
    return {key: value for key, value in resolved.items() if key != "title"} | {"run": run}

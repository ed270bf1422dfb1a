"""Results that are there without anybody having written down that they are."""

import json
from pathlib import Path
from typing import Any, Literal

from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import HashedReader
from rubnoise.scenario.points import Point
from rubnoise.storage.reader import open_run
from rubnoise.storage.seal import INTERVENTION
from rubnoise.storage.together import clear_unsettled, is_of_torn
from rubnoise.streams import STREAM_VERSION
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.rows import Row

Kind = Literal["whole", "torn", "other"]


def found_run(point: Point, *, root: Path, begun: bool = False) -> Row | None:
    """Return the row of a run whose finished result lies where it belongs, or None.

    It is that of the point where its scenario, seed and stream version are; title and engine have no part in that. All
    of it is read, and compared with its hashes: a power cut may have come before the disk had it. Of a run that was
    ``begun`` here, what is torn, and parts of which nothing can be made, are removed.
    """
    folder = SweepFolder(root)
    path = folder.run(point.run_id)
    row, kind = _found(point, folder, begun=begun) if path.exists() else (None, None)
    if begun:
        clear_unsettled(path, kind)
    return row


def _found(point: Point, folder: SweepFolder, *, begun: bool) -> tuple[Row | None, Kind]:
    try:
        with open_run(folder.run(point.run_id)) as file:
            kind, summary = _kind(point, file, begun=begun), file.summary
    except RunFileRefused as refusal:
        return None, "torn" if is_of_torn(refusal) else "other"
    if kind != "whole":
        return None, kind
    figures = {name: float(value) for name, value in summary.items() if isinstance(value, int | float)}
    return Row(run_id=point.run_id, file=folder.relative(point.run_id), figures=figures), kind


def _kind(point: Point, file: HashedReader, *, begun: bool) -> Kind:
    origin = file.provenance
    if origin["stream_version"] != STREAM_VERSION or not _is_same(str(origin["scenario_resolved"]), point):
        return "other"
    if INTERVENTION in origin:  # lives that somebody ended are no sample of the scenario
        return "other"
    # HDF5 has checksums of what is shorter than a page, and columns have hashes; a longer text has neither.
    lost = begun and origin["scenario_toml"] != point.scenario.text
    return "torn" if lost or not origin["finished"] or not file.summary or file.damaged() else "whole"


def _is_same(resolved: str, point: Point) -> bool:
    try:
        return _told(json.loads(resolved)) == _told(point.scenario.resolved())
    except (ValueError, TypeError, KeyError):
        return False


def _told(resolved: dict[str, Any]) -> dict[str, Any]:
    """Return a scenario as far as it counts for the bits of its run."""
    run = {key: value for key, value in resolved["run"].items() if key != "engine"}
    return {key: value for key, value in resolved.items() if key != "title"} | {"run": run}

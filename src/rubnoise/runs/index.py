"""The index of a sweep, made from the figures of its runs; and these figures, taken from an index that is not stale."""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.run_summary import CURVES
from rubnoise.errors import RunFileRefused
from rubnoise.figure_names import FIGURE_NAMES
from rubnoise.runs.folder import INDEX
from rubnoise.runs.point_file import RunFigures, file_of
from rubnoise.scenario.document import SECTIONS
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.points import Point
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.sweep import Sweep
from rubnoise.storage.index import RUNS, SUMMARIES, Filled, Index, IndexFile, open_index
from rubnoise.storage.index_checks import check_index
from rubnoise.storage.schema import Dataset
from rubnoise.units import RATIO, Quantity

PLANNED: Final = "planned"
DONE: Final = "done"
FAILED: Final = "failed"
LONGEST_REASON: Final = 500


def index_of(
    sweep: Sweep, points: Sequence[Point], found: Mapping[str, RunFigures], failed: Mapping[str, str], command: str
) -> Index:
    """Return the index of a sweep: runs that were ``found``, that ``failed`` for a reason, and that are planned."""
    of_values: dict[tuple[Any, ...], int] = {}
    numbers = [of_values.setdefault(tuple(point.values.values()), len(of_values)) for point in points]
    firsts = dict(zip(reversed(numbers), reversed(points), strict=True))
    of_points = [firsts[number] for number in range(len(firsts))]
    runs = [found.get(point.run_id) for point in points]
    of_point: list[Mapping[str, NDArray[Any]]] = [{}] * len(of_points)
    for number, run in zip(numbers, runs, strict=True):
        if run is not None and run.of_point:
            of_point[number] = run.of_point
    return Index(
        title=sweep.title,
        command=command,
        scenario_toml=sweep.text,
        scenario_resolved=of_points[0].scenario.resolved(),
        grid=tuple(key for key in sweep.keys if key not in sweep.side_by_side),
        side_by_side=sweep.side_by_side,
        points=list(_points(sweep, of_points)),
        runs=[*_plan(sweep, points, of_points, numbers), *_progress(sweep, points, runs, failed)],
        arrays_of_runs=_stacked([run.curves if run is not None else {} for run in runs]),
        arrays_of_points=_stacked(of_point),
    )


def text(name: str, meaning: str, texts: Sequence[str]) -> Filled:
    """Return texts as bytes of one length, at least two, since h5netcdf does not decode single bytes."""
    raw = [each.encode("utf-8", "backslashreplace") for each in texts]
    about = Dataset(name=name, units="", long_name=meaning, symbol="", dtype=f"|S{max(2, *map(len, [b'', *raw]))}")
    return Filled(about=about, values=np.array(raw, about.dtype))


def whole(name: str, meaning: str, numbers: Sequence[int]) -> Filled:
    """Return whole numbers."""
    about = Dataset(name=name, units="1", long_name=meaning, symbol="", dtype="<i8")
    return Filled(about=about, values=np.array(numbers, dtype=np.int64))


def figure(name: str, values: NDArray[np.float64]) -> Filled:
    """Return a column for a figure of /summary; its unit is that of the figure whose name its own begins with."""
    about = Dataset(name=name, units=_unit(name), long_name=name.replace("_", " "), symbol="")
    return Filled(about=about, values=values)


@lru_cache(maxsize=1024)
def _unit(name: str) -> str:
    return next((known.unit for figure, known in FIGURE_NAMES.items() if name.startswith(figure)), "") or "1"


def swept(key: str, scenarios: Sequence[Scenario]) -> Filled:
    """Return the values of a key as numbers in its working unit, or as texts if they are not numbers of one kind."""
    section, name = key.split(".")
    values = [getattr(getattr(scenario, section), name) for scenario in scenarios]
    meaning = keys_of(SECTIONS[section])[name].about
    units = {(value.kind.unit if isinstance(value, Quantity) and value.kind != RATIO else "1") for value in values}
    if len(units) == 1 and all(isinstance(value, int | float) for value in values):
        about = Dataset(name=key, units=units.pop(), long_name=meaning, symbol="")
        return Filled(about=about, values=np.array(values, dtype=np.float64))
    return text(key, meaning, [value.as_text() if isinstance(value, Quantity) else str(value) for value in values])


def _points(sweep: Sweep, points: Sequence[Point]) -> Iterator[Filled]:
    yield text("values", "swept values as written, as JSON", [json.dumps(dict(point.values)) for point in points])
    for key in sweep.keys:
        yield swept(key, [point.scenario for point in points])


def _plan(sweep: Sweep, points: Sequence[Point], of_points: Sequence[Point], numbers: list[int]) -> Iterator[Filled]:
    """Yield the columns that are known before any run: names, points, swept values, seeds."""
    yield text("run_id", "name of the run", [point.run_id for point in points])
    yield whole("point", "number of the point", numbers)
    yield whole("replicate", "number of the replicate", [point.replicate for point in points])
    for key in sweep.keys:
        by_point = swept(key, [point.scenario for point in of_points])
        yield Filled(about=by_point.about, values=by_point.values[numbers])
    yield whole("seed", "seed of the random streams", [point.seed for point in points])


def state_of(run_id: str, found: Mapping[str, Any], failed: Mapping[str, str]) -> str:
    """Return whether a run is done, failed or planned."""
    return DONE if run_id in found else FAILED if run_id in failed else PLANNED


def _progress(
    sweep: Sweep, points: Sequence[Point], runs: Sequence[RunFigures | None], failed: Mapping[str, str]
) -> Iterator[Filled]:
    done = {point.run_id: run for point, run in zip(points, runs, strict=True) if run is not None}
    files = [file_of(Path(), p.run_id, sweep.keep).as_posix() if p.run_id in done else "" for p in points]
    kept = sweep.keep == "runs"
    yield text("file", "result of the run, seen from this folder", files if kept else [""] * len(files))
    yield text("state", "planned, done or failed", [state_of(point.run_id, done, failed) for point in points])
    reasons = ["" if point.run_id in done else failed.get(point.run_id, "") for point in points]
    yield text("reason", "why it failed", [reason[:LONGEST_REASON] for reason in reasons])
    columns: dict[str, NDArray[np.float64]] = {}
    for row, run in enumerate(runs):
        for name, value in zip(run.names, run.values, strict=True) if run is not None else ():
            if name not in columns:
                columns[name] = np.full(len(points), np.nan)
            columns[name][row] = value
    for name, values in columns.items():
        yield figure(name, values)


def _stacked(arrays: Sequence[Mapping[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Return arrays of each name as one, a row for each; rows without it are nan or 0."""
    found: dict[str, NDArray[Any]] = {}
    for row, each in enumerate(arrays):
        for name, values in each.items():
            if name not in found:
                missing = np.nan if np.issubdtype(values.dtype, np.floating) else 0
                found[name] = np.full((len(arrays), *values.shape), missing, values.dtype)
            found[name][row] = values
    return found


def known_runs(root: Path, sweep: Sweep) -> tuple[dict[str, RunFigures], dict[str, str], int]:
    """Return what the index of a folder knows: runs whose files are older than it, failures, and replicates of points.

    Nothing if there is no index, or a damaged one: everything is then read from the files.
    """
    found: dict[str, RunFigures] = {}
    try:
        written = (root / INDEX).stat().st_mtime_ns
        with open_index(root / INDEX) as index:
            check_index(index)
            if not index.is_as_written():
                return {}, {}, 0
            for run_id, figures in figures_in(index, sweep.keep):
                with suppress(OSError):
                    about = file_of(root, run_id, sweep.keep).stat()
                    if max(about.st_mtime_ns, about.st_ctime_ns) <= written:
                        found[run_id] = figures
            columns = [index.read(RUNS, name).tolist() for name in ("run_id", "state", "reason")]
            failed = {name: reason for name, state, reason in zip(*columns, strict=True) if state == FAILED}
            return found, failed, 1 + int(index.read(RUNS, "replicate").max(initial=-1))
    except (OSError, RunFileRefused):
        return {}, {}, 0


def figures_in(index: IndexFile, keep: str) -> Iterator[tuple[str, RunFigures]]:
    """Yield the names of runs that an index calls done, with their figures, and curves of runs that keep no more."""
    keys = {*json.loads(index.attributes["grid"]), *json.loads(index.attributes["side_by_side"])}
    names = [about.name for about in index.columns(RUNS) if about.name not in {*_OWN, *keys}]
    figures = np.array([index.raw(RUNS, name) for name in names]).T
    points, files = index.read(RUNS, "point"), index.read(RUNS, "file")
    arrays = {about.name: index.read(SUMMARIES, about.name) for about in index.columns(SUMMARIES)}
    for row in np.flatnonzero(index.read(RUNS, "state") == DONE).tolist():
        if bool(files[row]) != (keep == "runs"):
            continue
        yield (
            str(index.read(RUNS, "run_id", row, row + 1)[0]),
            RunFigures(
                names=tuple(names),
                values=figures[row],
                curves={name: values[row] for name, values in arrays.items() if name in CURVES},
                of_point={name: values[points[row]] for name, values in arrays.items() if name not in CURVES},
            ),
        )


_OWN: Final = frozenset(("run", "run_id", "point", "replicate", "seed", "file", "state", "reason"))

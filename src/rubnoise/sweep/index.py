"""Make the index of a sweep from its file and its journals, and refresh it while runs are made."""

import json
import time
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import OutputRefused
from rubnoise.figure_names import FIGURE_NAMES
from rubnoise.scenario.document import SECTIONS
from rubnoise.scenario.points import Point
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.section import keys_of
from rubnoise.scenario.sweep import Sweep
from rubnoise.storage.index import POINTS, RUNS, Arrays, Filled, Index, Stack, write_index
from rubnoise.storage.index_file import open_index
from rubnoise.storage.layout import features_of
from rubnoise.storage.merged_sweep import write_merged
from rubnoise.storage.output import whole_file
from rubnoise.storage.schema import Dataset
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.journal import RunRow
from rubnoise.sweep.run_status import DONE, RecordedRuns, RunStatus
from rubnoise.sweep.stopping_rule import AdaptiveReplicates
from rubnoise.units import RATIO, Quantity


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
    return Filled(
        about=Dataset(name=name, units=_unit(name), long_name=name.replace("_", " "), symbol=""), values=values
    )


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


LONGEST_REASON = 500


def renew_index(folder: SweepFolder, sweep: Sweep, points: Sequence[Point], command: str) -> RecordedRuns:
    """Write the index of a sweep over an older one; raises OutputRefused if another process is writing it."""
    with whole_file(folder.index, force=True) as path:
        known = RecordedRuns.of(folder, points)
        write_index(path, index_of(folder, sweep, points, known, command))
    return known


def index_of(folder: SweepFolder, sweep: Sweep, points: Sequence[Point], known: RecordedRuns, command: str) -> Index:
    """Return the index of a sweep from its present status."""
    of_values: dict[tuple[Any, ...], int] = {}
    numbers = [of_values.setdefault(tuple(point.values.values()), len(of_values)) for point in points]
    firsts = dict(zip(reversed(numbers), reversed(points), strict=True))
    shapes: Shapes = {}
    of_points = [firsts[number] for number in range(len(firsts))]
    of_runs = ((place, row.arrays) for place, row in _rows(folder, known) if row.arrays)
    of_each_point = ((numbers[place], row.of_point) for place, row in _rows(folder, known) if row.of_point)
    return Index(
        title=sweep.title,
        command=command,
        scenario_toml=sweep.text,
        scenario_resolved=of_points[0].scenario.resolved(),
        grid=tuple(key for key in sweep.keys if key not in sweep.side_by_side),
        side_by_side=sweep.side_by_side,
        points=list(_points(sweep, of_points)),
        runs=[*_plan(sweep, points, of_points, numbers), *_progress(known)],
        stacks=list(_stacks(points, known)),
        arrays_of_runs=_alike(RUNS, of_runs, shapes, folder),
        arrays_of_points=_alike(POINTS, of_each_point, shapes, folder),
    )


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


def _progress(known: RecordedRuns) -> Iterator[Filled]:
    yield text("file", "result of the run, seen from this folder", known.files)
    yield text("state", "planned, done or failed", known.states)
    yield text("reason", "why it failed", [reason[:LONGEST_REASON] for reason in known.reasons])
    for name, values in known.figures.items():
        yield figure(name, values)


def _stacks(points: Sequence[Point], known: RecordedRuns) -> Iterator[Stack]:
    """Yield stacks of finished runs with equal ticks and columns, in the order of the first run of each."""
    alike: dict[tuple[Any, ...], list[int]] = {}
    for row, (point, file, state) in enumerate(zip(points, known.files, known.states, strict=True)):
        if file and state == DONE:
            model = point.scenario.model()
            kind = (model.tick_count, model.tick, features_of(model), model.sliding_speed, model.slider_rows)
            alike.setdefault(kind, []).append(row)
    for (tick_count, _, features, _, slider), rows in alike.items():
        files = [known.files[row] for row in rows]
        yield Stack(rows=rows, files=files, features=features, ticks=tick_count + 1, slider=slider)


def _rows(folder: SweepFolder, known: RecordedRuns) -> Iterator[tuple[int, RunRow]]:
    """Yield the rows of the journals one by one, each with its place; nothing if no run has arrays."""
    for entry in folder.entries() if known.arrays else ():
        if entry.row is not None and entry.run_id in known.places:
            yield known.places[entry.run_id], entry.row


Shapes = dict[str, tuple[str, tuple[int, ...]]]
"""Shapes of arrays by name, each with the kind of row (point or run) that has them."""


def _alike(of: str, arrays: Arrays, shapes: Shapes, folder: SweepFolder) -> Arrays:
    """Yield arrays as they come; raises OutputRefused if one differs in shape or type from earlier ones of its name."""
    for row, found in arrays:
        for name, values in found.items():
            if shapes.setdefault(name, (of, values.shape)) != (of, values.shape):
                raise OutputRefused(
                    f"{folder.root / 'journal'}: damaged: {name} is of several shapes; move this folder away, and the"
                    " same command makes its runs again"
                )
        yield row, found


EVERY: Final = 5.0
"""Least seconds between two indices."""

SHARE: Final = 0.02
"""Largest share of a sweep's time for its index, the last one not counted."""


class IndexRefresh:
    """The index of a whole sweep, rewritten from time to time; a shard writes it only at its end."""

    def __init__(
        self, folder: SweepFolder, sweep: Sweep, adaptive: AdaptiveReplicates, command: str, *, alone: bool
    ) -> None:
        """Start before the first index."""
        self._folder = folder
        self._sweep = sweep
        self._command = command
        self._alone = alone
        self._adaptive = adaptive
        self._due = time.monotonic() + EVERY

    def if_due(self) -> None:
        """Write the index if the last one is old enough."""
        if self._alone and time.monotonic() >= self._due:
            began = time.monotonic()
            self.now()
            self._due = time.monotonic() + max(EVERY, (time.monotonic() - began) / SHARE)

    def now(self) -> tuple[Sequence[Point], RecordedRuns]:
        """Write the index, and return its runs with their status; wait for another shard that is writing it."""
        with self._folder.alone_at("index"):
            points = self._points()
            return points, renew_index(self._folder, self._sweep, points, self._command)

    def _points(self) -> Sequence[Point]:
        if self._sweep.precision is not None:
            self._adaptive(RunStatus.of(self._folder, self._sweep.precision).ended)
        return self._adaptive.points


def merge(folder: SweepFolder) -> Path:
    """Write the index of a folder and every result of it, by value, into merged.h5, and return its path.

    An older file is replaced. The call waits for another process that merges or writes the index. Raises RunFileRefused
    if there is no index or a result cannot be read, RubnoiseError if the disk fails.
    """
    with folder.alone_at("index"), open_index(folder.index), whole_file(folder.merged, force=True) as path:
        write_merged(path, folder.index)
    return folder.merged

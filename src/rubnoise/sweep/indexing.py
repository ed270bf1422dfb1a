"""The index of a sweep made from its file and from what is known of its runs."""

import json
from collections.abc import Iterator, Sequence
from typing import Any

from rubnoise.scenario.points import Point
from rubnoise.scenario.sweep import Sweep
from rubnoise.storage.index import Arrays, Filled, Index, Stack, write_index
from rubnoise.storage.layout import features_of
from rubnoise.storage.whole import whole_file
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.known import DONE, Known
from rubnoise.sweep.table import figure, swept, text, whole

LONGEST_REASON = 500


def renew_index(folder: SweepFolder, sweep: Sweep, points: Sequence[Point], command: str) -> Known:
    """Write the index of a sweep anew, in place of an older one; raises OutputRefused while another process does."""
    with whole_file(folder.index, force=True) as path:
        known = Known.of(folder, points)
        write_index(path, index_of(folder, sweep, points, known, command))
    return known


def index_of(folder: SweepFolder, sweep: Sweep, points: Sequence[Point], known: Known, command: str) -> Index:
    """Return the index of what is known of a sweep."""
    numbers = point_numbers(points)
    firsts = dict(zip(reversed(numbers), reversed(points), strict=True))
    of_points = [firsts[number] for number in range(len(firsts))]
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
        arrays_of_runs=_arrays_of_runs(folder, known),
        arrays_of_points=_arrays_of_points(folder, known, numbers),
    )


def point_numbers(points: Sequence[Point]) -> list[int]:
    """Return for every run the number of its point, counted in the order in which they come."""
    numbers: dict[tuple[Any, ...], int] = {}
    return [numbers.setdefault(tuple(point.values.values()), len(numbers)) for point in points]


def _points(sweep: Sweep, points: Sequence[Point]) -> Iterator[Filled]:
    yield text("values", "swept values as written, as JSON", [json.dumps(dict(point.values)) for point in points])
    for key in sweep.keys:
        yield swept(key, [point.scenario for point in points])


def _plan(sweep: Sweep, points: Sequence[Point], of_points: Sequence[Point], numbers: list[int]) -> Iterator[Filled]:
    """Yield what is settled before anything runs: names, points, swept values, seeds."""
    yield text("run_id", "name of the run", [point.run_id for point in points])
    yield whole("point", "number of the point", numbers)
    yield whole("replicate", "number of the replicate", [point.replicate for point in points])
    for key in sweep.keys:
        by_point = swept(key, [point.scenario for point in of_points])
        yield Filled(about=by_point.about, values=by_point.values[numbers])
    yield whole("seed", "seed of the random streams", [point.seed for point in points])


def _progress(known: Known) -> Iterator[Filled]:
    yield text("file", "result of the run, seen from this folder", known.files)
    yield text("state", "planned, done or failed", known.states)
    yield text("reason", "why it failed", [reason[:LONGEST_REASON] for reason in known.reasons])
    for name, values in known.figures.items():
        yield figure(name, values)


def _stacks(points: Sequence[Point], known: Known) -> Iterator[Stack]:
    """Yield the runs that are done and alike in ticks and columns, in the order of the first of each."""
    alike: dict[tuple[Any, ...], list[int]] = {}
    for row, (point, file, state) in enumerate(zip(points, known.files, known.states, strict=True)):
        if file and state == DONE:
            model = point.scenario.model()
            kind = (model.tick_count, model.tick, features_of(model), model.sliding_speed, model.slider_rows)
            alike.setdefault(kind, []).append(row)
    for (tick_count, _, features, _, slider), rows in alike.items():
        files = [known.files[row] for row in rows]
        yield Stack(rows=rows, files=files, features=features, ticks=tick_count + 1, slider=slider)


def _arrays_of_runs(folder: SweepFolder, known: Known) -> Arrays:
    for entry in folder.entries() if known.arrays else ():
        if entry.row is not None and entry.row.arrays and entry.run_id in known.places:
            yield known.places[entry.run_id], entry.row.arrays


def _arrays_of_points(folder: SweepFolder, known: Known, numbers: Sequence[int]) -> Arrays:
    for entry in folder.entries() if known.arrays else ():
        if entry.row is not None and entry.row.of_point and entry.run_id in known.places:
            yield numbers[known.places[entry.run_id]], entry.row.of_point

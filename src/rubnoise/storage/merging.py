"""The index of a sweep with values in place of references, and the junctions of all of its runs.

What is read are files of ours in a folder of ours, which the index names; each is opened by the door for run files.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np
from numpy.typing import NDArray

from rubnoise.storage.index import RUN, RUNS, SUMMARIES, TRACES, attach, create_scale, describe_column
from rubnoise.storage.index_file import open_index
from rubnoise.storage.named_run import open_named
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.schema import CHUNK_ROWS, GROUPS, JUNCTIONS, Column
from rubnoise.storage.structure import LIBRARY_VERSIONS

COPIED: Final = ("points", RUNS, SUMMARIES)
_UNNUMBERED: Final = tuple(column for column in JUNCTIONS.columns if column.name != "junction")


def write_merged(path: Path, index: Path) -> None:
    """Write a file that needs no other: tables and traces as in the index, and /junctions with the run of each.

    Memory does not grow with the length of runs. Raises RunFileRefused where a result cannot be read, OSError where the
    disk fails.
    """
    results = _results(index)  # the door for strangers' files looks at the index before HDF5 has it in this process
    with h5py.File(index, "r") as given, h5py.File(path, "w", libver=LIBRARY_VERSIONS) as file:
        for name, value in given.attrs.items():
            file.attrs.create(name, value, dtype=given.attrs.get_id(name).dtype)
        for name in COPIED:
            if name in given:
                given.copy(name, file)
        for number in given.get(TRACES, ()):
            _write_stack(file, given[TRACES][number], number, results)
        _write_junctions(file, results)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Result:
    """A result that an index names: where it lies, its junctions, and the columns that it has of each."""

    path: Path
    junctions: int
    columns: frozenset[str]


def _results(index: Path) -> dict[int, _Result]:
    """Return the results that an index names, by row; raises RunFileRefused for one that is that of another run."""
    with open_index(index) as opened:
        named, done = opened.read(RUNS, "file"), opened.read(RUNS, "state") == "done"
        run_ids = opened.read(RUNS, "run_id")
    return {
        row: _result(index.parent / str(name), str(run_ids[row]))
        for row, name in enumerate(named)
        if name and done[row]
    }


def _result(path: Path, run_id: str) -> _Result:
    with open_named(path, run_id) as run:
        columns = frozenset(run.columns[JUNCTIONS.name])
        return _Result(path=path, junctions=run.extent.junctions, columns=columns)


def _write_stack(file: h5py.File, given: h5py.Group, number: str, results: dict[int, _Result]) -> None:
    for name, datasets in given.items():
        owner = file.create_group(f"{TRACES}/{number}/{name}", track_order=True)
        group = next(group for group in GROUPS if group.name == name)
        rows = datasets[RUN.name][:]
        about, *rest = (column for column in group.columns if column.name in datasets)
        runs = create_scale(owner, RUN, rows)
        with open_run(results[int(rows[0])].path) as first:
            ticks = create_scale(owner, about, first.column(name, about.name))
        filled = [_empty(owner, column, (rows.size, ticks.size)) for column in rest]
        for dataset in filled:
            attach(dataset, runs, ticks)
        for place, row in enumerate(rows):
            with open_run(results[int(row)].path) as run:
                _fill(filled, rest, run, name, place)


def _fill(datasets: Sequence[h5py.Dataset], columns: Sequence[Column], run: RunFile, group: str, place: int) -> None:
    for dataset, column in zip(datasets, columns, strict=True):
        for first, values in _panels(run, group, column.name):
            dataset[place, first : first + values.size] = values


def _write_junctions(file: h5py.File, results: dict[int, _Result]) -> None:
    """Write the junctions of all runs, one run after another, with the row of the run and the number within it."""
    total = sum(result.junctions for result in results.values())
    owner = file.create_group(JUNCTIONS.name, track_order=True)
    names = frozenset[str]().union(*(result.columns for result in results.values()))
    number = next(column for column in JUNCTIONS.columns if column.name == "junction")
    stored = [column for column in _UNNUMBERED if column.name in names]
    datasets = {column.name: _empty(owner, column, (total,)) for column in (RUN, number, *stored)}
    start = 0
    for row, result in results.items():
        with open_run(result.path) as run:
            stop = start + result.junctions
            datasets[RUN.name][start:stop] = row
            for column in (number, *stored):
                if column.name in result.columns:
                    for first, values in _panels(run, JUNCTIONS.name, column.name):
                        datasets[column.name][start + first : start + first + values.size] = values
            start = stop


def _panels(run: RunFile, group: str, name: str) -> Iterator[tuple[int, NDArray[Any]]]:
    for first in range(0, run.rows(group), CHUNK_ROWS):
        yield first, run.column(group, name, first, first + CHUNK_ROWS)


def _empty(owner: h5py.Group, about: Column, shape: tuple[int, ...]) -> h5py.Dataset:
    kind = np.dtype(about.dtype)
    missing = np.nan if kind.kind == "f" else 0
    return describe_column(owner.create_dataset(about.name, shape, kind, fillvalue=missing), about)

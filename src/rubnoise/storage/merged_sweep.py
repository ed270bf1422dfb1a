"""Write the index of a sweep with values in place of references, and the junctions of all of its runs.

It reads the results that the index names; each is opened as any run file is.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.arrays import slices
from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import chunks
from rubnoise.storage import disk
from rubnoise.storage.index import RUN, RUNS, SUMMARIES, TRACES, attach, create_scale, describe_column
from rubnoise.storage.index_file import open_index, open_named
from rubnoise.storage.pages import unfailing
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.schema import GROUPS, JUNCTIONS, Dataset, motion_of
from rubnoise.storage.structure import LIBRARY_VERSIONS

COPIED: Final = ("points", RUNS, SUMMARIES)


class _Filling:
    """Datasets filled in the order of their rows, with a hash of each, to be read back."""

    def __init__(self) -> None:
        self._hashes: dict[str, xxhash.xxh3_128] = {}

    def write(self, dataset: h5py.Dataset, values: NDArray[Any], first: int, row: int | None = None) -> None:
        """Write values from a place on; in row ``row`` if the dataset has several rows."""
        piece = slice(first, first + values.size)
        dataset[piece if row is None else (row, piece)] = values
        self._hashes.setdefault(dataset.name, xxhash.xxh3_128()).update(values.data)

    def note(self, dataset: h5py.Dataset) -> None:
        """Record the hash of a dataset of another file, with which `check` compares the one of this name."""
        self._hashes[dataset.name] = _hash(dataset)

    def check(self, path: Path) -> None:
        """Read all back, attributes too, whose checksums HDF5 compares; raises NotAsWritten if anything differs."""
        try:
            with h5py.File(path, "r", locking=False) as file:  # the part is locked by this process
                file.visititems(_read_attributes)
                for name, digest in self._hashes.items():
                    _check(name, _hash(file[name]).digest() == digest.digest())
        except (OSError, RuntimeError, LookupError, ValueError) as problem:
            raise disk.NotAsWritten("its structure") from problem


def _check(name: str, same: bool) -> None:  # noqa: FBT001
    if not same:
        raise disk.NotAsWritten(name)


def _read_attributes(_name: str, found: h5py.HLObject) -> None:
    for name in found.attrs:
        found.attrs.get_id(name)


def _hash(dataset: h5py.Dataset) -> xxhash.xxh3_128:
    """Return the hash of a dataset, read in chunks of its rows."""
    digest = xxhash.xxh3_128()
    if dataset.ndim == 1:
        places: Iterable[Any] = slices(0, dataset.size)
    elif dataset.ndim == 2:
        rows, columns = dataset.shape
        places = ((row, part) for row in range(rows) for part in slices(0, columns))
    else:
        places = range(len(dataset))
    for place in places:
        digest.update(dataset[place].tobytes())
    return digest


def write_merged(path: Path, index: Path) -> None:
    """Fill an empty file without references: tables and traces as in the index, and /junctions with their runs.

    Memory does not grow with the length of runs. Raises RunFileRefused if a result cannot be read or is damaged,
    OSError if the disk fails, NotAsWritten if what was written is not read back.
    """
    filling = _Filling()
    results = _results(index)  # the door for strangers' files looks at the index before HDF5 has it in this process
    with (
        h5py.File(index, "r") as given,
        unfailing(path) as target,
        h5py.File(target, "w", libver=LIBRARY_VERSIONS) as file,
    ):
        for name, value in given.attrs.items():
            file.attrs.create(name, value, dtype=given.attrs.get_id(name).dtype)
        for name in COPIED:
            if name in given:
                given.copy(name, file)
                for dataset in given[name].values():
                    filling.note(dataset)
        for number in given.get(TRACES, ()):
            _write_stack(file, given[TRACES][number], number, results, filling)
        _write_junctions(file, results, filling)
    filling.check(path)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Result:
    """A result that an index names: its path, its number of junctions, and their columns."""

    path: Path
    junctions: int
    columns: frozenset[str]


def _results(index: Path) -> dict[int, _Result]:
    """Return the results that an index names, by row; raises RunFileRefused if a file is the result of another run."""
    with open_index(index) as opened:
        named, done = opened.read(RUNS, "file"), opened.read(RUNS, "state") == "done"
        run_ids = opened.read(RUNS, "run_id")
    results = {}
    for row, (name, finished) in enumerate(zip(named, done, strict=True)):
        if not (name and finished):
            continue
        path = index.parent / str(name)
        with open_named(path, str(run_ids[row])) as run:
            columns = frozenset(run.columns[JUNCTIONS.name])
            results[row] = _Result(path=path, junctions=run.rows("junctions"), columns=columns)
    return results


def _write_stack(
    file: h5py.File, given: h5py.Group, number: str, results: dict[int, _Result], filling: _Filling
) -> None:
    for name, datasets in given.items():
        owner = file.create_group(f"{TRACES}/{number}/{name}", track_order=True)
        rows = datasets[RUN.name][:]
        features = motion_of(results[int(rows[0])].columns)
        group = next(group for group in GROUPS if group.name == name).as_in(features)
        about, *rest = (column for column in group.columns if column.name in datasets)
        runs = create_scale(owner, RUN, rows)
        with open_run(results[int(rows[0])].path) as one:
            ticks = create_scale(owner, about, one.column(name, about.name))
        filled = [_empty(owner, column, (rows.size, ticks.size)) for column in rest]
        for dataset in filled:
            attach(dataset, runs, ticks)
        for place, row in enumerate(rows):
            with open_run(results[int(row)].path) as run:
                for dataset, column in zip(filled, rest, strict=True):
                    for first, values in _panels(run, name, column.name):
                        filling.write(dataset, values, first, place)


def _write_junctions(file: h5py.File, results: dict[int, _Result], filling: _Filling) -> None:
    """Write the junctions of all runs, one run after another, with the row of the run and their number in it."""
    total = sum(result.junctions for result in results.values())
    owner = file.create_group(JUNCTIONS.name, track_order=True)
    names = {"junction"}.union(*(result.columns for result in results.values()))
    columns = (RUN, *(column for column in JUNCTIONS.columns if column.name in names))
    datasets = {column.name: _empty(owner, column, (total,)) for column in columns}
    start = 0
    for row, result in results.items():
        with open_run(result.path) as run:
            for column in columns:
                for place, values in _junctions(run, row, column):
                    filling.write(datasets[column.name], values, start + place)
        start += result.junctions


def _panels(run: RunFile, group: str, name: str) -> Iterator[tuple[int, NDArray[Any]]]:
    """Yield a column in chunks with their first rows; raises RunFileRefused at its end if it is damaged."""
    digest = xxhash.xxh3_128()
    for chunk in chunks(run, group):
        digest.update(chunk[name].data)
        yield chunk.first, chunk[name]
    if digest.hexdigest() != run.digest(group, name):
        raise RunFileRefused(f"{run.path}: damaged: /{group}/{name} is not what its hash was taken of")


def _junctions(run: RunFile, row: int, column: Dataset) -> Iterator[tuple[int, NDArray[Any]]]:
    """Return a column of a run's junctions; it may be the number of the run, or one that the run does not have."""
    if column.name in run.columns[JUNCTIONS.name]:
        return _panels(run, JUNCTIONS.name, column.name)
    return _same(row if column is RUN else _missing(column), column, run.rows("junctions"))


def _same(value: object, about: Dataset, count: int) -> Iterator[tuple[int, NDArray[Any]]]:
    """Yield a column with the same value in all rows, as `_panels` does."""
    for part in slices(0, count):
        yield part.start, np.full(part.stop - part.start, value, dtype=about.dtype)


def _missing(about: Dataset) -> float | int:
    return np.nan if np.dtype(about.dtype).kind == "f" else 0


def _empty(owner: h5py.Group, about: Dataset, shape: tuple[int, ...]) -> h5py.Dataset:
    empty = owner.create_dataset(about.name, shape, np.dtype(about.dtype), fillvalue=_missing(about))
    return describe_column(empty, about)

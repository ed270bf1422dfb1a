"""An open index of a sweep: its columns are read on demand with plain reads, the results of its runs opened by name."""

import os
from collections.abc import Mapping
from math import prod
from typing import Any

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.arrays import slices
from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.storage.index import POINTS, ROWS_AT_ONCE, RUNS, SUMMARIES, index_structure
from rubnoise.storage.objects import Place
from rubnoise.storage.reader import OpenFile, RunFile, TooNew, open_run, opened
from rubnoise.storage.schema import HASH, Dataset


class IndexFile(OpenFile):
    """An open index."""

    called = "index"

    def __init__(self, path: str | os.PathLike[str], descriptor: int, file: h5py.File) -> None:
        """Take over the descriptor of a file, and read its structure, which HDF5 has opened."""
        found = index_structure(file, os.fstat(descriptor).st_size)
        if "too_new" in found:
            raise TooNew(found["too_new"])
        self.attributes: Mapping[str, str] = found["index"]
        self._places: Mapping[str, Mapping[str, Any]] = {POINTS: {}, RUNS: {}, SUMMARIES: {}} | found["columns"]
        self._seal: str | None = found["seal"]
        for group in (POINTS, RUNS):
            if len({place["shape"][0] for place in self._places[group].values()}) != 1:
                raise RunFileRefused(f"/{group} has columns of several lengths")
        super().__init__(path, descriptor)

    @property
    def seal(self) -> str | None:
        """The stored hash of the index's attributes and columns; None without one."""
        return self._seal

    @property
    def hashes(self) -> dict[str, str | None]:
        """The stored hash of each column, by paths such as /runs/seed."""
        return {f"/{group}/{name}": place.get(HASH) for group, of in self._places.items() for name, place in of.items()}

    def damaged(self) -> tuple[str, ...]:
        """Return the paths of the columns that cannot be read, or differ from their stored hash."""
        return tuple(path for path, kept in self.hashes.items() if self._hash(*path[1:].split("/", 1)) != kept)

    def columns(self, group: str) -> tuple[Dataset, ...]:
        """Return descriptions of the columns of "points", "runs" or "summaries", in order; texts have the dtype str."""
        return tuple(_about(name, place) for name, place in self._places[group].items())

    def rows(self, group: str) -> int:
        """Return the number of points or of runs."""
        return int(next(iter(self._places[group].values()))["shape"][0])

    def read(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows of a column; raises KeyError if it does not exist, RunFileRefused if it cannot be read."""
        return _decoded(self.raw(group, name, start, stop))

    def raw(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows of a column as they are stored, texts as bytes; raises as `read` does."""
        place = self._places[group][name]
        rows, *others = place["shape"]
        width, kind = prod(others), np.dtype(place["dtype"])
        first, last, _ = slice(start, stop).indices(rows)
        column = Place(dtype=kind.str, rows=rows * width, offset=place["offset"])
        with self._reading():
            values = self.stored_rows(column, first * width, max(first, last) * width)
        return values.reshape(-1, *others)

    def _hash(self, group: str, name: str) -> str | None:
        digest = xxhash.xxh3_128()
        try:
            for part in slices(0, self._places[group][name]["shape"][0], ROWS_AT_ONCE):
                digest.update(self.raw(group, name, part.start, part.stop).data)
        except RunFileRefused:
            return None
        return digest.hexdigest()


def open_index(path: str | os.PathLike[str]) -> IndexFile:
    """Open the index of a sweep, which may come from elsewhere.

    Raises RunFileRefused, with the reason in one sentence, for a missing path, and for a file that is not an
    index, is damaged, or has a later format.
    """
    return opened(IndexFile, path)


def _about(name: str, place: Mapping[str, Any]) -> Dataset:
    kind = np.dtype(place["dtype"])
    dtype = f"<U{kind.itemsize}" if kind.kind == "S" else kind.str
    units, meaning = (str(place.get(about, "")) for about in ("units", "long_name"))
    return Dataset(name=name, units=units, long_name=meaning, symbol="", dtype=dtype)


def _decoded(values: NDArray[Any]) -> NDArray[Any]:
    if values.dtype.kind != "S":
        return values
    return np.char.decode(values, "utf-8", "replace") if values.size else np.empty(values.shape, dtype=np.str_)


def open_named(path: str | os.PathLike[str], run_id: str) -> RunFile:
    """Open the result of a run by its file and its name; raises RunFileRefused for the result of another run."""
    file = open_run(path)
    try:
        name = name_of(file)
    except BaseException:
        file.close()
        raise
    if name == run_id:
        return file
    file.close()
    raise RunFileRefused(f"{path}: is the result of another run, {name}")


def name_of(file: Reader) -> str:
    """Return the name of a run in its sweep, from the scenario in its file; raises RunFileRefused if there is none."""
    from rubnoise.scenario.points import run_id
    from rubnoise.scenario.reading import stored

    return run_id(stored(file.provenance["scenario_resolved"], f"{file.path}: the scenario in the file"))

"""An open index of a sweep: its columns are read when they are asked for, with plain reads."""

import os
from collections.abc import Mapping
from math import prod
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.storage.index import POINTS, RUNS, SUMMARIES
from rubnoise.storage.reader import examined, refusing
from rubnoise.storage.rows import StoredColumn
from rubnoise.storage.schema import Column


class IndexFile:
    """An open index. Use it as a context manager, or close it."""

    def __init__(self, path: str | os.PathLike[str], descriptor: int, found: Mapping[str, Any]) -> None:
        """Take over the descriptor of a file, and what a survey found in it."""
        self.path = Path(path)
        self._descriptor = descriptor
        self.attributes: Mapping[str, str] = found["index"]
        self._places: Mapping[str, Mapping[str, Any]] = {POINTS: {}, RUNS: {}, SUMMARIES: {}} | found["columns"]
        for group in (POINTS, RUNS):
            if len({place["shape"][0] for place in self._places[group].values()}) != 1:
                raise RunFileRefused(f"/{group} has columns of several lengths")
        self._close = finalize(self, os.close, descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; nothing can be read any more."""
        self._close()

    @property
    def closed(self) -> bool:
        """Whether the file was closed."""
        return not self._close.alive

    def columns(self, group: str) -> tuple[Column, ...]:
        """Return what the columns of "points", "runs" or "summaries" are, in their order; texts have a dtype of str."""
        return tuple(_about(name, place) for name, place in self._places[group].items())

    def rows(self, group: str) -> int:
        """Return the number of points or of runs."""
        return int(next(iter(self._places[group].values()))["shape"][0])

    def read(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows of a column; raises KeyError for one that is not there, RunFileRefused where it cannot be read."""
        if self.closed:
            raise ValueError(f"{self.path}: the index is closed")
        place = self._places[group][name]
        rows, *others = place["shape"]
        width, kind = prod(others), np.dtype(place["dtype"])
        first, last, _ = slice(start, stop).indices(rows)
        column = StoredColumn(dtype=kind, rows=rows * width, offset=place["offset"])
        with refusing(self.path):
            values = column.read(self._descriptor, first * width, max(first, last) * width)
        return _decoded(values).reshape(-1, *others)


def open_index(path: str | os.PathLike[str]) -> IndexFile:
    """Open the index of a sweep, whoever made it.

    Raises RunFileRefused, with the reason in one sentence, for a path that is missing, and for a file that is no index,
    damaged, or of a later format.
    """
    descriptor, found = examined(path)
    try:
        with refusing(path):
            _check_index(found)
            return IndexFile(path, descriptor, found)
    except BaseException:
        os.close(descriptor)
        raise


def _check_index(found: Mapping[str, Any]) -> None:
    if "index" not in found:
        raise RunFileRefused("is the result of one run, not the index of a sweep")


def _about(name: str, place: Mapping[str, Any]) -> Column:
    kind = np.dtype(place["dtype"])
    dtype = f"<U{kind.itemsize}" if kind.kind == "S" else kind.str
    units, meaning = (str(place.get(about, "")) for about in ("units", "long_name"))
    return Column(name=name, units=units, long_name=meaning, symbol="", dtype=dtype)


def _decoded(values: NDArray[Any]) -> NDArray[Any]:
    if values.dtype.kind != "S":
        return values
    return np.char.decode(values, "utf-8", "replace") if values.size else np.empty(0, dtype=np.str_)

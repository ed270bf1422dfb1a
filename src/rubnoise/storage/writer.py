"""The writer of result files: a sink that leaves a complete file with its final name, or nothing.

HDF5 makes the structure of ``NAME.h5.part``; rows then go to their places in it by plain writes. A run that was ended
is run again: its seed gives the same bits.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from tempfile import TemporaryFile
from typing import Final, Self

import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.arrays import CHUNK_ROWS, slices
from rubnoise.errors import OutputRefused, RubnoiseError, refusing_files
from rubnoise.record.rows import Columns
from rubnoise.regular_file import read_into, write_all
from rubnoise.storage.format import add_group, complete, compose, hdf5_on
from rubnoise.storage.layout import Name, RunDescription, now, row_count, stored_groups
from rubnoise.storage.life_curve import life_tables
from rubnoise.storage.output import PartFile, part_file
from rubnoise.storage.schema import Scalar

SLACK_BYTES: Final = 1 << 16
"""Reserved beyond the columns, so that hashes and summary find room on a disk that has filled up meanwhile."""


class RunWriter:
    """Writes one run, as a context manager: enter, write every row, publish. Memory does not grow with the run.

    If the block ends without ``publish``, an older file of this name stays. Rows of a group whose size is not known yet
    wait in files without names in the folder of the result.
    """

    def __init__(self, path: str | os.PathLike[str], about: RunDescription, *, force: bool = False) -> None:
        """Take the final name of the file and what it is to hold; nothing is made yet."""
        self.path, self.about, self._force = path, about, force
        self._open, self._columns = ExitStack(), dict[Name, _Column]()

    def __enter__(self) -> Self:
        """Make the file with its structure and size; raises OutputRefused (see `part_file`; also for a full disk)."""
        with ExitStack() as opened:
            self._part = opened.enter_context(part_file(self.path, force=self._force))
            with refusing_files(self._part.final, OutputRefused, "cannot be written: "):
                self._begin(self._part, opened)
            self._open = opened.pop_all()
        return self

    def __exit__(self, *problem: object) -> None:
        self._open.close()

    def _begin(self, part: PartFile, opened: ExitStack) -> None:
        with hdf5_on(part.descriptor, "w") as file:
            places = compose(file, self.about)
        part.reserve(os.fstat(part.descriptor).st_size + SLACK_BYTES)
        groups = stored_groups(self.about.features)
        self._later = [group for group in groups if (group.name, group.columns[0].name) not in places]
        for group in groups:
            rows = row_count(group, self.about.extent)
            for column in group.columns:
                name, dtype = (group.name, column.name), np.dtype(column.dtype)
                descriptor, place = part.descriptor, places.get(name, 0)
                if group in self._later:
                    spool = TemporaryFile(buffering=0, dir=part.final.parent)  # noqa: SIM115  (it ends with the writer)
                    descriptor = opened.enter_context(spool).fileno()
                    part.reserve((rows or 0) * dtype.itemsize, descriptor)
                self._columns[name] = _Column(dtype, descriptor, place, rows)
        for table, columns in life_tables(self.about.pulse).items():
            for each, values in columns.items():
                if (table, each) in self._columns:
                    self._columns[table, each].write(0, values)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Write rows of a group (see Sink)."""
        with self._part.failing():
            for name, values in columns.items():
                self._columns[group, name].write(first_row, values)

    def publish(self, summary: Mapping[str, Scalar], *, between: Callable[[], None] = lambda: None) -> None:
        """Fill in hashes, summary and the time of the end, and give the file its final name.

        ``between`` is called now and then while rows are copied, and may raise to stop. Raises RubnoiseError if a
        column lacks rows, if the disk fails, or if, without ``force``, another process created the file meanwhile.
        """
        with self._part.failing():
            whole = dict[str, int]()
            for (group, name), column in self._columns.items():
                right = whole.setdefault(group, column.rows if column.most is None else column.most)
                if column.rows != right:
                    raise RubnoiseError(f"{self._part.final}: /{group}/{name} has {column.rows} of its {right} rows")
            digests = {name: column.digest() for name, column in self._columns.items()}
            with hdf5_on(self._part.descriptor, "r+") as file:
                for later in self._later:
                    add_group(file, later, whole[later.name], self.about.compression)
                    for about in later.columns:
                        for first, values in self._columns[later.name, about.name].pieces():
                            file[later.name][about.name][first : first + values.size] = values
                            between()
                complete(file, self.about, digests, summary, now())
            self._part.finish()


@dataclass(slots=True)
class _Column:
    """One column at its place in an open file, hashed as its rows come; ``most``: of how many, None if it grows."""

    dtype: np.dtype[np.generic]
    descriptor: int
    place: int
    most: int | None
    rows: int = 0
    hash: xxhash.xxh3_128 | None = field(default_factory=xxhash.xxh3_128)

    def write(self, first_row: int, values: NDArray[np.generic]) -> None:
        """Write rows that follow those written before, or replace some of them.

        Raises TypeError for another dtype than the schema's, ValueError for rows that leave a gap or do not fit.
        """
        if values.dtype != self.dtype or values.ndim != 1:
            raise TypeError(f"rows of {values.dtype} in {values.ndim} dimensions for a column of {self.dtype}")
        end = first_row + values.size
        if not 0 <= first_row <= self.rows or (self.most is not None and end > self.most):
            raise ValueError(f"rows {first_row} to {end} of {self.most}, after {self.rows}")
        data = np.ascontiguousarray(values).view(np.uint8).data
        if first_row < self.rows:
            self.hash = None  # that of the rows before does not count any more
        elif self.hash is not None:
            self.hash.update(data)
        write_all(self.descriptor, data, self.place + first_row * self.dtype.itemsize)
        self.rows = max(self.rows, end)

    def digest(self) -> str:
        """Return the xxh3_128 of all rows in hexadecimal; a column of which rows were replaced is read once more."""
        if self.hash is None:
            self.hash = xxhash.xxh3_128()
            for _, values in self.pieces():
                self.hash.update(values.data)
        return str(self.hash.hexdigest())

    def pieces(self) -> Iterator[tuple[int, NDArray[np.generic]]]:
        """Yield first row and values of one piece of the column after the other, read back."""
        for part in slices(0, self.rows, CHUNK_ROWS):
            values = np.empty(part.stop - part.start, dtype=self.dtype)
            place = self.place + part.start * self.dtype.itemsize
            if read_into(self.descriptor, values.view(np.uint8).data, place) != values.nbytes:
                raise RubnoiseError("a file of the run was cut short meanwhile")
            yield part.start, values

"""The file beside a part for groups whose number of rows is known only at the end of a run.

It consists of steps of equal size. A step is allocated on disk before its first row is written; it belongs to one
group and holds as many rows as fit, column after column.
"""

import os
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Self

import numpy as np

from rubnoise.storage import disk
from rubnoise.storage.layout import DTYPES, ByteRange, Name
from rubnoise.storage.schema import GROUPS

STEP_BYTES: Final = 1 << 18
"""Some thousand rows: few calls of the system for many rows, little space for few."""

_MAGIC: Final = b"rng1"
_HEAD: Final = struct.Struct("<4sI")


@dataclass(frozen=True, slots=True, kw_only=True)
class Steps:
    """The steps of a group: its number, the offset of each column in a step, and the offsets of the steps so far.

    ``rows``: number of rows of a step.
    """

    group: int
    rows: int
    starts: Mapping[str, int]
    places: list[int] = field(default_factory=list)

    @classmethod
    def of(cls, group: str, columns: Sequence[str]) -> Self:
        """Return an empty list of steps for a group."""
        sizes = [np.dtype(DTYPES[group, name]).itemsize for name in columns]
        rows = (STEP_BYTES - _HEAD.size) // sum(sizes)
        begins = np.cumsum([_HEAD.size, *(rows * size for size in sizes[:-1])]).tolist()
        number = [each.name for each in GROUPS].index(group)
        return cls(group=number, rows=rows, starts=dict(zip(columns, begins, strict=True)))


@dataclass(frozen=True, slots=True)
class GrowingPlace:
    """The place of a growing column: used as a `ByteRange` is, and never full."""

    file: "GrowingFile"
    steps: Steps
    name: str
    dtype: str

    offset = 0
    """It has none before it lies in one piece."""

    rows = None
    """How many there will be is not known."""

    @property
    def held(self) -> int:
        """Number of rows for which space is allocated."""
        return len(self.steps.places) * self.steps.rows

    def reserve(self, end: int) -> None:
        """Allocate the steps that the first ``bytes`` of the column need."""
        while self.held * np.dtype(self.dtype).itemsize < end:
            self.file.add(self.steps)

    def pieces(self, first: int, size: int) -> Iterator[tuple[int, int]]:
        """Yield offset and size of each piece of the file that holds some bytes of the column."""
        width, start = self.steps.rows * np.dtype(self.dtype).itemsize, self.steps.starts[self.name]
        while size > 0:
            number, within = divmod(first, width)
            count = min(size, width - within)
            yield self.steps.places[number] + start + within, count
            first, size = first + count, size - count


class GrowingFile:
    """The file with the growing rows of some groups, each given with the names of its columns.

    ``descriptor`` is open until ``close``. Raises OSError if the disk fails.
    """

    def __init__(self, path: Path, groups: Mapping[str, Sequence[str]], *, descriptor: int) -> None:
        self.descriptor = descriptor
        self._path = path
        self._steps = {group: Steps.of(group, columns) for group, columns in groups.items()}
        self._size = 0
        self._named = False

    @classmethod
    def new(cls, path: Path, groups: Mapping[str, Sequence[str]]) -> Self:
        """Make an empty file, without any step."""
        disk.remove(path)
        return cls(path, groups, descriptor=disk.create(path))

    @classmethod
    def found(cls, path: Path, groups: Mapping[str, Sequence[str]]) -> Self:
        """Open the file with its complete steps; create it if it does not exist."""
        try:
            file = cls(path, groups, descriptor=disk.reopen(path))
        except FileNotFoundError:
            return cls.new(path, groups)
        try:
            file._find_steps()
        except BaseException:
            file.close()
            raise
        return file

    def close(self) -> None:
        """Close the file, without removing it."""
        disk.close(self.descriptor)

    @property
    def groups(self) -> tuple[str, ...]:
        """The groups whose rows are in this file."""
        return tuple(self._steps)

    def place(self, name: Name) -> GrowingPlace:
        """Return the place of a column."""
        return GrowingPlace(self, self._steps[name[0]], name[1], DTYPES[name])

    def add(self, steps: Steps) -> None:
        """Allocate one more step."""
        start, end = self._size, self._size + STEP_BYTES
        disk.allocate(self.descriptor, end, start)
        disk.write_all(self.descriptor, memoryview(_HEAD.pack(_MAGIC, steps.group)), start)
        steps.places.append(start)
        self._size = end

    def sync(self) -> None:
        """Flush all rows and the name of the file to disk."""
        disk.sync_rows(self.descriptor)
        if not self._named:
            disk.sync_folder(self._path.parent)
            self._named = True

    def copy(self, name: Name, place: ByteRange, target: int) -> None:
        """Copy a column into its place in another open file, unless a power cut has lost rows of it."""
        source, left, offset = self.place(name), place.end - place.offset, place.offset
        if place.rows > source.held:
            return
        buffer = np.empty(STEP_BYTES, dtype=np.uint8).data
        for begin, count in source.pieces(0, left):
            if disk.read_into(self.descriptor, buffer[:count], begin) != count:
                return
            disk.write_all(target, buffer[:count], offset)
            offset += count

    def _find_steps(self) -> None:
        """Find the steps, up to the first one without a valid head."""
        steps = {each.group: each for each in self._steps.values()}
        end = os.fstat(self.descriptor).st_size
        while self._size + STEP_BYTES <= end:
            magic, number = _HEAD.unpack(disk.read(self.descriptor, _HEAD.size, self._size))
            if magic != _MAGIC or number not in steps:
                return
            steps[number].places.append(self._size)
            self._size += STEP_BYTES

"""The file beside a part for groups whose number of rows is known only at the end of a run.

It consists of steps of equal size, each taken from the disk as a whole before its first row is written. A step belongs
to one group and holds as many of its rows as fit into it, column after column.
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
    """The steps of one group: its number, where each of its columns begins in a step, and where the steps lie so far.

    ``rows``: how many fit into a step.
    """

    group: int
    rows: int
    starts: Mapping[str, int]
    places: list[int] = field(default_factory=list)

    @classmethod
    def of(cls, group: str, columns: Sequence[str]) -> Self:
        """Return the steps of a group that has none yet."""
        sizes = [np.dtype(DTYPES[group, name]).itemsize for name in columns]
        rows = (STEP_BYTES - _HEAD.size) // sum(sizes)
        begins = np.cumsum([_HEAD.size, *(rows * size for size in sizes[:-1])]).tolist()
        number = [each.name for each in GROUPS].index(group)
        return cls(group=number, rows=rows, starts=dict(zip(columns, begins, strict=True)))


@dataclass(frozen=True, slots=True)
class GrowingPlace:
    """Where the bytes of a growing column lie: used as a `Place` is, and never full."""

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
        """Rows for which there is room already."""
        return len(self.steps.places) * self.steps.rows

    def reserve(self, end: int) -> None:
        """Take the steps that the first bytes of the column need."""
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
    """The growing rows of some groups, each with the names of its columns, in a file of their own.

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
        """Open the file with all its complete steps; make an empty file if it does not exist."""
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
        """Close the file; it stays."""
        disk.close(self.descriptor)

    @property
    def groups(self) -> tuple[str, ...]:
        """The groups whose rows lie here."""
        return tuple(self._steps)

    def place(self, name: Name) -> GrowingPlace:
        """Return where a column lies."""
        return GrowingPlace(self, self._steps[name[0]], name[1], DTYPES[name])

    def add(self, steps: Steps) -> None:
        """Take one more step from the disk."""
        start, end = self._size, self._size + STEP_BYTES
        disk.allocate(self.descriptor, end, start)
        disk.write_all(self.descriptor, memoryview(_HEAD.pack(_MAGIC, steps.group)), start)
        steps.places.append(start)
        self._size = end

    def sync(self) -> None:
        """See all rows onto the disk, and the name of the file."""
        disk.sync_rows(self.descriptor)
        if not self._named:
            disk.sync_folder(self._path.parent)
            self._named = True

    def copy(self, name: Name, place: ByteRange, target: int) -> None:
        """Copy a column to its place in another open file, in one piece; not if a power cut has taken rows of it."""
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
        """Find the steps up to the first that has no head."""
        steps = {each.group: each for each in self._steps.values()}
        end = os.fstat(self.descriptor).st_size
        while self._size + STEP_BYTES <= end:
            magic, number = _HEAD.unpack(disk.read(self.descriptor, _HEAD.size, self._size))
            if magic != _MAGIC or number not in steps:
                return
            steps[number].places.append(self._size)
            self._size += STEP_BYTES

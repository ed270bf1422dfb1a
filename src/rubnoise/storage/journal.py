"""The journal beside a part file: the run, each commit, and the ending of the file.

Records are appended, each with its length and a checksum of its own. A commit counts and hashes the rows on disk; the
last record holds everything of the final file except its rows.
"""

import json
import os
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import time
from typing import Final, Literal, Self

import xxhash

from rubnoise.errors import RunFileRefused
from rubnoise.regular_file import open_stream
from rubnoise.simulation.state import State
from rubnoise.storage import disk
from rubnoise.storage.columns import Mark
from rubnoise.storage.growing import GrowingFile
from rubnoise.storage.layout import DTYPES, ByteRange, Name, RunDescription

Kind = Literal["run", "rows", "end"]
"""What a record holds: which run this is; how far its rows are; what is yet to be written for the file to be whole."""

RECORD_BYTES: Final = 1 << 30
"""No record is longer: the largest holds the junctions that are alive, a million of them at most."""

_MAGIC: Final = b"rnj1"
_HEAD: Final = struct.Struct("<4s4sQQ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """One record of a journal: its kind, its content, and where it ends in the file."""

    kind: Kind
    content: bytes
    end: int


class Journal:
    """A journal for appending, made with a first record when there is something to append.

    The first ``size`` bytes of an existing journal are kept; the rest is cut off.
    """

    def __init__(self, path: Path, first: bytes, size: int = 0) -> None:
        self._path = path
        self._first = first
        self._end = size
        self._descriptor: int | None = None
        if size:
            self._descriptor = disk.reopen(path)
            disk.resize(self._descriptor, size)

    @property
    def begun(self) -> bool:
        """Whether the journal has records."""
        return self._end > 0

    def append(self, kind: Kind, content: bytes, *, durable: bool) -> None:
        """Append a record, and flush it to disk if ``durable``."""
        new = self._descriptor is None
        if self._descriptor is None:
            disk.remove(self._path)
            self._descriptor = disk.create(self._path)
            self._write(self._descriptor, "run", self._first)
        self._write(self._descriptor, kind, content)
        if durable:
            disk.sync(self._descriptor)
            if new:
                disk.sync_folder(self._path.parent)

    def close(self) -> None:
        """Close the file, without removing it."""
        if self._descriptor is not None:
            disk.close(self._descriptor)
            self._descriptor = None

    def _write(self, descriptor: int, kind: Kind, content: bytes) -> None:
        record = _packed(kind, content)
        disk.write_all(descriptor, memoryview(record), self._end)
        self._end += len(record)


def frames(path: Path) -> Iterator[Frame]:
    """Yield the records of a journal up to the first damaged one; none if the file is missing.

    Raises OSError if the disk fails.
    """
    try:
        stream = open_stream(path)
    except FileNotFoundError:
        return
    with stream:
        left = os.fstat(stream.fileno()).st_size
        while left >= _HEAD.size:
            head = stream.read(_HEAD.size)
            if len(head) != _HEAD.size:
                return  # cut off since its size was asked for
            magic, kind, length, checksum = _HEAD.unpack(head)
            left -= _HEAD.size + length
            if magic != _MAGIC or kind not in _KINDS or left < 0 or length > RECORD_BYTES:
                return
            content = stream.read(length)
            if len(content) != length or _checksum(kind, content) != checksum:
                return
            yield Frame(kind=_KINDS[kind], content=content, end=stream.tell())


_KINDS: Final[dict[bytes, Kind]] = {b"run ": "run", b"rows": "rows", b"end ": "end"}


def _packed(kind: Kind, content: bytes) -> bytes:
    name = kind.ljust(4).encode()
    return _HEAD.pack(_MAGIC, name, len(content), _checksum(name, content)) + content


def _checksum(kind: bytes, content: bytes) -> int:
    """Return the checksum of a record, which covers its length, too."""
    checksum: int = xxhash.xxh3_64_intdigest(kind + len(content).to_bytes(8, "little") + content)
    return checksum


_ENDING_HEAD: Final = struct.Struct("<QQ")
_PIECE: Final = struct.Struct("<QQ")


@dataclass(frozen=True, slots=True)
class Ending:
    """The content of a complete file outside of its rows: pieces with their offsets, and the file's size in bytes.

    ``grown``: the columns to copy from the file of growing rows, with their places in the complete file.
    """

    pieces: tuple[tuple[int, bytes], ...]
    size: int
    grown: tuple[tuple[Name, ByteRange], ...] = ()

    def packed(self) -> bytes:
        """Return the ending as the content of a record."""
        head = _ENDING_HEAD.pack(self.size, len(self.pieces))
        places = b"".join(_PIECE.pack(offset, len(data)) for offset, data in self.pieces)
        grown = [[*name, place.offset, place.rows] for name, place in self.grown]
        text = json.dumps(grown).encode() if grown else b""
        return head + places + b"".join(data for _, data in self.pieces) + text

    @classmethod
    def unpacked(cls, content: bytes) -> Self:
        """Return the ending in a record; raises struct.error, ValueError or KeyError if the record is not valid."""
        size, count = _ENDING_HEAD.unpack_from(content)
        begin = _ENDING_HEAD.size + count * _PIECE.size
        pieces = []
        for offset, length in _PIECE.iter_unpack(content[_ENDING_HEAD.size : begin]):
            pieces.append((offset, content[begin : begin + length]))
            begin += length
        grown = json.loads(content[begin:]) if content[begin:] else []
        grown = tuple(
            ((group, name), ByteRange(offset=int(offset), rows=int(rows), dtype=DTYPES[group, name]))
            for group, name, offset, rows in grown
        )
        return cls(tuple(pieces), size, grown)

    @property
    def grown_groups(self) -> dict[str, list[str]]:
        """The columns in the file of growing rows, by group."""
        groups: dict[str, list[str]] = {}
        for (group, name), _ in self.grown:
            groups.setdefault(group, []).append(name)
        return groups

    def carry_out(self, descriptor: int, growing: GrowingFile | None) -> None:
        """Write the ending to a file, and copy the growing rows into it, without fsync."""
        if growing is not None:
            disk.allocate(descriptor, self.size)
            for name, place in self.grown:
                growing.copy(name, place, descriptor)
        for offset, data in self.pieces:
            disk.write_all(descriptor, memoryview(data), offset)
        disk.resize(descriptor, self.size)

    def is_in(self, descriptor: int) -> bool:
        """Whether a file has this ending, to the last byte."""
        return os.fstat(descriptor).st_size == self.size and all(
            disk.read(descriptor, len(data), offset) == data for offset, data in self.pieces
        )


VERSION: Final = 2
MOST_COMMITS: Final = 4096
"""Commits that are remembered at most: of those long ago every other one is forgotten, again and again."""

LATEST: Final = 253_402_300_800.0
"""Seconds from 1970 to the end of the year 9999: of no later moment there is a date."""

_COMMIT_HEAD: Final = struct.Struct("<dI")
_MARK: Final = struct.Struct("<Q16s")


@dataclass(frozen=True, slots=True, kw_only=True)
class Commit:
    """The progress of a run at a ``moment`` (s since 1970): a mark for every column, and the place of its record.

    ``state``: place and length of the packed state in the journal; ``end``: where the record ends.
    """

    moment: float
    marks: Mapping[Name, Mark]
    state: tuple[int, int]
    end: int


@dataclass(slots=True, kw_only=True)
class History:
    """The content of a journal. ``run`` is None if there is no journal, or it names no run."""

    run: str | None = None
    columns: tuple[Name, ...] = ()
    commits: list[Commit] = field(default_factory=list)
    ending: Ending | None = None

    @classmethod
    def read(cls, path: Path) -> Self:
        """Return the content of a journal, up to the first damaged record.

        Raises RunFileRefused for another version, OSError if the disk fails.
        """
        history = cls()
        for frame in frames(path):
            if history.run is None and frame.kind != "run":
                break
            with _refusing(path):
                history._take(frame, path)
        return history

    def _take(self, frame: Frame, path: Path) -> None:
        if frame.kind == "run":
            head = json.loads(frame.content)
            if head["version"] != VERSION:
                raise RunFileRefused(f"{path}: has version {head['version']}; this rubnoise resumes version {VERSION}")
            self.run, self.columns = head["run"], tuple(map(tuple, head["columns"]))
        elif frame.kind == "rows":
            self.commits.append(_unpacked(frame, self.columns))
            if len(self.commits) > MOST_COMMITS:
                del self.commits[: MOST_COMMITS // 2 : 2]
        else:
            self.ending = Ending.unpacked(frame.content)


def state_at(path: Path, commit: Commit) -> State:
    """Return the state of a run at a commit; raises RunFileRefused if it is not valid."""
    place, length = commit.state
    with open_stream(path) as stream, _refusing(path):
        stream.seek(place)
        return State.unpack(stream.read(length))


def identity(description: RunDescription) -> str:
    """Return what identifies a run: its scenario, seed and streams, its rows, and its start time."""
    origin, extent = description.provenance, description.extent
    known = None if "free" in description.features else extent.junctions  # which the end of a free run alone shows
    rows = (known, extent.ticks, extent.blocks)
    parts = [description.scenario_resolved, origin.seed, origin.stream_version, origin.started, rows]
    return xxhash.xxh3_128_hexdigest(json.dumps(parts, sort_keys=True).encode())


def packed_run(description: RunDescription, columns: Sequence[Name]) -> bytes:
    """Return the content of a journal's first record."""
    head = {"version": VERSION, "run": identity(description), "columns": columns}
    return json.dumps(head).encode()


def packed_commit(marks: Sequence[Mark], state: State) -> bytes:
    """Return the content of a commit's record; its marks have the order of the columns in the first record."""
    packed = b"".join(_MARK.pack(mark.rows, mark.digest) for mark in marks)
    return _COMMIT_HEAD.pack(time(), len(marks)) + packed + state.pack()


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    """Raise RunFileRefused, which names the file, for an intact record without meaning: another program wrote it."""
    try:
        yield
    except (ValueError, KeyError, TypeError, struct.error) as problem:
        raise RunFileRefused(f"{path}: is no journal of rubnoise") from problem


def _unpacked(frame: Frame, columns: Sequence[Name]) -> Commit:
    moment, count = _COMMIT_HEAD.unpack_from(frame.content)
    if not 0.0 <= moment < LATEST:
        raise ValueError(f"a commit at {moment} s since 1970")
    end = _COMMIT_HEAD.size + count * _MARK.size
    marks = [
        Mark(rows=rows, digest=digest) for rows, digest in _MARK.iter_unpack(frame.content[_COMMIT_HEAD.size : end])
    ]
    length = len(frame.content) - end
    return Commit(
        moment=moment,
        marks=dict(zip(columns, marks, strict=True)),
        state=(frame.end - length, length),
        end=frame.end,
    )

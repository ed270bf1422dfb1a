"""The journal beside a part file: records that are appended, each with its length and a checksum of its own.

A record that a kill or a power cut has torn is as good as not written, and so is everything behind it.
"""

import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import xxhash

from rubnoise.regular_file import open_stream
from rubnoise.storage import disk

Kind = Literal["run", "rows", "end"]
"""What a record tells: which run this is; how far its rows are; what is yet to be written for the file to be whole."""

RECORD_BYTES: Final = 1 << 30
"""No record is longer: the largest holds the junctions that are alive, a million of them at most."""

_MAGIC: Final = b"rnj1"
_HEAD: Final = struct.Struct("<4s4sQQ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """One record as it was found: its kind, its content, and where it ends in the file."""

    kind: Kind
    content: bytes
    end: int


class Journal:
    """A journal for appending, made with a first record when there is something to append.

    Of a journal that is there already the first ``size`` bytes are good; the rest is cut off.
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
        """Whether there are records."""
        return self._end > 0

    def append(self, kind: Kind, content: bytes, *, durable: bool) -> None:
        """Append a record, and see it onto the disk where it shall be ``durable``."""
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
        """Close the file; it stays."""
        if self._descriptor is not None:
            disk.close(self._descriptor)
            self._descriptor = None

    def _write(self, descriptor: int, kind: Kind, content: bytes) -> None:
        record = _packed(kind, content)
        disk.write_all(descriptor, memoryview(record), self._end)
        self._end += len(record)


def frames(path: Path) -> Iterator[Frame]:
    """Yield the records of a journal up to the first that is torn; none of a file that is missing.

    Raises OSError where the disk fails.
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
    """Return the checksum of a record; the length has its share in it, so that it needs none of its own."""
    checksum: int = xxhash.xxh3_64_intdigest(kind + len(content).to_bytes(8, "little") + content)
    return checksum

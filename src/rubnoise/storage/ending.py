"""How a part file ends: all of it that is no row, as one record, and where rows go that lie beside it.

Carried out once more it gives the same file.

HDF5's own bytes must not be half old and half new, but a kill can come between any two writes. So what is to be written
is in the journal first.
"""

import json
import os
import struct
from dataclasses import dataclass
from typing import Final, Self

from rubnoise.storage import disk
from rubnoise.storage.growing import GrowingFile
from rubnoise.storage.layout import Name
from rubnoise.storage.place import DTYPES, Place

_HEAD: Final = struct.Struct("<QQ")
_PIECE: Final = struct.Struct("<QQ")


@dataclass(frozen=True, slots=True)
class Ending:
    """What a file has outside of its rows when it is whole: pieces with their offsets, and its size in bytes.

    ``grown``: the columns that lie in a file beside it until then, with their places in it.
    """

    pieces: tuple[tuple[int, bytes], ...]
    size: int
    grown: tuple[tuple[Name, Place], ...] = ()

    def packed(self) -> bytes:
        """Return it as the content of a record."""
        head = _HEAD.pack(self.size, len(self.pieces))
        places = b"".join(_PIECE.pack(offset, len(data)) for offset, data in self.pieces)
        grown = [[*name, place.offset, place.rows] for name, place in self.grown]
        told = json.dumps(grown).encode() if grown else b""
        return head + places + b"".join(data for _, data in self.pieces) + told

    @classmethod
    def unpacked(cls, content: bytes) -> Self:
        """Return what a record holds; raises struct.error, ValueError or KeyError for one that is none."""
        size, count = _HEAD.unpack_from(content)
        begin = _HEAD.size + count * _PIECE.size
        pieces = []
        for offset, length in _PIECE.iter_unpack(content[_HEAD.size : begin]):
            pieces.append((offset, content[begin : begin + length]))
            begin += length
        told = json.loads(content[begin:]) if content[begin:] else []
        grown = tuple(
            ((group, name), Place(offset=int(offset), rows=int(rows), dtype=DTYPES[group, name]))
            for group, name, offset, rows in told
        )
        return cls(tuple(pieces), size, grown)

    @property
    def grown_groups(self) -> dict[str, list[str]]:
        """The columns that lie beside the file, by group."""
        groups: dict[str, list[str]] = {}
        for (group, name), _ in self.grown:
            groups.setdefault(group, []).append(name)
        return groups

    def carry_out(self, descriptor: int, growing: GrowingFile | None) -> None:
        """Write it to a file, and copy the rows that lie beside it; the disk need not have it then."""
        if growing is not None:
            disk.allocate(descriptor, self.size)
            for name, place in self.grown:
                growing.copy(name, place, descriptor)
        for offset, data in self.pieces:
            disk.write_all(descriptor, memoryview(data), offset)
        disk.resize(descriptor, self.size)

    def is_in(self, descriptor: int) -> bool:
        """Whether a file has it, to the last byte."""
        return os.fstat(descriptor).st_size == self.size and all(
            disk.read(descriptor, len(data), offset) == data for offset, data in self.pieces
        )

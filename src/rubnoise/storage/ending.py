"""How a part file ends: all of it that is no row, as one record; carried out once more it gives the same file.

HDF5's own bytes must not be half old and half new, but a kill can come between any two writes. So what is to be written
is in the journal first.
"""

import os
import struct
from dataclasses import dataclass
from typing import Final, Self

from rubnoise.storage import disk

_HEAD: Final = struct.Struct("<QQ")
_PIECE: Final = struct.Struct("<QQ")


@dataclass(frozen=True, slots=True)
class Ending:
    """What a file has outside of its rows when it is whole: pieces with their offsets, and its size in bytes."""

    pieces: tuple[tuple[int, bytes], ...]
    size: int

    def packed(self) -> bytes:
        """Return it as the content of a record."""
        head = _HEAD.pack(self.size, len(self.pieces))
        places = b"".join(_PIECE.pack(offset, len(data)) for offset, data in self.pieces)
        return head + places + b"".join(data for _, data in self.pieces)

    @classmethod
    def unpacked(cls, content: bytes) -> Self:
        """Return what a record holds; raises struct.error for one that is none."""
        size, count = _HEAD.unpack_from(content)
        begin = _HEAD.size + count * _PIECE.size
        pieces = []
        for offset, length in _PIECE.iter_unpack(content[_HEAD.size : begin]):
            pieces.append((offset, content[begin : begin + length]))
            begin += length
        return cls(tuple(pieces), size)

    def carry_out(self, descriptor: int) -> None:
        """Write it to a file; the disk need not have it then."""
        for offset, data in self.pieces:
            disk.write_all(descriptor, memoryview(data), offset)
        disk.resize(descriptor, self.size)

    def is_in(self, descriptor: int) -> bool:
        """Whether a file has it, to the last byte."""
        return os.fstat(descriptor).st_size == self.size and all(
            disk.read(descriptor, len(data), offset) == data for offset, data in self.pieces
        )

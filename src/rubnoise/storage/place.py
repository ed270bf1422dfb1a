"""Where the bytes of columns lie in a file, and where those that are no rows do."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import xxhash

from rubnoise.errors import RunFileRefused
from rubnoise.storage.layout import Name
from rubnoise.storage.schema import GROUPS

DTYPES: Final = {(group.name, column.name): column.dtype for group in GROUPS for column in group.columns}


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where the bytes of a contiguous column lie in its file; without rows they lie nowhere and the offset is 0."""

    offset: int
    rows: int
    dtype: str

    @property
    def end(self) -> int:
        """Where it ends."""
        return self.offset + self.rows * np.dtype(self.dtype).itemsize

    @property
    def held(self) -> int:
        """Rows for which there is room: all of them."""
        return self.rows

    def reserve(self, end: int) -> None:
        """Take the space of the first bytes of the column, which its file has from the start."""

    def pieces(self, first: int, size: int) -> Iterator[tuple[int, int]]:
        """Yield offset and size of each piece of the file that holds some bytes of the column: of one alone."""
        yield self.offset + first, size


def places_of(found: Mapping[str, Any]) -> dict[Name, Place]:
    """Return where the columns lie that a survey has found; those in chunks have no place of their own."""
    return {
        (group, name): Place(offset=place.get("offset", 0), rows=place["rows"], dtype=DTYPES[group, name])
        for group, columns in found["columns"].items()
        for name, place in columns.items()
    }


def between(columns: Iterable[Place], size: int) -> tuple[range, ...]:
    """Return the places of a file that hold no rows, in order.

    Raises RunFileRefused where columns lie over one another or beyond the file.
    """
    found, start = [], 0
    for column in sorted((column for column in columns if column.rows), key=lambda column: column.offset):
        if not start <= column.offset <= column.end <= size:
            raise RunFileRefused("has overlapping columns")
        found.append(range(start, column.offset))
        start = column.end
    return tuple(place for place in [*found, range(start, size)] if place)


def digest_of(pieces: Iterable[tuple[int, bytes]]) -> str:
    """Return one hash of pieces of a file and of where they lie."""
    digest = xxhash.xxh3_128()
    for offset, data in pieces:
        digest.update(f"{offset} {len(data)} ".encode() + data)
    found: str = digest.hexdigest()
    return found

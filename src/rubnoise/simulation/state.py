"""The state that one block of a run passes to the next: explicit, frozen and storable."""

import json
import struct
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles

_HEADER = struct.Struct("<I")


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveRows:
    """Junctions whose death lies beyond the last finished tick, in order of birth.

    junction: row numbers; birth, diameter, departure (um); strength (MPa). departure is infinite for a junction that is
    alive, and the distance of its end for one that was ended early.
    """

    junction: NDArray[np.int64]
    birth: Doubles
    diameter: Doubles
    strength: Doubles
    departure: Doubles

    @classmethod
    def none(cls) -> "LiveRows":
        """Return no rows."""
        empty = np.empty(0)
        return cls(junction=np.empty(0, np.int64), birth=empty, diameter=empty, strength=empty, departure=empty)

    def __len__(self) -> int:
        """Return the number of rows."""
        return self.birth.size

    @property
    def death(self) -> Doubles:
        """Where each life ends, in um: its departure where it was ended early, else birth + 2d."""
        return np.minimum(self.departure, self.birth + 2.0 * self.diameter)

    def at(self, rows: NDArray[np.int64]) -> "LiveRows":
        """Return some of the rows."""
        return LiveRows(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    def part(self, first: int, end: int) -> "LiveRows":
        """Return the rows from ``first`` to ``end`` - 1, without a copy."""
        return LiveRows(**{f.name: getattr(self, f.name)[first:end] for f in fields(self)})

    def then(self, other: "LiveRows") -> "LiveRows":
        """Return these rows followed by others that were born later."""
        return LiveRows(
            **{f.name: np.concatenate([getattr(self, f.name), getattr(other, f.name)]) for f in fields(self)}
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """The state of a run between two blocks.

    block: the next block; next_birth (um): its first birth, where the block before it ended; junctions: rows born so
    far; ticks: ticks finished so far; events: events that the queue has seen, if there is one; live: the rows that are
    carried; slider_rows: rows of /slider so far; displacement (um) and velocity (um/s) of the slider in the last one,
    where it is coupled one way; two_way: where a slider is that is coupled two ways, written down by itself.
    """

    block: int
    begin: float
    next_birth: float
    junctions: int
    ticks: int
    events: int
    live: LiveRows
    slider_rows: int
    displacement: float
    velocity: float
    two_way: bytes = b""

    def pack(self) -> bytes:
        """Return the state as bytes from which ``unpack`` makes the same bits again."""
        numbers = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in {"live", "two_way"}}
        header = json.dumps(numbers | {"rows": len(self.live)}, allow_nan=False).encode()
        rows = [getattr(self.live, f.name).astype(f"<{_kind(f.name)}8").tobytes() for f in fields(LiveRows)]
        return _HEADER.pack(len(header)) + header + b"".join(rows) + self.two_way

    @classmethod
    def unpack(cls, data: bytes) -> "State":
        """Return the state that ``pack`` wrote down."""
        (length,) = _HEADER.unpack_from(data)
        begin = _HEADER.size + length
        numbers: dict[str, Any] = json.loads(data[_HEADER.size : begin])
        count = numbers.pop("rows")
        rows = {}
        for n, f in enumerate(fields(LiveRows)):
            column = np.frombuffer(data, dtype=f"<{_kind(f.name)}8", count=count, offset=begin + 8 * count * n)
            rows[f.name] = column.astype(column.dtype.newbyteorder("="))
        return cls(live=LiveRows(**rows), two_way=data[begin + 8 * count * len(rows) :], **numbers)


def _kind(column: str) -> str:
    return "i" if column == "junction" else "f"

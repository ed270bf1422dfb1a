"""Lives in the form of a page: a birth and a diameter have four bytes each; values that follow from them are left out.

Births are float32 numbers after a float64 base for every 256 rows, so that a birth is right to about 1e-5 um anywhere.
A column of one value is that value.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import check_numbers, gather
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import half_life
from rubnoise.record.reader import Reader
from rubnoise.storage.schema import JUNCTIONS
from rubnoise.web_page import packed

OWN: Final = ("diameter", "lateral_offset", "shear_strength")
OWN_OF_TOUCHES: Final = ("max_area", "max_overlap")
"""Columns of a touch that do not follow from its diameter, because its area follows the separation."""

_TIMES: Final = ("birth_time", "death_time")
_CHUNK: Final = 256  # rows with one base of their births
_WIDTH: Final = 4  # bytes of a value
_MARK: Final = 16  # bytes, about, that are added for a row whose end does not follow from its diameter
_MOST_WITH_TIMES: Final = 8_000_000  # bytes of lives up to which those of a two-way slider have their times, too
_SAME: Final = 1e-9  # share of a life up to which its end is where its diameter says


def bytes_of(file: Reader) -> int:
    """Return the largest number of bytes that all lives of a file take, without their times."""
    there = file.columns["junctions"]
    columns = 1 + sum(name in there for name in OWN[:2])
    if "encounter" in there:
        columns += len(OWN_OF_TOUCHES) + _MARK // _WIDTH
    return _WIDTH * columns * file.rows("junctions")


def lives(file: Reader, rows: NDArray[np.int64], *, timed: bool) -> dict[str, Any]:
    """Return rows of /junctions of a file, in order of birth, as a page holds them, ``timed`` with their times.

    Values that the page computes are left out: deaths if they follow from diameters, areas, and times at constant
    speed. Raises RunFileRefused, naming the row, if a row is not a life.
    """
    there = file.columns["junctions"]
    own = [*(name for name in OWN if name in there), *(OWN_OF_TOUCHES if "encounter" in there else ())]
    times = [name for name in _TIMES if timed and name in there and 2 * bytes_of(file) <= _MOST_WITH_TIMES]
    columns = gather(file, rows, ["birth_distance", "death_distance", "state", *own, *times])
    birth, death, state = (columns[name] for name in ("birth_distance", "death_distance", "state"))
    check_numbers("junctions", rows, {name: columns[name] for name in ("birth_distance", "death_distance", *own)})
    length = 2.0 * half_life(columns["diameter"], columns.get("lateral_offset"))
    marked = np.flatnonzero((state != 0) | (np.abs(death - birth - length) > _SAME * length))
    return {
        "units": {column.name: column.units for column in JUNCTIONS.columns if column.name in there},
        "rows": packed(rows.astype(np.uint32)) if rows.size and np.ptp(rows) >= rows.size else None,
        "first": int(rows[0]) if rows.size else 0,
        "columns": {name: _behind_bases(columns[name]) for name in ("birth_distance", *times)}
        | {name: _in_short(columns[name]) for name in own},
        "marked": {
            "row": packed(marked.astype(np.uint32)),
            "state": packed(state[marked].astype(np.uint8)),
            "death": packed(death[marked]),
        },
    }


def _behind_bases(values: Doubles) -> dict[str, Any]:
    """Return ascending values as float32 differences to the first value of each chunk."""
    bases = values[::_CHUNK]
    behind = values - np.repeat(bases, _CHUNK)[: values.size]
    return {"chunk": _CHUNK, "bases": packed(bases), "behind": packed(behind.astype(np.float32))}


def _in_short(values: Doubles) -> dict[str, Any]:
    """Return the value of all rows, if there is one, or float32 numbers."""
    if values.size and np.ptp(values) == 0.0:
        return {"value": float(values[0])}
    return {"values": packed(values.astype(np.float32))}

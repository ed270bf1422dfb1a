"""The layout of a result file: its columns, their rows and bytes, and their places in the file."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Final, Literal

import numpy as np
import xxhash

from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.storage.life_curve import CURVE_ROWS, TABLE_ROWS
from rubnoise.storage.provenance import Provenance
from rubnoise.storage.schema import GROUPS, Dataset, Feature, Group

STRUCTURE_BYTES = 24 * 1024
"""Room for everything in a file but columns and scenario: headers, attributes, scales, summary."""

Name = tuple[str, str]
"""What a column is found by: its group and its own name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDescription:
    """The content of a result file that is known before its first row."""

    title: str
    extent: Extent
    features: frozenset[Feature]
    compression: Literal["none", "gzip"]
    scenario_toml: str
    scenario_resolved: Mapping[str, object]
    provenance: Provenance


def features_of(model: Model) -> frozenset[Feature]:
    """Return the features of a run of this model: what it stores beyond the bare contact."""
    given: dict[Feature, object] = {
        "speed": model.sliding_speed,
        "strength": model.strengths,
        "slider": model.slider,
        "two-way": model.is_two_way,
        "free": model.free,
        "offset": None if model.pulse.offset == "none" else model.pulse.offset,
        "load": model.held,
        "base": model.slider is not None and model.slider.excitation == "base",
    }
    return frozenset(feature for feature, value in given.items() if value is not None and value is not False)


@cache
def stored_groups(features: frozenset[Feature]) -> tuple[Group, ...]:
    """Return the groups and columns of a run with these features, as its file describes them.

    Kept, since the runs of a sweep have the same.
    """
    return tuple(
        replace(group.as_in(features), columns=stored_columns(group, features))
        for group in GROUPS
        if (not group.needs or not features.isdisjoint(group.needs)) and features.isdisjoint(group.lacks)
    )


def stored_columns(group: Group, features: frozenset[Feature]) -> tuple[Dataset, ...]:
    """Return the columns that a group has in a run with these features, the scale first."""
    columns = group.as_in(features).columns
    return tuple(column for column in columns if column.needs is None or column.needs in features)


def row_count(group: Group, extent: Extent) -> int:
    """Return the number of rows that a group has before a run: 0 if its rows grow."""
    fixed = {"curve": CURVE_ROWS, "table": TABLE_ROWS}
    return fixed[group.length] if group.length in fixed else extent.rows(group.name) or 0


def grows(group: Group, extent: Extent) -> bool:
    """Whether the number of rows of a group is known only at the end of a run."""
    return bool(group.grows) and extent.rows(group.name) is None


def stored_extent(rows: Mapping[str, int], features: frozenset[Feature]) -> Extent:
    """Return how many rows the groups of a file have; a growing group has none before its run has ended."""
    growing = {group.name for group in GROUPS if not features.isdisjoint(group.grows) and rows.get(group.name) == 0}
    return Extent(
        junctions=None if "junctions" in growing else rows["junctions"],
        ticks=rows["trace"],
        blocks=rows.get("blocks", 0),
        slider=None if "slider" in growing else rows.get("slider", 0),
        landmarks=None if "landmarks" in growing else rows.get("landmarks", 0),
        load=rows.get("load", 0),
    )


def expected_bytes(extent: Extent, features: frozenset[Feature]) -> int:
    """Return the size of an uncompressed result file within a few kilobytes, without its scenario."""
    return STRUCTURE_BYTES + sum(
        row_count(group, extent) * np.dtype(column.dtype).itemsize
        for group in stored_groups(features)
        for column in group.columns
    )


DTYPES: Final = {(group.name, column.name): column.dtype for group in GROUPS for column in group.columns}


@dataclass(frozen=True, slots=True, kw_only=True)
class ByteRange:
    """The place of a contiguous column in its file; without rows its offset is 0."""

    offset: int
    rows: int
    dtype: str

    @property
    def end(self) -> int:
        """Where it ends."""
        return self.offset + self.rows * np.dtype(self.dtype).itemsize

    @property
    def held(self) -> int:
        """Number of rows for which space is allocated: all of them."""
        return self.rows

    def reserve(self, end: int) -> None:
        """Do nothing: the file has the space of the whole column from the start."""

    def pieces(self, first: int, size: int) -> Iterator[tuple[int, int]]:
        """Yield offset and size of the one piece of the file that holds some bytes of the column."""
        yield self.offset + first, size


def between(columns: Iterable[ByteRange], size: int) -> tuple[range, ...]:
    """Return the parts of a file that hold no rows, in order.

    Raises RunFileRefused if columns overlap or lie beyond the end of the file.
    """
    found, start = [], 0
    for column in sorted((column for column in columns if column.rows), key=lambda column: column.offset):
        if not start <= column.offset <= column.end <= size:
            raise RunFileRefused("has overlapping columns")
        found.append(range(start, column.offset))
        start = column.end
    return tuple(place for place in [*found, range(start, size)] if place)


def digest_of(pieces: Iterable[tuple[int, bytes]]) -> str:
    """Return one hash of pieces of a file and their offsets."""
    digest = xxhash.xxh3_128()
    for offset, data in pieces:
        digest.update(f"{offset} {len(data)} ".encode() + data)
    found: str = digest.hexdigest()
    return found

"""What one run stores: which columns, how many rows, how many bytes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.storage.life_curve import CURVE_ROWS
from rubnoise.storage.provenance import Provenance
from rubnoise.storage.schema import GROUPS, Column, Feature, Group

STRUCTURE_BYTES = 24 * 1024
"""Room for everything in a file but columns and scenario: headers, attributes, scales, summary."""

Name = tuple[str, str]
"""What a column is found by: its group and its own name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDescription:
    """All that is known of a result file before its first row."""

    title: str
    extent: Extent
    features: frozenset[Feature]
    compression: Literal["none", "gzip"]
    scenario_toml: str
    scenario_resolved: Mapping[str, object]
    provenance: Provenance


def features_of(model: Model) -> frozenset[Feature]:
    """Return what a run of this model stores beyond the bare contact."""
    given: dict[Feature, object] = {
        "speed": model.sliding_speed,
        "strength": model.strengths,
        "slider": model.slider,
        "two-way": model.is_two_way or None,
    }
    return frozenset(feature for feature, value in given.items() if value is not None)


def stored_groups(features: frozenset[Feature]) -> tuple[Group, ...]:
    """Return the groups of columns that a run with these features has."""
    return tuple(group for group in GROUPS if group.needs is None or group.needs in features)


def stored_columns(group: Group, features: frozenset[Feature]) -> tuple[Column, ...]:
    """Return the columns that a group has in a run with these features, the scale first."""
    return tuple(column for column in group.columns if column.needs is None or column.needs in features)


def row_count(group: Group, extent: Extent) -> int:
    """Return the number of rows in a group that are there before a run: none where they grow."""
    return CURVE_ROWS if group.length == "curve" else extent.rows(group.name) or 0


def grows(group: Group, extent: Extent) -> bool:
    """Whether only the end of a run tells how many rows a group has."""
    return group.grows and extent.rows(group.name) is None


def stored_extent(rows: Mapping[str, int]) -> Extent:
    """Return what the rows of a file tell by group; one that may grow has none before its run has ended."""
    growing = {group.name for group in GROUPS if group.grows and rows.get(group.name) == 0}
    return Extent(
        junctions=rows["junctions"],
        ticks=rows["trace"],
        blocks=rows.get("blocks", 0),
        slider=None if "slider" in growing else rows.get("slider", 0),
        landmarks=None if "landmarks" in growing else rows.get("landmarks", 0),
    )


def expected_bytes(extent: Extent, features: frozenset[Feature]) -> int:
    """Return the size of an uncompressed result file within a few kilobytes, its scenario not counted."""
    return STRUCTURE_BYTES + sum(
        row_count(group, extent) * np.dtype(column.dtype).itemsize for group, column in _all_columns(features)
    )


def _all_columns(features: frozenset[Feature]) -> Iterator[tuple[Group, Column]]:
    for group in stored_groups(features):
        for column in stored_columns(group, features):
            yield group, column

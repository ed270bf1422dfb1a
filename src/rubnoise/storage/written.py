"""The structure of a file that has just been written, from what was written: it saves reading the file again."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Self

from rubnoise.storage.columns import ColumnFile
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.schema import HASH, Scalar
from rubnoise.storage.seal import seal_of
from rubnoise.storage.structure import provenance_attributes, root_attributes, text_bytes

NamedColumn = tuple[tuple[str, str], ColumnFile]


@dataclass(frozen=True, slots=True)
class Written:
    """A file as it was when this process had written it, and what is in it if that is known (see read_structure)."""

    file: os.stat_result
    found: Mapping[str, Any] | None = None

    @classmethod
    def of(
        cls,
        file: os.stat_result,
        description: RunDescription,
        columns: Iterable[NamedColumn],
        summary: Mapping[str, Scalar],
        finished: str,
    ) -> Self:
        """Return a whole file of plain columns."""
        root = _stored(root_attributes(description))
        provenance = _stored(provenance_attributes(description) | {"finished": finished})
        del provenance[HASH]  # it stands apart, since it is taken of all the others
        found = {
            "features": sorted(description.features),
            "columns": _columns(columns),
            "attributes": {"value": root},
            "summary": {"value": _stored(summary)},
            "provenance": {"value": provenance},
            "seal": {"value": seal_of(root, _stored(summary), provenance)},
        }
        return cls(file, found)

    def is_still(self, now: os.stat_result) -> bool:
        """Whether a file is this one, untouched."""
        before = self.file
        return os.path.samestat(before, now) and (before.st_size, before.st_mtime_ns) == (now.st_size, now.st_mtime_ns)


def _columns(columns: Iterable[NamedColumn]) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for (group, name), column in columns:
        place = {"rows": column.rows, "digest": {"value": column.digest()}, "offset": column.offset}
        found.setdefault(group, {})[name] = place
    return found


def _stored(values: Mapping[str, Scalar]) -> dict[str, Scalar]:
    return {
        name: text_bytes(value).decode("utf-8", "replace").rstrip("\0") if isinstance(value, str) else value
        for name, value in values.items()
    }

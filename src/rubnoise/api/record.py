"""A run in memory, with what a run in a file has, and the way into a file."""

import json
import os
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from rubnoise.analysis.agreement import Agreement, from_attributes
from rubnoise.api.column_group import GROUP_HEADS, Columns, group_rows, listed
from rubnoise.api.columns import Column
from rubnoise.api.result import Contents, Run
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.reader import Reader
from rubnoise.storage import schema
from rubnoise.storage.reader import open_run
from rubnoise.tables import as_html, shortened

if TYPE_CHECKING:
    from rubnoise.analysis.verification import ResultFile
    from rubnoise.scenario import Scenario


@dataclass(frozen=True, slots=True, repr=False)
class Record(MemoryRecord, Contents):
    """A run kept in memory: ``record.trace["real_contact_area"]``, ``record.junction(17)``, ``record.plot("slider")``.

    ``record["trace"]["real_contact_area"]`` is the numpy array itself; groups and columns are named as in a file.
    ``scenario`` is what was run, ``intervention`` names the function that may have ended lives.

    >>> import rubnoise
    >>> record = rubnoise.simulate("paper/fig5", seed=7)
    >>> record.scenario.run.seed, len(record.trace), record.compare().passed
    (7, 200001, True)
    """

    scenario: "Scenario | None" = field(default=None, compare=False)
    intervention: str = ""

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> "Run":
        """Write the run into a result file and open it: the bits are those of `rubnoise.run`.

        ``force`` allows an existing file to be replaced. Raises OutputRefused where the file may not be written, and
        Refused for a record without its scenario.

        >>> import rubnoise
        >>> with rubnoise.simulate("paper/fig4", seed=7).save("kept.h5", force=True) as run:
        ...     run.provenance["seed"]
        7
        """
        from rubnoise.api.playing import save

        written = save(self, path, force=force)
        return Run(open_run(path, own=written))

    @property
    def provenance(self) -> Mapping[str, float | int | str]:
        """Scenario and seed of the run, by the names that they have in a file; raises Refused without a scenario."""
        return MemoryReader(self).provenance

    @property
    def summary(self) -> list[Agreement]:
        """What was measured beside what is exact, as a file keeps it; raises Refused without a scenario."""
        from rubnoise.api.playing import figures_of

        return from_attributes(figures_of(self, self.model()))

    def groups_by_name(self) -> Mapping[str, Columns]:
        """Return every group of columns by name."""
        return {group.name: self._columns(group) for group in schema.GROUPS if group.name in self.groups}

    @property
    def _pulse(self) -> Pulse:
        return self.pulse

    def _columns(self, group: schema.Group) -> Columns:
        arrays = self.groups[group.name]
        stored = group.as_in(schema.motion_of(self.groups["junctions"]))
        kept = [about for about in stored.columns if about.name in arrays]
        return Columns(stored, {about.name: _column(about, arrays[about.name]) for about in kept})

    def _attributes(self) -> Mapping[str, float | int | str]:
        return {"title": self.scenario.title if self.scenario is not None else ""}

    def reader(self) -> Reader:
        """Return the rows with what their file would say of them; raises Refused without a scenario."""
        return MemoryReader(self)

    def _file_of(self) -> "AbstractContextManager[ResultFile]":
        from rubnoise.api.answers import saved

        return saved(self)

    @property
    def _called(self) -> str:
        return "the run in memory"

    def __repr__(self) -> str:
        return shortened([self._heading, *listed(self.groups_by_name())])

    def _repr_html_(self) -> str:
        return as_html(self._heading, GROUP_HEADS, group_rows(self.groups_by_name()))

    @property
    def _heading(self) -> str:
        title = self.scenario.title if self.scenario is not None else ""
        return f"a run in memory: {title}" if title else "a run in memory"


class MemoryReader:
    """A run in memory with what its file would say of it."""

    def __init__(self, record: Record) -> None:
        """Stand for a record; raises Refused for one without its scenario."""
        if record.scenario is None:
            raise Refused("this record does not know its scenario; rubnoise.simulate makes one that does")
        self._record = record
        self.path = Path("memory")
        self.extent = record.extent
        self.attributes: Mapping[str, float | int | str] = {"title": record.scenario.title}
        self.summary: Mapping[str, float | int | str] = {}
        self.provenance: Mapping[str, float | int | str] = {
            "scenario_resolved": json.dumps(record.scenario.resolved()),
            "seed": record.scenario.run.seed,
        }

    @property
    def columns(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the columns in each group."""
        return {name: tuple(columns) for name, columns in self._record.groups.items()}

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        return next(iter(self._record.groups[group].values())).size

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Return rows ``start`` to ``stop`` of a column."""
        return self._record.groups[group][name][start:stop]


def _column(about: schema.Dataset, values: NDArray[Any]) -> Column:
    def read(start: int, stop: int) -> NDArray[Any]:
        return values[start:stop]

    return Column(about, values.size, read)

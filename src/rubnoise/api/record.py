"""A run in memory, with the same groups and methods as a run in a file, which it can be saved into."""

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from rubnoise.analysis.agreement import Agreement, from_attributes
from rubnoise.api.column_group import Columns, columns_by_group
from rubnoise.api.contents import Contents
from rubnoise.api.result import Run
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.reader import Attributes, Reader
from rubnoise.storage.reader import open_run

if TYPE_CHECKING:
    from rubnoise.analysis.verification import ResultFile
    from rubnoise.scenario import Scenario


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Record(MemoryRecord, Contents):
    """A run kept in memory: ``record.trace["real_contact_area"]``, ``record.junction(17)``, ``record.plot("slider")``.

    ``record["trace"]["real_contact_area"]`` is the numpy array itself, which cannot be changed; groups and columns are
    named as in a file.
    ``scenario`` is what was run, ``intervention`` names the function that may have ended lives.

    >>> import rubnoise
    >>> record = rubnoise.simulate("paper/fig5", seed=7)
    >>> record.scenario.run.seed, len(record.trace), record.compare().passed
    (7, 200001, True)
    """

    scenario: "Scenario | None" = None
    intervention: str = ""

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> "Run":
        """Write the run into a result file and open it: the bits are those of `rubnoise.run`.

        ``force`` allows an existing file to be replaced. Raises OutputRefused if the file may not be written, and
        Refused for a record without its scenario.

        >>> import rubnoise
        >>> with rubnoise.simulate("paper/fig4", seed=7).save("kept.h5", force=True) as run:
        ...     run.provenance["seed"]
        7
        """
        from rubnoise.runs.making import save

        save(self, path, force=force)
        return Run(open_run(path))

    @property
    def provenance(self) -> Mapping[str, float | int | str]:
        """Scenario and seed of the run, by the names that they have in a file; raises Refused without a scenario."""
        return self.reader().provenance

    @property
    def summary(self) -> list[Agreement]:
        """What was measured beside what is exact, as a file keeps it; raises Refused without a scenario."""
        from rubnoise.runs.making import figures_of

        return from_attributes(figures_of(self, self.model()))

    def known_scenario(self) -> "Scenario":
        """Return what was run; raises Refused if the record does not say."""
        if self.scenario is None:
            raise Refused("this record does not know its scenario; rubnoise.simulate makes one that does")
        return self.scenario

    def groups_by_name(self) -> Mapping[str, Columns]:
        """Return every group of columns by name."""
        return columns_by_group(self)

    @property
    def _pulse(self) -> Pulse:
        return self.pulse

    def _attributes(self) -> Mapping[str, float | int | str]:
        return {"title": self.scenario.title if self.scenario is not None else ""}

    def reader(self) -> Reader:
        """Return the rows with the attributes of their file; raises Refused without a scenario."""
        scenario = self.known_scenario()
        origin: Attributes = {"scenario_resolved": json.dumps(scenario.resolved()), "seed": scenario.run.seed}
        return MemoryReader(
            self.extent, self.groups, self.pulse, attributes={"title": scenario.title}, provenance=origin
        )

    @contextmanager
    def _file_of(self) -> "Iterator[ResultFile]":
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            path = Path(folder) / "record.h5"
            self.save(path).close()
            with open_run(path) as file:
                yield file

    @property
    def _called(self) -> str:
        return "the run in memory"

    def _heading_and_groups(self) -> tuple[str, Mapping[str, Columns]]:
        title = self.scenario.title if self.scenario is not None else ""
        return f"a run in memory: {title}" if title else "a run in memory", self.groups_by_name()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MemoryReader(MemoryRecord):
    """A run in memory with the attributes of its file."""

    attributes: Attributes
    provenance: Attributes
    summary: Attributes = field(default_factory=dict)
    path: Path = Path("memory")

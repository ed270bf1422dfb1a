"""An open result file."""

import json
import os
from collections.abc import Mapping
from functools import cached_property, partial
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

from rubnoise.analysis.agreement import Agreement, from_attributes
from rubnoise.api.column import Column
from rubnoise.api.columns import Columns
from rubnoise.api.contents import Contents
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import RunFileRefused, ScenarioRefused
from rubnoise.record.reader import Rows
from rubnoise.storage.life_curve import stored_pulse
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.schema import GROUPS

if TYPE_CHECKING:
    from rubnoise.scenario import Scenario


class Run(Contents):
    """An open result file; a context manager. Opening reads its structure, asking for rows reads those rows.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     print(run.trace["distance"][:3], run.trace["distance"].units)
    [0.  0.1 0.2] um
    """

    def __init__(self, file: RunFile) -> None:
        """Take over an open run file."""
        self._file = file
        self._found = {group.name: _columns(file, group.name) for group in GROUPS if group.name in file.columns}

    def __enter__(self) -> Self:
        """Return the run."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file; nothing can be read any more."""
        self._file.close()

    @property
    def path(self) -> Path:
        """Path of the file, as it was opened."""
        return self._file.path

    def groups(self) -> dict[str, Columns]:
        """Return every group of columns by name."""
        return dict(self._found)

    @cached_property
    def scenario(self) -> "Scenario":
        """The scenario of the run, with every default and change of it made explicit."""
        from rubnoise.scenario import build

        text = str(self.provenance["scenario_resolved"])
        try:
            return build(json.loads(text))
        except (ValueError, RecursionError, AttributeError, TypeError, ScenarioRefused) as problem:
            raise RunFileRefused(f"{self.path}: the scenario in the file is not valid") from problem

    @cached_property
    def summary(self) -> list[Agreement]:
        """What was measured beside what is exact."""
        return from_attributes(self._file.summary)

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Format, title, source and formula, as they stand at the root of the file."""
        return self._file.attributes

    @property
    def provenance(self) -> dict[str, float | int | str]:
        """Scenario, software, seed, command and times of the run."""
        return self._file.provenance

    def __repr__(self) -> str:
        if self._file.closed:
            return f"{self.path}: a run, closed"
        heading = f"{self.path}: {self.attributes['title']}"
        lines = [f"  .{name:<11} {len(group):>12,} rows: {', '.join(group)}" for name, group in self._found.items()]
        return "\n".join([heading, *lines])

    def _groups(self) -> Mapping[str, Columns]:
        return self._found

    @cached_property
    def _pulse(self) -> Pulse:
        return stored_pulse(self.provenance["scenario_resolved"])

    def _attributes(self) -> Mapping[str, float | int | str]:
        return self.attributes


def open(path: str | os.PathLike[str]) -> Run:  # noqa: A001  (rubnoise.open reads like h5py.File)
    """Open a result file for reading; raises RunFileRefused with the reason where it is none of ours or damaged.

    However long the run, this reads its structure only.
    """
    return Run(open_run(path))


def _columns(file: Rows, name: str) -> Columns:
    group = next(group for group in GROUPS if group.name == name)
    rows = file.rows(name)
    found = {
        about.name: Column(about, rows, partial(file.column, name, about.name))
        for about in group.columns
        if about.name in file.columns[name]
    }
    return Columns(group, found)

"""A run in a file."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import deepcopy
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

from rubnoise.analysis.agreement import Agreement, from_attributes
from rubnoise.api.column_group import Columns, columns_by_group
from rubnoise.api.contents import Contents
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.storage.life_curve import stored_pulse
from rubnoise.storage.reader import RunFile, open_run

if TYPE_CHECKING:
    from rubnoise.scenario import Scenario


class Opened:
    """An object that owns an open file; a context manager."""

    _file: RunFile

    def __enter__(self) -> Self:
        """Return it."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def __copy__(self) -> Self:
        """Return a copy that is opened again: closing one leaves the other open."""
        return deepcopy(self)

    def close(self) -> None:
        """Close the file; nothing can be read from it any more."""
        self._file.close()


class Run(Opened, Contents):
    """An open result file; a context manager. Opening reads its structure, asking for rows reads those rows.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     print(run.trace["distance"][:3], run.trace["distance"].units)
    [0.  0.1 0.2] um
    """

    def __init__(self, file: RunFile) -> None:
        """Take over an open run file."""
        self._file: RunFile = file
        self._groups = columns_by_group(file)

    @property
    def path(self) -> Path:
        """Path of the file, as it was opened."""
        return self._file.path

    def groups(self) -> dict[str, Columns]:
        """Return every group of columns by name."""
        return dict(self._groups)

    @cached_property
    def scenario(self) -> "Scenario":
        """The scenario of the run, with every default and change made explicit."""
        from rubnoise.scenario.reading import stored

        return stored(self.provenance["scenario_resolved"], f"{self.path}: the scenario in the file")

    @cached_property
    def summary(self) -> list[Agreement]:
        """The measured figures beside the exact ones."""
        return from_attributes(self._file.summary)

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Format, title, source and formula: the attributes of the file's root."""
        return self._file.attributes

    @property
    def provenance(self) -> dict[str, float | int | str]:
        """Scenario, software, seed, command and times of the run."""
        return self._file.provenance

    def _heading_and_groups(self) -> tuple[str, Mapping[str, Columns]]:
        if self._file.closed:
            return f"{self.path}: a run, closed", {}
        return f"{self.path}: {self.attributes['title']}", self._groups

    def reader(self) -> Reader:
        """Return the open file."""
        return self._file

    @contextmanager
    def _file_of(self) -> Iterator[RunFile]:
        yield self._file

    @property
    def _called(self) -> str:
        return str(self.path)

    def groups_by_name(self) -> Mapping[str, Columns]:
        """Return every group of columns by name."""
        return self._groups

    @cached_property
    def _pulse(self) -> Pulse:
        return stored_pulse(self.provenance["scenario_resolved"])

    def _attributes(self) -> Mapping[str, float | int | str]:
        return self.attributes


def open(path: str | os.PathLike[str]) -> Run:  # noqa: A001  (rubnoise.open reads like h5py.File)
    """Open a result file for reading, its structure alone, however long the run.

    Raises RunFileRefused with the reason if it is not a result of rubnoise, is damaged, or is a part that a killed run
    has left.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     run.scenario.title, run.junction(17).diameter > 0.0
    ('Figure 5: excitation force and vibration', True)
    """
    try:
        return Run(open_run(path))
    except RunFileRefused:
        from rubnoise.scenario.shipped import shipped_names

        if str(path) in shipped_names():
            raise RunFileRefused(f'{path}: is a scenario, not a result; rubnoise.simulate("{path}") runs it') from None
        raise

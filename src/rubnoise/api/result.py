"""Results: a run in a file (Run) or in memory (Record), what both hold, and one junction of either."""

import json
import os
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from operator import index
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.analysis.agreement import Agreement, from_attributes
from rubnoise.api.columns import Column, Columns
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.errors import RunFileRefused, ScenarioRefused, needing
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.reader import Rows
from rubnoise.record.rows import JunctionState
from rubnoise.storage import schema
from rubnoise.storage.life_curve import stored_pulse
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.schema import GROUPS

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from rubnoise.scenario import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Junction:
    """One junction's row: distances in um, area in um^2; times in s and strength in MPa where the run has them.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     junction = run.junction(17)
    >>> middle = junction.birth_distance + junction.diameter
    >>> bool(np.isclose(junction.area(middle), junction.max_area))
    True
    """

    number: int
    birth_distance: float
    death_distance: float
    life_distance: float
    diameter: float
    max_area: float
    state: JunctionState
    shear_strength: float | None = None
    birth_time: float | None = None
    death_time: float | None = None
    pulse: Pulse = field(default=LENS, repr=False)

    def area(self, distance: ArrayLike) -> NDArray[np.float64]:
        """Return its area in um^2 at sliding distances in um (any shape); 0 before birth and from death on.

        With x = |d - (s - birth_distance)| the lens has A(s) = d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2) (paper Eq. 2), the
        triangle (pi/4) d (d - x): whichever the run has.
        """
        s = np.asarray(distance, dtype=np.float64)
        alive = (self.birth_distance <= s) & (s < self.death_distance)
        return np.where(alive, self.pulse.area(s - self.birth_distance, self.diameter), 0.0)


class Contents(ABC):
    """The groups of a result and what can be made of them."""

    __slots__ = ()

    @abstractmethod
    def _groups(self) -> Mapping[str, Columns]:
        """Return every group of columns by name."""

    @property
    @abstractmethod
    def _pulse(self) -> Pulse:
        """Return the shape of the junctions' lives."""

    def _attributes(self) -> Mapping[str, float | int | str]:
        return {}

    @property
    def junctions(self) -> Columns:
        """One row a junction, in order of birth."""
        return self._groups()["junctions"]

    @property
    def trace(self) -> Columns:
        """Real contact area, junction count and friction force at every tick."""
        return self._groups()["trace"]

    @property
    def slider(self) -> Columns:
        """The slider's motion at every tick; raises KeyError where the run has no slider."""
        groups = self._groups()
        if "slider" not in groups:
            raise KeyError("the run has no slider")
        return groups["slider"]

    def junction(self, number: int) -> Junction:
        """Return one junction by its row number, reading that row; raises IndexError where there is no such row."""
        columns, number = self.junctions, index(number)
        if not 0 <= number < len(columns):
            there = f"junctions 0 to {len(columns) - 1}" if len(columns) else "no junctions at all"
            raise IndexError(f"junction {number}: the run has {there}")
        values = {name: columns[name][number].item() for name in columns if name != "junction"}
        return Junction(number=number, pulse=self._pulse, **values | {"state": JunctionState(values["state"])})

    def to_xarray(self, *, index: bool = True) -> "xr.DataTree":
        """Return the result as an xarray DataTree: ``run.to_xarray()["trace"]``, and so for every group.

        Variables are read when they are asked for, as long as the run is open; ``index`` is as in Columns.to_xarray.
        Raises ExtraMissing without xarray.
        """
        with needing("analysis", "to_xarray"):
            from rubnoise.api import labelled
        groups = {name: columns.to_xarray(index=index) for name, columns in self._groups().items()}
        return labelled.tree(groups, self._attributes())

    def to_pandas(self) -> "dict[str, pd.DataFrame]":
        """Read every group into a pandas DataFrame; see Columns.to_pandas, which reads one."""
        return {name: columns.to_pandas() for name, columns in self._groups().items()}


class Record(MemoryRecord, Contents):
    """A run kept in memory: ``record.trace["real_contact_area"]``, ``record.junction(17)``, ``record.to_xarray()``.

    ``record["trace"]["real_contact_area"]`` is the numpy array itself; groups and columns are named as in a file.
    """

    __slots__ = ()

    def _groups(self) -> Mapping[str, Columns]:
        return {group.name: self._columns(group) for group in schema.GROUPS if group.name in self.groups}

    @property
    def _pulse(self) -> Pulse:
        return self.pulse

    def _columns(self, group: schema.Group) -> Columns:
        arrays = self.groups[group.name]
        kept = [about for about in group.columns if about.name in arrays]
        return Columns(group, {about.name: _column(about, arrays[about.name]) for about in kept})

    def __repr__(self) -> str:
        return "\n".join(["a run in memory", *map(repr, self._groups().values())])


def _column(about: schema.Column, values: NDArray[Any]) -> Column:
    def read(start: int, stop: int) -> NDArray[Any]:
        return values[start:stop]

    return Column(about, values.size, read)


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

"""A run, in a file or in memory: its groups of columns, its answers, its pictures, and each of its junctions."""

import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from copy import deepcopy
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from math import inf
from numbers import Real
from operator import index
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.analysis.findings import from_attributes
from rubnoise.analysis.junctions import JunctionRow
from rubnoise.answer import Answer, Row
from rubnoise.api.columns import SHORT, Columns, columns_by_group, homes_of, with_units
from rubnoise.api.keywords import refuse_unknown, shown
from rubnoise.api.notebook import DataFrame, DataTree, Displayed, Overview
from rubnoise.arrays import at_each
from rubnoise.errors import Refused, RunFileRefused, needing
from rubnoise.figures import Axes, Figure, Kind, Style
from rubnoise.record.rows import JunctionState, Reader, refuse_touches
from rubnoise.storage import schema
from rubnoise.storage.reader import RunFile, calculating, open_run
from rubnoise.tables import as_html

if TYPE_CHECKING:
    from rubnoise.analysis.findings import Comparison
    from rubnoise.api.estimates import PowerSpectrum
    from rubnoise.api.trace import Trace
    from rubnoise.model import Model
    from rubnoise.runs.verification import Verification
    from rubnoise.scenario import Scenario
    from rubnoise.theory.exact import Exact


@dataclass(frozen=True, slots=True, kw_only=True)
class Junction(JunctionRow):
    """One junction's row: distances in um, area in um^2; times in s and strength in MPa if the run has them.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     junction = run.junction(17)
    >>> middle = junction.birth_distance + junction.diameter
    >>> bool(np.isclose(junction.area(middle), junction.max_area))
    True
    """

    def area(self, distance: ArrayLike) -> NDArray[np.float64]:
        """Return its area in um^2 at sliding distances in um (any shape); 0 before birth and from death on.

        With x = |d - (s - birth_distance)| the lens has A(s) = d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2) (paper Eq. 2), the
        triangle (pi/4) d (d - x) and the parabola (pi/4) (d^2 - x^2). A pass that misses the centre line by
        b = lateral_offset has sqrt(x^2 + b^2) for x, with x = 0 at birth_distance + sqrt(d^2 - b^2).
        """
        return at_each(self._area, distance, "distance", "um", (0.0, 0.0))

    def _area(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        alive = (self.birth_distance <= distance) & (distance < self.death_distance)
        return np.where(alive, self.area_at_age(distance - self.birth_distance), 0.0)

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the area over the sliding distance, from birth to death, and return the figure, that of ``ax``."""
        from rubnoise.api.pictures import drawn_columns

        place = np.linspace(self.birth_distance, self.death_distance, 401)
        along = (place, "sliding distance (um)")
        return drawn_columns(along, [(self.area(place), f"area of junction {self.number} (um^2)")], ax)

    def _repr_html_(self) -> str:
        units = {column.name: column.units for column in schema.JUNCTIONS.columns}
        values = {name: getattr(self, name, None) for name in units if name != "junction"}
        rows = [(name, value, units[name]) for name, value in values.items() if value is not None]
        return as_html(f"junction {self.number}", ("", "value", "unit"), rows)


class Summary(list[Row]):
    """The figures in the order of the file, shown as a table: ``run.summary[0].z``."""

    def _answer(self) -> Answer:
        return Answer(title="measured figures", rows=tuple(self))

    def __repr__(self) -> str:
        return repr(self._answer())

    def _repr_html_(self) -> str:
        return self._answer()._repr_html_()

    def to_pandas(self) -> "DataFrame":
        """Return the figures as a pandas DataFrame whose index is their name; raises ExtraMissing without pandas."""
        return self._answer().to_pandas().set_index("name")


_WORDS: Final = {"to_dataframe": "run.to_pandas()", "describe": "run.summary"}  # what a run has for words of pandas


class NoGroup(AttributeError, KeyError):  # noqa: N818  (says what is missing)
    """A run does not have a group of columns."""

    def __str__(self) -> str:
        """Return the message as it is, not in quotation marks as KeyError does."""
        return Exception.__str__(self)


class NoJunction(Refused, IndexError):  # noqa: N818  (says what is missing)
    """A run does not have a junction of this number."""


class Run(Displayed):
    """A run: an open result file, which is a context manager, or a `Record` in memory.

    Opening reads its structure, asking for rows reads those rows. The groups of columns are attributes: ``junctions``
    has one row a junction, in order of birth; at every tick ``trace`` has real contact area, junction count and
    friction force, ``slider`` the slider's motion, ``load`` the normal motion on a load that weighs, ``balance`` the
    energy of a slider that pushes back, summed up so far; ``landmarks`` are sticks, slips and reversals, flights and
    impacts, and ``life_curve``, only in files, is the curve of every life over its size, for programs without our code.
    To ask for a group that the run does not have raises NoGroup. ``path`` is that of the file, as it was opened,
    ``attributes`` are those of its root: format, title, source and formula, ``provenance`` holds scenario, software,
    seed, command and times.

    Columns are attributes, too, and ``run["force"]`` is ``run.force``. ``area``, ``count`` and ``distance`` are those
    of /trace; ``force``, ``time``, ``displacement`` and ``velocity`` those of /slider, or without one those of /trace,
    at the sliding speed. Other columns have their own name if it stands in one group alone.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     print(run.trace["distance"][:3], run.trace["distance"].units)
    [0.  0.1 0.2] um
    """

    junctions: Columns
    trace: Columns
    slider: Columns
    load: Columns
    landmarks: Columns
    balance: Columns
    life_curve: Columns

    def __init__(self, reader: Reader) -> None:
        self.path, self.attributes, self.provenance = reader.path, reader.attributes, reader.provenance
        self._reader, self._groups = reader, columns_by_group(reader)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __copy__(self) -> Self:
        """Return a copy that is opened again: closing one leaves the other open."""
        return deepcopy(self)

    def close(self) -> None:
        """Close the file; nothing can be read from it any more."""
        if isinstance(self._reader, RunFile):
            self._reader.close()

    def groups(self) -> dict[str, Columns]:
        """Return every group of columns by name."""
        return dict(self._groups)

    def reader(self) -> Reader:
        """Return the rows and attributes of the run."""
        return self._reader

    @cached_property
    def scenario(self) -> "Scenario":
        """The scenario of the run, with every default and change made explicit."""
        from rubnoise.scenario.reading import stored

        return stored(self.provenance["scenario_resolved"], f"{self._called}: the scenario in the file")

    @cached_property
    def summary(self) -> Summary:
        """The measured figures beside the exact ones, a list that is shown as a table."""
        return Summary(from_attributes(self._reader.summary))

    def __dir__(self) -> list[str]:
        """Return the names that an editor completes, also of groups and columns."""
        return sorted((set(super().__dir__()) - {"reader"}) | set(self.names))

    def __getattr__(self, name: str) -> Any:
        """Return a group, or a column that needs no group."""
        if name.startswith("_"):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)
        groups = self._groups
        if name in groups:
            return groups[name]
        if any(name == group.name for group in schema.GROUPS):
            raise NoGroup(f"the run has no {name}; it has {', '.join(groups)}", name=name, obj=self)
        homes = homes_of(groups, name)
        if len(homes) == 1:
            return groups[homes[0]][SHORT.get(name, name)]
        if name == "time" and (duration := self.model().tick_duration):
            steps = np.arange(len(self.trace)) * duration
            return with_units(steps, "time", "s", "time, the sliding distance over the speed")
        if homes := [group for group in groups if name in groups[group]]:
            raise NoGroup(f"{name} stands in {' and '.join(homes)}; run.{homes[0]}.{name} is one", name=name, obj=self)
        near = _WORDS.get(name) or ", ".join(get_close_matches(name, self.names) or self.names)
        raise NoGroup(f"a run has no {name!r}; it has {near}", name=name, obj=self)

    def __getitem__(self, name: str) -> Any:
        """Return what the run has under a name: a group, a column or a figure such as ``run["scenario"]``."""
        if not isinstance(name, str):
            raise KeyError(f"a run has groups and columns by name: {', '.join(self.names)}")
        return getattr(self, name)

    def __contains__(self, group: object) -> bool:
        return group in self._groups

    def __iter__(self) -> Iterator[str]:
        return iter(self._groups)

    def keys(self) -> list[str]:
        """Return the names of the groups."""
        return list(self._groups)

    @property
    def names(self) -> list[str]:
        """Names of groups, and of columns that need no group."""
        columns = {*SHORT, *(name for group in self._groups.values() for name in group)}
        return [*self._groups, *sorted(name for name in columns if len(homes_of(self._groups, name)) == 1)]

    def junction(self, number: int) -> Junction:
        """Read and return one junction by its row number; raises IndexError without such a row, Refused for a touch."""
        columns, number = self.junctions, index(number)
        refuse_touches(columns)
        if not 0 <= number < len(columns):
            there = f"junctions 0 to {len(columns) - 1}" if len(columns) else "no junctions at all"
            raise NoJunction(f"junction {number}: the run has {there}")
        names = (name for name in columns if name != "junction")
        values = {name: self._reader.column("junctions", name, number, number + 1)[0].item() for name in names}
        return Junction(number=number, pulse=self.model().pulse, **values | {"state": JunctionState(values["state"])})

    def compare(self, bound: float | None = None) -> "Comparison":
        """Compare the rows with the theory of the scenario: a table with z-scores, and ``passed``.

        ``bound``: the largest |z|, by default what all in 99.9 % of right runs keep. Refuses short runs.
        """
        from rubnoise.analysis.comparison import compare

        if bound is not None and not (isinstance(bound, Real) and 0.0 < float(bound) < inf):
            raise Refused(f"bound=: {shown(bound)} is no bound on |z|; it is a number above 0")
        with calculating(self._called):
            return replace(compare(self.model(), self._reader, bound), title=f"{self._called}: compared with theory")

    def verify(self) -> "Verification":
        """Check every value against hashes, scenario and the run, played again: a table of checks, and ``passed``.

        A run in memory is saved first.
        """
        from rubnoise.runs.verification import verify

        with self._file_of() as file, calculating(self._called):
            return replace(verify(file), title=f"{self._called}: verified")

    def psd(self, quantity: str = "real_contact_area", *, segment: Any = None) -> "PowerSpectrum":
        """Return Welch's estimate of a spectral density, with the exact one if theory knows it; see PowerSpectrum.

        Columns of a slider are in time, those of the trace along the distance. ``segment`` is the length of a segment
        in s or um, or a text such as "0.5 s"; by default there are some 64. Raises KeyError for another quantity.
        """
        from rubnoise.api.estimates import spectrum_of

        return spectrum_of(self, quantity, segment)

    spectrum = psd  # the same under the word of other programs

    def plot(
        self,
        what: "Kind | None" = None,
        ax: "Axes | None" = None,
        *,
        start: Any = None,
        stop: Any = None,
        of: str = "area",
        beside: "Run | Trace | str | os.PathLike[str] | None" = None,
        size: str | None = None,
        title: bool = True,
        style: "Style | None" = None,
        **unknown: Any,
    ) -> "Figure":
        """Draw a picture of the run beside theory, and return it as a matplotlib figure.

        ``what`` is a name as for `rubnoise plot`; without it "overview", or "load" of a slider that moves freely.
        ``start`` and ``stop`` are sliding distances in um ("contact" is from above, at ``start``). ``of`` is whose
        spectrum "psd" shows: "area", "force", "displacement" or "velocity". ``beside`` is another run or its file, for
        "slider", "phase", "load" and "psd", or for "psd" a `Trace` or its file. With ``ax`` it takes the place of these
        axes, and the whole figure is returned. ``size`` is "84 mm x 60 mm", or "single" or "double" for the columns of
        a journal; ``title`` is whether axes have titles; ``style`` is "screen", "paper" (small letters and thin lines,
        the default below 120 mm) or "slides". Raises Refused for a picture that the run does not have, ExtraMissing
        without matplotlib.

        >>> import rubnoise
        >>> with rubnoise.open("fig5.h5") as run:
        ...     figure = run.plot("psd", of="velocity")
        >>> len(figure.axes)  # the spectrum, and its ratio to the exact one
        2
        """
        from rubnoise.api.pictures import appearance, drawn

        refuse_unknown(unknown, tuple(Run.plot.__kwdefaults__ or ()))
        look = appearance(what or "overview", size=size, title=title, style=style)
        return drawn(self, what, ax, start=start, stop=stop, of=of, beside=beside, look=look)

    @property
    def exact(self) -> "Exact":
        """What theory says about the scenario of the run."""
        from rubnoise.theory.exact import exact

        return exact(self.model())

    def model(self) -> "Model":
        """Return the physics of the run; raises RunFileRefused for a file whose scenario is not valid."""
        return self.scenario.model()

    def _file_of(self) -> "AbstractContextManager[RunFile]":
        """Return the run as an open file."""
        return nullcontext(self._reader)  # type: ignore[arg-type]

    @property
    def _called(self) -> str:
        """The name of the run in messages."""
        return str(self.path)

    def _overview(self) -> Overview:
        """Return name, number of rows and columns of each group, but not of a closed file."""
        if isinstance(self._reader, RunFile) and self._reader.closed:
            return f"{self._called}: a run, closed", (), (), ()
        rows = [(f".{name}", f"{len(group):,} rows", ", ".join(group)) for name, group in self._groups.items()]
        heading = f"{self._called}: {self.attributes['title']}".removesuffix(": ")
        return heading, ("group", "", "columns"), rows, ()

    def to_xarray(self, *, index: bool = True) -> "DataTree":
        """Return the result as an xarray DataTree, ``run.to_xarray()["trace"]``; groups are as of Columns.to_xarray."""
        with needing("analysis", "to_xarray"):
            import xarray as xr
        groups = {f"/{name}": columns.to_xarray(index=index) for name, columns in self._groups.items()}
        found = xr.DataTree.from_dict(groups)
        found.attrs.update(self.attributes)
        return found

    def to_pandas(self) -> "dict[str, DataFrame]":
        """Read every group into a pandas DataFrame; see Columns.to_pandas, which reads one."""
        return {name: columns.to_pandas() for name, columns in self._groups.items()}


def open(path: str | os.PathLike[str]) -> Run:  # noqa: A001  (rubnoise.open reads like h5py.File)
    """Open a result file for reading, its structure alone, however long the run.

    Raises RunFileRefused if it is not a result of rubnoise, is damaged, or is a part that a killed run has left.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     print(run.scenario.title, run.trace["distance"][:3], run.trace["distance"].units)
    Figure 5: excitation force and vibration [0.  0.1 0.2] um
    """
    try:
        return Run(open_run(path))
    except RunFileRefused as refused:
        from rubnoise.scenario.layers import shipped_names

        if str(path) in shipped_names() or "is a scenario" in str(refused):
            calls = f'rubnoise.load("{path}") reads it, rubnoise.simulate("{path}") runs it'
            raise RunFileRefused(f"{path}: is a scenario, not a result; {calls}") from None
        raise

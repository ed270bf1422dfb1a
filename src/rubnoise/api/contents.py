"""What a result holds, whether it lies in a file or in memory."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from operator import index
from typing import TYPE_CHECKING

from rubnoise.api.columns import Columns
from rubnoise.api.junction import Junction
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import needing
from rubnoise.record.rows import JunctionState

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]
    import xarray as xr


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

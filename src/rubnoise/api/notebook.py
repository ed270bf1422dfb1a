"""How objects of Python show themselves, as text and in notebooks, and types of libraries that are loaded on demand."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rubnoise.tables import as_html, as_text, shortened

if TYPE_CHECKING:
    from pandas import DataFrame  # type: ignore[import-untyped]
    from xarray import Dataset, DataTree
else:
    DataFrame = Dataset = DataTree = Any

__all__ = ["DataFrame", "DataTree", "Dataset", "Displayed", "Overview"]

Overview = tuple[str, Sequence[str], Sequence[Sequence[str]], Sequence[str]]  # heading, names of columns, rows, remarks


class Displayed(ABC):
    """An object that shows itself by its overview."""

    @abstractmethod
    def _overview(self) -> Overview:
        """Return what is shown."""

    def __repr__(self) -> str:
        heading, names, rows, remarks = self._overview()
        lines = as_text([""] * len(names), rows) if rows else []
        return shortened([heading, *(f"  {line}" for line in (*remarks, *lines))])

    def _repr_html_(self) -> str:
        heading, names, rows, remarks = self._overview()
        return as_html(heading, names, rows, "\n".join(remarks))

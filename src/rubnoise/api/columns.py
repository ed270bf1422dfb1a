"""Columns: numpy arrays that know their name, unit and meaning."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rubnoise.arrays import CHUNK_ROWS, slices
from rubnoise.storage.schema import Dataset

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SHOWN_WHOLE = 4
"""Rows of a column that are all shown; of a longer one, the first three and the last."""

Place = Callable[[], "Column"]
"""Returns the column over which another one is drawn."""


class Column(np.ndarray[Any, np.dtype[Any]]):
    """One column of a result: a numpy array with ``name``, ``units``, ``long_name`` and ``symbol``.

    Slices, chosen rows, sorted and other copies, and pickles of it have them, too; anything else that is computed from
    it, such as ``2 * column`` or ``column.argsort()``, has none. ``run.trace["distance"]`` reads the column each time,
    or maps it if it has more than 64 MB, so keep it for a loop. It may be changed: the run remains as it is.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     area = run.trace["real_contact_area"]
    ...     area.units, len(area), area[:3].shape
    ('um^2', 200001, (3,))
    """

    about: Dataset | None = None
    _place: Place | None = None

    def __new__(cls, values: NDArray[Any], about: Dataset, place: Place | None = None) -> Self:
        """Take an array, its description, and what returns the column over which it is drawn."""
        self = np.asarray(values).view(cls)
        self.about, self._place = about, place
        return self

    def _described(self, values: NDArray[Any], place: Place | None) -> "Column":
        return values if self.about is None else Column(values, self.about, place)  # type: ignore[return-value]

    def __getitem__(self, index: Any) -> Any:
        """Return a number, or rows with their unit."""
        found = super().__getitem__(index)
        if not isinstance(found, np.ndarray):
            return found
        place = self._place if found.ndim == self.ndim else None
        return self._described(found, None if place is None else partial(_rows_of, place, index))

    def copy(self, order: Any = "C") -> "Column":
        """Return a copy with its unit."""
        return self._described(super().copy(order), self._place)

    def __copy__(self) -> "Column":
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any] | None = None, /) -> "Column":
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        values = np.asarray(self)
        return (np.asarray, (values,)) if self.about is None else (Column, (values, self.about))

    def sort(self, *given: Any, **named: Any) -> None:
        """Sort the rows in place, which then belong to no place any more."""
        super().sort(*given, **named)
        self._place = None

    def __array_wrap__(self, found: Any, context: Any = None, return_scalar: bool = False) -> Any:  # noqa: FBT001, FBT002
        """Return what is computed as a plain array or number (numpy's protocol)."""
        return found[()] if return_scalar else np.asarray(found)

    def _say(self, what: str) -> str:
        if self.about is None:
            raise AttributeError(f"an array that was computed from a column has no {what}", name=what, obj=self)
        return str(getattr(self.about, what))

    @property
    def name(self) -> str:
        """The name in its group; raises AttributeError, as the ones below, for what was computed from a column."""
        return self._say("name")

    @property
    def units(self) -> str:
        """The unit, such as "um^2"."""
        return self._say("units")

    @property
    def long_name(self) -> str:
        """The meaning in words."""
        return self._say("long_name")

    @property
    def symbol(self) -> str:
        """The symbol in equations."""
        return self._say("symbol")

    @property
    def label(self) -> str:
        """Meaning and unit, for an axis."""
        return f"{self.long_name or self.name} ({self.units})"

    @property
    def beside(self) -> "Column | None":
        """The same rows of the first column of its group, over which it is drawn; None if it has none."""
        return None if self._place is None else self._place()

    @property
    def attributes(self) -> dict[str, Any]:
        """Unit, meaning, symbol and flags, as the dataset in the file has them."""
        self._say("units")  # what was computed has none
        said = {} if self.about is None else self.about.attributes
        return {name: value for name, value in said.items() if not isinstance(value, str) or value}

    @property
    def values(self) -> NDArray[Any]:
        """The rows as a plain array, under the name that pandas and xarray use."""
        return np.asarray(self)

    def to_numpy(self, dtype: DTypeLike | None = None, *, copy: bool = True) -> NDArray[Any]:  # noqa: ARG002
        """Return a plain array, of another type if one is given (``copy`` is always true)."""
        return np.array(self, dtype=dtype)

    def chunks(self, rows: int = CHUNK_ROWS) -> Iterator["Column"]:
        """Yield the column as arrays of ``rows`` rows, the last one shorter."""
        for part in slices(0, self.shape[0], rows):
            yield self[part]

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the column over the first one of its group, or over its rows, and return the figure, that of ``ax``."""
        from rubnoise.api.pictures import drawn_columns

        place = self.beside
        along = (np.arange(self.size), "row") if place is None else (place.values, place.label)
        return drawn_columns(along, [(self.values, self.label)], ax)

    def __repr__(self) -> str:
        if self.about is None or self.ndim != 1:
            return repr(np.asarray(self))
        unit = f" ({self.units})" if self.units else ""
        text = f"{self.name}{unit}, {self.size:,} rows of {'text' if self.dtype.kind == 'U' else self.dtype}"
        if self.size <= SHOWN_WHOLE:
            return f"<{text}: {' '.join(map(_short, self))}>"
        return f"<{text}: {' '.join(map(_short, self[:3]))} ... {_short(self[-1])}>"


def with_units(values: NDArray[Any], name: str, units: str, long_name: str = "") -> Column:
    """Return an array as a column of which no more is known than its name, its unit and perhaps its meaning."""
    return Column(values, Dataset(name=name, units=units, symbol="", long_name=long_name))


def _rows_of(place: Place, index: Any) -> Column:
    rows: Column = place()[index]
    return rows


def _short(value: Any) -> str:
    """Return a number with six digits, or the beginning of a text."""
    return f"{value:.40}" if isinstance(value, str) else f"{value:.6g}"

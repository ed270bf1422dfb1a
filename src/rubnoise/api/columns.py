"""Columns: numpy arrays that know their name, unit and meaning."""

from collections.abc import Callable, Iterator
from typing import Any, Self

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rubnoise.arrays import CHUNK_ROWS, slices
from rubnoise.figures import Axes, Figure
from rubnoise.storage.schema import Dataset

SHOWN_WHOLE = 4  # rows of a column that are all shown; of a longer one, the first three and the last
Place = Callable[[], "Column"]  # returns the column over which another one is drawn


def _said(what: str, meaning: str) -> Any:
    """Return a property that says what is known of a column."""

    def say(column: "Column") -> str:
        if column.about is None:
            raise AttributeError(f"an array that was computed from a column has no {what}", name=what, obj=column)
        return str(getattr(column.about, what))

    return property(say, doc=meaning)


class Column(np.ndarray[Any, np.dtype[Any]]):
    """One column of a result: a numpy array with ``name``, ``units``, ``long_name`` and ``symbol``.

    Slices, chosen rows, sorted and other copies, and pickles of it have them, too; anything else that is computed from
    it, such as ``2 * column`` or ``column.argsort()``, has none. ``run.trace["distance"]`` reads the column each time,
    or maps it if it has more than 64 MB, so keep it for a loop. It may be changed: the run remains as it is.
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
        return self._described(found, None if place is None else lambda: place()[index])

    def copy(self, order: Any = "C") -> "Column":
        """Return a copy with its unit."""
        return self._described(super().copy(order), self._place)

    def __deepcopy__(self, *_memo: Any) -> "Column":
        return self.copy()

    __copy__ = __deepcopy__

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

    name: str = _said("name", "The name in its group; raises AttributeError, as the ones below, for what was computed.")
    units: str = _said("units", 'The unit, such as "um^2".')
    long_name: str = _said("long_name", "The meaning in words.")
    symbol: str = _said("symbol", "The symbol in equations.")

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
        rows = [f"{each:.40}" if isinstance(each, str) else f"{each:.6g}" for each in (*self[:3], *self[3:][-1:])]
        return f"<{text}: {' '.join([*rows[:3], *(['...'] if self.size > SHOWN_WHOLE else []), *rows[3:]])}>"


def with_units(values: NDArray[Any], name: str, units: str, long_name: str = "") -> Column:
    """Return an array as a column of which no more is known than its name, its unit and perhaps its meaning."""
    return Column(values, Dataset(name=name, units=units, symbol="", long_name=long_name))

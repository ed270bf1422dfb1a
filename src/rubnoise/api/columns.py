"""Columns of a result: arrays that read rows when they are needed."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from inspect import signature
from math import sqrt
from types import EllipsisType
from typing import TYPE_CHECKING, Any, Final, SupportsIndex, overload

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import DTypeLike, NDArray

from rubnoise.arrays import CHUNK_ROWS, chunk_of_steps, slices
from rubnoise.errors import RunFileRefused
from rubnoise.record.tally import Moments
from rubnoise.storage import schema

if TYPE_CHECKING:
    from matplotlib.figure import Figure

READ_AT_ONCE: Final = 4
Read = Callable[[int, int], NDArray[Any]]
"""Returns rows start to stop of a column; of a run in memory these are the run's own, and read-only."""


class Column(NDArrayOperatorsMixin):
    """One column of a result: an array that is read when it is needed, and no farther.

    ``column[:100]`` reads a hundred rows and returns a numpy array. ``numpy.asarray(column)``, ``values``, arithmetic,
    comparisons, ufuncs, matplotlib, scipy, pandas and polars read all of it. ``sum``, ``mean``, ``std``, ``var``,
    ``min``, ``max`` (and ``numpy.mean(column)`` and so on) and iteration read it in pieces, so that they need no more
    memory for a longer run. After the run is closed, reading raises ValueError; what was read stays, and may be
    changed: the run remains as it is.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     area = run.trace["real_contact_area"]
    ...     area.units, len(area), area[:3].shape
    ('um^2', 200001, (3,))
    """

    ndim = 1

    def __init__(self, about: schema.Dataset, rows: int, read: Read) -> None:
        """Take the number of rows, and the function ``read`` that reads them."""
        self.name = about.name
        self.units = about.units
        self.long_name = about.long_name
        self.symbol = about.symbol
        self.about = about
        self.dtype: np.dtype[Any] = np.dtype(about.dtype)
        self._coded = about.coded
        self._rows = rows
        self._read = read
        self.beside: Column | None = None

    def plot(self) -> "Figure":
        """Draw the column over the first one of its group, or over its rows, and return the figure."""
        from rubnoise.api.pictures import drawn_columns

        place = self if self.beside is None else self.beside
        if place is self:
            along: tuple[NDArray[Any], str] = (np.arange(self._rows), "row")
        else:
            along = (place[:], f"{place.long_name} ({place.units})")
        return drawn_columns(along, [(self[:], f"{self.long_name} ({self.units})")])

    def __len__(self) -> int:
        return self._rows

    @property
    def shape(self) -> tuple[int]:
        """The shape of numpy: the number of rows, in a tuple."""
        return (self._rows,)

    @property
    def size(self) -> int:
        """The number of rows."""
        return self._rows

    @property
    def attributes(self) -> dict[str, Any]:
        """Unit, meaning, symbol and flags, as the dataset in the file has them."""
        attributes: dict[str, Any] = {"units": self.units, "long_name": self.long_name, "symbol": self.symbol}
        attribute, codes = self._coded
        if codes:
            attributes[attribute] = np.array([number for number, _ in codes], dtype=self.dtype)
            attributes["flag_meanings"] = " ".join(meaning for _, meaning in codes)
        return attributes

    @property
    def values(self) -> NDArray[Any]:
        """All rows as a numpy array, under the name that pandas and xarray use."""
        return self[:]

    def to_numpy(self, dtype: DTypeLike | None = None, *, copy: bool = False) -> NDArray[Any]:  # noqa: ARG002
        """Read all rows into a new numpy array, of another type if one is given (``copy`` is always true)."""
        return np.asarray(self, dtype=dtype)

    def astype(self, dtype: DTypeLike) -> NDArray[Any]:
        """Read all rows into a numpy array of a type."""
        return self.to_numpy(dtype)

    def tolist(self) -> list[Any]:
        """Read all rows into a list of Python's numbers."""
        return self[:].tolist()

    @overload
    def __getitem__(self, index: slice | Sequence[int] | NDArray[Any] | EllipsisType | None) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, index: Any) -> Any: ...
    def __getitem__(self, index: Any) -> Any:
        """Return a number, or the rows of a slice, list, mask or tuple of these, as numpy does; read no other rows.

        Raises IndexError if numpy does.
        """
        if isinstance(index, tuple) or index is None or index is Ellipsis:
            return self._shaped(index if isinstance(index, tuple) else (index,))
        if isinstance(index, slice):
            return self._sliced(*index.indices(self._rows))
        if isinstance(index, SupportsIndex) and not isinstance(index, bool | np.ndarray):
            return self._row(index.__index__())
        return self._picked(np.asarray(index))

    def __iter__(self) -> Iterator[Any]:
        """Yield every number, reading chunk by chunk."""
        for chunk in self._chunks():
            yield from chunk

    def taken(self, rows: NDArray[np.int64]) -> "Column":
        """Return a column of chosen rows, in ascending order, which are read when they are needed."""
        return Column(self.about, rows.size, RowsOfColumn(self, rows))

    @property
    def is_chosen(self) -> bool:
        """Whether it has only chosen rows of another column, whose numbers then do not count from 0."""
        return isinstance(self._read, RowsOfColumn)

    def chunks(self, rows: int = CHUNK_ROWS) -> Iterator[NDArray[Any]]:
        """Yield the column as arrays of ``size`` rows, the last one shorter."""
        for chunk in self._chunks(rows):
            yield _own(chunk)

    def _chunks(self, rows: int | None = None) -> Iterator[NDArray[Any]]:
        """Yield the same arrays, which the caller must not change."""
        for part in slices(0, self._rows, rows):
            yield self._read(part.start, part.stop)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:  # noqa: FBT001
        """Read the whole column (numpy's protocol)."""
        if copy is False:
            raise ValueError(f"{self.name} is read from its file; there is no array to share")
        return self[:].astype(self.dtype if dtype is None else dtype, copy=False)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Read the whole column if arithmetic needs it (numpy's protocol)."""
        written = inputs[:1] if method == "at" else options.get("out", ())
        if any(isinstance(each, Column) for each in written):
            return NotImplemented
        looked_at = (each._read(0, len(each)) if isinstance(each, Column) else each for each in inputs)  # noqa: SLF001
        return getattr(ufunc, method)(*looked_at, **options)

    def __array_function__(self, function: Any, _types: Any, arguments: Any, options: Mapping[str, Any]) -> Any:
        """Read the whole column if one of numpy's functions needs it (numpy's protocol)."""
        if function in IN_PIECES and arguments and arguments[0] is self and len(arguments) == 1:
            reduction = getattr(self, IN_PIECES[function])
            if options.keys() <= set(signature(reduction).parameters):
                return reduction(**options)
        return function(*map(_as_arrays, arguments), **{name: _as_arrays(value) for name, value in options.items()})

    def sum(self) -> Any:
        """Return the sum; 0 without rows."""
        return sum((chunk.sum() for chunk in self._chunks()), start=self.dtype.type(0))

    def mean(self) -> float:
        """Return the mean; nan without rows."""
        return self._moments().mean if self._rows else float("nan")

    def var(self, ddof: float = 0) -> float:
        """Return the variance about the mean, over the number of rows less ``ddof``; nan without so many rows."""
        if self._rows <= ddof:
            return float("nan")
        return self._moments().variance * self._rows / (self._rows - ddof)

    def std(self, ddof: float = 0) -> float:
        """Return the standard deviation about the mean, over the number of rows less ``ddof``; nan without so many."""
        return sqrt(self.var(ddof))

    def min(self) -> Any:
        """Return the smallest number; raises ValueError without rows."""
        return min(chunk.min() for chunk in self._chunks())

    def max(self) -> Any:
        """Return the largest number; raises ValueError without rows."""
        return max(chunk.max() for chunk in self._chunks())

    def __repr__(self) -> str:
        unit = f" ({self.units})" if self.units else ""
        text = f"{self.name}{unit}, {self._rows:,} rows of {'text' if self.dtype.kind == 'U' else self.dtype}"
        try:
            few = self._rows <= READ_AT_ONCE
            values = " ".join(map(_short, self[: None if few else 3]))
            return f"<{text}: {values}>" if few else f"<{text}: {values} ... {_short(self[-1])}>"
        except ValueError:
            return f"<{text}: closed>"
        except RunFileRefused as refused:
            return f"<{text}: {refused}>"

    def _moments(self) -> Moments:
        moments = Moments(powers=2)
        for chunk in self._chunks():
            moments.add_plain(chunk.astype(np.float64, copy=False))
        return moments

    def _shaped(self, index: tuple[Any, ...]) -> NDArray[Any]:
        """Return rows with axes of length 1 where a tuple holds None, such as ``column[:, None]``."""
        chosen = [each for each in index if each is not None and each is not Ellipsis]
        if len(chosen) > 1:
            raise IndexError(f"too many indices: {self.name} has one dimension, and {len(chosen)} were given")
        if sum(each is Ellipsis for each in index) > 1:
            raise IndexError("an index can only have a single ellipsis ('...')")
        if len(index) == len(chosen) == 1:
            return self[chosen[0]]
        # The rows stand where they are chosen; if they are not, at the ellipsis, or else behind all.
        rows = np.asarray(self[chosen[0]] if chosen else self[:])
        places = [each for each in index if each is None or not chosen or each is not Ellipsis]
        places = places if any(each is not None for each in places) else [*places, Ellipsis]
        return rows[tuple(None if each is None else Ellipsis for each in places)]

    def _row(self, number: int) -> Any:
        row = number + self._rows if number < 0 else number
        if not 0 <= row < self._rows:
            raise IndexError(f"row {number}: {self.name} has {self._rows} rows")
        return self._read(row, row + 1)[0]

    def _sliced(self, start: int, stop: int, step: int) -> NDArray[Any]:
        if step < 0:
            rows = range(start, stop, step)
            return self._sliced(rows[-1], rows[0] + 1, -step)[::-1] if rows else self._sliced(0, 0, 1)
        if step == 1:
            return _own(self._read(start, max(start, stop)))
        # Steps wider than a chunk touch single rows; narrower ones pick from chunks that hold a whole number of steps.
        span = chunk_of_steps(step)
        width = span if step <= CHUNK_ROWS else 1
        parts = [self._read(first, min(first + width, stop))[::step] for first in range(start, stop, span)]
        return np.concatenate(parts) if parts else self._sliced(0, 0, 1)

    def _picked(self, index: NDArray[Any]) -> NDArray[Any]:
        """Return chosen rows, from the shortest stretch that has all of them."""
        if not index.size:
            return self._sliced(0, 0, 1)
        if index.dtype == np.bool_:
            return self._masked(index)
        if not np.issubdtype(index.dtype, np.integer):
            raise IndexError(f"{self.name} has rows, numbered 0 to {self._rows - 1}; {index.dtype} is no row number")
        rows = np.where(index < 0, index + self._rows, index)
        low, high = int(rows.min()), int(rows.max())
        if low < 0 or high >= self._rows:
            raise IndexError(f"rows {low} to {high}: {self.name} has {self._rows} rows")
        picked: NDArray[Any] = self._read(low, high + 1)[rows - low]
        return picked

    def _masked(self, mask: NDArray[np.bool_]) -> NDArray[Any]:
        """Return the rows that a mask chooses, from the chunks that have any."""
        if mask.shape != self.shape:
            raise IndexError(
                f"a mask of shape {mask.shape} chooses no rows of {self.name}, which has {self._rows} rows"
            )
        parts = [self._read(part.start, part.stop)[mask[part]] for part in slices(0, self._rows) if mask[part].any()]
        return np.concatenate(parts) if parts else self._sliced(0, 0, 1)


@dataclass(frozen=True, slots=True, eq=False)
class RowsOfColumn:
    """Reads rows of a column that were chosen, in ascending order."""

    column: Column
    rows: NDArray[np.int64]

    def __call__(self, start: int, stop: int) -> NDArray[Any]:
        """Return the chosen rows ``start`` to ``stop``, read chunk by chunk, since they may be far apart."""
        chosen = self.rows[start:stop]
        parts = np.split(chosen, np.flatnonzero(np.diff(chosen // CHUNK_ROWS)) + 1)
        return np.concatenate([self.column[part] for part in parts])


Sequence.register(Column)  # for libraries that take an array or a sequence, such as polars

IN_PIECES: Final[Mapping[Any, str]] = {
    np.sum: "sum",
    np.mean: "mean",
    np.var: "var",
    np.std: "std",
    np.min: "min",
    np.max: "max",
}
"""Functions of numpy that need not hold a whole column."""


def _own(values: NDArray[Any]) -> NDArray[Any]:
    """Return rows that the caller may change: those read from a file, or a copy of the rows of a run in memory."""
    return values if values.base is None and values.flags.writeable else values.copy()


def _short(value: Any) -> str:
    """Return a number with six digits, or the beginning of a text."""
    return f"{value:.40}" if isinstance(value, str) else f"{value:.6g}"


def _as_arrays(value: Any) -> Any:
    """Return a value in which every column, also in a list, is replaced by an array."""
    if isinstance(value, list | tuple):
        return type(value)(map(_as_arrays, value))
    return value[:] if isinstance(value, Column) else value

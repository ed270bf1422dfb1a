"""Measurements of the user's own: records that are uniform in time or distance, read from a file and checked."""

import csv
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from io import StringIO
from math import isfinite
from numbers import Real
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.analysis.covariance import autocovariance
from rubnoise.analysis.histogram import BINS, Histogram, histogram
from rubnoise.analysis.records import RecordTooShort
from rubnoise.api import keywords
from rubnoise.api.estimates import Autocovariance, PowerSpectrum, power_spectrum
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused, needing
from rubnoise.regular_file import open_stream
from rubnoise.tables import as_html, shortened
from rubnoise.units import KINDS, QuantityError, Unit, parse_unit

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]

WORKING: Final[Mapping[tuple[int, ...], str]] = MappingProxyType(
    {
        (1, 0, 0): "um",
        (2, 0, 0): "um^2",
        (1, 0, -1): "um/s",
        (0, 0, 1): "s",
        (1, 1, -2): "uN",
        (-1, 1, -2): "MPa",
        (0, 1, 0): "kg",
    }
)
"""Working units by their powers of length, mass and time."""

ENDINGS: Final = ("um_per_s", "um2", "um", "uN", "MPa", "s")
"""Units at the end of names, as `rubnoise export --to csv` writes them."""

LARGEST_FILE: Final = 2 * 1024**3
UNEVEN: Final = 0.01
"""How far the steps of a record may differ, relative to their mean, beyond what the digits of its places leave open."""

_HEADER: Final = re.compile(r"(?P<name>[^()\[\]]+?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\[\]]*)\])?")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """Columns over a uniform ``place``, such as a time in s or a sliding distance in um.

    ``columns`` are arrays by name and ``units`` their units, the place among them; ``step`` is the spacing of places.
    Lengths, areas, speeds, forces, stresses, masses and times are converted to um, um^2, um/s, uN, MPa, kg and s; other
    units, such as V, stay as they are. `from_csv` reads a trace from a file, `from_arrays` makes one.

    >>> import rubnoise
    >>> measured = rubnoise.Trace.from_arrays({"time (s)": [0.0, 0.1, 0.2], "velocity (mm/s)": [1.0, 2.0, 1.5]})
    >>> measured["velocity"], measured.units["velocity"]
    (array([1000., 2000., 1500.]), 'um/s')
    """

    name: str
    place: str
    step: float
    columns: Mapping[str, Doubles] = field(repr=False)
    units: Mapping[str, str] = field(repr=False)

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str], *, place: str | None = None) -> Self:
        """Read a file of one header line and a row of numbers per line, separated by commas, semicolons or tabs.

        A header is ``NAME (UNIT)``, ``NAME [UNIT]`` or, as `rubnoise export` writes it, ``NAME_UNIT``; without a unit a
        column is a plain number. Lines that begin with # are comments. ``place`` names the column of times or
        distances, which must be uniform; the default is the first column. Raises Refused, with the line, for a cell
        that is no finite number, for an unknown unit, and for gaps and uneven steps.
        """
        names, rows, lines, decimals = _cells(path)
        return cls._of(str(path), names, rows.T, place, lines=lines, resolution=decimals)

    @classmethod
    def from_arrays(cls, columns: Mapping[str, ArrayLike], *, place: str | None = None, name: str = "<python>") -> Self:
        """Make a trace of arrays of equal length, with headers as names; raises Refused as `from_csv` does."""
        arrays = [np.asarray(values, dtype=np.float64) for values in columns.values()]
        if not arrays or any(each.shape != (arrays[0].size,) for each in arrays):
            raise Refused(f"{name}: a trace needs columns of equal length, each of one dimension")
        for header, each in zip(columns, arrays, strict=True):
            if not np.isfinite(each).all():
                row = int(np.argmin(np.isfinite(each)))
                raise Refused(f"{name}: {header}: row {row} is {each[row]}; every value must be a finite number")
        return cls._of(name, list(columns), arrays, place)

    @classmethod
    def _of(
        cls,
        source: str,
        headers: Sequence[str],
        arrays: Iterable[Doubles],
        place: str | None,
        *,
        lines: Sequence[int] | None = None,
        resolution: Mapping[str, float] | None = None,
    ) -> Self:
        columns: dict[str, Doubles] = {}
        units: dict[str, str] = {}
        found: dict[str, str] = {}
        for header, values in zip(headers, arrays, strict=True):
            name, unit = _named(header)
            if name in columns:
                raise Refused(f"{source}: two columns are named {name}")
            units[name], factor = _in_working_units(unit, f"{source}: {header}")
            columns[name], found[name] = factor * np.ascontiguousarray(values), header
        chosen = next(iter(columns)) if place is None else place
        if chosen not in columns:
            raise Refused(f"{source}: no column {chosen}; it has {', '.join(columns)}")
        finest = (resolution or {}).get(found[chosen], 0.0) * _in_working_units(_named(found[chosen])[1], source)[1]
        step = _step(columns[chosen], f"{source}: {found[chosen]}", units[chosen], lines, finest)
        return cls(
            name=source, place=chosen, step=step, columns=MappingProxyType(columns), units=MappingProxyType(units)
        )

    def __getitem__(self, name: str) -> Doubles:
        """Return a column; raises KeyError with the names there are."""
        if name not in self.columns:
            raise KeyError(f"{self.name} has no column {name!r}; it has {', '.join(self.columns)}")
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return int(self.columns[self.place].size)

    def psd(self, name: str | None = None, *, segment: Any = None) -> PowerSpectrum:
        """Return Welch's estimate of the spectrum of a column; see PowerSpectrum.

        ``segment`` is the length of a segment with its unit, such as "0.5 s"; by default there are some 64 segments. Of
        a trace with one column beside the place, that one is meant. Raises Refused for a length without a unit, and for
        a record or a segment of fewer than 8 rows.
        """
        chosen = self._column(name)
        return power_spectrum(
            chosen,
            self.units[chosen],
            [self.columns[chosen]],
            rows=len(self),
            step=self.step,
            place_units=self.units[self.place],
            segment=self._length("segment", segment),
        )

    def acf(self, name: str | None = None, *, longest: Any = None) -> Autocovariance:
        """Return the autocovariance of a column at lags up to ``longest``, such as "0.1 s"; by default a tenth of it.

        R_j = (1/n) sum of (x_i - mean)(x_(i+j) - mean). Raises Refused for a lag that the record does not have, and for
        one without a unit.
        """
        chosen, units = self._column(name), self.units[self.place]
        lag = self._length("longest", longest)
        reach = max(1, len(self) // 10) if lag is None else round(lag / self.step)
        if not 0 < reach < len(self):
            most = (len(self) - 1) * self.step
            raise Refused(
                f"{self.name}: longest=: {keywords.shown(longest)}: the record has lags up to {most:.6g} {units}"
            )
        return Autocovariance(
            name=chosen,
            lag=self.step * np.arange(reach + 1, dtype=np.float64),
            lag_units=units,
            covariance=autocovariance(self.columns[chosen], reach),
            units=f"({self.units[chosen]})^2",
        )

    def histogram(self, name: str | None = None, *, bins: ArrayLike | int = BINS) -> Histogram:
        """Return the density of a column over bins: their number or their edges, in the unit of the column.

        Its ``standard_error`` knows that neighbouring rows are not independent; it is inf for a record too short to
        tell. Raises ValueError for edges that do not rise.
        """
        values = self.columns[self._column(name)]
        try:
            return histogram(values, self.step, bins)
        except RecordTooShort as short:
            if isinstance(short.estimate, Histogram):
                return short.estimate
            raise

    def to_pandas(self) -> "pd.DataFrame":
        """Return a DataFrame over the place, its units in ``frame.attrs["units"]``; else raises ExtraMissing."""
        with needing("analysis", "to_pandas"):
            import pandas as pd
        rest = {name: values for name, values in self.columns.items() if name != self.place}
        frame = pd.DataFrame(rest, index=pd.Index(self.columns[self.place], name=self.place))
        frame.attrs["units"] = dict(self.units)
        return frame

    def _length(self, keyword: str, value: Any) -> float | None:
        """Return a length along the place; a number where the place has no unit that is known here."""
        kind = next((each for each in KINDS if each.unit == self.units[self.place]), None)
        if kind is not None:
            return keywords.quantity(keyword, value, kind)
        if value is not None and (isinstance(value, bool) or not isinstance(value, Real) or not isfinite(value)):
            raise Refused(f"{keyword}=: {keywords.shown(value)}: a number is needed, {self.place} has no unit")
        return None if value is None else float(value)

    def _column(self, name: str | None) -> str:
        others = [each for each in self.columns if each != self.place]
        if name is None and len(others) == 1:
            return others[0]
        if name in others and name is not None:
            return name
        raise Refused(f"{self.name}: say which column: {', '.join(others)}" + (f", not {name}" if name else ""))

    def __repr__(self) -> str:
        units = self.units[self.place]
        head = f"{self.name}: {len(self):,} rows, every {self.step:.6g} {units}"
        rows = [f"  {name}  {self.units[name]}  {_range(values)}" for name, values in self.columns.items()]
        return shortened([head, *rows])

    def _repr_html_(self) -> str:
        head = f"{self.name}: {len(self):,} rows, every {self.step:.6g} {self.units[self.place]}"
        rows = [(name, self.units[name], _range(values)) for name, values in self.columns.items()]
        return as_html(head, ("column", "unit", "range"), rows)


def _range(values: Doubles) -> str:
    return f"{values.min():.6g} to {values.max():.6g}"


def _named(header: str) -> tuple[str, str]:
    """Return name and unit of a header; a plain number has the unit 1."""
    text = header.strip().strip('"').strip()
    found = _HEADER.fullmatch(text)
    if found is None:
        return text, "1"
    unit = found["round"] if found["round"] is not None else found["square"]
    if unit is not None:
        return found["name"].strip(), unit.strip() or "1"
    for ending in ENDINGS:
        if text.endswith(f"_{ending}"):
            return text.removesuffix(f"_{ending}"), ending.replace("_per_", "/").replace("um2", "um^2")
    return text, "1"


def _in_working_units(unit: str, what: str) -> tuple[str, float]:
    """Return the working unit of a unit, and how many of it that unit is; a unit of another kind stays as it is."""
    if unit in ("1", "-"):
        return "1", 1.0
    try:
        read: Unit = parse_unit(unit)
    except QuantityError as problem:
        if re.fullmatch(r"[A-Za-z\u00b5\u03bc\u2126%][^,;]{0,39}", unit) and "unknown unit" in str(problem):
            return unit, 1.0  # a volt, say: no unit of this model, and kept as it is
        raise Refused(f"{what}: {problem}" + (f" ({problem.hint})" if problem.hint else "")) from None
    working = WORKING.get(tuple(read.dimension))
    if working is None:
        return unit, 1.0
    return working, float(read.size / parse_unit(working).size)


def _step(places: Doubles, what: str, units: str, lines: Sequence[int] | None, resolution: float) -> float:
    """Return the step of places that are uniform; raises Refused, naming the first gaps, where they are not."""
    if places.size < 2:
        raise Refused(f"{what}: {places.size} rows; a trace has two or more")
    steps = np.diff(places)
    usual = float(np.median(steps))
    if not usual > 0.0:
        row = int(np.argmin(steps > 0.0))
        raise Refused(f"{what}: must rise from row to row; it falls or stays at {_where(row + 1, lines)}")
    wrong = np.flatnonzero(~((0.5 * usual < steps) & (steps < 1.5 * usual)))
    if wrong.size:
        examples = "; ".join(
            f"{_where(row + 1, lines)}: {steps[row]:.6g} {units} after the row before" for row in wrong[:3].tolist()
        )
        more = f"; and {wrong.size - 3:,} more" if wrong.size > 3 else ""
        raise Refused(
            f"{what}: not uniform: {wrong.size:,} of {steps.size:,} steps are not {usual:.6g} {units}: {examples}{more}"
        )
    mean = float(places[-1] - places[0]) / (places.size - 1)
    allowed = UNEVEN * mean + 2.0 * resolution
    if float(np.abs(steps - mean).max()) > allowed:
        row = int(np.argmax(np.abs(steps - mean)))
        raise Refused(
            f"{what}: not uniform: the step to {_where(row + 1, lines)} is {steps[row]:.6g} {units}, the mean is"
            f" {mean:.6g}; interpolate onto equal steps first"
        )
    return mean


def _where(row: int, lines: Sequence[int] | None) -> str:
    return f"row {row}" if lines is None else f"line {lines[row]}"


def _cells(path: str | os.PathLike[str]) -> tuple[list[str], Doubles, list[int], dict[str, float]]:
    """Return the headers of a file, its numbers row by row, their lines, and the last digit of each column."""
    try:
        with open_stream(path) as stream:
            content = stream.read(LARGEST_FILE + 1)
    except OSError as problem:
        raise Refused(f"{path}: {(problem.strerror or str(problem)).lower()}") from problem
    if len(content) > LARGEST_FILE:
        raise Refused(f"{path}: larger than {LARGEST_FILE // 1024**3} GB")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise Refused(f"{path}: not UTF-8 text (at byte {problem.start})") from None
    kept = [
        (n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(kept) < 2:
        raise Refused(f"{path}: needs a line of headers and rows of numbers below it")
    separator = max(",;\t", key=kept[0][1].count)
    headers = next(csv.reader(StringIO(kept[0][1]), delimiter=separator))
    lines = [n for n, _ in kept[1:]]
    rows = np.empty((len(lines), len(headers)))
    for at, (line, cells) in enumerate(
        zip(lines, csv.reader((text for _, text in kept[1:]), delimiter=separator), strict=True)
    ):
        if len(cells) != len(headers):
            raise Refused(f"{path}: line {line}: {len(cells)} cells below {len(headers)} headers")
        for column, cell in enumerate(cells):
            rows[at, column] = _number(cell, separator, f"{path}: line {line}: {headers[column].strip()}")
    return headers, rows, lines, _resolutions(headers, kept[1][1].split(separator), kept[-1][1].split(separator))


def _number(cell: str, separator: str, what: str) -> float:
    text = cell.strip()
    if separator != "," and text.count(",") == 1 and "." not in text:
        text = text.replace(",", ".")  # 0,5 in a file whose cells a semicolon separates
    try:
        value = float(text)
    except ValueError:
        raise Refused(f"{what}: {'is empty' if not text else f'{text[:40]!r} is no number'}") from None
    if not isfinite(value):
        raise Refused(f"{what}: {text[:40]!r} is no finite number; interpolate or cut such rows first")
    return value


def _resolutions(headers: Sequence[str], *rows: Sequence[str]) -> dict[str, float]:
    """Return the size of the last digit of each column, from some rows as written; 0 where they are rounded nowhere."""
    found: dict[str, float] = {}
    for header, *cells in zip(headers, *rows, strict=True):
        digits = [re.fullmatch(r"\s*[+-]?\d*[.,]?(\d*)(?:[eE]([+-]?\d+))?\s*", cell) for cell in cells]
        sizes = [10.0 ** (int(each[2] or 0) - len(each[1])) for each in digits if each is not None]
        found[header] = max(sizes, default=0.0)
    return found

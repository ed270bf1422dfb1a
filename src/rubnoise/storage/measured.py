"""Measured traces in files of other programs: text, WAV, MATLAB 5, and any dataset of an HDF5 or netCDF file.

HDF5 is read in the sandbox. What a file does not say, unit or rate, has to be given.
"""

import csv
import json
import os
import re
import sys
import threading
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from io import TextIOWrapper
from itertools import chain
from pathlib import Path
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.regular_file import open_regular, open_stream, read_at_most
from rubnoise.units import LENGTH, TIME, QuantityError, parse_unit

LARGEST: Final = 2 * 1024**3
"""Bytes of a file of text, sound or MATLAB."""

MOST_VALUES: Final = 100_000_000
"""Of a dataset of another program's HDF5 file."""

_ROUNDED: Final = 0.01
_PIECE_BYTES: Final = 4 * 1024**2  # of text
_PIECE_VALUES: Final = 1 << 21  # of a dataset: it and its scale go down the pipe of the sandbox

UNEVEN: Final = 0.01
"""How far one step between samples may be from the mean step, in parts of it, beyond the digits that are written."""

_PLACES: Final = {"time": "s", "t": "s", "distance": "um", "position": "um"}
ENDINGS: Final = {"_um_per_s": "um/s", "_um2": "um^2", "_um": "um", "_uN": "uN", "_MPa": "MPa", "_s": "s"}
_HEADER: Final = re.compile(r"(?P<name>[^()\[\]]+?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\[\]]*)\])")
_HDF5: Final = b"\x89HDF"
_PROGRAM: Final = "from rubnoise.storage.measured import serve_dataset; serve_dataset()"


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """One column of values at even steps: ``step`` in s, or in um where ``along`` is "distance"; None where unknown.

    ``unit`` is as written, empty where the file has none; ``where`` names the file, and the line of the names;
    ``lines`` says which line each value is from, None where values have none.
    """

    name: str
    values: Doubles = field(repr=False)
    unit: str
    step: float | None
    along: str
    where: str = ""
    lines: "_Lines | None" = field(default=None, repr=False)

    def place(self, sample: int) -> str:
        """Return where a sample stands in its file."""
        return f"sample {sample + 1:,}" if self.lines is None else f"line {self.lines.of(sample)}"


def read_measured(trace: str | os.PathLike[str], column: str | None = None) -> Measured:
    """Return a column of a file; raises Refused, by name and line, for what is no trace.

    ``FILE.h5:PATH`` is a dataset. Without a ``column`` there has to be one that is neither time nor distance.
    """
    text = os.fspath(trace)
    path, dataset = (Path(text), "") if Path(text).exists() else _split(text)
    if read_at_most(path, len(_HDF5)) == _HDF5:
        if not dataset:
            raise Refused(f"{path}: which dataset? {path}:PATH names one")
        return _of_dataset(path, dataset)
    if path.stat().st_size > LARGEST:
        raise Refused(f"{path}: has {path.stat().st_size:,} bytes; traces of up to {LARGEST:,} are read")
    kind = path.suffix.lower()
    if kind == ".wav":
        return _of_wave(path, column)
    if kind == ".mat":
        return _of_matlab(path, column)
    return _of_text(path, column)


def _split(text: str) -> tuple[Path, str]:
    path, _, dataset = text.rpartition(":")
    return (Path(path), dataset) if path and Path(path).exists() else (Path(text), "")


def _of_text(path: Path, wanted: str | None) -> Measured:
    """Return a column of a table of text, which is read in pieces: only the column itself is kept."""
    rows = _rows(path)
    begun = next(rows, [])
    if not begun:
        raise Refused(f"{path}: has 0 lines; a line of names and a row for each sample are needed")
    head_line, head = begun.pop(0)
    separator = next((mark for mark in ("\t", ";", ",") if mark in head), ",")
    heads = [_named(cell) for cell in next(csv.reader([head], delimiter=separator))]
    if all(_is_number(name) for name, _ in heads):
        raise Refused(
            f'{path}: line {head_line}: numbers; a first line of names is needed: "time (s){separator}force (mN)"'
        )
    place = next((n for n, (name, unit) in enumerate(heads) if _along(name, unit)), None)
    if wanted is None and place is None:
        _check_place_units(heads, f"{path}: line {head_line}")
    chosen = _chosen(path, [name for name, _ in heads], wanted, place)
    kept: list[Doubles] = []
    lines = _Lines()
    even: _EvenSteps | None = None
    for piece in chain([begun], rows):
        if not piece:
            continue
        table = _numbers(path, piece, separator, len(heads))
        numbers = [number for number, _ in piece]
        if not np.isfinite(table[:, chosen]).all():
            row = int(np.argmin(np.isfinite(table[:, chosen])))
            raise Refused(
                f"{path}: line {numbers[row]}: {heads[chosen][0]} is {table[row, chosen]}; every sample needs a number"
            )
        if place is not None:
            if even is None:
                even = _EvenSteps(heads[place], path, _resolution(piece[:100], separator, place))
            even.add(table[:, place], numbers)
        kept.append(table[:, chosen].copy())
        lines.add(numbers)
    if lines.count < 2:
        raise Refused(f"{path}: has {lines.count + 1} lines; a line of names and a row for each sample are needed")
    return Measured(
        name=heads[chosen][0],
        values=np.concatenate(kept),
        unit=heads[chosen][1],
        step=None if even is None else even.step(),
        along="time" if place is None else _along(*heads[place]),
        where=f"{path}: line {head_line}",
        lines=lines,
    )


def _rows(path: Path) -> Iterator[list[tuple[int, str]]]:
    """Yield the lines of a text with their numbers, a piece at a time, without comments and empty lines."""
    number = 0
    with open_stream(path) as stream, TextIOWrapper(stream, encoding="utf-8-sig") as text:
        try:
            while piece := text.readlines(_PIECE_BYTES):
                kept = [(at, line) for at, line in enumerate(piece, number + 1) if line.strip() and line[0] != "#"]
                number += len(piece)
                if kept:
                    yield kept
        except UnicodeDecodeError as problem:
            raise Refused(f"{path}: is no text in UTF-8, beyond line {number}") from problem


def _check_place_units(heads: list[tuple[str, str]], where: str) -> None:
    """Raise Refused for a column that is called a time or a distance and has no unit."""
    for name, unit in heads:
        if not unit and (found := _PLACES.get(name.lower())):
            raise Refused(f'{where}: {name} has no unit; write "{name} ({found})", or whichever unit it has')


class _Lines:
    """Which line of a file each row of a column is from: kept where the two part, not for each row."""

    def __init__(self) -> None:
        """Begin with no rows."""
        self.count = 0
        self._first: list[int] = []
        self._ahead: list[int] = []

    def add(self, numbers: list[int]) -> None:
        """Take the line numbers of the next rows."""
        ahead = np.array(numbers) - np.arange(self.count, self.count + len(numbers))
        before = self._ahead[-1] if self._ahead else None
        changed = np.flatnonzero(np.diff(ahead)) + 1
        for row in ([0] if before != ahead[0] else []) + changed.tolist():
            self._first.append(self.count + row)
            self._ahead.append(int(ahead[row]))
        self.count += len(numbers)

    def of(self, row: int) -> int:
        """Return the line of a row."""
        return row + self._ahead[bisect_right(self._first, row) - 1]


def _numbers(path: Path, rows: list[tuple[int, str]], separator: str, count: int) -> Doubles:
    """Return the table; raises Refused with the first line that is not one of ``count`` numbers."""
    try:
        table: Doubles = np.loadtxt([line for _, line in rows], delimiter=separator, ndmin=2, comments=None)
    except ValueError:
        table = np.empty((0, 0))
    if table.shape[1] == count:
        return table
    for number, line in rows:
        cells = next(csv.reader([line], delimiter=separator))
        if len(cells) != count:
            raise Refused(f"{path}: line {number}: {len(cells)} cells; there are {count} names")
        for cell in cells:
            if not _is_number(cell):
                raise Refused(f"{path}: line {number}: {cell.strip()!r} is no number")
    raise Refused(f"{path}: is no table of numbers")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _named(cell: str) -> tuple[str, str]:
    """Return the name and the unit of a header: `NAME (UNIT)`, `NAME [UNIT]` or our own `NAME_UNIT`."""
    text = cell.strip()
    if match := _HEADER.fullmatch(text):
        return match["name"].strip(), (match["round"] or match["square"] or "").strip()
    ending = next((end for end in ENDINGS if text.endswith(end)), "")
    return (text.removesuffix(ending), ENDINGS[ending]) if ending else (text, "")


def _along(name: str, unit: str) -> str:
    """Return "time" or "distance" for what places samples; empty for other columns."""
    try:
        dimension = parse_unit(unit).dimension if name and unit else None
    except QuantityError:
        return ""
    if dimension is None:
        return ""
    if dimension == TIME.dimension:
        return "time"
    travelled = name.lower().split()[-1].split("_")[-1] in {"distance", "position", "s"}
    return "distance" if dimension == LENGTH.dimension and travelled else ""


def _chosen(path: Path, names: list[str], wanted: str | None, place: int | None) -> int:
    if wanted is not None:
        if names.count(wanted) != 1:
            raise Refused(f"{path}: --column {wanted}: the columns are {', '.join(names)}")
        return names.index(wanted)
    others = [number for number in range(len(names)) if number != place]
    if len(others) != 1:
        listed = ", ".join(names[number] for number in others) or "none but the place"
        raise Refused(f"{path}: which column? --column NAME takes one of: {listed}")
    return others[0]


def _resolution(rows: list[tuple[int, str]], separator: str, place: int) -> float:
    """Return the last decimal with which places are written."""
    cells = [next(csv.reader([line], delimiter=separator))[place].strip() for _, line in rows]
    return min(10.0 ** -len(cell.partition("e")[0].partition(".")[2]) for cell in cells)


class _EvenSteps:
    """Places of samples, taken in pieces and refused with the line where they are not even."""

    def __init__(self, head: tuple[str, str], path: Path, resolution: float) -> None:
        """Name the column, its file and the last decimal with which places are written."""
        self._head, self._path, self._resolution = head, path, resolution
        self._usual = self._tolerance = 0.0
        self._first = self._last = 0.0
        self._count = 0

    def add(self, places: Doubles, lines: Sequence[int]) -> None:
        """Take the next places, and the line of each; the usual step is that of the first piece."""
        name, unit = self._head
        if not np.isfinite(places).all():
            raise Refused(f"{self._path}: line {lines[int(np.argmin(np.isfinite(places)))]}: {name} is no number")
        steps = np.diff(places, prepend=self._last if self._count else places[0])
        own = steps[1:] if self._count == 0 else steps
        if self._usual == 0.0 and own.size:
            self._usual = float(np.median(own))
            if self._usual <= 0.0:
                raise Refused(f"{self._path}: {name} does not grow from row to row")
            self._tolerance = self._allowed(own)
        off = np.abs(own - self._usual) > self._tolerance
        if off.any():
            row = int(np.argmax(off))
            raise Refused(
                f"{self._path}: line {lines[row + steps.size - own.size]}: {name} grows by {own[row]:g} {unit} where"
                f" the usual step is {self._usual:g}; samples have to be evenly spaced"
            )
        if self._count == 0:
            self._first = float(places[0])
        self._last = float(places[-1])
        self._count += places.size

    def _allowed(self, steps: Doubles) -> float:
        """Return how far a step may be from the usual one: 1 %, and a digit of the places, by which they are rounded.

        Where a step is a digit, and nearly all are equal, a longer one is a row that is missing and no rounding.
        """
        uneven = UNEVEN * self._usual
        rounded = float(np.mean(np.abs(steps - self._usual) > uneven)) > _ROUNDED
        return uneven if self._resolution > 0.5 * self._usual and not rounded else uneven + 1.01 * self._resolution

    def step(self) -> float:
        """Return the mean step in s or um."""
        return (self._last - self._first) / (self._count - 1) * float(parse_unit(self._head[1]).size)


def _even(places: Doubles, head: tuple[str, str], path: Path) -> float:
    """Return the step in s or um; raises Refused where places are not even, as if each value had a line."""
    steps = _EvenSteps(head, path, 0.0)
    steps.add(places, range(1, places.size + 1))
    return steps.step()


def _of_wave(path: Path, wanted: str | None) -> Measured:
    import warnings

    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)  # of chunks with texts
        try:
            rate, samples = wavfile.read(path)
        except (ValueError, EOFError) as problem:
            raise Refused(f"{path}: is no WAV file that can be read: {problem}") from problem
    if samples.ndim == 1:
        samples = samples[:, None]
    names = [str(channel + 1) for channel in range(samples.shape[1])]
    chosen = _chosen(path, names, wanted, None)
    values = samples[:, chosen].astype(np.float64)
    if samples.dtype.kind in "iu":
        full = float(np.iinfo(samples.dtype).max) + 1.0
        values /= full if samples.dtype.kind == "i" else 0.5 * full
        values -= 0.0 if samples.dtype.kind == "i" else 1.0
    _check_finite(values, f"{path}: channel {names[chosen]}")
    return Measured(
        name=f"channel {names[chosen]}", values=values, unit="", step=1.0 / rate, along="time", where=str(path)
    )


def _of_matlab(path: Path, wanted: str | None) -> Measured:
    from scipy.io import loadmat

    try:
        content = loadmat(path, squeeze_me=True, struct_as_record=True)
    except Exception as problem:
        raise Refused(f"{path}: is no MATLAB 5 file that can be read: {problem}; save it with -v6 or -v7") from problem
    rows = {
        name: value
        for name, value in content.items()
        if isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "fiu"
    }
    places = [name for name in rows if name.lower() in {"t", "time"}]
    names = list(rows)
    place = names.index(places[0]) if places else None
    chosen = names[_chosen(path, names, wanted, place)]
    step = None
    if places and rows[places[0]].size == rows[chosen].size:
        step = _even(rows[places[0]].astype(np.float64), (places[0], "s"), path)
    values = rows[chosen].astype(np.float64)
    _check_finite(values, f"{path}: {chosen}")
    return Measured(name=chosen, values=values, unit="", step=step, along="time", where=str(path))


def _check_finite(values: Doubles, what: str) -> None:
    if not np.isfinite(values).all():
        raise Refused(f"{what}: value {int(np.argmin(np.isfinite(values))) + 1} is no number")


def _of_dataset(path: Path, name: str) -> Measured:
    """Return a dataset that the sandbox has read, in pieces that go down its pipe one by one."""
    kept: list[Doubles] = []
    along, count = "", 0
    even: _EvenSteps | None = None
    descriptor = open_regular(path)
    try:
        while True:
            head, _, rest = _from_sandbox(descriptor, name, count).partition(b"\n")
            found: dict[str, Any] = json.loads(head)
            if "refused" in found:
                raise Refused(f"{path}: {found['refused']}")
            both = np.frombuffer(rest, dtype="<f8").astype(np.float64)
            values, places = both[: found["here"]], both[found["here"] :]
            if count == 0:
                along = _along(found["place"].rpartition("/")[2], found["place_unit"])
                even = _EvenSteps((found["place"], found["place_unit"]), path, 0.0) if along else None
            if even is not None:
                even.add(places, range(count + 1, count + 1 + values.size))
            kept.append(values)
            count += values.size
            if count >= found["count"] or not values.size:
                break
    finally:
        os.close(descriptor)
    whole = np.concatenate(kept)
    _check_finite(whole, f"{path}: {name}")
    return Measured(
        name=name,
        values=whole,
        unit=found["unit"],
        step=None if even is None else even.step(),
        along=along or "time",
        where=str(path),
    )


def _load_hdf5() -> None:
    """Load all that reading a dataset needs: in the sandbox nothing can be opened, no module either."""
    import_module("rubnoise.storage.pages")
    import_module("h5py._hl.dims")


def _from_sandbox(descriptor: int, name: str, first: int) -> bytes:
    from rubnoise.storage.sandbox import sandboxed

    _load_hdf5()
    if threading.active_count() == 1:
        return sandboxed(descriptor, partial(read_dataset, name=name, first=first))
    # A program with threads should not copy itself: a new one of one thread does it.
    from subprocess import run

    folders = os.pathsep.join(filter(None, sys.path))
    command = [sys.executable, "-P", "-c", _PROGRAM, name, str(first)]
    done = run(command, stdin=descriptor, capture_output=True, check=False, env={**os.environ, "PYTHONPATH": folders})  # noqa: S603  (our own words)
    return done.stdout or b'{"refused": "the process that reads it has ended"}'


def serve_dataset() -> None:
    """Be that program: read the dataset that the arguments name, from a row on, of the file on standard input."""
    from rubnoise.storage.sandbox import sandboxed

    _load_hdf5()
    sys.stdout.buffer.write(sandboxed(0, partial(read_dataset, name=sys.argv[1], first=int(sys.argv[2]))))


def read_dataset(descriptor: int, name: str, first: int = 0) -> bytes:
    """Return a line of JSON and a piece of a dataset as doubles, then that of its dimension scale; or why not."""
    import h5py

    from rubnoise.storage.pages import Overlay

    try:
        with h5py.File(Overlay(descriptor), "r") as file:
            dataset = file.get(name)
            if not isinstance(dataset, h5py.Dataset):
                return _no(f"{name} is no dataset in it; it has {', '.join(_datasets(file)) or 'none'}")
            if dataset.ndim != 1 or dataset.dtype.kind not in "fiu":
                return _no(f"{name} has {dataset.ndim} dimensions of {dataset.dtype}; one of numbers is needed")
            if dataset.size > MOST_VALUES:
                return _no(f"{name} has {dataset.size:,} values; up to {MOST_VALUES:,} are read from a file of others")
            scale = dataset.dims[0][0] if len(dataset.dims[0]) else None
            if scale is not None and (scale.shape != dataset.shape or scale.dtype.kind not in "fiu"):
                scale = None
            piece = slice(first, min(first + _PIECE_VALUES, dataset.size))
            head = {"count": dataset.size, "here": piece.stop - piece.start, "unit": _unit(dataset)}
            head |= (
                {"place": "", "place_unit": ""} if scale is None else {"place": scale.name, "place_unit": _unit(scale)}
            )
            parts = [dataset[piece]] if scale is None else [dataset[piece], scale[piece]]
            return json.dumps(head).encode() + b"\n" + b"".join(part.astype("<f8").tobytes() for part in parts)
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, MemoryError) as problem:
        return _no(f"damaged or no HDF5: {problem}")


def _no(reason: str) -> bytes:
    return json.dumps({"refused": reason}).encode()


def _unit(dataset: Any) -> str:
    unit = dataset.attrs.get("units", "")
    return unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)


def _datasets(file: Any) -> list[str]:
    import h5py

    found: list[str] = []
    file.visititems(
        lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) and len(found) < 12 else None
    )
    return found

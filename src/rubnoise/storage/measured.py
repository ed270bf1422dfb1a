"""Measured traces in files of other programs: text, WAV, MATLAB 5, and any dataset of an HDF5 or netCDF file.

HDF5 is read in the sandbox. What a file does not say, unit or rate, has to be given.
"""

import csv
import json
import os
import re
import sys
import threading
from dataclasses import dataclass, field
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.regular_file import open_regular, open_stream, read_at_most
from rubnoise.units import LENGTH, TIME, QuantityError, parse_unit

LARGEST: Final = 2 * 1024**3
"""Bytes of a file of text, sound or MATLAB."""

MOST_VALUES: Final = 8_000_000
"""Of a dataset of another program's HDF5 file: they come through a pipe."""

UNEVEN: Final = 0.01
"""How far one step between samples may be from the mean step, in parts of it, beyond the digits that are written."""

ENDINGS: Final = {"_um_per_s": "um/s", "_um2": "um^2", "_um": "um", "_uN": "uN", "_MPa": "MPa", "_s": "s"}
_HEADER: Final = re.compile(r"(?P<name>[^()\[\]]+?)\s*(?:\((?P<round>[^()]*)\)|\[(?P<square>[^\[\]]*)\])")
_HDF5: Final = b"\x89HDF"
_PROGRAM: Final = "from rubnoise.storage.measured import serve_dataset; serve_dataset()"


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """One column of values at even steps: ``step`` in s, or in um where ``along`` is "distance"; None where unknown.

    ``unit`` is as written, empty where the file has none.
    """

    name: str
    values: Doubles = field(repr=False)
    unit: str
    step: float | None
    along: str


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
    with open_stream(path) as stream:
        raw = stream.read()
    try:
        lines = raw.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as problem:
        raise Refused(f"{path}: is no text in UTF-8 (byte {problem.start})") from problem
    kept = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(kept) < 3:
        raise Refused(f"{path}: has {len(kept)} lines; a line of names and a row for each sample are needed")
    separator = next((mark for mark in ("\t", ";", ",") if mark in kept[0][1]), ",")
    heads = [_named(cell) for cell in next(csv.reader([kept[0][1]], delimiter=separator))]
    if all(_is_number(name) for name, _ in heads):
        raise Refused(
            f'{path}: line {kept[0][0]}: numbers; a first line of names is needed: "time (s){separator}force (mN)"'
        )
    table = _numbers(path, kept[1:], separator, len(heads))
    numbers = [number for number, _ in kept[1:]]
    places = [n for n, (name, unit) in enumerate(heads) if _along(name, unit)]
    place = places[0] if places else None
    chosen = _chosen(path, [name for name, _ in heads], wanted, place)
    if not np.isfinite(table[:, chosen]).all():
        row = int(np.argmin(np.isfinite(table[:, chosen])))
        raise Refused(
            f"{path}: line {numbers[row]}: {heads[chosen][0]} is {table[row, chosen]}; every sample needs a number"
        )
    step, along = None, "time"
    if place is not None:
        along = _along(*heads[place])
        step = _even(table[:, place], heads[place], path, numbers, _resolution(kept[1:101], separator, place))
    return Measured(
        name=heads[chosen][0],
        values=np.ascontiguousarray(table[:, chosen]),
        unit=heads[chosen][1],
        step=step,
        along=along,
    )


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
        dimension = parse_unit(unit).dimension if unit else None
    except QuantityError:
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


def _even(places: Doubles, head: tuple[str, str], path: Path, lines: list[int], resolution: float) -> float:
    """Return the step in s or um; raises Refused with the line where places are not even."""
    steps = np.diff(places)
    if not np.isfinite(places).all():
        raise Refused(f"{path}: line {lines[int(np.argmin(np.isfinite(places)))]}: {head[0]} is no number")
    usual = float(np.median(steps))
    if usual <= 0.0:
        raise Refused(f"{path}: {head[0]} does not grow from row to row")
    off = np.abs(steps - usual) > UNEVEN * usual + 1.01 * resolution
    if off.any():
        row = int(np.argmax(off))
        raise Refused(
            f"{path}: line {lines[row + 1]}: {head[0]} grows by {steps[row]:g} {head[1]} where the usual step is"
            f" {usual:g}; samples have to be evenly spaced"
        )
    mean = (places[-1] - places[0]) / steps.size
    return float(mean) * float(parse_unit(head[1]).size)


def _of_wave(path: Path, wanted: str | None) -> Measured:
    import warnings

    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)  # of chunks with texts
        try:
            rate, samples = wavfile.read(path)
        except (ValueError, EOFError) as problem:
            raise Refused(f"{path}: is no WAV file that can be read: {problem}") from problem
    values = samples.astype(np.float64)
    if samples.dtype.kind in "iu":
        full = float(np.iinfo(samples.dtype).max) + 1.0
        values = values / full if samples.dtype.kind == "i" else values / (0.5 * full) - 1.0
    if values.ndim == 1:
        values = values[:, None]
    names = [str(channel + 1) for channel in range(values.shape[1])]
    chosen = _chosen(path, names, wanted, None)
    return Measured(
        name=f"channel {names[chosen]}", values=values[:, chosen].copy(), unit="", step=1.0 / rate, along="time"
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
        lines = list(range(1, rows[chosen].size + 1))
        step = _even(rows[places[0]].astype(np.float64), (places[0], "s"), path, lines, 0.0)
    values = rows[chosen].astype(np.float64)
    _check_finite(values, f"{path}: {chosen}")
    return Measured(name=chosen, values=values, unit="", step=step, along="time")


def _check_finite(values: Doubles, what: str) -> None:
    if not np.isfinite(values).all():
        raise Refused(f"{what}: value {int(np.argmin(np.isfinite(values))) + 1} is no number")


def _of_dataset(path: Path, name: str) -> Measured:
    """Return a dataset that the sandbox has read."""
    descriptor = open_regular(path)
    try:
        answer = _from_sandbox(descriptor, name)
    finally:
        os.close(descriptor)
    head, _, rest = answer.partition(b"\n")
    found: dict[str, Any] = json.loads(head)
    if "refused" in found:
        raise Refused(f"{path}: {found['refused']}")
    values = np.frombuffer(rest[: 8 * found["count"]], dtype="<f8").astype(np.float64)
    places = np.frombuffer(rest[8 * found["count"] :], dtype="<f8")
    _check_finite(values, f"{path}: {name}")
    step, along = None, "time"
    if places.size == values.size:
        kind = _along(found["place"].rpartition("/")[2], found["place_unit"])
        if kind:
            along = kind
            lines = list(range(1, values.size + 1))
            step = _even(places, (found["place"], found["place_unit"]), path, lines, 0.0)
    return Measured(name=name, values=values, unit=found["unit"], step=step, along=along)


def _load_hdf5() -> None:
    """Load all that reading a dataset needs: in the sandbox nothing can be opened, no module either."""
    import_module("rubnoise.storage.pages")
    import_module("h5py._hl.dims")


def _from_sandbox(descriptor: int, name: str) -> bytes:
    from rubnoise.storage.sandbox import sandboxed

    _load_hdf5()
    if threading.active_count() == 1:
        return sandboxed(descriptor, partial(read_dataset, name=name))
    # A program with threads should not copy itself: a new one of one thread does it.
    from subprocess import run

    folders = os.pathsep.join(filter(None, sys.path))
    command = [sys.executable, "-P", "-c", _PROGRAM, name]
    done = run(command, stdin=descriptor, capture_output=True, check=False, env={**os.environ, "PYTHONPATH": folders})  # noqa: S603  (our own words)
    return done.stdout or b'{"refused": "the process that reads it has ended"}'


def serve_dataset() -> None:
    """Be that program: read the dataset that the argument names of the file on standard input."""
    from rubnoise.storage.sandbox import sandboxed

    _load_hdf5()
    sys.stdout.buffer.write(sandboxed(0, partial(read_dataset, name=sys.argv[1])))


def read_dataset(descriptor: int, name: str) -> bytes:
    """Return a line of JSON and the values of a dataset as doubles, then those of its dimension scale; or why not."""
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
            if scale is not None and (scale.shape != dataset.shape or 2 * dataset.size > MOST_VALUES):
                scale = None
            head = {"count": dataset.size, "unit": _unit(dataset)}
            head |= (
                {"place": "", "place_unit": ""} if scale is None else {"place": scale.name, "place_unit": _unit(scale)}
            )
            parts = [dataset[()]] if scale is None else [dataset[()], scale[()]]
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

"""Measured traces in files of other programs: text, WAV, MATLAB 5, and any dataset of an HDF5 or netCDF file.

HDF5 is read in the sandbox. What a file does not say, unit or rate, has to be given.
"""

import json
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.regular_file import open_regular, read_at_most
from rubnoise.storage.measured_text import read_text
from rubnoise.storage.samples import EvenSteps, Measured, along_of, check_values, chosen_column, even_step

LARGEST: Final = 2 * 1024**3
"""Bytes of a file of text, sound or MATLAB."""

MOST_VALUES: Final = 100_000_000
"""Of a dataset of another program's HDF5 file."""

_PIECE_VALUES: Final = 1 << 21  # of a dataset: it and its scale go down the pipe of the sandbox
_HDF5: Final = b"\x89HDF"
_PROGRAM: Final = "from rubnoise.storage.measured import serve_dataset; serve_dataset()"


@contextmanager
def refusing_files(path: object) -> Iterator[None]:
    """Turn what the system says of a file into a refusal that names it."""
    try:
        yield
    except (OSError, ValueError) as problem:
        reason = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
        raise Refused(f"{path}: {reason[:1].lower()}{reason[1:]}") from problem


def read_measured(trace: str | os.PathLike[str], column: str | None = None, rate: float | None = None) -> Measured:
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
    return read_text(path, column, rate)


def _split(text: str) -> tuple[Path, str]:
    path, _, dataset = text.rpartition(":")
    return (Path(path), dataset) if path and Path(path).exists() else (Path(text), "")


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
    chosen = chosen_column(path, names, wanted, None)
    values = samples[:, chosen].astype(np.float64)
    if samples.dtype.kind in "iu":
        full = float(np.iinfo(samples.dtype).max) + 1.0
        values /= full if samples.dtype.kind == "i" else 0.5 * full
        values -= 0.0 if samples.dtype.kind == "i" else 1.0
    check_values(values, f"{path}: channel {names[chosen]}")
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
    chosen = names[chosen_column(path, names, wanted, place)]
    step = None
    if places and rows[places[0]].size == rows[chosen].size:
        step = even_step(rows[places[0]].astype(np.float64), places[0], "s", str(path))
    values = rows[chosen].astype(np.float64)
    check_values(values, f"{path}: {chosen}")
    return Measured(name=chosen, values=values, unit="", step=step, along="time", where=str(path))


def _of_dataset(path: Path, name: str) -> Measured:
    """Return a dataset that the sandbox has read, in pieces that go down its pipe one by one."""
    kept: list[Doubles] = []
    along, count = "", 0
    even: EvenSteps | None = None
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
                along = along_of(found["place"].rpartition("/")[2], found["place_unit"])
                even = EvenSteps(found["place"], found["place_unit"], str(path), word="row") if along else None
            if even is not None:
                even.add(places, range(count + 1, count + 1 + values.size))
            kept.append(values)
            count += values.size
            if count >= found["count"] or not values.size:
                break
    finally:
        os.close(descriptor)
    whole = np.concatenate(kept)
    check_values(whole, f"{path}: {name}")
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

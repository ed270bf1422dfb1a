"""Measured traces in files of other programs: text, WAV, MATLAB 5, and any dataset of an HDF5 or netCDF file.

The caller must give a unit or rate that the file does not have.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import NoColumn, Refused
from rubnoise.regular_file import is_hdf5, open_stream, size_of
from rubnoise.storage.foreign_dataset import pieces_of_dataset
from rubnoise.storage.measured_text import read_text
from rubnoise.storage.samples import EvenSteps, Measured, along_of, check_values, chosen_column, even_step
from rubnoise.storage.wave_reader import read_wave

LARGEST: Final = 2 * 1024**3
"""Bytes of a file of text, sound or MATLAB."""

MOST_UNPACKED: Final = 10_000_000
"""Values of a vector of MATLAB: a file says how many it has before they are unpacked."""

_NUMBERS: Final = frozenset(
    ["double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))]
)


@contextmanager
def refusing_files(path: object) -> Iterator[None]:
    """Turn an OSError about a file into a refusal that names the file."""
    try:
        yield
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise Refused(f"{path}: {reason[:1].lower()}{reason[1:]}") from problem


def read_measured(trace: str | os.PathLike[str], column: str | None = None, rate: float | None = None) -> Measured:
    """Return a column of a file; raises Refused, with name and line, if it is not a trace.

    ``FILE.h5:PATH`` is a dataset. Without ``column`` the file must have one column that is neither time nor distance.
    """
    text = os.fspath(trace)
    if "\0" in text:
        raise Refused(f"{text[:40]!r}: no file has a zero byte in its name")
    path, dataset = (Path(text), "") if Path(text).exists() else _split(text)
    if is_hdf5(path):
        if not dataset:
            raise Refused(f"{path}: which dataset? {path}:PATH names one")
        return _of_dataset(path, dataset)
    if (held := size_of(path)) > LARGEST:
        raise Refused(f"{path}: has {held:,} bytes; traces of up to {LARGEST:,} are read")
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
    channel, values, rate = read_wave(path, wanted)
    check_values(values, f"{path}: channel {channel}")
    return Measured(name=f"channel {channel}", values=values, unit="", step=1.0 / rate, along="time", where=str(path))


def _of_matlab(path: Path, wanted: str | None) -> Measured:
    """Return a vector of a MATLAB file, which says how many values it has before they are unpacked."""
    with open_stream(path) as stream, _naming_matlab(path):
        sizes = _vectors(stream)
        names = list(sizes)
        place = next((name for name in names if name.lower() in {"t", "time"}), "")
        chosen = names[chosen_column(path, names, wanted, names.index(place) if place else None)]
        values = _vector(stream, chosen, sizes[chosen])
        times = _vector(stream, place, sizes[place]) if place and sizes[place] == sizes[chosen] else None
    check_values(values, f"{path}: {chosen}")
    step = None if times is None else even_step(times, place, "s", str(path))
    return Measured(name=chosen, values=values, unit="", step=step, along="time", where=str(path))


@contextmanager
def _naming_matlab(path: Path) -> Iterator[None]:
    """Turn what scipy raises on a damaged file, which may be any error, into a refusal that names the file."""
    try:
        yield
    except NoColumn:
        raise
    except Refused as refused:
        raise Refused(f"{path}: {refused}") from refused
    except MemoryError as problem:
        raise Refused(
            f"{path}: is damaged, or there is no memory to unpack it; save the one vector with -v7"
        ) from problem
    except Exception as problem:
        why = " ".join(str(problem).split())[:200]
        raise Refused(f"{path}: is no MATLAB 5 file that can be read: {why}; save it with -v6 or -v7") from problem


def _vectors(stream: BinaryIO) -> dict[str, int]:
    """Return the number of values of every vector of real numbers in a MATLAB file; raises Refused without any."""
    from scipy.io import whosmat

    shapes = {name: shape for name, shape, kind in whosmat(stream) if kind in _NUMBERS}
    vectors = {
        name: prod(shape) for name, shape in shapes.items() if sum(side != 1 for side in shape) == 1 and min(shape) > 0
    }
    if not vectors:
        sizes = ", ".join(f"{name} {'x'.join(map(str, shape))}" for name, shape in list(shapes.items())[:12])
        raise Refused(f"has no vector of real numbers; it has {sizes or 'no numbers'}")
    return vectors


def _vector(stream: BinaryIO, name: str, count: int) -> Doubles:
    from scipy.io import loadmat

    if count > MOST_UNPACKED:
        raise Refused(f"{name} has {count:,} values; up to {MOST_UNPACKED:,} are read; save it as CSV or HDF5")
    stream.seek(0)
    found: Any = loadmat(stream, squeeze_me=True, variable_names=[name])[name]
    if not isinstance(found, np.ndarray) or found.dtype.kind not in "fiu" or found.shape != (count,):
        raise Refused(f"{name} is no vector of real numbers")
    return found.astype(np.float64)


def _of_dataset(path: Path, name: str) -> Measured:
    kept: list[Doubles] = []
    along, count = "", 0
    even: EvenSteps | None = None
    for found, values, places in pieces_of_dataset(path, name):
        if count == 0:
            along = along_of(found.place.rpartition("/")[2], found.place_unit)
            even = EvenSteps(found.place, found.place_unit, str(path), word="row") if along else None
        if even is not None:
            even.add(places, range(count + 1, count + 1 + values.size))
        kept.append(values)
        count += values.size
    whole = np.concatenate(kept)
    check_values(whole, f"{path}: {name}")
    return Measured(
        name=name,
        values=whole,
        unit=found.unit,
        step=None if even is None else even.step(),
        along=along or "time",
        where=str(path),
    )

"""Measured traces in files of other programs: text, WAV, MATLAB 5, and any dataset of an HDF5 or netCDF file.

HDF5 is read in the sandbox. The caller must give a unit or rate that the file does not have.
"""

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import UNFINISHED, NoColumn, Refused, RunFileRefused
from rubnoise.regular_file import is_hdf5, open_regular, size_of
from rubnoise.storage.measured_text import read_text
from rubnoise.storage.samples import EvenSteps, Measured, along_of, check_values, chosen_column, even_step
from rubnoise.storage.sandbox import MEMORY_BYTES, Look, LookName, look_at
from rubnoise.storage.schema import FORMAT
from rubnoise.storage.wave_reader import read_wave

LARGEST: Final = 2 * 1024**3
"""Bytes of a file of text, sound or MATLAB."""

MOST_VALUES: Final = 100_000_000
"""Of a dataset of another program's HDF5 file."""

MOST_UNPACKED: Final = 10_000_000
"""Values of a vector of MATLAB: a file says how many it has before they are unpacked."""

_PIECE_VALUES: Final = 1 << 21  # that go down the pipe of the sandbox, with those of their scale
_NUMBERS: Final = frozenset(
    ["double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))]
)
_PATIENCE: Final = 8.0  # seconds for a look at a file


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
    """Return a vector of a MATLAB file, read in the sandbox, since some kilobytes may unpack to gigabytes."""
    descriptor = open_regular(path)
    try:
        listed: dict[str, Any] = json.loads(_from_sandbox(descriptor, "matlab", "", 0))
        if "refused" in listed:
            raise Refused(f"{path}: {_reason(listed)}")
        names: list[str] = listed["names"]
        places = [name for name in names if name.lower() in {"t", "time"}]
        place = names.index(places[0]) if places else None
        chosen = names[chosen_column(path, names, wanted, place)]
        values, times = (_vector(path, descriptor, each) if each else None for each in (chosen, (places or [""])[0]))
    finally:
        os.close(descriptor)
    if values is None:
        raise AssertionError("a column was chosen")
    check_values(values, f"{path}: {chosen}")
    step = even_step(times, places[0], "s", str(path)) if times is not None and times.size == values.size else None
    return Measured(name=chosen, values=values, unit="", step=step, along="time", where=str(path))


def _vector(path: Path, descriptor: int, name: str) -> Doubles:
    parts: list[Doubles] = []
    count = 0
    while True:
        head, _, rest = _from_sandbox(descriptor, "matlab", name, count).partition(b"\n")
        found: dict[str, Any] = json.loads(head)
        if "refused" in found:
            raise Refused(f"{path}: {_reason(found)}")
        parts.append(np.frombuffer(rest, dtype="<f8").astype(np.float64))
        count += parts[-1].size
        if count >= found["count"] or not parts[-1].size:
            return np.concatenate(parts)


def _reason(found: dict[str, Any]) -> str:
    """Return why the sandbox refused a MATLAB file: its message, or that the file needs too much memory or time."""
    if "unseen" not in found:
        return str(found["refused"])
    most = MEMORY_BYTES // 1024**2
    return f"is damaged, or unpacking it takes more than {most} MB or {_PATIENCE:g} s; save the one vector with -v7"


def _of_dataset(path: Path, name: str) -> Measured:
    """Return a dataset, which the sandbox reads and sends through its pipe in pieces."""
    kept: list[Doubles] = []
    along, count = "", 0
    even: EvenSteps | None = None
    for found, values, places in pieces_of_dataset(path, name):
        if count == 0:
            along = along_of(found["place"].rpartition("/")[2], found["place_unit"])
            even = EvenSteps(found["place"], found["place_unit"], str(path), word="row") if along else None
        if even is not None:
            even.add(places, range(count + 1, count + 1 + values.size))
        kept.append(values)
        count += values.size
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


def pieces_of_dataset(path: Path, name: str) -> Iterator[tuple[dict[str, Any], Doubles, Doubles]]:
    """Yield pieces of a dataset: its description, values, and those of its scale; raises NoColumn if it is missing."""
    count = 0
    descriptor = open_regular(path)
    try:
        while True:
            head, _, rest = _from_sandbox(descriptor, "dataset", name, count).partition(b"\n")
            found: dict[str, Any] = json.loads(head)
            if "refused" in found:
                raise NoColumn(f"{path}: {found['refused']}")
            if found["unfinished"]:
                raise RunFileRefused(f"{path}: {UNFINISHED}")
            both = np.frombuffer(rest, dtype="<f8").astype(np.float64)
            values = both[: found["here"]]
            yield found, values, both[found["here"] :]
            count += values.size
            if count >= found["count"] or not values.size:
                return
    finally:
        os.close(descriptor)


def _load_matlab() -> None:
    """Load every module that reading a MATLAB file needs, by reading one."""
    from scipy.io import loadmat, savemat, whosmat

    content = BytesIO()
    savemat(content, {"a": np.zeros(2)}, do_compression=True)
    whosmat(content)
    loadmat(content, squeeze_me=True)


def look_at_values(kind: str, name: str, first: str) -> Look:
    """Return the sandbox's function for values of a file of this kind, with all of its modules loaded."""
    if kind == "matlab":
        _load_matlab()
        return lambda file: read_matlab(file, name, int(first))
    import_module("rubnoise.storage.pages")
    import_module("h5py._hl.dims")
    return lambda file: read_dataset(file, name, int(first))


def _from_sandbox(descriptor: int, kind: LookName, name: str, first: int) -> bytes:
    return look_at(descriptor, (kind, name, str(first)), patience=_PATIENCE)


def read_matlab(descriptor: int, name: str, first: int) -> bytes:
    """Return a line of JSON and a piece of a vector as doubles, or the names of all vectors, or a refusal."""
    from scipy.io import loadmat, whosmat

    os.lseek(descriptor, 0, os.SEEK_SET)
    try:
        with os.fdopen(descriptor, "rb", closefd=False) as stream:
            shapes = {each: shape for each, shape, kind in whosmat(stream) if kind in _NUMBERS}
            vectors = [
                each for each, shape in shapes.items() if sum(side != 1 for side in shape) == 1 and 0 not in shape
            ]
            if not name:
                sizes = ", ".join(f"{each} {'x'.join(map(str, shape))}" for each, shape in list(shapes.items())[:12])
                none = f"has no vector of real numbers; it has {sizes or 'no numbers'}"
                return json.dumps({"names": vectors} if vectors else {"refused": none}).encode()
            count = int(np.prod([float(side) for side in shapes[name]]))
            if count > MOST_UNPACKED:
                return _no(f"{name} has {count:,} values; up to {MOST_UNPACKED:,} are read; save it as CSV or HDF5")
            os.lseek(descriptor, 0, os.SEEK_SET)
            stream.seek(0)
            found: Any = loadmat(stream, squeeze_me=True, variable_names=[name])[name]
            if not isinstance(found, np.ndarray) or found.dtype.kind not in "fiu" or found.shape != (count,):
                return _no(f"{name} is no vector of real numbers")
            piece = found[first : first + _PIECE_VALUES]
            return json.dumps({"count": count}).encode() + b"\n" + piece.astype("<f8").tobytes()
    except MemoryError:
        return json.dumps({"refused": "", "unseen": True}).encode()
    except Exception as problem:  # noqa: BLE001  (what a damaged file raises is whatever it raises)
        return _no(f"is no MATLAB 5 file that can be read: {str(problem)[:200]}; save it with -v6 or -v7")


def read_dataset(descriptor: int, name: str, first: int) -> bytes:
    """Return a line of JSON, a piece of a dataset as doubles and of its dimension scale, or the reason of a refusal."""
    import h5py

    from rubnoise.storage.pages import PagedFile

    try:
        with h5py.File(PagedFile(descriptor), "r") as file:
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
            head["unfinished"] = _is_unfinished(file)
            head |= (
                {"place": "", "place_unit": ""}
                if scale is None
                else {"place": scale.name or f"scale of {name}", "place_unit": _unit(scale)}
            )
            parts = [dataset[piece]] if scale is None else [dataset[piece], scale[piece]]
            return json.dumps(head).encode() + b"\n" + b"".join(part.astype("<f8").tobytes() for part in parts)
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, MemoryError) as problem:
        return _no(f"damaged or no HDF5: {problem}")


def _no(reason: str) -> bytes:
    return json.dumps({"refused": reason}).encode()


def _is_unfinished(file: Any) -> bool:
    """Whether a file is the part file of a run of ours."""
    origin = file.get("provenance")
    return _attribute(file, "format") == FORMAT and origin is not None and _attribute(origin, "finished") == ""


def _unit(dataset: Any) -> str:
    return _attribute(dataset, "units") or ""


def _attribute(item: Any, name: str) -> str | None:
    text = item.attrs.get(name)
    return text.decode("utf-8", "replace") if isinstance(text, bytes) else None if text is None else str(text)


def _datasets(file: Any) -> list[str]:
    import h5py

    found: list[str] = []
    file.visititems(
        lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) and len(found) < 12 else None
    )
    return found

"""The index of a sweep as an HDF5 file: a row for each point and for each run, and curves kept in place of files."""

import io
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Self

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.regular_file import open_stream
from rubnoise.storage.provenance import now, package_version
from rubnoise.storage.schema import CONVENTIONS, HASH, Dataset

FORMAT: Final = "rubnoise-sweep"
FORMAT_VERSION: Final = 1
RUNS: Final = "runs"
SUMMARIES: Final = "summaries"
POINTS: Final = "points"
TEXTS: Final = (
    "title",
    "source",
    "written",
    "command",
    "scenario_toml",
    "scenario_resolved",
    "grid",
    "side_by_side",
)
"""The attributes of an index that are not the same in all of them."""

RUN: Final = Dataset(name="run", dtype="<i8", units="1", symbol="r", long_name="row number of the run")
POINT: Final = Dataset(name="point", dtype="<i8", units="1", symbol="p", long_name="number of the point")

MOST_COLUMNS: Final = 256
"""More columns are in no group of an index."""

LIBRARY_VERSIONS: Final = ("v110", "v110")


@dataclass(frozen=True, slots=True, kw_only=True)
class Filled:
    """A column of the index with its values: numbers, or texts as bytes of one length."""

    about: Dataset
    values: NDArray[Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Index:
    """The content of an index: texts about the sweep, columns of points and runs, and arrays with a row for each.

    ``scenario_resolved`` is that of the first point; with the values of another one it is that one's.
    """

    title: str
    command: str
    scenario_toml: str
    scenario_resolved: Mapping[str, object]
    grid: tuple[str, ...]
    side_by_side: tuple[str, ...]
    points: Sequence[Filled]
    runs: Sequence[Filled]
    arrays_of_runs: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    arrays_of_points: Mapping[str, NDArray[Any]] = field(default_factory=dict)


def index_bytes(index: Index) -> bytes:
    """Return the file of an index.

    HDF5 makes it in memory, since it ends the process instead of raising if a disk is full.
    """
    with h5py.File("index.h5", "w", driver="core", backing_store=False, libver=LIBRARY_VERSIONS) as file:
        texts = _put_texts(file, index)
        for name, about, columns, arrays in (
            (POINTS, POINT, index.points, index.arrays_of_points),
            (RUNS, RUN, index.runs, index.arrays_of_runs),
        ):
            owner = file.create_group(name, track_order=True)
            scale = _column(owner, about, np.arange(columns[0].values.size))
            scale.make_scale(about.name)
            for column in columns:
                _column(owner, column.about, column.values).dims[0].attach_scale(scale)
            for name_of_array, values in arrays.items():
                dataset = file.require_group(SUMMARIES).create_dataset(name_of_array, data=values)
                _put_text(dataset, HASH, _hash(values))
                dataset.dims[0].attach_scale(scale)
        hashes = {
            dataset.name: str(dataset.attrs[HASH], "ascii")
            for owner in (POINTS, RUNS, SUMMARIES)
            if owner in file
            for dataset in file[owner].values()
        }
        _put_text(file, HASH, seal_of_index(texts, hashes))
        file.flush()
        return file.id.get_file_image()


def seal_of_index(attributes: Mapping[str, str], hashes: Mapping[str, str]) -> str:
    """Return the xxh3_128 of a JSON text with the index's attributes and the hashes of its columns.

    ``attributes`` are those in TEXTS, ``hashes`` stand under paths such as /runs/seed; names are sorted.
    """
    text = json.dumps([attributes, hashes], sort_keys=True, separators=(",", ":"))
    return xxhash.xxh3_128_hexdigest(text.encode())


def _put_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Write an attribute of text, at least two bytes long, since h5netcdf does not decode single bytes."""
    raw = text.encode("utf-8", "backslashreplace")
    size = max(2, len(raw))
    owner.attrs.create(name, np.array(raw, dtype=f"S{size}"), dtype=h5py.string_dtype("utf-8", size))


def _put_texts(file: h5py.File, index: Index) -> dict[str, str]:
    """Write the attributes of the file, and return those in TEXTS."""
    texts = {
        "title": index.title,
        "source": f"rubnoise {package_version('rubnoise')}",
        "written": now(),
        "command": index.command,
        "scenario_toml": index.scenario_toml,
        "scenario_resolved": json.dumps(index.scenario_resolved, ensure_ascii=False),
        "grid": json.dumps(list(index.grid)),
        "side_by_side": json.dumps(list(index.side_by_side)),
    }
    for name, text in {"Conventions": CONVENTIONS, "format": FORMAT, **texts, "NX_class": "NXroot"}.items():
        _put_text(file, name, text)
    file.attrs.create("format_version", FORMAT_VERSION, dtype="<i8")
    return {name: text.encode("utf-8", "backslashreplace").decode("utf-8") for name, text in texts.items()}


def _column(owner: h5py.Group, about: Dataset, values: NDArray[Any]) -> h5py.Dataset:
    """Create a column with its values, their description and their hash."""
    raw = np.ascontiguousarray(values, dtype=about.dtype)
    dataset = owner.create_dataset(about.name, data=raw)
    for name, text in {"units": about.units, "long_name": about.long_name, "symbol": about.symbol}.items():
        if text:
            _put_text(dataset, name, text)
    _put_text(dataset, HASH, _hash(raw))
    return dataset


def _hash(values: NDArray[Any]) -> str:
    return xxhash.xxh3_128_hexdigest(np.ascontiguousarray(values).data)


class IndexFile:
    """An index, read: its columns are in memory, its arrays are read when they are needed."""

    called = "index"

    def __init__(self, path: str | os.PathLike[str], content: bytes | None = None) -> None:
        """Read an index from its path, or from the ``content`` that would be there; raises RunFileRefused."""
        self.path = Path(path)
        self.closed = False
        self._place = self.path.absolute()
        self._content = content
        with _refusing(self.path), self._open() as file:
            _check_format(file)
            self.attributes: Mapping[str, str] = {name: _text(file, name) for name in TEXTS}
            self.seal: str | None = _text(file, HASH) if HASH in file.attrs else None
            self._groups = {name: dict(_members(file, name)) for name in (POINTS, RUNS)}
            self._values = {
                name: {column: file[name][column][()] for column in group} for name, group in self._groups.items()
            }
            self._groups[SUMMARIES] = dict(_members(file, SUMMARIES)) if SUMMARIES in file else {}
            self.hashes = {
                f"/{group}/{name}": _text(dataset, HASH) if HASH in (dataset := file[group][name]).attrs else None
                for group, members in self._groups.items()
                for name in members
            }
            self.others = sorted(set(file) - {POINTS, RUNS, SUMMARIES})
        for name in (POINTS, RUNS):
            if len({values.shape[:1] for values in self._values[name].values()}) != 1:
                raise RunFileRefused(f"{self.path}: /{name} has columns of several lengths")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let nothing more be read."""
        self.closed = True

    def columns(self, group: str) -> tuple[Dataset, ...]:
        """Return descriptions of the columns of "points", "runs" or "summaries", in order; texts have the dtype str."""
        return tuple(self._groups[group].values())

    def rows(self, group: str) -> int:
        """Return the number of points or of runs."""
        return len(next(iter(self._values[group].values())))

    def read(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows of a column; raises KeyError if it does not exist, RunFileRefused if it cannot be read."""
        values = self.raw(group, name, start, stop)
        if values.dtype.kind != "S":
            return values
        return np.char.decode(values, "utf-8", "replace") if values.size else np.empty(values.shape, dtype=np.str_)

    def raw(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows of a column as they are stored, texts as bytes; raises as `read` does."""
        if self.closed:
            raise ValueError(f"{self.path}: the index is closed")
        self._groups[group][name]
        if group != SUMMARIES:
            return self._values[group][name][start:stop].copy()
        with _refusing(self.path), self._open() as file:
            if (_text(file, HASH) if HASH in file.attrs else None) != self.seal:
                raise RunFileRefused("was replaced since it was opened; open it again")
            dict(_members(file, SUMMARIES))
            return file[SUMMARIES][name][start:stop]

    def damaged(self) -> tuple[str, ...]:
        """Return the paths of the columns that cannot be read, or differ from their stored hash."""
        return tuple(path for path, kept in self.hashes.items() if self._hash_of(*path[1:].split("/", 1)) != kept)

    def is_as_written(self) -> bool:
        """Whether all columns and attributes are those that the hashes were made of."""
        hashes = {path: kept or "" for path, kept in self.hashes.items()}
        return self.seal == seal_of_index(dict(self.attributes), hashes) and not self.damaged()

    def _hash_of(self, group: str, name: str) -> str | None:
        try:
            return _hash(self.raw(group, name))
        except RunFileRefused:
            return None

    @contextmanager
    def _open(self) -> Iterator[h5py.File]:
        source = open_stream(self._place) if self._content is None else io.BytesIO(self._content)
        with source as stream, h5py.File(stream, "r") as file:
            yield file


def open_index(path: str | os.PathLike[str]) -> IndexFile:
    """Open the index of a sweep, which may come from elsewhere.

    Raises RunFileRefused, with the reason in one sentence, for a missing path, and for a file that is not an
    index, is damaged, or has a later format.
    """
    return IndexFile(path)


def index_of_bytes(content: bytes, path: Path) -> IndexFile:
    """Return an index that was never written, as it would be read from its path."""
    return IndexFile(path, content)


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    """Raise RunFileRefused, with the path in front, for whatever HDF5 or the system says of a file."""
    try:
        yield
    except RunFileRefused as refusal:
        raise RunFileRefused(f"{path}: {refusal}") from refusal
    except FileNotFoundError as problem:
        raise RunFileRefused(f"{path}: no such file") from problem
    except OSError as problem:
        reason = problem.strerror.lower() if problem.strerror else "is not an HDF5 file, or is damaged"
        raise RunFileRefused(f"{path}: {reason}") from problem
    except (RuntimeError, LookupError, ValueError, TypeError, MemoryError) as problem:
        raise RunFileRefused(f"{path}: damaged: {' '.join(str(problem).split())}") from problem


def _check_format(file: h5py.File) -> None:
    found = _text(file, "format") if "format" in file.attrs else ""
    if found != FORMAT:
        known = "the result of one run, not the index of a sweep" if found else "an HDF5 file, but no index of a sweep"
        raise RunFileRefused(f"is {known}")
    if (version := file.attrs["format_version"]) != FORMAT_VERSION:
        raise RunFileRefused(f"has format version {version}, and this rubnoise knows {FORMAT_VERSION}; install a newer")


def _text(owner: h5py.HLObject, name: str) -> str:
    """Return an attribute of text; raises RunFileRefused for a missing one or one of another type."""
    if not h5py.h5a.exists(owner.id, name.encode()):
        raise RunFileRefused(f"attribute {name} is missing")
    if owner.attrs.get_id(name).dtype.kind != "S":
        raise RunFileRefused(f"attribute {name} is no text")
    return bytes(owner.attrs[name]).decode("utf-8", "replace").rstrip("\0")


def _members(file: h5py.File, name: str) -> Iterator[tuple[str, Dataset]]:
    """Yield the columns of a group with their descriptions; raises RunFileRefused for what no index has."""
    if file.get(name, getlink=True).__class__ is not h5py.HardLink or not isinstance(file.get(name), h5py.Group):
        raise RunFileRefused(f"/{name} is missing")
    if len(file[name]) > MOST_COLUMNS:
        raise RunFileRefused(f"/{name} holds {len(file[name])} objects")
    for member in file[name]:
        yield member, _about(file[name], member)


def _about(owner: h5py.Group, name: str) -> Dataset:
    path, linked = f"{owner.name}/{name}", owner.get(name, getlink=True)
    dataset = owner[name] if isinstance(linked, h5py.HardLink) else None
    if not isinstance(dataset, h5py.Dataset) or not dataset.ndim:
        raise RunFileRefused(f"{path} is no column")
    creation, kind = dataset.id.get_create_plist(), dataset.dtype
    plain = kind.str in {"<f8", "<i8"} or (kind.kind == "S" and not kind.names and kind.itemsize > 0)
    if creation.get_layout() != h5py.h5d.CONTIGUOUS or creation.get_external_count() or not plain:
        raise RunFileRefused(f"{path} is not stored as an index stores it")
    if dataset.size and dataset.id.get_storage_size() != dataset.nbytes:
        raise RunFileRefused(f"{path} has rows that are not in the file")
    units, meaning = (_text(dataset, each) if each in dataset.attrs else "" for each in ("units", "long_name"))
    dtype = f"<U{kind.itemsize}" if kind.kind == "S" else kind.str
    return Dataset(name=name, units=units, long_name=meaning, symbol="", dtype=dtype)

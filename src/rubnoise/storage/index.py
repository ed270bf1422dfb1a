"""Write the index of a sweep as HDF5: a row for each run, and the traces of similar runs as one array."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.arrays import slices
from rubnoise.errors import RunFileRefused
from rubnoise.storage.layout import stored_columns
from rubnoise.storage.objects import has_hard_link, read_attribute, read_integer, read_text, sound_group
from rubnoise.storage.pages import unfailing
from rubnoise.storage.provenance import now, package_version
from rubnoise.storage.schema import (
    CONVENTIONS,
    HASH,
    INDEX_FORMAT,
    LOAD,
    SLIDER,
    TRACE,
    Dataset,
    Feature,
    Group,
    Scalar,
)
from rubnoise.storage.structure import LIBRARY_VERSIONS, put_text, text_bytes

FORMAT: Final = INDEX_FORMAT
FORMAT_VERSION: Final = 1
RUNS: Final = "runs"
SUMMARIES: Final = "summaries"
TRACES: Final = "traces"
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

ROWS_AT_ONCE: Final = 4096
"""Rows of an index that are read at once; one of them may hold a whole curve."""

RUN: Final = Dataset(name="run", dtype="<i8", units="1", symbol="r", long_name="row number of the run")
POINT: Final = Dataset(name="point", dtype="<i8", units="1", symbol="p", long_name="number of the point")


@dataclass(frozen=True, slots=True, kw_only=True)
class Filled:
    """A column of the index with its values: numbers, or texts as bytes of one length."""

    about: Dataset
    values: NDArray[Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Stack:
    """Runs with the same ticks and the same columns: their rows in /runs, and the relative paths of their files.

    ``slider``: rows of /slider in each of them, None if every run has another number.
    """

    rows: Sequence[int]
    files: Sequence[str]
    features: frozenset[Feature]
    ticks: int
    slider: int | None

    @property
    def groups(self) -> dict[Group, int]:
        """The groups of columns of which its runs have equally many rows, and how many."""
        of_slider = {SLIDER: self.slider} if "slider" in self.features and self.slider is not None else {}
        of_load = {LOAD: self.ticks} if "load" in self.features else {}
        return {TRACE: self.ticks} | of_slider | of_load

    def columns(self, group: Group) -> tuple[Dataset, ...]:
        """The columns of a group that its runs have, the scale first."""
        return stored_columns(group, self.features)


Arrays = Iterable[tuple[int, Mapping[str, NDArray[Any]]]]
"""Arrays by name, with the row that they belong to."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Index:
    """The content of an index: keys by table, columns of points and runs, stacks of similar runs, and arrays of both.

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
    stacks: Sequence[Stack]
    arrays_of_runs: Arrays = ()
    arrays_of_points: Arrays = ()


def write_index(path: Path, index: Index) -> None:
    """Write an index into an empty file; raises OSError if the disk fails."""
    with unfailing(path) as target, h5py.File(target, "w", libver=LIBRARY_VERSIONS) as file:
        compose_index(file, index)


def compose_index(file: h5py.File, index: Index) -> None:
    """Write an index into an empty file."""
    describe(file, index)
    for number, stack in enumerate(index.stacks):
        for group, rows in stack.groups.items():
            _refer(file.create_group(f"{TRACES}/{number}/{group.name}", track_order=True), group, rows, stack)


def seal_of_index(attributes: Mapping[str, str], hashes: Mapping[str, str]) -> str:
    """Return the xxh3_128 of a JSON text with the index's attributes and the hashes of its columns.

    ``attributes`` are those in TEXTS, ``hashes`` stand under paths such as /runs/seed; names are sorted.
    """
    text = json.dumps([attributes, hashes], sort_keys=True, separators=(",", ":"))
    return xxhash.xxh3_128_hexdigest(text.encode())


def describe(file: h5py.File, index: Index) -> None:
    """Write everything but the traces: the sweep's attributes, its runs, and the figures kept instead of files."""
    texts = {
        "Conventions": CONVENTIONS,
        "format": FORMAT,
        "title": index.title,
        "source": f"rubnoise {package_version('rubnoise')}",
        "written": now(),
        "command": index.command,
        "scenario_toml": index.scenario_toml,
        "scenario_resolved": json.dumps(index.scenario_resolved, ensure_ascii=False),
        "grid": json.dumps(list(index.grid)),
        "side_by_side": json.dumps(list(index.side_by_side)),
        "NX_class": "NXroot",
    }
    for name, text in texts.items():
        put_text(file, name, text)
    file.attrs.create("format_version", FORMAT_VERSION, dtype="<i8")
    for name, about, columns, arrays in (
        (POINTS, POINT, index.points, index.arrays_of_points),
        (RUNS, RUN, index.runs, index.arrays_of_runs),
    ):
        owner = file.create_group(name, track_order=True)
        scale = create_scale(owner, about, np.arange(columns[0].values.size))
        for column in columns:
            attach(described(owner, column.about, column.values), scale)
        _keep_arrays(file, arrays, scale)
    attributes = {name: text_bytes(texts[name]).decode("utf-8", "replace").rstrip("\0") for name in TEXTS}
    owners = [file[name] for name in (POINTS, RUNS, SUMMARIES) if name in file]
    hashes = {dataset.name: str(dataset.attrs[HASH], "ascii") for owner in owners for dataset in owner.values()}
    put_text(file, HASH, seal_of_index(attributes, hashes))


def create_scale(owner: h5py.Group, about: Dataset, values: NDArray[Any]) -> h5py.Dataset:
    """Create the column on which the others depend."""
    scale = described(owner, about, values)
    scale.make_scale(about.name)
    return scale


def described(owner: h5py.Group, about: Dataset, values: NDArray[Any]) -> h5py.Dataset:
    """Create a column with its values, their description and their hash."""
    raw = np.asarray(values, dtype=about.dtype)
    dataset = describe_column(owner.create_dataset(about.name, data=raw), about)
    put_text(dataset, HASH, xxhash.xxh3_128_hexdigest(np.ascontiguousarray(raw).data))
    return dataset


def describe_column(dataset: h5py.Dataset, about: Dataset) -> h5py.Dataset:
    """Write the attributes that describe a dataset."""
    for name, text in {"units": about.units, "long_name": about.long_name, "symbol": about.symbol}.items():
        if text:
            put_text(dataset, name, text)
    return dataset


def attach(dataset: h5py.Dataset, *scales: h5py.Dataset) -> None:
    """Attach dimension scales, the first one to the first dimension."""
    for dimension, scale in zip(dataset.dims, scales, strict=False):
        dimension.attach_scale(scale)


def _refer(owner: h5py.Group, group: Group, count: int, stack: Stack) -> None:
    """Write a stack of similar runs as datasets over run and row; the values stay in the files of the runs."""
    about, *rest = stack.columns(group)
    runs = create_scale(owner, RUN, np.asarray(stack.rows))
    # Similar runs have the same ticks: those of the first one serve for all.
    ticks = _virtual(owner, about, stack.files[:1], group, count, flat=True)
    ticks.make_scale(about.name)
    for column in rest:
        attach(_virtual(owner, column, stack.files, group, count, flat=False), runs, ticks)


def _virtual(
    owner: h5py.Group, about: Dataset, files: Sequence[str], group: Group, count: int, *, flat: bool
) -> h5py.Dataset:
    """Create a virtual dataset of columns in other files, by HDF5's own calls, since h5py's take five times as long."""
    shape = (count,) if flat else (len(files), count)
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    source, whole = h5py.h5s.create_simple((count,)), h5py.h5s.create_simple(shape)
    place = f"/{group.name}/{about.name}".encode()
    for row, file in enumerate(files):
        if not flat:
            whole.select_hyperslab((row, 0), (1, 1), block=(1, count))
        creation.set_virtual(whole, file.encode(), place, source)
    kind = h5py.h5t.py_create(np.dtype(about.dtype))
    space = h5py.h5s.create_simple(shape)
    dataset = h5py.Dataset(h5py.h5d.create(owner.id, about.name.encode(), kind, space, creation))
    return describe_column(dataset, about)


def _keep_arrays(file: h5py.File, arrays: Arrays, scale: h5py.Dataset) -> None:
    """Write arrays into their rows, one at a time in memory; rows without an array are nan or 0."""
    datasets: dict[str, h5py.Dataset] = {}
    for row, found in arrays:
        for name, values in found.items():
            if name not in datasets:
                missing = np.nan if np.issubdtype(values.dtype, np.floating) else 0
                shape = (scale.size, *values.shape)
                owner = file.require_group(SUMMARIES)
                datasets[name] = owner.create_dataset(name, shape, values.dtype, fillvalue=missing)
                attach(datasets[name], scale)
            datasets[name][row] = values
    for dataset in datasets.values():
        _put_hash(dataset)


def _put_hash(dataset: h5py.Dataset) -> None:
    """Read a column back in pieces, and write its hash as its attribute."""
    digest = xxhash.xxh3_128()
    for part in slices(0, dataset.shape[0], ROWS_AT_ONCE):
        digest.update(np.ascontiguousarray(dataset[part]).data)
    put_text(dataset, HASH, digest.hexdigest())


def index_structure(file: h5py.File, size: int) -> dict[str, Any]:
    """Return the places of an index's columns and its attributes; raises RunFileRefused for an invalid index."""
    if not h5py.h5a.exists(file.id, b"format") or read_attribute(file, "format") != FORMAT:
        raise RunFileRefused("is not the index of a sweep")
    version = read_integer(file, "format_version")
    if version > FORMAT_VERSION:
        return {"too_new": f"has format version {version}; this one reads versions up to {FORMAT_VERSION}"}
    attributes: dict[str, Scalar] = {name: read_text(file, name) for name in TEXTS}
    groups = {name: dict(_index_columns(sound_group(file, name), size)) for name in (POINTS, RUNS)}
    if has_hard_link(file, SUMMARIES):
        groups[SUMMARIES] = dict(_index_columns(sound_group(file, SUMMARIES), size))
    seal = read_text(file, HASH) if h5py.h5a.exists(file.id, HASH.encode()) else None
    return {"index": attributes, "columns": groups, "seal": seal}


def _index_columns(owner: h5py.Group, size: int) -> Iterator[tuple[str, dict[str, Any]]]:
    for name in owner:
        yield name, _index_column(owner, name, size)


def _index_column(owner: h5py.Group, name: str, size: int) -> dict[str, Any]:
    path = f"{owner.name}/{name}"
    dataset = owner[name] if has_hard_link(owner, name) else None
    if not isinstance(dataset, h5py.Dataset) or not dataset.ndim:
        raise RunFileRefused(f"{path} is no column")
    creation, kind = dataset.id.get_create_plist(), dataset.dtype
    if creation.get_layout() != h5py.h5d.CONTIGUOUS or creation.get_external_count() or not _is_plain(kind):
        raise RunFileRefused(f"{path} is not stored as an index stores it")
    offset = dataset.id.get_offset() or 0
    if dataset.size and not dataset.id.get_storage_size() == dataset.nbytes <= size - offset:
        raise RunFileRefused(f"{path} has rows that are not in the file")
    attributes = {
        about: read_attribute(dataset, about) for about in ("units", "long_name", HASH) if about in dataset.attrs
    }
    return {"offset": offset, "shape": list(dataset.shape), "dtype": kind.str} | attributes


def _is_plain(kind: Any) -> bool:
    """Whether values are doubles, whole numbers of 64 bits or texts of fixed length."""
    return kind.str in {"<f8", "<i8"} or (kind.kind == "S" and not kind.names and kind.itemsize > 0)

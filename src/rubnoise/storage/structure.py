"""The result file as HDF5 sees it: groups, datasets of final size, scales and attributes, without a single row."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import Shape
from rubnoise.storage.layout import RunDescription, row_count, stored_columns, stored_groups
from rubnoise.storage.provenance import Provenance, package_version
from rubnoise.storage.pulse import pulse_of
from rubnoise.storage.schema import (
    CHUNK_ROWS,
    CONVENTIONS,
    FORMAT,
    FORMAT_VERSION,
    GROUPS,
    HASH,
    HASH_DIGITS,
    JUNCTION_AREA_FORMULAS,
    Column,
    Feature,
    Group,
    Scalar,
)

LIBRARY_VERSIONS = ("v110", "v110")
GZIP_LEVEL = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where the bytes of a contiguous column lie in its file; without rows they lie nowhere and the offset is 0."""

    offset: int
    rows: int
    dtype: str


def compose(file: h5py.File, description: RunDescription, *, compressed: bool) -> None:
    """Build the whole structure in an empty file; columns are contiguous, or chunks when ``compressed``."""
    root = root_attributes(description.title, pulse_of(description.scenario_resolved).shape)
    for name, value in (root | {"NX_class": "NXroot", "default": "trace"}).items():
        _put(file, name, value)
    for group in stored_groups(description.features):
        rows = row_count(group, description.extent)
        _compose_group(file, group, description.features, rows, compressed=compressed)
    summary = file.create_group("summary", track_order=True)
    put_text(summary, "NX_class", "NXcollection")
    provenance = file.create_group("provenance")
    for name, value in ({"NX_class": "NXcollection"} | provenance_attributes(description)).items():
        _put(provenance, name, value)


def complete(
    file: h5py.File,
    digests: Mapping[tuple[str, str], str],
    summary: Mapping[str, Scalar],
    finished: str,
) -> None:
    """Fill in what is known only when the last row is written: hashes, summary and the time of the end."""
    owners = {group: file[group].id for group, _ in digests}
    for (group, column), digest in digests.items():
        put_text(h5py.Dataset(h5py.h5d.open(owners[group], column.encode())), HASH, digest)
    for name, value in summary.items():
        _put(file["summary"], name, value)
    put_text(file["provenance"], "finished", finished)


def places(file: h5py.File) -> dict[tuple[str, str], Place]:
    """Return where every contiguous column of a file lies."""
    return {
        (group.name, column.name): _place(h5py.h5d.open(owner.id, column.name.encode()), column)
        for group in GROUPS
        if (owner := file.get(group.name)) is not None
        for names in [set(owner)]
        for column in group.columns
        if column.name in names
    }


def put_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Write a text attribute of fixed length, in UTF-8."""
    _put_texts(owner, name, text)


def _place(dataset: h5py.h5d.DatasetID, column: Column) -> Place:
    return Place(offset=dataset.get_offset() or 0, rows=dataset.shape[0], dtype=column.dtype)


def root_attributes(title: str, shape: Shape) -> dict[str, Scalar]:
    """Return what the root of a file says about it."""
    return {
        "Conventions": CONVENTIONS,
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": title,
        "source": f"rubnoise {package_version('rubnoise')}",
        "junction_area_formula": JUNCTION_AREA_FORMULAS[shape],
    }


def _compose_group(file: h5py.File, group: Group, features: frozenset[Feature], rows: int, *, compressed: bool) -> None:
    owner = _create_group(file, group.name)
    columns = stored_columns(group, features)
    datasets = [_create_dataset(owner, column, rows, compressed=compressed) for column in columns]
    scale, *rest = datasets
    scale.make_scale(columns[0].name)
    for dataset in rest:
        dataset.dims[0].attach_scale(scale)
    _describe_group(owner, group, columns[0].name)
    for column, dataset in zip(columns, datasets, strict=True):
        _describe_column(dataset, column)


def _create_group(file: h5py.File, name: str) -> h5py.Group:
    """Create a group that remembers the order of its columns, so that viewers list them as the schema does."""
    creation = h5py.h5p.create(h5py.h5p.GROUP_CREATE)
    creation.set_obj_track_times(False)
    creation.set_link_creation_order(h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED)
    return h5py.Group(h5py.h5g.create(file.id, name.encode(), gcpl=creation))


def _create_dataset(owner: h5py.Group, column: Column, rows: int, *, compressed: bool) -> h5py.Dataset:
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_obj_track_times(False)
    if compressed and rows:
        creation.set_chunk((min(rows, CHUNK_ROWS),))
        creation.set_shuffle()
        creation.set_deflate(GZIP_LEVEL)
    else:
        creation.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
        creation.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    kind = h5py.h5t.py_create(np.dtype(column.dtype))
    space = h5py.h5s.create_simple((rows,))
    return h5py.Dataset(h5py.h5d.create(owner.id, column.name.encode(), kind, space, creation))


def _describe_group(owner: h5py.Group, group: Group, scale: str) -> None:
    """Say what the group is, and in NeXus terms what to plot against what.

    One column only: viewers draw auxiliary signals on the axis of the first, where a force of 5e4 uN hides an area of
    200 um^2.
    """
    put_text(owner, "long_name", group.long_name)
    put_text(owner, "NX_class", "NXdata")
    put_text(owner, "signal", group.plotted)
    _put_texts(owner, "axes", [scale])


def _describe_column(dataset: h5py.Dataset, column: Column) -> None:
    put_text(dataset, "units", column.units)
    put_text(dataset, "long_name", column.long_name)
    put_text(dataset, "symbol", column.symbol)
    put_text(dataset, HASH, "0" * HASH_DIGITS)
    if column.flags:
        dataset.attrs.create("flag_masks", [bit for bit, _ in column.flags], dtype=column.dtype)
        put_text(dataset, "flag_meanings", " ".join(meaning for _, meaning in column.flags))


def provenance_attributes(description: RunDescription) -> dict[str, Scalar]:
    """Return what a file says of its origin before the run has finished."""
    origin: Provenance = description.provenance
    return {
        "scenario_toml": description.scenario_toml,
        "scenario_resolved": json.dumps(description.scenario_resolved, ensure_ascii=False),
        "software": json.dumps(dict(origin.software)),
        "environment": json.dumps(dict(origin.environment)),
        "seed": origin.seed,
        "stream_version": origin.stream_version,
        "calibrated_diameter": origin.calibrated_diameter,
        "propagator_constants": json.dumps(dict(origin.propagator_constants)),
        "command": origin.command,
        "started": origin.started,
        "finished": "",
    }


def _put(owner: h5py.HLObject, name: str, value: Scalar) -> None:
    if isinstance(value, str):
        put_text(owner, name, value)
    else:
        dtype = "<i8" if isinstance(value, int) else "<f8"
        _put_attribute(owner, name, np.array(value, dtype=dtype), _number_kind(dtype))


def text_bytes(text: str) -> bytes:
    """Return a text as it is stored: whatever is no character becomes an escape of one."""
    return text.encode("utf-8", "backslashreplace")


def _put_texts(owner: h5py.HLObject, name: str, text: str | Sequence[str]) -> None:
    """Write one text or a list of texts; at least two bytes long, as h5netcdf hands single bytes over undecoded."""
    raw = [text_bytes(item) for item in ([text] if isinstance(text, str) else text)]
    size = max(2, *map(len, raw))
    value = np.array(raw[0] if isinstance(text, str) else raw, dtype=f"S{size}")
    _put_attribute(owner, name, value, _text_kind(size))


def _put_attribute(owner: h5py.HLObject, name: str, value: NDArray[Any], kind: h5py.h5t.TypeID) -> None:
    """Write an attribute, also over one of its name; by HDF5's own calls, as h5py's take longer than a short run."""
    key = name.encode()
    if h5py.h5a.exists(owner.id, key):
        h5py.h5a.delete(owner.id, key)
    space = h5py.h5s.create_simple(value.shape) if value.ndim else _scalar_space()
    h5py.h5a.create(owner.id, key, kind, space).write(value, kind)


@lru_cache(maxsize=256)
def _text_kind(size: int) -> h5py.h5t.TypeID:
    return h5py.h5t.py_create(h5py.string_dtype("utf-8", size), logical=True)


@cache
def _number_kind(dtype: str) -> h5py.h5t.TypeID:
    return h5py.h5t.py_create(np.dtype(dtype), logical=True)


@cache
def _scalar_space() -> h5py.h5s.SpaceID:
    return h5py.h5s.create(h5py.h5s.SCALAR)

"""Write the structure of a result file with HDF5: groups, columns of their final size, scales and attributes; no rows.

`compose` makes a whole file as far as it is known before the first row; `add_group` adds a group whose number of rows,
or of bytes, only the end of the run shows; `complete` writes what else is known then.
"""

import json
from collections.abc import Mapping
from functools import cache, lru_cache
from typing import Any, Final

import h5py
import numpy as np
from numpy.typing import NDArray

from rubnoise.storage.layout import Name, RunDescription, grows, row_count, stored_groups
from rubnoise.storage.life_curve import JUNCTION_AREA_FORMULAS, TOUCH_AREA_FORMULA, pulse_of
from rubnoise.storage.provenance import package_version
from rubnoise.storage.run_structure import INTERVENTION, seal_of
from rubnoise.storage.schema import (
    CHUNK_ROWS,
    CONVENTIONS,
    FORMAT,
    FORMAT_VERSION,
    HASH,
    HASH_DIGITS,
    Dataset,
    Group,
    Scalar,
)

LIBRARY_VERSIONS: Final = ("v110", "v110")
GZIP_LEVEL: Final = 4
ATTRIBUTES_IN_HEADER: Final = 1 << 15
"""More than any group has."""


def compose(file: h5py.File, about: RunDescription) -> dict[Name, int]:
    """Write the structure of a run into an empty file, and return the places of the columns whose rows are known.

    Groups that grow, and all groups of a compressed file, are left out: they need their rows (see `add_group`).
    """
    for name, value in ({**root_attributes(about), "NX_class": "NXroot", "default": "trace"}).items():
        _put(file.id, name, value)
    places: dict[Name, int] = {}
    for group in stored_groups(about.features):
        if about.compression == "none" and not grows(group, about.extent):
            places |= add_group(file, group, row_count(group, about.extent), "none")
    _put(_create_notes(file, "summary"), "NX_class", "NXcollection")
    provenance = _create_notes(file, "provenance")
    begun = {**provenance_attributes(about), "finished": "", HASH: "0" * HASH_DIGITS}
    for name, value in ({"NX_class": "NXcollection"} | begun).items():
        _put(provenance, name, value)
    return places


def add_group(file: h5py.File, group: Group, rows: int, compression: str) -> dict[Name, int]:
    """Write a group with space for its rows, and return the places of its columns; 0 without rows, or in chunks."""
    owner = _create_group(file, group.name)
    space = h5py.h5s.create_simple((rows,))
    creation = _chunked(min(rows, CHUNK_ROWS)) if compression == "gzip" and rows else _contiguous()
    columns = [
        (column, h5py.h5d.create(owner, column.name.encode(), _number_kind(column.dtype), space, creation))
        for column in group.columns
    ]
    (first, scale), *rest = columns
    h5py.h5ds.set_scale(scale, first.name.encode())
    for _, dataset in rest:
        h5py.h5ds.attach_scale(dataset, scale, 0)
    _describe_group(owner, group, first.name)
    for column, dataset in columns:
        _describe_column(dataset, column)
    return {(group.name, column.name): dataset.get_offset() or 0 for column, dataset in columns}


def complete(
    file: h5py.File, about: RunDescription, digests: Mapping[Name, str], summary: Mapping[str, Scalar], finished: str
) -> None:
    """Write what is known only after the last row: hashes of the columns, summary, end time and seal."""
    owners = {group: h5py.h5g.open(file.id, group.encode()) for group, _ in digests}
    for (group, column), digest in digests.items():
        h5py.h5a.open(h5py.h5d.open(owners[group], column.encode()), HASH.encode()).write(*_text(digest))
    figures, provenance = h5py.h5g.open(file.id, b"summary"), h5py.h5g.open(file.id, b"provenance")
    for name, value in summary.items():
        _put(figures, name, value)
    origin = {**provenance_attributes(about), "finished": finished}
    seal = seal_of(*map(_as_stored, (root_attributes(about), summary, origin)))
    for name, value in (("finished", finished), (HASH, seal)):
        h5py.h5a.delete(provenance, name.encode())
        _put(provenance, name, value)


def put_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Write a new text attribute of fixed length, in UTF-8."""
    _put(owner.id, name, text)


def text_bytes(text: str) -> bytes:
    """Return a text as it is stored: invalid characters (lone surrogates) become escapes."""
    return text.encode("utf-8", "backslashreplace")


def root_attributes(about: RunDescription) -> dict[str, Scalar]:
    """Return the attributes of the root of a file."""
    formula = JUNCTION_AREA_FORMULAS[pulse_of(about.scenario_resolved).name]
    return {
        "Conventions": CONVENTIONS,
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": about.title,
        "source": f"rubnoise {package_version('rubnoise')}",
        "junction_area_formula": TOUCH_AREA_FORMULA if "free" in about.features else formula,
    }


def provenance_attributes(about: RunDescription) -> dict[str, Scalar]:
    """Return the attributes of /provenance that are known before the run has ended."""
    origin = about.provenance
    return {
        "scenario_toml": about.scenario_toml,
        "scenario_resolved": json.dumps(about.scenario_resolved, ensure_ascii=False),
        "software": json.dumps(dict(origin.software)),
        "environment": json.dumps(dict(origin.environment)),
        "seed": origin.seed,
        "stream_version": origin.stream_version,
        "calibrated_diameter": origin.calibrated_diameter,
        "propagator_constants": json.dumps(dict(origin.propagator_constants)),
        "command": origin.command,
        **({INTERVENTION: origin.intervention} if origin.intervention else {}),
        "started": origin.started,
    }


def _create_group(file: h5py.File, name: str) -> h5py.h5g.GroupID:
    """Create a group that keeps the order of its columns, so that viewers list them as the schema does."""
    creation = h5py.h5p.create(h5py.h5p.GROUP_CREATE)
    creation.set_obj_track_times(False)
    creation.set_link_creation_order(h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED)
    return h5py.h5g.create(file.id, name.encode(), gcpl=creation)


def _create_notes(file: h5py.File, name: str) -> h5py.h5g.GroupID:
    """Create a group for attributes that keeps their order, and stores all of them in its header.

    HDF5 has checksums for headers, and none for long texts stored elsewhere, which is its default. Only attributes that
    would make a header longer than 64 kB are still stored elsewhere.
    """
    creation = h5py.h5p.create(h5py.h5p.GROUP_CREATE)
    creation.set_obj_track_times(False)
    creation.set_attr_creation_order(h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED)
    creation.set_attr_phase_change(ATTRIBUTES_IN_HEADER, 0)
    return h5py.h5g.create(file.id, name.encode(), gcpl=creation)


@cache
def _contiguous() -> h5py.h5p.PropDCID:
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_obj_track_times(False)
    creation.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    creation.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    return creation


def _chunked(rows: int) -> h5py.h5p.PropDCID:
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_obj_track_times(False)
    creation.set_chunk((rows,))
    creation.set_shuffle()
    creation.set_deflate(GZIP_LEVEL)
    return creation


def _describe_group(owner: h5py.h5g.GroupID, about: Group, scale: str) -> None:
    """Write the group's description, and the NeXus attributes that tell viewers which columns to plot.

    They name one column only: viewers draw further signals on the axis of the first, where a force of 5e4 uN hides an
    area of 200 um^2.
    """
    _put(owner, "long_name", about.long_name)
    _put(owner, "NX_class", "NXdata")
    _put(owner, "signal", about.plotted)
    _put(owner, "axes", (scale,))


def _describe_column(dataset: h5py.h5d.DatasetID, column: Dataset) -> None:
    _put(dataset, "units", column.units)
    _put(dataset, "long_name", column.long_name)
    _put(dataset, "symbol", column.symbol)
    _put(dataset, HASH, "0" * HASH_DIGITS)
    attribute, codes = column.coded
    if codes:
        numbers = np.array([number for number, _ in codes], dtype=column.dtype)
        _create(dataset, attribute.encode(), numbers, _number_kind(column.dtype))
        _put(dataset, "flag_meanings", " ".join(meaning for _, meaning in codes))


def _put(owner: h5py.h5g.GroupID, name: str, value: Scalar | tuple[str, ...]) -> None:
    """Write a new attribute by HDF5's own calls, since h5py's take longer than a short run."""
    _create(owner, name.encode(), *_stored(value))


def _create(owner: h5py.h5g.GroupID, key: bytes, value: NDArray[Any], kind: h5py.h5t.TypeID) -> None:
    space = h5py.h5s.create_simple(value.shape) if value.ndim else _scalar_space()
    h5py.h5a.create(owner, key, kind, space).write(value, kind)


def _stored(value: Scalar | tuple[str, ...]) -> tuple[NDArray[Any], h5py.h5t.TypeID]:
    """Return a value as it is stored in an attribute, and its type there."""
    if isinstance(value, str | tuple):
        return _text(value)
    dtype = "<i8" if isinstance(value, int) else "<f8"
    return np.array(value, dtype=dtype), _number_kind(dtype)


@lru_cache(maxsize=256)
def _text(text: str | tuple[str, ...]) -> tuple[NDArray[Any], h5py.h5t.TypeID]:
    """Return one text or a list of texts, at least two bytes long, since h5netcdf does not decode single bytes."""
    raw = [text_bytes(item) for item in ([text] if isinstance(text, str) else text)]
    size = max(2, *map(len, raw))
    return np.array(raw[0] if isinstance(text, str) else raw, dtype=f"S{size}"), _text_kind(size)


@lru_cache(maxsize=256)
def _text_kind(size: int) -> h5py.h5t.TypeID:
    return h5py.h5t.py_create(h5py.string_dtype("utf-8", size), logical=True)


@cache
def _number_kind(dtype: str) -> h5py.h5t.TypeID:
    return h5py.h5t.py_create(np.dtype(dtype), logical=True)


@cache
def _scalar_space() -> h5py.h5s.SpaceID:
    return h5py.h5s.create(h5py.h5s.SCALAR)


def _as_stored(values: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return attributes as they are read back."""
    return {
        name: text_bytes(value).decode("utf-8", "replace").rstrip("\0") if isinstance(value, str) else value
        for name, value in values.items()
    }

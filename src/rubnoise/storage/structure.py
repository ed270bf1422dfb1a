"""Write a result file with HDF5, without its rows: groups, datasets of final size, scales and attributes."""

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from rubnoise.storage.columns import ColumnFile
from rubnoise.storage.layout import ByteRange, Name, RunDescription, row_count, stored_groups
from rubnoise.storage.life_curve import JUNCTION_AREA_FORMULAS, TOUCH_AREA_FORMULA, pulse_of
from rubnoise.storage.provenance import Provenance, package_version
from rubnoise.storage.run_structure import INTERVENTION, seal_of
from rubnoise.storage.schema import (
    CHUNK_ROWS,
    CONVENTIONS,
    FORMAT,
    FORMAT_VERSION,
    GROUPS,
    HASH,
    HASH_DIGITS,
    Dataset,
    Feature,
    Group,
    Scalar,
    motion_of,
)

LIBRARY_VERSIONS = ("v110", "v110")
GZIP_LEVEL = 4
ATTRIBUTES_IN_HEADER = 1 << 15
"""More than any group has."""


def compose(file: h5py.File, description: RunDescription, *, compressed: bool) -> dict[Name, ByteRange]:
    """Write the whole structure into an empty file, and return the places of its columns.

    Columns are contiguous; if ``compressed`` they are chunks, which have no place of their own.
    """
    root = root_attributes(description)
    for name, value in (root | {"NX_class": "NXroot", "default": "trace"}).items():
        _put(file.id, name, value)
    places: dict[Name, ByteRange] = {}
    for group in stored_groups(description.features):
        rows = row_count(group, description.extent)
        for column, dataset in _compose_group(file, group, rows, compressed=compressed):
            places[group.name, column.name] = _place(dataset, column, rows)
    _put(_create_notes(file, "summary"), "NX_class", "NXcollection")
    provenance = _create_notes(file, "provenance")
    for name, value in ({"NX_class": "NXcollection"} | provenance_attributes(description)).items():
        _put(provenance, name, value)
    return places


def enlarge(file: h5py.File, rows: Mapping[str, int]) -> dict[Name, ByteRange]:
    """Replace growing groups by groups with space for all of their rows, and return the places of their columns."""
    places: dict[Name, ByteRange] = {}
    for name, count in rows.items():
        group = next(group for group in GROUPS if group.name == name).as_in(motion_of(file["junctions"]))
        stored = replace(group, columns=tuple(column for column in group.columns if column.name in file[name]))
        del file[name]
        for column, dataset in _compose_group(file, stored, count, compressed=False):
            places[name, column.name] = _place(dataset, column, count)
    return places


@dataclass(frozen=True, slots=True)
class Words:
    """The attributes of a file's root and of /provenance as they are read back, also before its run has ended."""

    root: Mapping[str, Scalar]
    provenance: Mapping[str, Scalar]

    @classmethod
    def of(cls, description: RunDescription) -> Self:
        """Return the attributes of a run that has not ended."""
        provenance = _as_stored(provenance_attributes(description))
        del provenance[HASH]  # it stands apart, since it is taken of all the others
        return cls(_as_stored(root_attributes(description)), provenance)

    def at_the_end(self, finished: str) -> "Words":
        """Return the attributes of the run after its end."""
        return replace(self, provenance={**self.provenance, "finished": finished})

    def seal(self, summary: Mapping[str, Scalar]) -> str:
        """Return the hash of all attributes."""
        return seal_of(self.root, _as_stored(summary), self.provenance)


def complete(
    file: h5py.File,
    words: Words,
    digests: Mapping[Name, str],
    summary: Mapping[str, Scalar],
    finished: str,
) -> None:
    """Write everything that is known only after the last row: hashes, summary, end time and seal.

    ``words`` are the file's attributes, so that nothing is read from it.
    """
    owners = {group: h5py.h5g.open(file.id, group.encode()) for group, _ in digests}
    for (group, column), digest in digests.items():
        h5py.h5a.open(h5py.h5d.open(owners[group], column.encode()), HASH.encode()).write(*_text(digest))
    figures, provenance = h5py.h5g.open(file.id, b"summary"), h5py.h5g.open(file.id, b"provenance")
    _clear(figures)
    for name, value in summary.items():
        _put(figures, name, value)
    _replace(provenance, "finished", finished)
    _replace(provenance, HASH, words.at_the_end(finished).seal(summary))


def put_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Write a new text attribute of fixed length, in UTF-8."""
    _put(owner.id, name, text)


def _place(dataset: h5py.h5d.DatasetID, column: Dataset, rows: int) -> ByteRange:
    return ByteRange(offset=dataset.get_offset() or 0, rows=rows, dtype=column.dtype)


def root_attributes(description: RunDescription) -> dict[str, Scalar]:
    """Return the attributes of the root of a file."""
    formula = JUNCTION_AREA_FORMULAS[pulse_of(description.scenario_resolved).name]
    return {
        "Conventions": CONVENTIONS,
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": description.title,
        "source": f"rubnoise {package_version('rubnoise')}",
        "junction_area_formula": TOUCH_AREA_FORMULA if "free" in description.features else formula,
    }


def _compose_group(
    file: h5py.File,
    group: Group,
    rows: int,
    *,
    compressed: bool,
) -> list[tuple[Dataset, h5py.h5d.DatasetID]]:
    owner = _create_group(file, group.name)
    space = h5py.h5s.create_simple((rows,))
    creation = _chunked(min(rows, CHUNK_ROWS)) if compressed and rows else _contiguous()
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
    return columns


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


def provenance_attributes(description: RunDescription) -> dict[str, Scalar]:
    """Return the attributes of /provenance before the run has finished."""
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
        **({INTERVENTION: origin.intervention} if origin.intervention else {}),
        "started": origin.started,
        "finished": "",
        HASH: "0" * HASH_DIGITS,
    }


def text_bytes(text: str) -> bytes:
    """Return a text as it is stored: invalid characters (lone surrogates) become escapes."""
    return text.encode("utf-8", "backslashreplace")


def _put(owner: h5py.h5g.GroupID, name: str, value: Scalar | tuple[str, ...]) -> None:
    """Write a new attribute by HDF5's own calls, since h5py's take longer than a short run."""
    _create(owner, name.encode(), *_stored(value))


def _clear(notes: h5py.h5g.GroupID) -> None:
    """Remove the figures of an earlier ending from a summary."""
    names: list[bytes] = []
    h5py.h5a.iterate(notes, names.append)
    for name in names:
        if name != b"NX_class":
            h5py.h5a.delete(notes, name)


def _replace(owner: h5py.h5g.GroupID, name: str, value: Scalar) -> None:
    key = name.encode()
    if h5py.h5a.exists(owner, key):
        h5py.h5a.delete(owner, key)
    _create(owner, key, *_stored(value))


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


NamedColumn = tuple[tuple[str, str], ColumnFile]


@dataclass(frozen=True, slots=True)
class Written:
    """A file as this process has written it, and its structure if that is known (see read_structure)."""

    file: os.stat_result
    found: Mapping[str, Any] | None = None

    @classmethod
    def of(
        cls,
        file: os.stat_result,
        features: frozenset[Feature],
        words: Words,
        columns: Iterable[NamedColumn],
        summary: Mapping[str, Scalar],
        finished: str,
    ) -> Self:
        """Return a complete file of uncompressed columns."""
        words = words.at_the_end(finished)
        found = {
            "features": sorted(features),
            "columns": _columns(columns),
            "attributes": {"value": words.root},
            "summary": {"value": _as_stored(summary)},
            "provenance": {"value": words.provenance},
            "seal": {"value": words.seal(summary)},
        }
        return cls(file, found)

    def is_still(self, now: os.stat_result) -> bool:
        """Whether a file is this one, unchanged."""
        before = self.file
        return os.path.samestat(before, now) and (before.st_size, before.st_mtime_ns) == (now.st_size, now.st_mtime_ns)


def _columns(columns: Iterable[NamedColumn]) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for (group, name), column in columns:
        place = {"rows": column.rows, "digest": {"value": column.digest()}, "offset": column.offset}
        found.setdefault(group, {})[name] = place
    return found


def _as_stored(values: Mapping[str, Scalar]) -> dict[str, Scalar]:
    return {
        name: text_bytes(value).decode("utf-8", "replace").rstrip("\0") if isinstance(value, str) else value
        for name, value in values.items()
    }

"""What a result file or an index consists of, read with HDF5 as plain data; no row is read here.

HDF5 may crash, loop or take any memory on a file that was made to harm, so this runs in the sandbox, unless this
process has just made the file itself. Everything is asked for by name, and checked before it is looked into.
"""

import json
import os
from collections.abc import Callable, Iterator
from typing import Any

import h5py

from rubnoise.errors import RunFileRefused
from rubnoise.storage import index
from rubnoise.storage.checks import has_hard_link, read_attribute, read_integer, read_text, sound_dataset, sound_group
from rubnoise.storage.index import POINTS, RUNS, SUMMARIES, TEXTS
from rubnoise.storage.layout import stored_columns, stored_groups
from rubnoise.storage.pages import PagedFile
from rubnoise.storage.rows import REMEDY
from rubnoise.storage.schema import FORMAT, FORMAT_VERSION, HASH, Dataset, Feature, Scalar
from rubnoise.storage.seal import read_provenance, read_root, read_seal, read_summary


def read_structure(descriptor: int) -> bytes:
    """Return, as JSON, where the columns of an open file lie and what its attributes say, or why it is refused."""
    return structure_read_by(descriptor, lambda file: found_in(file, os.fstat(descriptor).st_size))


def structure_read_by(descriptor: int, find: Callable[[h5py.File], dict[str, Any]]) -> bytes:
    """Return, as JSON, what is found in an open file, or why it is refused."""
    try:
        with h5py.File(PagedFile(descriptor), "r") as file:
            found = find(file)
    except (RunFileRefused, OSError, RuntimeError, LookupError, ValueError, TypeError, MemoryError) as problem:
        found = {"refused": _reason(problem)}
    return json.dumps(found, ensure_ascii=False).encode("utf-8", "backslashreplace")


def found_in(file: h5py.File, size: int) -> dict[str, Any]:
    """Return what there is in a file of so many bytes; raises RunFileRefused and whatever HDF5 raises."""
    if _format(file) == index.FORMAT:
        return index_structure(file, size)
    version = _version(file)
    if version > FORMAT_VERSION:
        return {"too_new": version, "source": read_text(file, "source")}
    features = _features(file)
    return {
        "features": sorted(features),
        "columns": _columns(file, features, size),
        "attributes": _or_refusal(lambda: read_root(file)),
        "summary": _or_refusal(lambda: read_summary(file)),
        "provenance": _or_refusal(lambda: read_provenance(file)),
        "seal": _or_refusal(lambda: read_seal(file)),
    }


def _format(file: h5py.File) -> Scalar | None:
    return read_attribute(file, "format") if h5py.h5a.exists(file.id, b"format") else None


def _version(file: h5py.File) -> int:
    if _format(file) != FORMAT:
        raise RunFileRefused("is an HDF5 file, but not one of rubnoise")
    version = read_integer(file, "format_version")
    if version < 1:
        raise RunFileRefused(f"has format version {version}, which does not exist")
    return version


def _features(file: h5py.File) -> frozenset[Feature]:
    """Return what the run has beyond the bare contact, seen by the columns that only exist with it."""
    junctions = sound_group(file, "junctions")
    present: dict[Feature, bool] = {
        "strength": has_hard_link(junctions, "shear_strength"),
        "speed": has_hard_link(junctions, "birth_time"),
        "slider": has_hard_link(file, "slider"),
        "two-way": has_hard_link(file, "balance"),
        "offset": has_hard_link(junctions, "lateral_offset"),
        "load": has_hard_link(file, "load"),
        "free": has_hard_link(junctions, "encounter"),
    }
    present["base"] = present["slider"] and has_hard_link(sound_group(file, "slider"), "base_displacement")
    needed: list[tuple[Feature, str]] = [("speed", "birth_time")]
    needed += [] if present["base"] else [("strength", "shear_strength")]
    for feature, column in needed:
        if present["slider"] and not present[feature]:
            raise RunFileRefused(f"has a slider without a {feature}: /junctions/{column} is missing")
    if present["two-way"] and not present["slider"]:
        raise RunFileRefused("has /balance without /slider")
    if present["free"] and not (present["load"] and present["speed"]):
        raise RunFileRefused("has summits that are touched without /load and times")
    if has_hard_link(file, "landmarks") and not present["two-way"] and not present["free"]:
        raise RunFileRefused("has /landmarks without /balance")
    return frozenset(feature for feature, there in present.items() if there)


def _columns(file: h5py.File, features: frozenset[Feature], size: int) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for group in stored_groups(features):
        if group.added and not has_hard_link(file, group.name):
            continue
        owner = sound_group(file, group.name)
        columns = stored_columns(group, features)
        found[group.name] = {column.name: _column(owner, column, size) for column in columns}
    return found


def _column(owner: h5py.Group, column: Dataset, size: int) -> dict[str, Any]:
    dataset = sound_dataset(owner, column, size)
    place: dict[str, Any] = {"rows": dataset.size, "digest": _or_refusal(lambda: read_text(dataset, HASH))}
    if dataset.chunks is None:
        return place | {"offset": dataset.id.get_offset() or 0}
    return place | {"chunk_rows": dataset.chunks[0], "chunks": list(_chunks(dataset, size))}


def _chunks(dataset: h5py.Dataset, size: int) -> Iterator[tuple[int, int, int]]:
    """Yield offset, bytes and skipped filters of every chunk, in order; raises RunFileRefused if one is missing."""
    stored: dict[int, tuple[int, int, int]] = {}

    def note(chunk: Any) -> None:
        stored[chunk.chunk_offset[0]] = (chunk.byte_offset, chunk.size, chunk.filter_mask)

    dataset.id.chunk_iter(note)
    for first in range(0, dataset.size, dataset.chunks[0]):
        offset, count, skipped = stored.get(first, (size, 1, 0))
        if not 0 <= offset <= size - count:
            raise RunFileRefused(f"{dataset.name} has rows that are not in the file")
        yield offset, count, skipped


def _or_refusal(read: Callable[[], object]) -> dict[str, object]:
    """Return what could be read, or why not: a damaged attribute does not hide the rows."""
    try:
        return {"value": read()}
    except (RunFileRefused, OSError, RuntimeError, KeyError, ValueError, TypeError) as problem:
        return {"refused": _reason(problem)}


def _reason(problem: Exception) -> str:
    if isinstance(problem, RunFileRefused):
        return str(problem)
    what = "cut short" if "truncated file" in str(problem) else f"damaged: {problem}"
    return f"{what}; {REMEDY}"


def index_structure(file: h5py.File, size: int) -> dict[str, Any]:
    """Return where the columns of an index lie and what its attributes say; raises RunFileRefused for one unsound."""
    version = read_integer(file, "format_version")
    if version > index.FORMAT_VERSION:
        return {"too_new": version, "source": read_text(file, "source")}
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

"""What a result file consists of, found with HDF5 and handed on as plain data: no row is read here.

HDF5 may crash, loop or take any memory on a file that was made to harm, so that this is called in a child process (see
vetting), unless this process has just made the file itself. Everything is asked for by name, and checked before it is
looked into.
"""

import json
import os
from collections.abc import Callable, Iterator
from typing import Any

import h5py

from rubnoise.errors import RunFileRefused
from rubnoise.storage import index
from rubnoise.storage.index_survey import found_in_index
from rubnoise.storage.layout import stored_columns, stored_groups
from rubnoise.storage.pages import Overlay
from rubnoise.storage.rows import REMEDY
from rubnoise.storage.schema import FORMAT, FORMAT_VERSION, HASH, Column, Feature, Scalar
from rubnoise.storage.seal import read_provenance, read_root, read_seal, read_summary
from rubnoise.storage.soundness import (
    has_hard_link,
    read_attribute,
    read_integer,
    read_text,
    sound_dataset,
    sound_group,
)


def survey(descriptor: int) -> bytes:
    """Return, as JSON, where the columns of an open file lie and what its attributes say, or why it is refused."""
    return surveying(descriptor, lambda file, _: found_in(file, os.fstat(descriptor).st_size))


def surveying(descriptor: int, find: Callable[[h5py.File, int], dict[str, Any]]) -> bytes:
    """Return, as JSON, what is found in an open file by HDF5 and its descriptor, or why it is refused."""
    try:
        with h5py.File(Overlay(descriptor), "r") as file:
            found = find(file, descriptor)
    except (RunFileRefused, OSError, RuntimeError, LookupError, ValueError, TypeError, MemoryError) as problem:
        found = {"refused": _reason(problem)}
    return json.dumps(found, ensure_ascii=False).encode("utf-8", "backslashreplace")


def found_in(file: h5py.File, size: int) -> dict[str, Any]:
    """Return what there is in a file of so many bytes; raises RunFileRefused and whatever HDF5 raises."""
    if _format(file) == index.FORMAT:
        return found_in_index(file, size)
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
    """Return what the run has beyond the bare contact, told by the columns that only exist with it."""
    junctions = sound_group(file, "junctions")
    told: dict[Feature, bool] = {
        "strength": has_hard_link(junctions, "shear_strength"),
        "speed": has_hard_link(junctions, "birth_time"),
        "slider": has_hard_link(file, "slider"),
        "two-way": has_hard_link(file, "landmarks"),
    }
    needed: tuple[tuple[Feature, str], ...] = (("speed", "birth_time"), ("strength", "shear_strength"))
    for feature, column in needed:
        if told["slider"] and not told[feature]:
            raise RunFileRefused(f"has a slider without a {feature}: /junctions/{column} is missing")
    if told["two-way"] and not told["slider"]:
        raise RunFileRefused("has /landmarks without /slider")
    return frozenset(feature for feature, present in told.items() if present)


def _columns(file: h5py.File, features: frozenset[Feature], size: int) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for group in stored_groups(features):
        if group.added and not has_hard_link(file, group.name):
            continue
        owner = sound_group(file, group.name)
        columns = stored_columns(group, features)
        found[group.name] = {column.name: _column(owner, column, size) for column in columns}
    return found


def _column(owner: h5py.Group, column: Column, size: int) -> dict[str, Any]:
    dataset = sound_dataset(owner, column, size)
    place: dict[str, Any] = {"rows": dataset.size, "digest": _or_refusal(lambda: read_text(dataset, HASH))}
    if dataset.chunks is None:
        return place | {"offset": dataset.id.get_offset() or 0}
    return place | {"chunk_rows": dataset.chunks[0], "chunks": list(_chunks(dataset, size))}


def _chunks(dataset: h5py.Dataset, size: int) -> Iterator[tuple[int, int, int]]:
    """Yield offset, bytes and skipped filters of every chunk, in order; raises RunFileRefused where one is missing."""
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

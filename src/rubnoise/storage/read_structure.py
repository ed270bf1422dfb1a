"""Read the structure of a result file or an index with HDF5, as plain data; no row is read here.

HDF5 may crash, loop or take any memory on a file that was made to harm, so this runs in the sandbox, unless this
process has just made the file itself. Everything is read by name, and checked before it is opened.
"""

import json
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

import h5py
import numpy as np
import xxhash

from rubnoise.errors import UNFINISHED, RunFileRefused
from rubnoise.storage.index import FORMAT as INDEX
from rubnoise.storage.layout import stored_groups
from rubnoise.storage.pages import PagedFile
from rubnoise.storage.rows import REMEDY
from rubnoise.storage.schema import CHUNK_ROWS, FORMAT, FORMAT_VERSION, HASH, Dataset, Feature, Scalar

ROOT_ATTRIBUTES: Final = ("Conventions", "format", "format_version", "title", "source", "junction_area_formula")
PROVENANCE_TEXTS: Final = (
    "scenario_toml",
    "scenario_resolved",
    "software",
    "environment",
    "propagator_constants",
    "command",
    "started",
    "finished",
)
INTERVENTION: Final = "intervention"
"""What only a run has whose lives were ended from outside: the name of the function."""

PROVENANCE_NUMBERS: Final = ("seed", "stream_version", "calibrated_diameter")


def read_root(file: h5py.File) -> dict[str, Scalar]:
    """Return the attributes of the root by name; raises RunFileRefused if one is missing or not a plain value."""
    return {name: read_attribute(file, name) for name in ROOT_ATTRIBUTES}


def read_summary(file: h5py.File) -> dict[str, Scalar]:
    """Return the figures of /summary by name; raises RunFileRefused if one is not a plain value."""
    group = sound_group(file, "summary")
    count = h5py.h5a.get_num_attrs(group.id)
    if count > ATTRIBUTES_LIMIT:
        raise RunFileRefused(f"/summary has {count} attributes")
    return {name: read_attribute(group, name) for name in group.attrs if name != "NX_class"}


def read_provenance(file: h5py.File) -> dict[str, Scalar]:
    """Return the attributes of /provenance by name; raises RunFileRefused if one is missing or not a plain value."""
    group = sound_group(file, "provenance")
    names = [*PROVENANCE_TEXTS, *[INTERVENTION] * h5py.h5a.exists(group.id, INTERVENTION.encode())]
    texts: dict[str, Scalar] = {name: read_text(group, name) for name in names}
    return texts | {name: read_attribute(group, name) for name in PROVENANCE_NUMBERS}


def read_seal(file: h5py.File) -> str | None:
    """Return the hash that a file keeps of its attributes; None if it has none."""
    group = sound_group(file, "provenance")
    return read_text(group, HASH) if h5py.h5a.exists(group.id, HASH.encode()) else None


def seal_of(root: Mapping[str, Scalar], summary: Mapping[str, Scalar], provenance: Mapping[str, Scalar]) -> str:
    """Return the seal of a file in hexadecimal: the xxh3_128 of a JSON text of its attributes, summary and provenance.

    Names are sorted, characters beyond ASCII are escaped, and numbers have the digits that bring back their bits.
    """
    text = json.dumps([root, summary, provenance], sort_keys=True, separators=(",", ":"))
    return xxhash.xxh3_128_hexdigest(text.encode())


ATTRIBUTE_BYTES = 1 << 22
ATTRIBUTES_LIMIT = 256
LINKS_LIMIT = 256
"""More of either is in no file of ours; some room is left for what others add to it."""

DEFLATE_RATIO = 1032
"""The most that deflate can expand: more rows than that were never in the file."""


def sound_group(owner: h5py.Group, name: str) -> h5py.Group:
    """Return a group held by a hard link; raises RunFileRefused otherwise."""
    found = owner[name] if has_hard_link(owner, name) else None
    if not isinstance(found, h5py.Group):
        raise RunFileRefused(f"/{name} is missing")
    if found.id.get_num_objs() > LINKS_LIMIT:
        raise RunFileRefused(f"/{name} holds {found.id.get_num_objs()} objects")
    return found


def sound_dataset(owner: h5py.Group, column: Dataset, file_size: int) -> h5py.Dataset:
    """Return the dataset of a column if its type, shape and storage are those of the schema.

    Raises RunFileRefused for anything else: links of other kinds, external or virtual storage, filters other than
    shuffle and deflate, more rows than the file's bytes can hold.
    """
    path = f"{owner.name}/{column.name}"
    dataset = owner[column.name] if has_hard_link(owner, column.name) else None
    if not isinstance(dataset, h5py.Dataset):
        raise RunFileRefused(f"{path} is missing")
    # The layout before the shape: that of a virtual dataset may be found in other files only.
    creation = dataset.id.get_create_plist()
    if creation.get_layout() not in {h5py.h5d.CONTIGUOUS, h5py.h5d.CHUNKED} or creation.get_external_count():
        raise RunFileRefused(f"{path} is not stored as a run file stores it")
    if dataset.dtype != np.dtype(column.dtype) or dataset.ndim != 1:
        raise RunFileRefused(f"{path} holds {dataset.dtype} in {dataset.ndim} dimensions, not {column.dtype} in one")
    if not (_is_contiguous(dataset, file_size) or _is_gzip(dataset, file_size)):
        raise RunFileRefused(f"{path} is not stored as a run file stores it")
    return dataset


def read_attribute(owner: h5py.HLObject, name: str) -> Scalar:
    """Return a scalar attribute: text of fixed length, an integer or a double; raises RunFileRefused otherwise."""
    raw = name.encode()
    if not h5py.h5a.exists(owner.id, raw):
        raise RunFileRefused(f"{owner.name} attribute {name} is missing")
    attribute = h5py.h5a.open(owner.id, raw)
    kind = attribute.get_type()
    if attribute.shape != () or kind.get_size() > ATTRIBUTE_BYTES or not _is_plain(kind):
        raise RunFileRefused(f"{owner.name} attribute {name} is not a plain number or text")
    value = np.empty((), dtype=kind.dtype)
    attribute.read(value)  # by HDF5's own call: h5py's takes longer than all the rest of opening a file
    return value.item().decode("utf-8", "replace") if value.dtype.kind == "S" else value.item()


def read_text(owner: h5py.HLObject, name: str) -> str:
    """Return a text attribute; raises RunFileRefused for a number."""
    value = read_attribute(owner, name)
    if not isinstance(value, str):
        raise RunFileRefused(f"{owner.name} attribute {name} is not a text")
    return value


def read_integer(owner: h5py.HLObject, name: str) -> int:
    """Return an integer attribute; raises RunFileRefused for anything else."""
    value = read_attribute(owner, name)
    if not isinstance(value, int):
        raise RunFileRefused(f"{owner.name} attribute {name} is not an integer")
    return value


def has_hard_link(owner: h5py.Group, name: str) -> bool:
    """Return whether a group itself holds an object of this name, not a link to elsewhere."""
    raw = name.encode()
    return bool(owner.id.links.exists(raw)) and bool(owner.id.links.get_info(raw).type == h5py.h5l.TYPE_HARD)


def _is_plain(kind: h5py.h5t.TypeID) -> bool:
    if isinstance(kind, h5py.h5t.TypeStringID):
        return not kind.is_variable_str()
    return isinstance(kind, h5py.h5t.TypeIntegerID | h5py.h5t.TypeFloatID)


def _is_contiguous(dataset: h5py.Dataset, file_size: int) -> bool:
    if dataset.id.get_create_plist().get_layout() != h5py.h5d.CONTIGUOUS:
        return False
    offset = dataset.id.get_offset() or 0
    return dataset.size == 0 or bool(dataset.id.get_storage_size() == dataset.nbytes <= file_size - offset)


def _is_gzip(dataset: h5py.Dataset, file_size: int) -> bool:
    creation = dataset.id.get_create_plist()
    if creation.get_layout() != h5py.h5d.CHUNKED or creation.get_chunk() != (min(dataset.size, CHUNK_ROWS),):
        return False
    filters = [creation.get_filter(i)[0] for i in range(creation.get_nfilters())]
    stored = dataset.id.get_storage_size()
    return filters == [h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_DEFLATE] and bool(
        dataset.nbytes <= DEFLATE_RATIO * stored <= DEFLATE_RATIO * file_size
    )


def read_structure(descriptor: int) -> bytes:
    """Return the places of an open file's columns and its attributes as JSON, or the reason why it is refused."""
    return structure_read_by(descriptor, lambda file: found_in(file, os.fstat(descriptor).st_size))


def structure_read_by(descriptor: int, find: Callable[[h5py.File], dict[str, Any]]) -> bytes:
    """Return what ``find`` returns for an open file, as JSON, or the reason why the file is refused."""
    try:
        with h5py.File(PagedFile(descriptor), "r") as file:
            found = find(file)
    except (RunFileRefused, OSError, RuntimeError, LookupError, ValueError, TypeError, MemoryError) as problem:
        found = {"refused": _reason(problem)}
    return json.dumps(found, ensure_ascii=False).encode("utf-8", "backslashreplace")


def found_in(file: h5py.File, size: int) -> dict[str, Any]:
    """Return the structure of a file of the given size; raises RunFileRefused, and any error of HDF5."""
    if _format(file) == INDEX:
        return {"index": True}
    version = _version(file)
    if version > FORMAT_VERSION:
        return {"too_new": version, "source": read_text(file, "source")}
    origin = _or_refusal(lambda: read_provenance(file))
    if origin.get("value", {}).get("finished") == "":
        raise RunFileRefused(UNFINISHED)
    features = _features(file)
    return {
        "features": sorted(features),
        "columns": _columns(file, features, size),
        "attributes": _or_refusal(lambda: read_root(file)),
        "summary": _or_refusal(lambda: read_summary(file)),
        "provenance": origin,
        "seal": _or_refusal(lambda: read_seal(file)),
    }


def _format(file: h5py.File) -> Scalar | None:
    return read_attribute(file, "format") if h5py.h5a.exists(file.id, b"format") else None


def _version(file: h5py.File) -> int:
    if _format(file) != FORMAT:
        raise RunFileRefused("is an HDF5 file, but not one of rubnoise")
    version = read_integer(file, "format_version")
    if version < FORMAT_VERSION:
        raise RunFileRefused(
            f"has format version {version}, and this rubnoise reads version {FORMAT_VERSION}: run its scenario again"
        )
    return version


def _features(file: h5py.File) -> frozenset[Feature]:
    """Return the features of the run, found by the columns that exist only with them."""
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
        owner = sound_group(file, group.name)
        found[group.name] = {column.name: _column(owner, column, size) for column in group.columns}
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


def _or_refusal(read: Callable[[], object]) -> dict[str, Any]:
    """Return what was read or the reason why not, since one damaged attribute must not hide the rows."""
    try:
        return {"value": read()}
    except (RunFileRefused, OSError, RuntimeError, KeyError, ValueError, TypeError) as problem:
        return {"refused": _reason(problem)}


def _reason(problem: Exception) -> str:
    if isinstance(problem, RunFileRefused):
        return str(problem)
    what = "cut short" if "truncated file" in str(problem) else f"damaged: {problem}"
    return f"{what}; {REMEDY}"

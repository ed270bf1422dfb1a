"""What the index of a sweep consists of, as plain data; traces, which lie in other files, are not looked at.

Called by `survey`, in a child process.
"""

from collections.abc import Iterator
from typing import Any

import h5py

from rubnoise.errors import RunFileRefused
from rubnoise.storage.index import FORMAT_VERSION, POINTS, RUNS, SUMMARIES, TEXTS
from rubnoise.storage.schema import HASH, Scalar
from rubnoise.storage.soundness import has_hard_link, read_attribute, read_integer, read_text, sound_group


def found_in_index(file: h5py.File, size: int) -> dict[str, Any]:
    """Return where the columns of an index lie and what its attributes say; raises RunFileRefused for one unsound."""
    version = read_integer(file, "format_version")
    if version > FORMAT_VERSION:
        return {"too_new": version, "source": read_text(file, "source")}
    attributes: dict[str, Scalar] = {name: read_text(file, name) for name in TEXTS}
    groups = {name: dict(_columns(sound_group(file, name), size)) for name in (POINTS, RUNS)}
    if has_hard_link(file, SUMMARIES):
        groups[SUMMARIES] = dict(_columns(sound_group(file, SUMMARIES), size))
    seal = read_text(file, HASH) if h5py.h5a.exists(file.id, HASH.encode()) else None
    return {"index": attributes, "columns": groups, "seal": seal}


def _columns(owner: h5py.Group, size: int) -> Iterator[tuple[str, dict[str, Any]]]:
    for name in owner:
        yield name, _column(owner, name, size)


def _column(owner: h5py.Group, name: str, size: int) -> dict[str, Any]:
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
    told = {about: read_attribute(dataset, about) for about in ("units", "long_name", HASH) if about in dataset.attrs}
    return {"offset": offset, "shape": list(dataset.shape), "dtype": kind.str} | told


def _is_plain(kind: Any) -> bool:
    """Whether values are doubles, whole numbers of 64 bits or texts of fixed length."""
    return kind.str in {"<f8", "<i8"} or (kind.kind == "S" and not kind.names and kind.itemsize > 0)

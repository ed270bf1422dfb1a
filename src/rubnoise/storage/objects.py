"""Objects of an HDF5 file from elsewhere: each is found by name, over hard links alone, and checked before it is read.

So a file leads to no other file, and nothing in it is counted or read that no file of ours has so much of.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import h5py
import numpy as np

from rubnoise.errors import RunFileRefused
from rubnoise.storage.schema import CHUNK_ROWS, Dataset, Scalar

REMEDY: Final = "copy it again, or run its scenario again"

ATTRIBUTE_BYTES = 1 << 22
ATTRIBUTES_LIMIT = 256
LINKS_LIMIT = 256
"""More of either is in no file of ours; some room is left for what others add to it."""

DEFLATE_RATIO = 1032
"""The most that deflate can expand: more rows than that were never in the file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where the rows of a column lie in their file; the offset is 0 without rows, and for compressed chunks."""

    offset: int
    rows: int
    dtype: str


def opened_by_hdf5(path: str | os.PathLike[str], descriptor: int) -> h5py.File:
    """Open the file of a descriptor with HDF5, also if another one has its name by now.

    Locks are those of h5py's default, since HDF5 refuses a file that this process has open in another way.

    Raises RunFileRefused where the system knows descriptors by no name, and another file has the path.
    """
    name = Path("/dev/fd", str(descriptor))
    file = h5py.File(name if name.exists() else path, "r", locking="best-effort")
    if os.path.samestat(os.fstat(descriptor), os.fstat(file.id.get_vfd_handle())):
        return file
    file.close()
    raise RunFileRefused("has changed since it was opened")


@contextmanager
def naming_damage() -> Iterator[None]:
    """Turn what HDF5 and h5py raise on a damaged file, which may be any error, into a refusal."""
    try:
        yield
    except RunFileRefused:
        raise
    except Exception as problem:
        raise RunFileRefused(reason_of(problem)) from problem


def reason_of(problem: Exception) -> str:
    """Return why a file cannot be read, in a few words."""
    if isinstance(problem, RunFileRefused):
        return str(problem)
    text = " ".join(str(problem).split())
    return f"cut short; {REMEDY}" if "truncated file" in text else f"damaged: {text}; {REMEDY}"


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

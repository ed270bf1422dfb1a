"""Objects of an HDF5 file from elsewhere: each is found by name, over hard links alone, and checked before it is read.

So a file leads to no other file, and nothing in it is counted or read that no file of ours has so much of.
"""

import os
import re
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from math import ceil
from pathlib import Path
from types import UnionType
from typing import Any, Final

import h5py
import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import Refused, RunFileRefused, advised, reason_of
from rubnoise.storage.schema import CHUNK_ROWS, HASH, Dataset, Scalar

REMEDY: Final = "copy it again, or run its scenario again"
ATTRIBUTE_BYTES: Final = 1 << 22
_WORDS: Final[Mapping[Any, str]] = {str: "a text", int: "a whole number"}

OWN: Final = (h5py.h5d.CONTIGUOUS, h5py.h5d.CHUNKED)  # layouts of our datasets
MOST: Final = 256
"""More objects in a group, or attributes of one, are in no file of ours; some room is left for what others add."""

DEFLATE_RATIO: Final = 1032  # the most that deflate can expand: more rows than that were never in the file


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
def naming_damage(words: str = "damaged", remedy: str = REMEDY, kind: type[Refused] = RunFileRefused) -> Iterator[None]:
    """Turn what a library raises on a damaged file, which may be any error, into a refusal: ``words``, and why."""
    try:
        yield
    except Refused:
        raise
    except Exception as problem:
        text = " ".join(re.sub(r"'?<\S+ object at \w+>'?|`", "", reason_of(problem)).split())
        why = "cut short" if "truncated file" in text else text[:200].rstrip(".")
        raise kind(advised(f"{words}: {why}", remedy)) from problem


def check_count(place: str, count: int, what: str, most: int = MOST) -> None:
    """Raise RunFileRefused for more objects or attributes than files of ours have."""
    if count > most:
        raise RunFileRefused(f"{place} holds {count} {what}")


def linked(owner: h5py.HLObject, path: str, *, soft: int = 0) -> h5py.HLObject | None:
    """Return the object at a path, reached by hard links, and by so many soft ones, within the file; None else."""
    first, _, rest = path.strip("/").partition("/")
    if not first:
        return owner
    link = owner.get(first, getlink=True) if isinstance(owner, h5py.Group) else None
    if isinstance(link, h5py.SoftLink) and soft:
        return linked(owner.file if link.path.startswith("/") else owner, f"{link.path}/{rest}", soft=soft - 1)
    return linked(owner[first], rest, soft=soft) if isinstance(link, h5py.HardLink) else None


def sound_group(owner: h5py.Group, name: str) -> h5py.Group:
    """Return a group held by a hard link; raises RunFileRefused otherwise."""
    found = linked(owner, name)
    if not isinstance(found, h5py.Group):
        raise RunFileRefused(f"/{name} is missing")
    check_count(f"/{name}", found.id.get_num_objs(), "objects")
    return found


def own_dataset(owner: h5py.Group, name: str) -> tuple[h5py.Dataset, h5py.h5p.PropDCID]:
    """Return a dataset and how it is stored; raises RunFileRefused unless it lies in the file itself."""
    dataset = linked(owner, name)
    if not isinstance(dataset, h5py.Dataset):
        raise RunFileRefused(f"{owner.name}/{name} is missing")
    # The layout before the shape: that of a virtual dataset may be found in other files only.
    creation = dataset.id.get_create_plist()
    if creation.get_layout() not in OWN or creation.get_external_count():
        raise RunFileRefused(f"{owner.name}/{name} is not stored as our files store it")
    return dataset, creation


def sound_column(owner: h5py.Group, column: Dataset) -> h5py.Dataset:
    """Return a column of a group; raises RunFileRefused if type, shape or storage are not ours."""
    path, (dataset, creation) = f"{owner.name}/{column.name}", own_dataset(owner, column.name)
    if dataset.dtype != np.dtype(column.dtype) or dataset.ndim != 1:
        raise RunFileRefused(f"{path} holds {dataset.dtype} in {dataset.ndim} dimensions, not {column.dtype} in one")
    check_whole(dataset, creation)
    return dataset


def check_whole(dataset: h5py.Dataset, creation: h5py.h5p.PropDCID) -> None:
    """Raise RunFileRefused unless all of a dataset is in the file, in one piece or in chunks and filters of ours."""
    stored, end = dataset.id.get_storage_size(), dataset.file.id.get_filesize()
    if creation.get_layout() == h5py.h5d.CONTIGUOUS:
        whole = not dataset.size or stored == dataset.nbytes <= end - (dataset.id.get_offset() or 0)
    else:
        filters = [creation.get_filter(number)[0] for number in range(creation.get_nfilters())]
        (rows,) = creation.get_chunk()
        whole = (
            rows == min(dataset.size, CHUNK_ROWS)
            and filters == [h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_DEFLATE]
            and dataset.nbytes / DEFLATE_RATIO <= stored <= end
            and dataset.id.get_num_chunks() == ceil(dataset.size / rows)
        )
    if not whole:
        raise RunFileRefused(f"{dataset.name} is not stored as our files store it")


def rows_of_chunks(dataset: h5py.Dataset, first: int, last: int) -> NDArray[Any]:
    """Return rows ``first`` to ``last`` of a dataset; raises RunFileRefused for damaged chunks.

    HDF5 finds a chunk; it is unpacked here, to one byte more than it should have at most. HDF5 itself hands out memory
    that belongs to others where a chunk unpacks to fewer bytes.
    """
    rows, width = dataset.chunks[0], dataset.dtype.itemsize
    values: NDArray[Any] = np.empty(last - first, dataset.dtype)
    for begin in range(first - first % rows, last, rows):
        skipped, stored = dataset.id.read_direct_chunk((begin,))
        inflating = zlib.decompressobj()
        try:
            content = inflating.decompress(stored, rows * width + 1)
        except zlib.error as problem:
            raise RunFileRefused(f"damaged: {problem}") from problem
        if skipped or not inflating.eof or len(content) != rows * width:
            raise RunFileRefused("damaged: a chunk is not packed as its rows are")
        # The filter shuffle puts the first bytes of all values first, then the second ones.
        chunk = np.ascontiguousarray(np.frombuffer(content, np.uint8).reshape(width, rows).T).view(dataset.dtype)[:, 0]
        here = slice(max(first, begin), min(last, begin + rows))
        values[here.start - first : here.stop - first] = chunk[here.start - begin : here.stop - begin]
    return values


def stored_hash(owner: h5py.HLObject) -> str:
    """Return a stored hash, which is part of no other attributes; empty if there is none."""
    return str(read_attribute(owner, HASH, str)) if HASH in owner.attrs else ""


def read_attributes(owner: h5py.HLObject, kinds: Mapping[str, type | UnionType]) -> dict[str, Scalar]:
    """Return attributes by name, each of the kind that is given; raises as `read_attribute` does."""
    return {name: read_attribute(owner, name, kind) for name, kind in kinds.items()}


def read_attribute(owner: h5py.HLObject, name: str, wanted: type | UnionType = Scalar) -> Any:
    """Return a scalar attribute: text of fixed length, an integer or a double; raises RunFileRefused otherwise."""
    place = f"{owner.name} attribute {name}"
    if name not in owner.attrs:
        raise RunFileRefused(f"{place} is missing")
    attribute = owner.attrs.get_id(name)
    if attribute.shape != () or attribute.get_storage_size() > ATTRIBUTE_BYTES or attribute.dtype.kind not in "Siuf":
        raise RunFileRefused(f"{place} is not a plain number or text")
    value = np.empty((), attribute.dtype)
    attribute.read(value)
    found = value.item().decode("utf-8", "replace") if value.dtype.kind == "S" else value.item()
    if not isinstance(found, wanted):
        raise RunFileRefused(f"{place} is not {_WORDS.get(wanted, 'a number')}")
    return found

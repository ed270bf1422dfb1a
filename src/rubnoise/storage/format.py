"""The structure of a result file, written with HDF5: groups, columns of their final size, scales, attributes; no rows.

`compose` makes a whole file as far as it is known before the first row; `add_group` adds a group whose number of rows,
or of bytes, only the end of the run shows; `complete` writes what else is known then. HDF5 ends the process instead of
raising if a disk is full, so it writes through `hdf5_on`, and hears of no error.
"""

import io
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.regular_file import read_into, write_all
from rubnoise.storage.layout import Name, RunDescription, root_attributes, row_count, stored_groups
from rubnoise.storage.schema import CHUNK_ROWS, HASH, Dataset, Group, Scalar

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer, WriteableBuffer

LIBRARY_VERSIONS: Final = ("v110", "v110")
GZIP_LEVEL: Final = 4
NO_HASH: Final = "0" * 32  # what stands in place of a hash until the rows are there


class Unfailing(io.FileIO):
    """A file on disk that hides errors from HDF5: the first error is kept, to be raised later."""

    def __init__(self, descriptor: int) -> None:
        super().__init__(descriptor, "r+", closefd=False)
        self.failure: OSError | None = None

    @contextmanager
    def _hiding(self) -> Iterator[None]:
        try:
            yield
        except OSError as failure:
            self.failure = self.failure or failure

    def truncate(self, size: int | None = None, /) -> int:
        """Set the size of the file, and return it."""
        size = self.tell() if size is None else size
        with self._hiding():
            os.ftruncate(self.fileno(), size)
        return size

    def readinto(self, buffer: "WriteableBuffer", /) -> int:
        """Fill the buffer from the disk, with zeros beyond its end and if the disk fails."""
        target = memoryview(buffer).cast("B")
        target[:] = bytes(len(target))
        with self._hiding():
            read_into(self.fileno(), target, self.tell())
        return len(target)

    def write(self, data: "ReadableBuffer", /) -> int:
        """Write to the disk if it does not fail."""
        source = memoryview(data).cast("B")
        with self._hiding():
            write_all(self.fileno(), source, self.tell())
        return len(source)


@contextmanager
def unfailing(descriptor: int) -> Iterator[Unfailing]:
    """Yield an open file for HDF5 to write into; raises OSError afterwards if the disk failed."""
    target = Unfailing(descriptor)
    try:
        yield target
    finally:
        if target.failure is not None:
            raise target.failure


@contextmanager
def hdf5_on(descriptor: int, mode: str) -> Iterator[h5py.File]:
    """Open a file with HDF5 to write into it; raises OSError afterwards if the disk failed."""
    with unfailing(descriptor) as target, h5py.File(target, mode, libver=LIBRARY_VERSIONS) as file:
        yield file


def compose(file: h5py.File, about: RunDescription) -> dict[Name, int]:
    """Write the structure of a run into an empty file, and return the places of the columns whose rows are known.

    Groups that grow, and all groups of a compressed file, are left out: they need their rows (see `add_group`).
    """
    put_attributes(file, {**root_attributes(about), "NX_class": "NXroot", "default": "trace"})
    places: dict[Name, int] = {}
    for group in stored_groups(about.features):
        rows = row_count(group, about.extent)
        if about.compression == "none" and rows is not None:
            places |= add_group(file, group, rows, "none")
    begun = {**about.provenance, "finished": "", HASH: NO_HASH}
    for name, known in {"summary": {}, "provenance": begun}.items():
        put_attributes(_create_group(file, name, notes=True), {"NX_class": "NXcollection", **known})
    return places


def add_group(file: h5py.File, group: Group, rows: int, compression: str) -> dict[Name, int]:
    """Write a group with space for its rows, and return the places of its columns; 0 without rows, or in chunks."""
    owner = _create_group(file, group.name)
    space = h5py.h5s.create_simple((rows,))
    creation = _storage(min(rows, CHUNK_ROWS) if compression == "gzip" else 0)
    columns: dict[Dataset, h5py.Dataset] = {}
    for column in group.columns:
        kind = h5py.h5t.py_create(np.dtype(column.dtype), logical=True)
        columns[column] = h5py.Dataset(h5py.h5d.create(owner.id, column.name.encode(), kind, space, creation))
    (first, scale), *rest = columns.items()
    scale.make_scale(first.name)
    for _, dataset in rest:
        dataset.dims[0].attach_scale(scale)
    # NeXus tells viewers what to plot, one column: they draw further ones on the axis of the first, where a force of
    # 5e4 uN hides an area of 200 um^2.
    plot = {"NX_class": "NXdata", "signal": group.plotted, "axes": (first.name,)}
    put_attributes(owner, {"long_name": group.long_name, **plot})
    for column, dataset in columns.items():
        said = {**column.attributes, HASH: NO_HASH}
        put_attributes(dataset, {name: said[name] for name in sorted(said, key=lambda name: name.startswith("flag"))})
    return {(group.name, column.name): dataset.id.get_offset() or 0 for column, dataset in columns.items()}


def complete(
    file: h5py.File, about: RunDescription, digests: Mapping[Name, str], summary: Mapping[str, Scalar], finished: str
) -> None:
    """Write what is known only after the last row: hashes of the columns, summary, end time and seal."""
    owners = {group: file[group] for group, _ in digests}
    for (group, column), digest in digests.items():
        owners[group][column].attrs.modify(HASH, digest)
    put_attributes(file["summary"], summary)
    origin = {**about.provenance, "finished": finished}
    seal = seal_of(*map(_as_stored, (root_attributes(about), summary, origin)))
    put_attributes(file["provenance"], {"finished": finished, HASH: seal})


def seal_of(root: Mapping[str, Scalar], summary: Mapping[str, Scalar], provenance: Mapping[str, Scalar]) -> str:
    """Return the seal of a file in hexadecimal: the xxh3_128 of a JSON text of its attributes, summary and provenance.

    Names are sorted, characters beyond ASCII are escaped, and numbers have the digits that bring back their bits.
    """
    text = json.dumps([root, summary, provenance], sort_keys=True, separators=(",", ":"))
    return xxhash.xxh3_128_hexdigest(text.encode())


def _as_stored(values: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return attributes as they are read back."""
    return {
        name: as_bytes(value).item().decode() if isinstance(value, str) else value for name, value in values.items()
    }


def as_bytes(texts: str | Sequence[str]) -> NDArray[np.bytes_]:
    """Return one text or several as they are stored: invalid characters (lone surrogates) become escapes.

    They are at least two bytes long, since h5netcdf does not decode single bytes.
    """
    raw = [text.encode("utf-8", "backslashreplace") for text in ([texts] if isinstance(texts, str) else texts)]
    return np.array(raw[0] if isinstance(texts, str) else raw, dtype=f"S{max(2, *map(len, raw))}")


def _create_group(file: h5py.File, name: str, *, notes: bool = False) -> h5py.Group:
    """Create a group that keeps the order of its columns, or, if it is for ``notes``, of its attributes.

    All attributes of notes lie in the header: HDF5 has checksums for headers, and none for long texts stored elsewhere,
    which is its default. Only attributes that would make a header longer than 64 kB are still stored elsewhere.
    """
    creation, in_order = h5py.h5p.create(h5py.h5p.GROUP_CREATE), h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED
    creation.set_obj_track_times(False)
    if notes:
        creation.set_attr_creation_order(in_order)
        creation.set_attr_phase_change(1 << 15, 0)  # more than any group has
    else:
        creation.set_link_creation_order(in_order)
    return h5py.Group(h5py.h5g.create(file.id, name.encode(), gcpl=creation))


@cache
def _storage(chunk_rows: int) -> h5py.h5p.PropDCID:
    """Return how a column is stored: in compressed chunks of so many rows, or in one piece if there are none."""
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_obj_track_times(False)
    if chunk_rows:
        creation.set_chunk((chunk_rows,))
        creation.set_shuffle()
        creation.set_deflate(GZIP_LEVEL)
    else:
        creation.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
        creation.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    return creation


def put_attributes(owner: h5py.HLObject, values: Mapping[str, Any]) -> None:
    """Write attributes: numbers, arrays, texts or tuples of texts."""
    for name, value in values.items():
        stored = as_bytes(value) if isinstance(value, str | tuple) else np.asarray(value)
        text = h5py.string_dtype("utf-8", stored.itemsize) if stored.dtype.kind == "S" else None
        owner.attrs.create(name, stored, dtype=text)

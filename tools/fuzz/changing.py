"""What single changes of a result have in common: where they are, what may be changed, and hashes put right."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from random import Random
from typing import Any

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.storage.schema import HASH
from rubnoise.storage.seal import read_provenance, read_root, read_summary, seal_of

OF_HDF5 = frozenset(("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where a file was changed: an object, and one of its attributes where it was that."""

    path: str
    attribute: str = ""

    def __str__(self) -> str:
        """Return the place as `rubnoise verify` names it."""
        return f"{self.path} {self.attribute}" if self.attribute else self.path


Places = tuple[Place, ...]
Change = Callable[[h5py.File, Random], Places]


def put_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Write a text attribute as results have them, in place of an older one."""
    raw = text.encode("utf-8", "backslashreplace")
    owner.attrs.create(name, np.bytes_(raw), dtype=h5py.string_dtype("utf-8", max(2, len(raw))))


def put_values(dataset: h5py.Dataset, values: NDArray[Any]) -> None:
    """Write a column and the hash of what it has become."""
    dataset[...] = values
    put_text(dataset, HASH, xxhash.xxh3_128(np.ascontiguousarray(values, dataset.dtype).tobytes()).hexdigest())


def put_seal(file: h5py.File) -> None:
    """Write the hash of the attributes as they have become."""
    put_text(file["provenance"], HASH, seal_of(read_root(file), read_summary(file), read_provenance(file)))


def objects(file: h5py.File) -> Iterator[tuple[str, h5py.HLObject]]:
    """Yield every object of a file with its path."""
    yield "/", file["/"]
    for name, group in file.items():
        yield f"/{name}", group
        for inner, column in group.items():
            yield f"/{name}/{inner}", column


def columns(file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    """Yield every column with its path."""
    return ((path, owner) for path, owner in objects(file) if isinstance(owner, h5py.Dataset))


def filled(file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    """Yield every column that has rows."""
    return ((path, column) for path, column in columns(file) if column.size)


def texts(file: h5py.File) -> Iterator[tuple[Place, str]]:
    """Yield every text of one value, but for those that HDF5 writes itself."""
    for path, owner in objects(file):
        for name in sorted(set(owner.attrs) - OF_HDF5):
            if isinstance(value := owner.attrs[name], bytes):
                yield Place(path=path, attribute=name), value.decode()


def numbers(file: h5py.File) -> Iterator[tuple[Place, float]]:
    """Yield every number among the attributes."""
    for path, owner in objects(file):
        for name, value in owner.attrs.items():
            if isinstance(value, np.integer | np.floating):
                yield Place(path=path, attribute=name), value.item()

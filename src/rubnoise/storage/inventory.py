"""What a file of HDF5 holds beside its rows, in words by place, and what that of a correct run would hold."""

import json
from collections.abc import Iterator
from tempfile import TemporaryFile
from typing import Any, Final

import h5py
import numpy as np

from rubnoise.errors import RunFileRefused
from rubnoise.storage.format import add_group, compose, hdf5_on
from rubnoise.storage.layout import RunDescription, row_count, stored_groups
from rubnoise.storage.objects import ATTRIBUTE_BYTES, OWN, check_count

MOST_ENTRIES: Final = 20_000  # more groups, columns and attributes together are in no file of ours
DEEPEST: Final = 4  # groups that lie deeper below the root than this are in no file of ours
Inventory = dict[tuple[str, str], str]
"""What there is, by the path of an object and an empty text, or the name of its attribute."""

OF_HDF5: Final = frozenset(("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"))
"""Attributes that HDF5 writes itself, in types of its own choice: which scale a dataset has."""


def expected_inventory(about: RunDescription) -> Inventory:
    """Return what the file of a run must hold beside its rows, made in a file without rows or name."""
    with TemporaryFile(buffering=0) as room, hdf5_on(room.fileno(), "w") as file:
        compose(file, about)
        for group in stored_groups(about.features):
            if group.name not in file:
                add_group(file, group, row_count(group, about.extent) or 0, about.compression)
        return inventory_of(file)


def inventory_of(file: h5py.File) -> Inventory:
    """Return all that a file holds, only names of links and types; raises RunFileRefused for more than ours have."""
    found = Inventory()
    for path, owner in _objects("", file["/"]):
        found[path or "/", ""] = _in_words(owner)
        if isinstance(owner, h5py.Dataset | h5py.Group):
            found |= {(path or "/", name): words for name, words in _attributes(owner)}
        if len(found) > MOST_ENTRIES:
            raise RunFileRefused(f"holds more than {MOST_ENTRIES} groups, columns and attributes")
    return found


def _objects(path: str, owner: h5py.HLObject | None) -> Iterator[tuple[str, h5py.HLObject | None]]:
    """Yield an object and what it holds, by their paths; None is one that no hard link leads to."""
    yield path, owner
    if isinstance(owner, h5py.Group) and path.count("/") < DEEPEST:
        check_count(path, owner.id.get_num_objs(), "objects", MOST_ENTRIES)
        for name in owner:
            hard = isinstance(owner.get(name, getlink=True), h5py.HardLink)
            yield from _objects(f"{path}/{_readable(name)}", owner[name] if hard else None)


def _in_words(owner: h5py.HLObject | None) -> str:
    """Return an object in words: of a dataset its type, shape and storage."""
    if not isinstance(owner, h5py.Dataset):
        return "group" if isinstance(owner, h5py.Group) else "link" if owner is None else "type"
    creation = owner.id.get_create_plist()
    layout = creation.get_layout()
    if layout not in OWN or creation.get_external_count():
        return f"dataset, {_type(owner.dtype)}, elsewhere"  # HDF5 would look into other files even for its shape
    storage = "in one piece"
    if layout == h5py.h5d.CHUNKED:
        filters = [creation.get_filter(number)[0] for number in range(creation.get_nfilters())]
        storage = f"in chunks of {creation.get_chunk()[0]} through filters {filters}"
    return f"dataset, {_type(owner.dtype)}, {list(owner.shape or ())}, {storage}"


def _attributes(owner: h5py.HLObject) -> Iterator[tuple[str, str]]:
    """Yield names and values, None for a long one, with their types; of a dataset also those that it lies along."""
    check_count(owner.name, h5py.h5a.get_num_attrs(owner.id), "attributes")
    if isinstance(owner, h5py.Dataset) and owner.id.get_create_plist().get_layout() in OWN and owner.ndim == 1:
        yield "scale", f"{json.dumps([scale.name for scale in owner.dims[0].values()])}, path"
    for name in owner.attrs:
        attribute, value = owner.attrs.get_id(name), None
        plain = attribute.get_storage_size() <= ATTRIBUTE_BYTES and attribute.dtype.kind in "Siuf"
        if plain and attribute.shape is not None:
            raw = np.asarray(owner.attrs[name])
            value = (np.char.decode(raw, "utf-8", "backslashreplace") if raw.dtype.kind == "S" else raw).tolist()
        yield _readable(name), f"{json.dumps(value)}, {'any' if name in OF_HDF5 else _type(attribute.dtype)}"


def _type(kind: np.dtype[Any]) -> str:
    """Return the type of values as text; the texts are equal if the types are."""
    text = h5py.check_string_dtype(kind)
    if text is None:
        return kind.str
    return f"{text.encoding} text of {'any length' if text.length is None else f'{text.length} bytes'}"


def _readable(name: str) -> str:
    """Return a name with bytes that are no text as escapes."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")

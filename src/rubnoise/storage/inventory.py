"""What a result file holds beside its rows, by name, and what the file of a correct run would hold."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from tempfile import TemporaryFile
from typing import Any, Final

import h5py
import numpy as np

from rubnoise.errors import RunFileRefused
from rubnoise.storage.format import add_group, compose, hdf5_on
from rubnoise.storage.layout import RunDescription, row_count, stored_groups
from rubnoise.storage.objects import ATTRIBUTE_BYTES, MOST_ATTRIBUTES

MOST_OBJECTS: Final = 20_000
"""More groups and columns are in no file of ours, be it the index of the largest sweep."""

DEEPEST: Final = 4
"""Groups that lie deeper below the root than this are in no file of ours."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One object of a file in words, and its attributes by name, each with its value, or None if long, and its type."""

    words: str
    attributes: Mapping[str, tuple[Any, str]] = field(default_factory=dict)


Inventory = Mapping[str, Entry]
"""What there is, by path."""

OF_HDF5: Final = frozenset(("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"))
"""Attributes that HDF5 writes itself, in types of its own choice: which scale a dataset has."""


def expected_inventory(about: RunDescription) -> Inventory:
    """Return what the file of a run must hold beside its rows, made in a file without rows or name."""
    with TemporaryFile(buffering=0) as room, hdf5_on(room.fileno(), "w") as file:
        compose(file, about)
        for group in stored_groups(about.features):
            if group.name not in file:
                add_group(file, group, row_count(group, about.extent), about.compression)
        return inventory_of(file)


def inventory_of(file: h5py.File) -> Inventory:
    """Return everything that a file holds; of objects that are neither groups nor datasets of the file, only the names.

    Raises RunFileRefused for more objects than any of our files has.
    """
    found: dict[str, Entry] = {}
    waiting = [("", file["/"])]
    while waiting:
        path, owner = waiting.pop()
        found[path or "/"] = Entry("group", _attributes(owner))
        if len(found) + len(waiting) + owner.id.get_num_objs() > MOST_OBJECTS:
            raise RunFileRefused(f"holds more than {MOST_OBJECTS} groups and columns")
        for name in owner:
            place = f"{path}/{_readable(name)}"
            entry = owner[name] if isinstance(owner.get(name, getlink=True), h5py.HardLink) else None
            if isinstance(entry, h5py.Group) and place.count("/") < DEEPEST:
                waiting.append((place, entry))
            elif isinstance(entry, h5py.Dataset):
                found[place] = _dataset(entry)
            else:
                found[place] = Entry("group" if isinstance(entry, h5py.Group) else "link" if entry is None else "type")
    return found


def _dataset(dataset: h5py.Dataset) -> Entry:
    creation = dataset.id.get_create_plist()
    layout, storage = creation.get_layout(), "elsewhere"
    if layout == h5py.h5d.CONTIGUOUS and not creation.get_external_count():
        storage = "in one piece"
    elif layout == h5py.h5d.CHUNKED:
        filters = [creation.get_filter(number)[0] for number in range(creation.get_nfilters())]
        storage = f"in chunks of {creation.get_chunk()[0]} through filters {filters}"
    # HDF5 would look into other files for the shape of a virtual dataset.
    shape = [] if layout == h5py.h5d.VIRTUAL else list(dataset.shape or ())
    scales = [scale.name for scale in dataset.dims[0].values()] if storage != "elsewhere" and len(shape) == 1 else []
    words = f"dataset, {_type(dataset.dtype)}, {shape}, {storage}"
    return Entry(words, _attributes(dataset) | {"scale": (scales, "path")})


def _attributes(owner: h5py.HLObject) -> dict[str, tuple[Any, str]]:
    if (count := h5py.h5a.get_num_attrs(owner.id)) > MOST_ATTRIBUTES:
        raise RunFileRefused(f"{owner.name} has {count} attributes")
    found: dict[str, tuple[Any, str]] = {}
    for name in owner.attrs:
        attribute, value = owner.attrs.get_id(name), None
        plain = attribute.get_storage_size() <= ATTRIBUTE_BYTES and attribute.dtype.kind in "Siuf"
        if plain and attribute.shape is not None:
            raw = np.asarray(owner.attrs[name])
            value = (np.char.decode(raw, "utf-8", "backslashreplace") if raw.dtype.kind == "S" else raw).tolist()
        found[_readable(name)] = value, _type(attribute.dtype)
    return found


def _type(kind: np.dtype[Any]) -> str:
    """Return the type of values as text; the texts are equal if the types are."""
    text = h5py.check_string_dtype(kind)
    if text is None:
        return kind.str
    return f"{text.encoding} text of {'any length' if text.length is None else f'{text.length} bytes'}"


def _readable(name: str) -> str:
    """Return a name with bytes that are no text as escapes."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")

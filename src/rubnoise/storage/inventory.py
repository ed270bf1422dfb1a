"""List everything in a file by name, with every attribute, and what the file of a correct run would have.

Objects are counted before they are listed; no row is read.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Final

import h5py
import numpy as np
import xxhash

from rubnoise.errors import RunFileRefused
from rubnoise.storage.layout import Name, RunDescription, row_count, stored_groups
from rubnoise.storage.objects import ATTRIBUTE_BYTES, ATTRIBUTES_LIMIT
from rubnoise.storage.pages import PagedFile
from rubnoise.storage.schema import Scalar
from rubnoise.storage.structure import LIBRARY_VERSIONS, add_group, complete, compose, put_text

OBJECTS_LIMIT: Final = 20_000
"""More groups and columns are in no file of ours, be it the index of the largest sweep."""

DEEPEST: Final = 4
"""Groups that lie deeper below the root than this are in no file of ours."""

GROUP, DATASET = "group", "dataset"

Inventory = Mapping[str, Mapping[str, Any]]
"""What there is, by path: its kind, of a dataset also type, shape, storage and sources, and its attributes by name."""


OF_HDF5: Final = frozenset(("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"))
"""Attributes that HDF5 writes itself, in types of its own choice."""

Ended = tuple[Mapping[Name, str], Mapping[str, Scalar], str]
"""What only the end of a run shows: the hashes of its columns, its summary, and the time."""


def expected_inventory(
    description: RunDescription, *, compressed: bool, ending: Ended | None = None
) -> dict[str, dict[str, Any]]:
    """Return what the file of a run must hold beside its rows, before the first one or at the end, made in memory."""
    about = replace(description, compression="gzip" if compressed else "none")
    with h5py.File(PagedFile(), "w", libver=LIBRARY_VERSIONS) as file:
        compose(file, about)
        for group in stored_groups(about.features):
            if group.name not in file:
                add_group(file, group, row_count(group, about.extent), about.compression)
        if ending is not None:
            complete(file, about, *ending)
        return inventory_of(file)


def stored_texts(texts: Mapping[str, str]) -> dict[str, Any]:
    """Return texts by name in the form that attributes of our files have."""
    with h5py.File(PagedFile(), "w", libver=LIBRARY_VERSIONS) as file:
        for name, text in texts.items():
            put_text(file, name, text)
        return _attributes(file)


def inventory_of(file: h5py.File) -> dict[str, dict[str, Any]]:
    """Return everything that a file holds; of objects that are neither groups nor datasets of the file, only the names.

    Raises RunFileRefused for more objects than any of our files has.
    """
    found: dict[str, dict[str, Any]] = {}
    waiting = [("/", file["/"])]
    while waiting:
        path, owner = waiting.pop()
        found[path] = {"kind": GROUP, "attributes": _attributes(owner)}
        for name, kind, entry in _links(owner):
            place = f"{path.rstrip('/')}/{name}"
            if len(found) + len(waiting) >= OBJECTS_LIMIT:
                raise RunFileRefused(f"holds more than {OBJECTS_LIMIT} groups and columns")
            if kind == GROUP and place.count("/") < DEEPEST:
                waiting.append((place, entry))
            else:
                found[place] = _dataset(entry) if kind == DATASET else {"kind": kind, "attributes": {}}
    return found


def _links(owner: h5py.Group) -> Iterator[tuple[str, str, Any]]:
    """Yield name, kind and object of everything in a group; the object only for hard links."""
    if owner.id.get_num_objs() > OBJECTS_LIMIT:
        raise RunFileRefused(f"holds more than {OBJECTS_LIMIT} groups and columns")
    names: list[bytes] = []
    owner.id.links.iterate(names.append)
    for raw in names:
        name = raw.decode("utf-8", "backslashreplace")
        if owner.id.links.get_info(raw).type != h5py.h5l.TYPE_HARD:
            yield name, "link", None
            continue
        entry = h5py.h5o.open(owner.id, raw)
        if isinstance(entry, h5py.h5g.GroupID):
            yield name, GROUP, h5py.Group(entry)
        elif isinstance(entry, h5py.h5d.DatasetID):
            yield name, DATASET, h5py.Dataset(entry)
        else:
            yield name, "type", None


def _dataset(dataset: h5py.Dataset) -> dict[str, Any]:
    creation = dataset.id.get_create_plist()
    layout = creation.get_layout()
    # HDF5 would look into other files for the shape of a virtual dataset.
    virtual = layout == h5py.h5d.VIRTUAL and creation.get_virtual_count()
    space = creation.get_virtual_vspace(0) if virtual else dataset.id.get_space()
    return {
        "kind": DATASET,
        "type": _type(dataset.id.get_type()),
        "shape": list(space.shape),
        "grows_to": list(space.get_simple_extent_dims(maxdims=True)),
        "storage": _storage(creation, layout),
        "sources": _sources(creation) if layout == h5py.h5d.VIRTUAL else "none",
        "attributes": _attributes(dataset),
    }


def _storage(creation: h5py.h5p.PropDCID, layout: int) -> str:
    """Return how the rows of a dataset are stored, in words."""
    if layout == h5py.h5d.CONTIGUOUS:
        return "in other files" if creation.get_external_count() else "in one piece"
    if layout == h5py.h5d.VIRTUAL:
        return "in the files of runs"
    if layout != h5py.h5d.CHUNKED:
        return "in its header"
    filters = [creation.get_filter(number)[0] for number in range(creation.get_nfilters())]
    return f"in chunks of {creation.get_chunk()[0]} through filters {filters}"


def _sources(creation: h5py.h5p.PropDCID) -> str:
    """Return the sources of a virtual dataset: the number of pieces, and a hash of their files, datasets and rows."""
    digest, count = xxhash.xxh3_128(), creation.get_virtual_count()
    for number in range(count):
        place = (creation.get_virtual_filename(number), creation.get_virtual_dsetname(number))
        digest.update(json.dumps([_selection(creation.get_virtual_vspace(number)), *place]).encode())
    return f"{count} pieces with the hash {digest.hexdigest()}"


def _selection(space: h5py.h5s.SpaceID) -> str:
    """Return a selection of values as the corners of its bounding box and its number of values."""
    if space.get_select_type() == h5py.h5s.SEL_ALL:
        return "all"
    first, last = (tuple(map(int, corner)) for corner in space.get_select_bounds())
    return f"{space.get_select_npoints()} from {first} to {last}"


def _attributes(owner: h5py.HLObject) -> dict[str, Any]:
    if (count := h5py.h5a.get_num_attrs(owner.id)) > ATTRIBUTES_LIMIT:
        raise RunFileRefused(f"{owner.name} has {count} attributes")
    found: dict[str, Any] = {}
    names: list[bytes] = []
    h5py.h5a.iterate(owner.id, names.append)
    for raw in names:
        attribute = h5py.h5a.open(owner.id, raw)
        name, kind = raw.decode("utf-8", "backslashreplace"), attribute.get_type()
        shape = attribute.shape
        found[name] = {
            "type": _type(kind),
            "shape": None if shape is None else list(shape),
            "value": _value(owner, attribute, kind),
        }
    return found


def _type(kind: h5py.h5t.TypeID) -> str:
    """Return the type of values as text; the texts are equal if the types are."""
    if isinstance(kind, h5py.h5t.TypeStringID):
        characters = "UTF-8" if kind.get_cset() == h5py.h5t.CSET_UTF8 else "ASCII"
        length = "any length" if kind.is_variable_str() else f"{kind.get_size()} bytes"
        return f"{characters} text of {length}"
    if isinstance(kind, h5py.h5t.TypeIntegerID | h5py.h5t.TypeFloatID):
        return str(kind.dtype.str)
    if isinstance(kind, h5py.h5t.TypeReferenceID):
        return "reference"
    if isinstance(kind, h5py.h5t.TypeVlenID):
        return f"list of {_type(kind.get_super())}"
    if isinstance(kind, h5py.h5t.TypeCompoundID):
        members = (_type(kind.get_member_type(number)) for number in range(kind.get_nmembers()))
        return f"({', '.join(members)})"
    return f"HDF5 class {kind.get_class()}"


def _value(owner: h5py.HLObject, attribute: h5py.h5a.AttrID, kind: h5py.h5t.TypeID) -> Any:
    """Return the value of an attribute, with references as paths; None if it cannot be read."""
    if attribute.get_storage_size() > ATTRIBUTE_BYTES or attribute.shape is None:
        return None
    if isinstance(kind, h5py.h5t.TypeStringID):
        if kind.is_variable_str():
            return None
        texts = np.empty(attribute.shape, dtype=kind.dtype)
        attribute.read(texts)
        return _decoded(texts.tolist())
    if isinstance(kind, h5py.h5t.TypeIntegerID | h5py.h5t.TypeFloatID):
        numbers = np.empty(attribute.shape, dtype=kind.dtype)
        attribute.read(numbers)
        return numbers.tolist()
    if isinstance(kind, h5py.h5t.TypeVlenID | h5py.h5t.TypeCompoundID | h5py.h5t.TypeReferenceID):
        return _referred(owner, owner.attrs.get(attribute.name))
    return None


def _decoded(texts: Any) -> Any:
    return [_decoded(each) for each in texts] if isinstance(texts, list) else texts.decode("utf-8", "backslashreplace")


def _referred(owner: h5py.HLObject, value: Any) -> Any:
    """Return lists and rows with references replaced by paths."""
    if isinstance(value, h5py.Reference):
        try:
            name = h5py.h5r.get_name(value, owner.file.id) if value else None
        except (OSError, RuntimeError, KeyError, ValueError):
            return None  # what it referred to is gone
        return None if name is None else name.decode("utf-8", "backslashreplace")
    if isinstance(value, np.void):
        return [_referred(owner, each) for each in value.item()]
    if isinstance(value, np.ndarray):
        return [_referred(owner, each) for each in value]
    if isinstance(value, np.generic):
        return value.item()
    return value if isinstance(value, int | float | str) else None

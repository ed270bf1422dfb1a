"""The structure of a part file compared, name by name, with the structure that its own description gives.

A part found on the disk may be damaged, or made by anybody, in what no row and no hash covers: units, names, meanings,
links between columns, a group too many. Called in a child process, as `survey` is.
"""

import os
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import Any, Final

import h5py
import numpy as np

from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk
from rubnoise.storage.checks import ATTRIBUTE_BYTES, ATTRIBUTES_LIMIT, LINKS_LIMIT, has_hard_link
from rubnoise.storage.layout import between, digest_of, places_of, stored_extent
from rubnoise.storage.pages import Overlay
from rubnoise.storage.provenance import package_version
from rubnoise.storage.read_structure import found_in, structure_read_by
from rubnoise.storage.run_description import description
from rubnoise.storage.schema import HASH
from rubnoise.storage.structure import LIBRARY_VERSIONS, complete, compose

STRUCTURE_LIMIT: Final = 8 * 1024**2
"""Bytes that are no rows, at most: a part has some 100 kB of them, and the texts of its scenario."""

ELSEWHERE: Final = frozenset({("/", "attribute source"), ("/provenance", f"attribute {HASH}")})
"""Attributes that say which version of the program began a run, and the hash that goes with them: checked by value."""

package_version("rubnoise")  # looked up now: a child process may open no file

Attributes = Mapping[str, object]
Objects = Mapping[str, Attributes]


def inspect(descriptor: int) -> bytes:
    """Return what `survey` does of an open part, and a hash of all that is no row.

    It is refused where anything of its structure is missing, too many or other than the program makes it.
    """
    return structure_read_by(descriptor, _inspected)


def _inspected(file: h5py.File, descriptor: int) -> dict[str, Any]:
    found = found_in(file, os.fstat(descriptor).st_size)
    if "columns" not in found or "index" in found:
        return found
    wrong = list(islice(_differences(file, found), 3))
    if wrong:
        raise RunFileRefused(f"damaged: {'; '.join(wrong)}")
    return found | {"structure": "" if _is_compressed(found) else _digest(descriptor, found)}


def _digest(descriptor: int, found: Mapping[str, Any]) -> str:
    rest = between(places_of(found).values(), os.fstat(descriptor).st_size)
    if sum(map(len, rest)) > STRUCTURE_LIMIT:
        raise RunFileRefused(f"holds {sum(map(len, rest)):,} bytes that are no rows")
    return digest_of((place.start, disk.read(descriptor, len(place), place.start)) for place in rest)


def _is_compressed(found: Mapping[str, Any]) -> bool:
    return any("chunks" in place for columns in found["columns"].values() for place in columns.values())


def _differences(file: h5py.File, found: Mapping[str, Any]) -> Iterator[str]:
    """Yield where a file is not what is made of its own description, columns left out of account."""
    with h5py.File(_made(found), "r", libver=LIBRARY_VERSIONS) as right:
        there, expected = _objects(file), _objects(right)
    for path in sorted({*there, *expected}):
        if path not in there:
            yield f"{path} is missing"
        elif path not in expected:
            yield f"{path} belongs to no run"
        else:
            yield from _differing(path, there[path], expected[path])


def _differing(path: str, there: Attributes, expected: Attributes) -> Iterator[str]:
    for name in sorted({*there, *expected}):
        what = f"{path} {name}"
        if name not in there:
            yield f"{what} is missing"
        elif name not in expected:
            yield f"{what} belongs to no run"
        elif there[name] != expected[name] and (path, name) not in ELSEWHERE:
            yield f"{what} is not that of a run"


def _made(found: Mapping[str, Any]) -> Overlay:
    """Return the file that is made of what a file says of itself, without its rows; raises RunFileRefused."""
    about, origin, summary = (_value(found[name]) for name in ("attributes", "provenance", "summary"))
    rows = {name: next(iter(columns.values()))["rows"] for name, columns in found["columns"].items()}
    described = description(str(about["title"]), origin, stored_extent(rows), frozenset(found["features"]))
    image = Overlay()
    with h5py.File(image, "w", libver=LIBRARY_VERSIONS) as file:
        compose(file, described, compressed=_is_compressed(found))
        if finished := str(origin["finished"]):
            digests = {
                (group, name): _value(place["digest"])
                for group, columns in found["columns"].items()
                for name, place in columns.items()
            }
            complete(file, digests, summary, finished)
    return image


def _value(answer: Mapping[str, Any]) -> Any:
    if "refused" in answer:
        raise RunFileRefused(answer["refused"])
    return answer["value"]


def _objects(file: h5py.File) -> Objects:
    """Return what there is by its path: the root, its groups and their columns, each with all that is said of it."""
    found = {"/": _attributes(file)}
    for name, group in _held(file):
        found[name] = _attributes(group)
        if isinstance(group, h5py.Group):
            found |= {path: _kind(column) | _attributes(column) for path, column in _held(group)}
    return found


def _held(owner: h5py.Group) -> Iterator[tuple[str, h5py.HLObject]]:
    """Yield what a group itself holds, with its path; raises RunFileRefused for links to elsewhere and far too many."""
    if owner.id.get_num_objs() > LINKS_LIMIT:
        raise RunFileRefused(f"{owner.name} holds {owner.id.get_num_objs()} objects")
    for name in owner:
        path = f"{owner.name.rstrip('/')}/{name}"
        if not has_hard_link(owner, name):
            raise RunFileRefused(f"{path} is a link")
        yield path, owner[name]


def _kind(column: h5py.HLObject) -> dict[str, object]:
    """Return how a column is stored."""
    if not isinstance(column, h5py.Dataset):
        return {"kind": type(column).__name__}
    creation = column.id.get_create_plist()
    filters = [creation.get_filter(n)[0] for n in range(creation.get_nfilters())]
    stored = (column.dtype.str, column.shape, column.maxshape, column.chunks, filters, creation.get_layout())
    return {"kind": "column", "storage": stored}


def _attributes(owner: h5py.HLObject) -> dict[str, object]:
    """Return all attributes; those that tie columns together as the paths to which they lead."""
    if h5py.h5a.get_num_attrs(owner.id) > ATTRIBUTES_LIMIT:
        raise RunFileRefused(f"{owner.name} has {h5py.h5a.get_num_attrs(owner.id)} attributes")
    names: list[bytes] = []
    h5py.h5a.iterate(owner.id, names.append)
    return {f"attribute {name.decode('utf-8', 'replace')}": _content(owner, name) for name in names}


def _content(owner: h5py.HLObject, name: bytes) -> object:
    if name == b"DIMENSION_LIST":
        return [[owner.file[scale].name for scale in of_one] for of_one in owner.attrs[name.decode()]]
    if name == b"REFERENCE_LIST":
        return sorted((owner.file[column].name, int(number)) for column, number in owner.attrs[name.decode()])
    attribute = h5py.h5a.open(owner.id, name)
    kind = attribute.get_type()
    if attribute.get_storage_size() > ATTRIBUTE_BYTES or not _is_plain(kind):
        return None
    values = np.empty(attribute.shape, dtype=kind.dtype)
    attribute.read(values)
    return kind.dtype.str, attribute.shape, values.tobytes()


def _is_plain(kind: h5py.h5t.TypeID) -> bool:
    if isinstance(kind, h5py.h5t.TypeStringID):
        return not kind.is_variable_str()
    return isinstance(kind, h5py.h5t.TypeIntegerID | h5py.h5t.TypeFloatID)

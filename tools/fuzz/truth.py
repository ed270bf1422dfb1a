"""Every value and every attribute of a run, read with plain h5py."""

import hashlib
from pathlib import Path
from typing import Any

import h5py
import numpy as np

LINKS = frozenset(("DIMENSION_LIST", "REFERENCE_LIST"))
"""How columns are tied together for viewers; no value of the run."""


def values(path: Path) -> str:
    """Return one hash of all columns and attributes by name; raises whatever h5py raises."""
    digest = hashlib.sha256()
    with h5py.File(path, "r") as file:
        for name in ("/", *sorted(file)):
            _add(digest, name, file[name])
            for column in sorted(file[name]) if name != "/" else ():
                _add(digest, f"{name}/{column}", file[name][column])
                content = file[name][column][()]
                digest.update(f"{content.dtype}{content.shape}".encode() + np.ascontiguousarray(content).tobytes())
    return digest.hexdigest()


def _add(digest: "hashlib._Hash", name: str, owner: h5py.HLObject) -> None:
    for key in sorted(set(owner.attrs) - LINKS):
        value = np.asarray(owner.attrs[key])
        digest.update(f"{name} {key} {value.dtype} {value.shape}".encode() + value.tobytes())


def everything(path: Path) -> str:
    """Return one hash of all that a file holds, by name: objects of any kind, their attributes, types and values."""
    digest = hashlib.sha256()
    with h5py.File(path, "r") as file:
        _add_object(digest, "/", file["/"])
    return digest.hexdigest()


def _add_object(digest: "hashlib._Hash", path: str, owner: h5py.Group | h5py.Dataset) -> None:
    for key in sorted(owner.attrs):
        kind = owner.attrs.get_id(key).get_type()
        digest.update(f"{path} {key} {kind.get_class()} {kind.get_size()} {_read(owner, owner.attrs[key])}".encode())
    if isinstance(owner, h5py.Dataset):
        digest.update(
            f"{owner.dtype.str} {owner.shape} {owner.chunks}".encode() + np.ascontiguousarray(owner[()]).tobytes()
        )
        return
    for name in sorted(owner):
        link = owner.get(name, getlink=True)
        digest.update(f"{path} {name} {type(link).__name__}".encode())
        if isinstance(link, h5py.HardLink) and isinstance(owner[name], h5py.Group | h5py.Dataset):
            _add_object(digest, f"{path}/{name}", owner[name])


def _read(owner: h5py.HLObject, value: Any) -> str:
    """Return a value as text, references by what they refer to."""
    if isinstance(value, h5py.Reference):
        try:
            return str(owner.file[value].name)
        except (OSError, RuntimeError, KeyError, ValueError):
            return "nothing that is there"
    if isinstance(value, np.ndarray | np.void | tuple):
        return str([_read(owner, each) for each in (value.item() if isinstance(value, np.void) else value)])
    return repr(value)

"""Every value and every attribute of a run, read with plain h5py."""

import hashlib
from pathlib import Path

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

"""The attributes of a result beside its columns, and the hash of all of them."""

import json
from collections.abc import Mapping
from typing import Final

import h5py
import xxhash

from rubnoise.errors import RunFileRefused
from rubnoise.storage.checks import ATTRIBUTES_LIMIT, read_attribute, read_text, sound_group
from rubnoise.storage.schema import HASH, Scalar

ROOT_ATTRIBUTES: Final = ("Conventions", "format", "format_version", "title", "source", "junction_area_formula")
PROVENANCE_TEXTS: Final = (
    "scenario_toml",
    "scenario_resolved",
    "software",
    "environment",
    "propagator_constants",
    "command",
    "started",
    "finished",
)
INTERVENTION: Final = "intervention"
"""What only a run has whose lives were ended from outside: the name of the function."""

PROVENANCE_NUMBERS: Final = ("seed", "stream_version", "calibrated_diameter")


def read_root(file: h5py.File) -> dict[str, Scalar]:
    """Return the attributes of the root by name; raises RunFileRefused if one is missing or no plain value."""
    return {name: read_attribute(file, name) for name in ROOT_ATTRIBUTES}


def read_summary(file: h5py.File) -> dict[str, Scalar]:
    """Return the figures of /summary by name; raises RunFileRefused for one that is no plain value."""
    group = sound_group(file, "summary")
    count = h5py.h5a.get_num_attrs(group.id)
    if count > ATTRIBUTES_LIMIT:
        raise RunFileRefused(f"/summary has {count} attributes")
    return {name: read_attribute(group, name) for name in group.attrs if name != "NX_class"}


def read_provenance(file: h5py.File) -> dict[str, Scalar]:
    """Return the attributes of /provenance by name; raises RunFileRefused if one is missing or no plain value."""
    group = sound_group(file, "provenance")
    names = [*PROVENANCE_TEXTS, *[INTERVENTION] * h5py.h5a.exists(group.id, INTERVENTION.encode())]
    texts: dict[str, Scalar] = {name: read_text(group, name) for name in names}
    return texts | {name: read_attribute(group, name) for name in PROVENANCE_NUMBERS}


def read_seal(file: h5py.File) -> str | None:
    """Return the hash that a file keeps of its attributes; None if it has none."""
    group = sound_group(file, "provenance")
    return read_text(group, HASH) if h5py.h5a.exists(group.id, HASH.encode()) else None


def seal_of(root: Mapping[str, Scalar], summary: Mapping[str, Scalar], provenance: Mapping[str, Scalar]) -> str:
    """Return the xxh3_128 of what a file says of itself, in hexadecimal: that of a JSON text of the three.

    Names are sorted, characters beyond ASCII are escaped, and numbers have the digits that bring back their bits.
    """
    text = json.dumps([root, summary, provenance], sort_keys=True, separators=(",", ":"))
    return xxhash.xxh3_128_hexdigest(text.encode())

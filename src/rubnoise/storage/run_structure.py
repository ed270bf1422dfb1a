"""The structure of a result file: its features, the places of its columns and its attributes; no row is read here."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import ceil
from typing import Any, Final

import h5py
import xxhash

from rubnoise.errors import UNFINISHED, RunFileRefused
from rubnoise.storage.layout import Name, stored_groups
from rubnoise.storage.objects import (
    ATTRIBUTES_LIMIT,
    Place,
    has_hard_link,
    read_attribute,
    read_integer,
    read_text,
    reason_of,
    sound_dataset,
    sound_group,
)
from rubnoise.storage.schema import FORMAT, FORMAT_VERSION, HASH, INDEX_FORMAT, Dataset, Feature, Scalar

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

Answer = Any
"""What was read at one place, or the RunFileRefused that says why not: one damaged attribute must not hide the rows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunStructure:
    """What is read of a result file when it is opened; ``later`` says why a file of a later format is not read.

    A column in compressed chunks has the offset 0.
    """

    features: frozenset[Feature] = frozenset()
    columns: Mapping[str, Mapping[str, Place]] = field(default_factory=dict)
    digests: Mapping[Name, Answer] = field(default_factory=dict)
    attributes: Answer = None
    summary: Answer = None
    provenance: Answer = None
    seal: Answer = None
    later: str = ""


def structure_of(file: h5py.File, size: int) -> RunStructure:
    """Return the structure of a file of the given size; raises RunFileRefused, and any error of HDF5."""
    version = _version(file)
    if version > FORMAT_VERSION:
        source = read_text(file, "source")
        return RunStructure(
            later=f"has format version {version}, written by {source}; this one reads versions up to {FORMAT_VERSION}."
            f" {source} or later is needed"
        )
    origin = _or_refusal(read_provenance, file)
    if isinstance(origin, dict) and origin.get("finished") == "":
        raise RunFileRefused(UNFINISHED)
    features = _features(file)
    columns: dict[str, dict[str, Place]] = {}
    digests: dict[Name, Answer] = {}
    for group in stored_groups(features):
        owner, columns[group.name] = sound_group(file, group.name), {}
        for column in group.columns:
            dataset = sound_dataset(owner, column, size)
            columns[group.name][column.name] = _place(dataset, column)
            digests[group.name, column.name] = _or_refusal(read_text, dataset, HASH)
    return RunStructure(
        features=features,
        columns=columns,
        digests=digests,
        attributes=_or_refusal(read_root, file),
        summary=_or_refusal(read_summary, file),
        provenance=origin,
        seal=_or_refusal(read_seal, file),
    )


def read_root(file: h5py.File) -> dict[str, Scalar]:
    """Return the attributes of the root by name; raises RunFileRefused if one is missing or not a plain value."""
    return {name: read_attribute(file, name) for name in ROOT_ATTRIBUTES}


def read_summary(file: h5py.File) -> dict[str, Scalar]:
    """Return the figures of /summary by name; raises RunFileRefused if one is not a plain value."""
    group = sound_group(file, "summary")
    count = h5py.h5a.get_num_attrs(group.id)
    if count > ATTRIBUTES_LIMIT:
        raise RunFileRefused(f"/summary has {count} attributes")
    return {name: read_attribute(group, name) for name in group.attrs if name != "NX_class"}


def read_provenance(file: h5py.File) -> dict[str, Scalar]:
    """Return the attributes of /provenance by name; raises RunFileRefused if one is missing or not a plain value."""
    group = sound_group(file, "provenance")
    names = [*PROVENANCE_TEXTS, *[INTERVENTION] * h5py.h5a.exists(group.id, INTERVENTION.encode())]
    texts: dict[str, Scalar] = {name: read_text(group, name) for name in names}
    return texts | {name: read_attribute(group, name) for name in PROVENANCE_NUMBERS}


def read_seal(file: h5py.File) -> str | None:
    """Return the hash that a file keeps of its attributes; None if it has none."""
    group = sound_group(file, "provenance")
    return read_text(group, HASH) if h5py.h5a.exists(group.id, HASH.encode()) else None


def seal_of(root: Mapping[str, Scalar], summary: Mapping[str, Scalar], provenance: Mapping[str, Scalar]) -> str:
    """Return the seal of a file in hexadecimal: the xxh3_128 of a JSON text of its attributes, summary and provenance.

    Names are sorted, characters beyond ASCII are escaped, and numbers have the digits that bring back their bits.
    """
    text = json.dumps([root, summary, provenance], sort_keys=True, separators=(",", ":"))
    return xxhash.xxh3_128_hexdigest(text.encode())


def _version(file: h5py.File) -> int:
    there = h5py.h5a.exists(file.id, b"format")
    found = read_attribute(file, "format") if there else None
    if found == INDEX_FORMAT:
        raise RunFileRefused("is the index of a sweep, not the result of a run")
    if found != FORMAT:
        raise RunFileRefused("is an HDF5 file, but not one of rubnoise")
    version = read_integer(file, "format_version")
    if version < FORMAT_VERSION:
        raise RunFileRefused(
            f"has format version {version}, and this rubnoise reads version {FORMAT_VERSION}: run its scenario again"
        )
    return version


def _features(file: h5py.File) -> frozenset[Feature]:
    """Return the features of the run, found by the columns that exist only with them."""
    junctions = sound_group(file, "junctions")
    present: dict[Feature, bool] = {
        "strength": has_hard_link(junctions, "shear_strength"),
        "speed": has_hard_link(junctions, "birth_time"),
        "slider": has_hard_link(file, "slider"),
        "two-way": has_hard_link(file, "balance"),
        "offset": has_hard_link(junctions, "lateral_offset"),
        "load": has_hard_link(file, "load"),
        "free": has_hard_link(junctions, "encounter"),
    }
    present["base"] = present["slider"] and has_hard_link(sound_group(file, "slider"), "base_displacement")
    needed: list[tuple[Feature, str]] = [("speed", "birth_time")]
    needed += [] if present["base"] else [("strength", "shear_strength")]
    for feature, column in needed:
        if present["slider"] and not present[feature]:
            raise RunFileRefused(f"has a slider without a {feature}: /junctions/{column} is missing")
    if present["two-way"] and not present["slider"]:
        raise RunFileRefused("has /balance without /slider")
    if present["free"] and not (present["load"] and present["speed"]):
        raise RunFileRefused("has summits that are touched without /load and times")
    if has_hard_link(file, "landmarks") and not present["two-way"] and not present["free"]:
        raise RunFileRefused("has /landmarks without /balance")
    return frozenset(feature for feature, there in present.items() if there)


def _place(dataset: h5py.Dataset, column: Dataset) -> Place:
    """Return where the rows of a dataset lie; raises RunFileRefused if a chunk is missing."""
    if dataset.chunks is None:
        return Place(offset=dataset.id.get_offset() or 0, rows=dataset.size, dtype=column.dtype)
    if dataset.id.get_num_chunks() < ceil(dataset.size / dataset.chunks[0]):
        raise RunFileRefused(f"{dataset.name} has rows that are not in the file")
    return Place(offset=0, rows=dataset.size, dtype=column.dtype)


def _or_refusal(read: Callable[..., Answer], *given: Any) -> Answer:
    """Return what is read, or the reason why not."""
    try:
        return read(*given)
    except Exception as problem:  # noqa: BLE001  (what a damaged file raises is whatever it raises)
        return RunFileRefused(reason_of(problem))

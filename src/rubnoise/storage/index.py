"""The index of a sweep as an HDF5 file: a row for each point and for each run, and curves kept in place of files.

It is made whole and read whole. Behind what HDF5 reads lie the bytes of its xxh3_128: one that is not as it was written
is refused, since the same sweep makes it again.
"""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.regular_file import open_stream
from rubnoise.scenario import Scenario
from rubnoise.scenario.reading import stored
from rubnoise.storage.format import LIBRARY_VERSIONS, as_bytes, put_attributes
from rubnoise.storage.objects import check_whole, naming_damage, own_dataset, read_attribute, sound_group
from rubnoise.storage.reader import SIGNATURE, check_format, refusing
from rubnoise.storage.schema import CONVENTIONS, INDEX_FORMAT, Dataset

FORMAT_VERSION: Final = 1
GROUPS: Final = ("points", "runs", "summaries")
TEXTS: Final = ("title", "source", "written", "command", "scenario_toml", "scenario_resolved", "grid", "side_by_side")
"""The attributes of an index that are not the same in all of them."""

REMEDY: Final = "the same `rubnoise sweep` writes it again"


@dataclass(frozen=True, slots=True, kw_only=True)
class Filled:
    """A column of the index with its values: numbers or texts."""

    about: Dataset
    values: NDArray[Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Index:
    """The content of an index: texts about the sweep, columns of its points and runs by name, and arrays of either.

    The first column of points and of runs numbers them. An array has a row for each run, or for each point.
    """

    texts: Mapping[str, str]
    points: Mapping[str, Filled]
    runs: Mapping[str, Filled]
    summaries: Mapping[str, NDArray[Any]]

    def swept(self, how: Literal["grid", "side_by_side"]) -> tuple[str, ...]:
        """Return the swept keys of a grid, or those whose values go side by side."""
        return tuple(json.loads(self.texts[how]))

    @property
    def keys(self) -> tuple[str, ...]:
        """All swept keys: those of the grid, then those side by side."""
        return (*self.swept("grid"), *self.swept("side_by_side"))

    @property
    def values(self) -> list[dict[str, Any]]:
        """The swept values of every point, by key, as written in the file, and sizes of a file that was swept."""
        return [json.loads(text) for text in self.points["values"].values.tolist()]

    def scenario(self, point: int) -> Scenario:
        """Return the scenario of a point by its number, with a seed of the first point; raises RunFileRefused."""
        resolved = json.loads(self.texts["scenario_resolved"])
        for key, value in json.loads(self.points["values"].values[point]).items():  # of this point alone
            section, name = key.split(".")
            resolved.setdefault(section, {})[name] = value
        return stored(resolved, f"the scenario of point {point}")


def index_bytes(index: Index) -> bytes:
    """Return the file of an index, made in memory: HDF5 ends the process instead of raising if a disk is full."""
    with h5py.File("index", "w", driver="core", backing_store=False, libver=LIBRARY_VERSIONS) as file:
        about = {"format_version": FORMAT_VERSION, "format": INDEX_FORMAT, "Conventions": CONVENTIONS}
        put_attributes(file, {**about, "NX_class": "NXroot", **index.texts})
        scales: dict[int, h5py.Dataset] = {}
        for group, filled in zip(GROUPS, (index.points, index.runs), strict=False):
            owner = file.create_group(group, track_order=True)
            scale, *others = [_put_column(owner, each) for each in filled.values()]
            scale.make_scale(scale.name.rpartition("/")[2])
            for dataset in others:
                dataset.dims[0].attach_scale(scale)
            scales[scale.size] = scale
        summaries = file.create_group(GROUPS[-1])
        for name, values in index.summaries.items():
            summaries.create_dataset(name, data=values).dims[0].attach_scale(scales[len(values)])
        file.flush()
        return sealed(file.id.get_file_image())


def sealed(content: bytes) -> bytes:
    """Return bytes and, behind them, their xxh3_128."""
    return content + xxhash.xxh3_128_digest(content)


def _put_column(owner: h5py.Group, column: Filled) -> h5py.Dataset:
    values = as_bytes(column.values.tolist()) if column.values.dtype.kind == "U" else column.values
    dataset = owner.create_dataset(column.about.name, data=values)
    said = {"units": column.about.units, "long_name": column.about.long_name}
    put_attributes(dataset, {name: text for name, text in said.items() if text})
    return dataset


def read_index(path: str | os.PathLike[str]) -> Index:
    """Read the index of a sweep, also from elsewhere; raises RunFileRefused with the reason in one sentence."""
    with refusing(path), open_stream(path) as stream:
        content = stream.read()
        if not content.startswith(SIGNATURE):
            raise RunFileRefused(f"is not an HDF5 file; {REMEDY}")
        with naming_damage(), h5py.File(stream, "r") as file:
            check_format(file, INDEX_FORMAT, FORMAT_VERSION, REMEDY)
            if sealed(content[:-16]) != content:
                raise RunFileRefused(f"damaged: is not as it was written; {REMEDY}")
            points, runs, summaries = (_columns(file, name) for name in GROUPS)
            curves = {name: column.values for name, column in summaries.items()}
            texts = {name: read_attribute(file, name, str) for name in TEXTS}
            return Index(texts=texts, points=points, runs=runs, summaries=curves)


def _columns(file: h5py.File, group: str) -> dict[str, Filled]:
    """Return the columns of a group, in order; raises RunFileRefused for what no index has."""
    owner, found = sound_group(file, group), {}
    for name in owner:
        dataset, creation = own_dataset(owner, name)
        if creation.get_layout() != h5py.h5d.CONTIGUOUS or not dataset.ndim or dataset.dtype.kind not in "fiS":
            raise RunFileRefused(f"{dataset.name} is not stored as our files store it")
        check_whole(dataset, creation)
        values: NDArray[Any] = dataset[()]
        if values.dtype.kind == "S":
            values = np.char.decode(values, "utf-8", "replace") if values.size else np.empty(values.shape, np.str_)
        said = {each: read_attribute(dataset, each, str) for each in ("units", "long_name") if each in dataset.attrs}
        about = Dataset(name, said.get("units", ""), "", said.get("long_name", ""), dtype=values.dtype.str)
        found[name] = Filled(about=about, values=values)
    return found

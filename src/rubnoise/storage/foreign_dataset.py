"""A dataset of another program's HDF5 or netCDF file, read in pieces with its dimension scale.

Soft links lead on within the file; links and storage in other files are not followed.
"""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import h5py
import numpy as np

from rubnoise.arrays import Doubles, slices
from rubnoise.errors import UNFINISHED, NoColumn, RunFileRefused
from rubnoise.regular_file import open_regular
from rubnoise.storage.objects import opened_by_hdf5
from rubnoise.storage.schema import FORMAT

MOST_VALUES: Final = 100_000_000
PIECE_VALUES: Final = 1 << 21
_MOST_LINKS: Final = 16
_LISTED: Final = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignDataset:
    """The unit of a dataset, and name and unit of its scale; each is empty where there is none."""

    unit: str
    place: str = ""
    place_unit: str = ""


def pieces_of_dataset(path: Path, name: str) -> Iterator[tuple[ForeignDataset, Doubles, Doubles]]:
    """Yield pieces of a dataset: its description, values, and those of its scale; raises NoColumn if it is missing."""
    descriptor = open_regular(path)
    try:
        with opened_by_hdf5(path, descriptor) as file:
            _check_finished(path, file)
            dataset = _dataset(file, name)
            scale = _scale(dataset)
            about = _described(dataset, scale, name)
            for part in slices(0, dataset.size, PIECE_VALUES) if dataset.size else [slice(0, 0)]:
                places = np.zeros(0) if scale is None else scale[part].astype(np.float64)
                yield about, dataset[part].astype(np.float64), places
    except NoColumn as refused:
        raise NoColumn(f"{path}: {refused}") from refused
    except RunFileRefused:
        raise
    except Exception as problem:
        raise NoColumn(f"{path}: damaged or no HDF5: {' '.join(str(problem).split())}") from problem
    finally:
        os.close(descriptor)


def _dataset(file: h5py.File, name: str) -> h5py.Dataset:
    """Return the dataset of numbers with a path; raises NoColumn for anything else."""
    dataset = _linked(file, name)
    if not isinstance(dataset, h5py.Dataset):
        raise NoColumn(f"{name} is no dataset in it; it has {', '.join(_datasets(file)) or 'none'}")
    if not _is_here(dataset):
        raise NoColumn(f"{name} has its values in other files, which are not read")
    if dataset.ndim != 1 or dataset.dtype.kind not in "fiu":
        raise NoColumn(f"{name} has {dataset.ndim} dimensions of {dataset.dtype}; one of numbers is needed")
    if dataset.size > MOST_VALUES:
        raise NoColumn(f"{name} has {dataset.size:,} values; up to {MOST_VALUES:,} are read from a file of others")
    return dataset


def _linked(file: h5py.File, path: str, links: int = 0) -> h5py.HLObject | None:
    """Return the object at a path, reached by hard and soft links within the file; None if there is none."""
    owner, parts = file["/"], [part for part in path.split("/") if part]
    for number, part in enumerate(parts):
        link = owner.get(part, getlink=True) if isinstance(owner, h5py.Group) else None
        if isinstance(link, h5py.SoftLink) and links < _MOST_LINKS:
            there = link.path if link.path.startswith("/") else f"{owner.name}/{link.path}"
            return _linked(file, "/".join([there, *parts[number + 1 :]]), links + 1)
        if not isinstance(link, h5py.HardLink):
            return None
        owner = owner[part]
    return owner


def _is_here(dataset: h5py.Dataset) -> bool:
    """Whether the values of a dataset lie in its own file."""
    creation = dataset.id.get_create_plist()
    return creation.get_layout() != h5py.h5d.VIRTUAL and not creation.get_external_count()


def _scale(dataset: h5py.Dataset) -> h5py.Dataset | None:
    """Return the dimension scale of a dataset, if it has one of numbers, and as long."""
    scale = dataset.dims[0][0] if len(dataset.dims[0]) else None
    if scale is None or not _is_here(scale) or scale.shape != dataset.shape or scale.dtype.kind not in "fiu":
        return None
    return scale


def _described(dataset: h5py.Dataset, scale: h5py.Dataset | None, name: str) -> ForeignDataset:
    unit = _attribute(dataset, "units") or ""
    if scale is None:
        return ForeignDataset(unit=unit)
    place = scale.name or f"scale of {name}"
    return ForeignDataset(unit=unit, place=place, place_unit=_attribute(scale, "units") or "")


def _check_finished(path: Path, file: h5py.File) -> None:
    """Refuse the part file of a run of ours, whose last rows were never computed."""
    origin = _linked(file, "provenance")
    if _attribute(file, "format") == FORMAT and origin is not None and _attribute(origin, "finished") == "":
        raise RunFileRefused(f"{path}: {UNFINISHED}")


def _attribute(item: h5py.HLObject, name: str) -> str | None:
    text = item.attrs.get(name)
    return text.decode("utf-8", "replace") if isinstance(text, bytes) else None if text is None else str(text)


def _datasets(file: h5py.File) -> list[str]:
    """Return the paths of the first few datasets."""
    found: list[str] = []

    def note(name: str, item: h5py.HLObject) -> bool | None:
        if isinstance(item, h5py.Dataset):
            found.append(name)
        return True if len(found) == _LISTED else None

    file.visititems(note)
    return found

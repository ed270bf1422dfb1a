"""What a result file holds: its columns, their rows and bytes, and where it comes from; no person is named."""

import os
import platform
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Literal

import numpy as np

from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model
from rubnoise.record.rows import Extent
from rubnoise.storage.life_curve import CURVE_ROWS, JUNCTION_AREA_FORMULAS, TABLE_ROWS, TOUCH_AREA_FORMULA
from rubnoise.storage.schema import CONVENTIONS, FORMAT, FORMAT_VERSION, GROUPS, Feature, Group, Scalar


def this_command() -> list[str]:
    """Return the command line of this process, without the path of the program."""
    return [Path(sys.argv[0]).name, *sys.argv[1:]]


def software() -> dict[str, str]:
    """Return the versions that a result may depend on."""
    import h5py

    packages = ("rubnoise", "numpy", "scipy", "numba", "simpy", "h5py")
    others = {"hdf5": h5py.version.hdf5_version, "python": platform.python_version()}
    return {**{name: package_version(name) for name in packages}, **others}


def environment() -> dict[str, str | int]:
    """Return the platform, the processor family and the number of processors."""
    return {"platform": platform.platform(), "machine": platform.machine(), "cpu_count": os.cpu_count() or 0}


@cache
def package_version(name: str) -> str:
    """Return the version of an installed package, or ``not installed``."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def now() -> str:
    """Return the time in UTC as ISO 8601, to the second."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


STRUCTURE_BYTES = 20 * 1024
"""Room for everything in a file but columns and scenario: headers, attributes, scales, summary."""

Name = tuple[str, str]  # what a column is found by: its group and its own name


@dataclass(frozen=True, slots=True, kw_only=True)
class RunDescription:
    """The content of a result file that is known before its first row."""

    title: str
    extent: Extent
    features: frozenset[Feature]
    compression: Literal["none", "gzip"]
    pulse: Pulse
    provenance: Mapping[str, Scalar]


def root_attributes(about: RunDescription) -> dict[str, Scalar]:
    """Return the attributes of the root of a file."""
    return {
        "Conventions": CONVENTIONS,
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": about.title,
        "source": f"rubnoise {package_version('rubnoise')}",
        "junction_area_formula": (
            TOUCH_AREA_FORMULA if "free" in about.features else JUNCTION_AREA_FORMULAS[about.pulse.name]
        ),
    }


def features_of(model: Model) -> frozenset[Feature]:
    """Return the features of a run of this model: what it stores beyond the bare contact."""
    given: dict[Feature, object] = {
        "speed": model.sliding_speed,
        "strength": model.strengths,
        "slider": model.slider,
        "two-way": model.is_two_way,
        "free": model.free,
        "offset": None if model.pulse.offset == "none" else model.pulse.offset,
        "load": model.held,
        "base": model.slider is not None and model.slider.excitation == "base",
    }
    return frozenset(feature for feature, value in given.items() if value is not None and value is not False)


@cache  # since the runs of a sweep have the same
def stored_groups(features: frozenset[Feature]) -> tuple[Group, ...]:
    """Return the groups and columns of a run with these features, as its file describes them."""
    found = []
    for group in GROUPS:
        if (not group.needs or not features.isdisjoint(group.needs)) and features.isdisjoint(group.lacks):
            columns = tuple(column for column in group.columns if column.needs is None or column.needs in features)
            found.append(replace(group, columns=columns).as_in(features))
    return tuple(found)


def row_count(group: Group, extent: Extent) -> int | None:
    """Return the number of rows of a group, None if only the end of a run shows it."""
    return {"life_curve": CURVE_ROWS, "life_table": TABLE_ROWS, **extent}[group.name]


def expected_bytes(extent: Extent, features: frozenset[Feature]) -> int:
    """Return the size of an uncompressed result file within a few kilobytes, without its scenario."""
    return STRUCTURE_BYTES + sum(
        (row_count(group, extent) or 0) * np.dtype(column.dtype).itemsize
        for group in stored_groups(features)
        for column in group.columns
    )

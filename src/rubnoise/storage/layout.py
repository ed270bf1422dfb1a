"""What a result file holds: its columns, their rows and bytes, where it comes from, and the life of any junction.

The table is that of the pulse that the file names; any tool can interpolate it. No person is named.
"""

import os
import platform
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import OFF_CENTRE, PULSES, Pulse, Shape
from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.storage.schema import CONVENTIONS, FORMAT, FORMAT_VERSION, GROUPS, Feature, Group, Scalar

TIME = "%Y-%m-%dT%H:%M:%SZ"
"""How moments are written: in UTC, as ISO 8601, to the second."""

PACKAGES = ("rubnoise", "numpy", "scipy", "numba", "simpy", "h5py")


def this_command() -> list[str]:
    """Return the command line of this process, without the path of the program."""
    return [Path(sys.argv[0]).name, *sys.argv[1:]]


def software() -> dict[str, str]:
    """Return the versions that a result may depend on."""
    import h5py

    packages = {name: package_version(name) for name in PACKAGES}
    return {**packages, "hdf5": h5py.version.hdf5_version, "python": platform.python_version()}


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
    return datetime.now(UTC).strftime(TIME)


STRUCTURE_BYTES = 20 * 1024
"""Room for everything in a file but columns and scenario: headers, attributes, scales, summary."""

Name = tuple[str, str]
"""What a column is found by: its group and its own name."""


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


@cache
def stored_groups(features: frozenset[Feature]) -> tuple[Group, ...]:
    """Return the groups and columns of a run with these features, as its file describes them.

    Kept, since the runs of a sweep have the same.
    """
    there = (
        group.as_in(features)
        for group in GROUPS
        if (not group.needs or not features.isdisjoint(group.needs)) and features.isdisjoint(group.lacks)
    )
    return tuple(
        replace(group, columns=tuple(each for each in group.columns if each.needs is None or each.needs in features))
        for group in there
    )


def row_count(group: Group, extent: Extent) -> int | None:
    """Return the number of rows of a group, None if only the end of a run shows it."""
    fixed = {"life_curve": CURVE_ROWS, "life_table": TABLE_ROWS}
    return fixed.get(group.name) or extent.rows(group.name)


def expected_bytes(extent: Extent, features: frozenset[Feature]) -> int:
    """Return the size of an uncompressed result file within a few kilobytes, without its scenario."""
    return STRUCTURE_BYTES + sum(
        (row_count(group, extent) or 0) * np.dtype(column.dtype).itemsize
        for group in stored_groups(features)
        for column in group.columns
    )


# The life of any junction.
_WHERE: Final = (
    " with d = diameter, x = |d - (s - birth_distance)|, for birth_distance <= s < death_distance, and 0 elsewhere"
)
_WHERE_OFF_CENTRE: Final = (
    " with d = diameter, b = lateral_offset, x = s - birth_distance - sqrt(d^2 - b^2), r = sqrt(x^2 + b^2), for"
    " birth_distance <= s < death_distance, and 0 elsewhere"
)
JUNCTION_AREA_FORMULAS: Final = {
    **{name: f"A(s) = {pulse.formula}{_WHERE}" for name, pulse in PULSES.items()},
    **{pulse.name: f"A(s) = {pulse.formula}{_WHERE_OFF_CENTRE}" for pulse in OFF_CENTRE.values()},
}
"""The area of a junction in words, by the name of its pulse."""

TOUCH_AREA_FORMULA: Final = (
    "A = max_area * overlap/max_overlap; the overlap follows the separation: h - (s - x)^2 height_scale/c^2 - z of a"
    " summit of height h at x, c^2 = 4 mean_real_contact_area/(pi mean_junction_count)"
)
"""The area of a junction under a slider that may leave its contact."""


HALF_POINTS = 512
CURVE_ROWS = 2 * HALF_POINTS + 1
TABLE_STEPS = 32
TABLE_ROWS = (2 * TABLE_STEPS + 1) * (TABLE_STEPS + 1)


def life_tables(pulse: Pulse) -> dict[str, dict[str, NDArray[np.float64]]]:
    """Return the group of columns that describes the area of any life of a pulse, by its name."""
    if pulse.offset == "none":
        return {"life_curve": life_curve(pulse.shape)}
    return {"life_table": life_table(pulse.shape)}


@cache
def life_table(shape: Shape) -> dict[str, NDArray[np.float64]]:
    """Return ``u``, ``offset_fraction`` and ``area_fraction`` so that A(s) = d^2 interp(u, |b|/d), within 1e-3 d^2.

    u is the distance since birth over half of the life, h = sqrt(d^2 - b^2), in [0, 2]; every value of |b|/d in [0, 1]
    follows for each u. Both go by t^2 (3 - 2t), so that points are close where the area is a power 3/2 and where it has
    its tip, at u = 1 and b = 0.
    """
    steps = [t * t * (3 * TABLE_STEPS - 2 * t) / TABLE_STEPS**3 for t in range(TABLE_STEPS + 1)]
    b, half = np.array(steps), np.array(steps)[:, None]
    apart = np.sqrt(b * b + (1.0 - b * b) * (1.0 - half) ** 2)  # of the centres, for unit diameter
    rising = PULSES[shape].overlap(apart)
    u = [*steps, *(2.0 - each for each in reversed(steps[:-1]))]
    return {
        "u": np.repeat(u, len(steps)),
        "offset_fraction": np.tile(steps, len(u)),
        "area_fraction": np.concatenate([rising, rising[-2::-1]]).ravel(),
    }


@cache
def life_curve(shape: Shape) -> dict[str, NDArray[np.float64]]:
    """Return ``u`` and ``area_fraction`` so that A(s) = d^2 interp(u), u = (s - birth)/d in [0, 2], within 1e-6 d^2.

    The pulse's own area over d^2 at u = (i/n)^2 and its mirror image: the squares put the points where the lens is a
    power 3/2 and leave a linear interpolation at most 0.15/n^2 off.
    """
    squares = [(i * i) / (HALF_POINTS * HALF_POINTS) for i in range(HALF_POINTS + 1)]
    rising = PULSES[shape].overlap(1.0 - np.array(squares))
    mirrored = [2.0 - u for u in reversed(squares[:-1])]
    return {"u": np.array(squares + mirrored), "area_fraction": np.concatenate([rising, rising[-2::-1]])}

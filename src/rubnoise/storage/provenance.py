"""The origin of a result: software, machine, seed, command and times; nothing that names a person."""

import os
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from shlex import join

from rubnoise.streams import STREAM_VERSION

TIME = "%Y-%m-%dT%H:%M:%SZ"
"""How moments are written: in UTC, as ISO 8601, to the second."""

PACKAGES = ("rubnoise", "numpy", "scipy", "numba", "simpy", "h5py")


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """The origin of one run, without the time of its end.

    calibrated_diameter in um; propagator_constants are the rounded constants of the slider's exact step, by name;
    intervention: the function that may have ended lives, empty if the model alone did.
    """

    software: Mapping[str, str]
    environment: Mapping[str, str | int]
    seed: int
    stream_version: int
    calibrated_diameter: float
    propagator_constants: Mapping[str, float]
    command: str
    started: str
    intervention: str = ""


def gather(
    *,
    seed: int,
    calibrated_diameter: float,
    propagator_constants: Mapping[str, float],
    command: Sequence[str],
    intervention: str = "",
) -> Provenance:
    """Return the provenance of a run that starts now in this process.

    ``command`` is the command line without the path of the program, e.g. ["rubnoise", "run", "fig5.toml"].
    """
    return Provenance(
        software=software(),
        environment=environment(),
        seed=seed,
        stream_version=STREAM_VERSION,
        calibrated_diameter=calibrated_diameter,
        propagator_constants=dict(propagator_constants),
        command=join(command),
        started=now(),
        intervention=intervention,
    )


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

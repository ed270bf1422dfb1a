"""Provenance names software, machine and command, and no person."""

import getpass
import json
import platform
import re
from dataclasses import asdict

import h5py
import numpy as np
import pytest

from rubnoise.storage.provenance import gather, now, package_version
from rubnoise.streams import STREAM_VERSION


@pytest.fixture(name="origin")
def gathered() -> dict[str, object]:
    return asdict(
        gather(
            seed=12,
            calibrated_diameter=5.53,
            propagator_constants={"decay": 0.1},
            command=["rubnoise", "run", "my run.toml", "--seed", "12"],
        )
    )


def test_versions_are_those_in_use(origin: dict[str, object]) -> None:
    software = origin["software"]
    assert isinstance(software, dict)
    assert {"rubnoise", "numpy", "scipy", "numba", "simpy", "h5py", "hdf5", "python"} == set(software)
    assert software["numpy"] == np.__version__
    assert software["hdf5"] == h5py.version.hdf5_version
    assert software["python"] == platform.python_version()


def test_command_can_be_pasted_into_a_shell(origin: dict[str, object]) -> None:
    assert origin["command"] == "rubnoise run 'my run.toml' --seed 12"


def test_constants_and_seed_are_kept(origin: dict[str, object]) -> None:
    assert (origin["seed"], origin["calibrated_diameter"]) == (12, 5.53)
    assert origin["propagator_constants"] == {"decay": 0.1}
    assert origin["stream_version"] == STREAM_VERSION


def test_neither_a_person_nor_the_host_is_named(origin: dict[str, object]) -> None:
    text = json.dumps(origin)
    assert platform.node() not in text
    assert re.search(rf"\b{re.escape(getpass.getuser())}\b", text) is None
    assert "/" not in text


def test_times_are_utc_to_the_second() -> None:
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", now())


def test_a_missing_package_is_said_to_be_missing() -> None:
    assert package_version("rubnoise-that-never-was") == "not installed"

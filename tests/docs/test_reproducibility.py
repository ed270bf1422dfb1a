"""docs/reproducibility.md promises what the program does, and lists all of it."""

import re
import tomllib
from pathlib import Path

import h5py
import pytest

import rubnoise
from rubnoise.scenario import Scenario
from rubnoise.storage.schema import GROUPS
from rubnoise.streams import STREAM_VERSION, Stream
from tests.architecture.sources import ROOT

PAGE = (ROOT / "docs" / "reproducibility.md").read_text(encoding="utf-8")
PROMISED = re.findall(r"^\| `/(\w+)` \| every column", PAGE, re.MULTILINE)


def test_every_group_of_columns_is_promised() -> None:
    assert sorted(PROMISED) == sorted(group.name for group in GROUPS)


def test_streams_and_their_version_are_those_of_the_program() -> None:
    listed = re.findall(r"^\| `(\w+)` \| (\d+) \|", PAGE, re.MULTILINE)
    assert [(name, int(key)) for name, key in listed] == [(stream.name, stream.value) for stream in Stream]
    assert f"and is **{STREAM_VERSION}** now" in " ".join(PAGE.split())


def test_the_oldest_libraries_that_were_measured_are_the_oldest_allowed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (bound,) = re.findall(r"numpy>=(\S+)'", str(project["dependencies"]))
    measured = re.findall(r"^\| (3\.\d+) \| oldest allowed \| (\S+) \|", PAGE, re.MULTILINE)
    assert {python for python, _ in measured} == {"3.11", "3.12", "3.13"}
    assert all(version.startswith(f"{bound}.") for _, version in measured)


def scenario(engine: str, compression: str, seed: int = 7) -> Scenario:
    return rubnoise.build(
        {
            "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
            "diameter": {"law": "normal", "spread": "0.2 um"},
            "strength": {"mean": "250 MPa"},
            "sliding": {"distance": "1 mm", "speed": "1 mm/s"},
            "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
            "output": {"tick": "0.5 um", "compression": compression},
            "run": {"seed": seed, "engine": engine},
        }
    )


def hashes(path: Path) -> dict[str, str]:
    with h5py.File(path) as file:
        return {
            column.name: column.attrs["xxh3_128"] for name in PROMISED if name in file for column in file[name].values()
        }


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("kept") / "kept.h5"
    rubnoise.run(scenario("events", "none"), path).close()
    return path


@pytest.mark.parametrize(("engine", "compression"), [("events", "none"), ("events", "gzip"), ("batch", "none")])
def test_what_is_promised_is_the_same_and_the_file_is_not(
    kept: Path, tmp_path: Path, engine: str, compression: str
) -> None:
    again = tmp_path / "again.h5"
    rubnoise.run(scenario(engine, compression), again).close()
    assert hashes(again) == hashes(kept)
    assert len(hashes(kept)) > 20
    assert again.read_bytes() != kept.read_bytes()


def test_another_seed_has_other_columns(kept: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.h5"
    rubnoise.run(scenario("batch", "none", seed=8), other).close()
    differ = {name for name, value in hashes(kept).items() if hashes(other).get(name) != value}
    assert differ >= {"/junctions/birth_distance", "/trace/real_contact_area", "/slider/velocity"}
    assert "/life_curve/area_fraction" not in differ

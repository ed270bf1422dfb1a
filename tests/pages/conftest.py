"""Runs to look into, made once, and the browser of the lesson's tests."""

from pathlib import Path

import pytest

import rubnoise
from tests.architecture.sources import ROOT

PAPER = ROOT / "scenarios" / "paper"


@pytest.fixture(scope="session")
def one_way(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run of Figure 5 over 400 um, some 740 junctions."""
    path = tmp_path_factory.mktemp("one_way") / "one_way.h5"
    rubnoise.run(rubnoise.load(PAPER / "fig5.toml", ["sliding.distance=400 um"]), path).close()
    return path


@pytest.fixture(scope="session")
def off_centre(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the same contact, whose junctions miss each other's centre line."""
    path = tmp_path_factory.mktemp("off_centre") / "off_centre.h5"
    changes = ["sliding.distance=400 um", 'pulse.offset="uniform"', 'interface.calibration="exact"']
    rubnoise.run(rubnoise.load(PAPER / "fig5.toml", changes), path).close()
    return path


@pytest.fixture(scope="session")
def two_way(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run of Figure 5 with two-way coupling over 600 um, which sticks several times."""
    path = tmp_path_factory.mktemp("two_way") / "two_way.h5"
    rubnoise.run(rubnoise.load(PAPER / "fig5_two_way.toml", ["sliding.distance=600 um"]), path).close()
    return path


@pytest.fixture(scope="session")
def bouncing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a run of a light slider that hops, over 6 mm."""
    path = tmp_path_factory.mktemp("bouncing") / "bouncing.h5"
    rubnoise.run(rubnoise.load(ROOT / "scenarios" / "load" / "bouncing.toml", ["sliding.distance=6 mm"]), path).close()
    return path


@pytest.fixture(scope="session")
def sweep_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a sweep of six runs over the number of junctions."""
    folder = tmp_path_factory.mktemp("sweep")
    scenario = folder / "few.toml"
    scenario.write_text(
        f'format = 1\nextends = "{(PAPER / "fig5.toml").as_posix()}"\ntitle = "few <b>points</b>"\n'
        '[sliding]\ndistance = "300 um"\n[sweep]\nreplicates = 2\n'
        "[sweep.grid]\ninterface.mean_junction_count = [5, 10, 20]\n",
        encoding="utf-8",
    )
    with rubnoise.sweep(scenario, folder / "few", jobs=1):
        pass
    return folder / "few"

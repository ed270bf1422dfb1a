"""The file that the page is about, made by the program as it is."""

import shutil
from pathlib import Path

import pytest

import rubnoise

FIG5 = Path(__file__).parents[2] / "scenarios" / "paper" / "fig5.toml"


@pytest.fixture(scope="session", params=["none", "gzip"])
def kept_run(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """Return the beginning of Figure 5: its first junctions are those of the whole run."""
    path = tmp_path_factory.mktemp("reading") / "fig5.h5"
    scenario = rubnoise.load(FIG5, ['sliding.distance="40 um"', f'output.compression="{request.param}"'])
    rubnoise.run(scenario, path, command=["rubnoise", "run", "fig5.toml"]).close()
    return path


@pytest.fixture(scope="session")
def two_way_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the beginning of Figure 5 with two-way coupling, as fig5_two_way.h5."""
    folder = tmp_path_factory.mktemp("two_way")
    scenario = rubnoise.load(FIG5.with_name("fig5_two_way.toml"), ['sliding.distance="1 mm"', "run.engine=batch"])
    rubnoise.run(scenario, folder / "fig5_two_way.h5").close()
    return folder


@pytest.fixture
def folder(kept_run: Path, tmp_path: Path) -> Path:
    """Return a folder with nothing but fig5.h5 in it."""
    shutil.copy(kept_run, tmp_path / "fig5.h5")
    return tmp_path

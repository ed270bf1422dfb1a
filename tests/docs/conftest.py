"""Where examples run: a folder with what the README has made by then, the scenarios and fig5.h5.

Every day the scenarios of the paper's long runs are shorter there, and claims are not settled anew for the page that
prints them (tests/verification does); with --all they are what they are.
"""

import os
import shutil
import sys
from pathlib import Path

import pytest

import rubnoise
from rubnoise.claims import catalogue
from tests.architecture.sources import ROOT
from tests.cli.test_json_contract import A_CLAIM
from tests.wishes import Wishes

SHORTER = {"fig5": "11 mm", "fig8": "2 mm", "fig9": "2 mm"}
"""Distances in place of the paper's; half a second of sound, twenty times as fast, takes 10 mm of Figure 5."""


@pytest.fixture(scope="session")
def scenarios(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of scenarios."""
    if Wishes.everything:
        return ROOT / "scenarios"
    folder = tmp_path_factory.mktemp("scenarios") / "scenarios"
    shutil.copytree(ROOT / "scenarios", folder)
    for name, distance in SHORTER.items():
        text = (
            f'format = 1\nextends = "{ROOT / "scenarios" / "paper" / name}.toml"\n[sliding]\ndistance = "{distance}"\n'
        )
        (folder / "paper" / f"{name}.toml").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def figure_5(tmp_path_factory: pytest.TempPathFactory, scenarios: Path) -> Path:
    """Return the result of the README's first command."""
    path = tmp_path_factory.mktemp("result") / "fig5.h5"
    rubnoise.run(rubnoise.load(scenarios / "paper" / "fig5.toml"), path).close()
    return path


@pytest.fixture
def workplace(tmp_path: Path, scenarios: Path, figure_5: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in a folder with scenarios and a result, where `rubnoise` is a command."""
    here, commands = tmp_path / "workplace", tmp_path / "bin"
    here.mkdir()
    commands.mkdir()
    (here / "scenarios").symlink_to(scenarios)
    os.link(figure_5, here / "fig5.h5")
    shim = commands / "rubnoise"
    shim.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m rubnoise "$@"\n', encoding="utf-8")
    shim.chmod(0o755)
    monkeypatch.setenv("PATH", f"{commands}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(here)
    if not Wishes.everything:
        monkeypatch.setattr(catalogue, "settle", lambda _: (A_CLAIM,))
    return here

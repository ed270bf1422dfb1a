"""Where examples run: a folder with what the README has made by then, the scenarios and fig5.h5."""

import os
import sys
from pathlib import Path

import pytest

import rubnoise
from tests.architecture.sources import ROOT


@pytest.fixture(scope="session")
def figure_5(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the result of Figure 5, which the README makes."""
    path = tmp_path_factory.mktemp("result") / "fig5.h5"
    rubnoise.run(rubnoise.load(ROOT / "scenarios" / "paper" / "fig5.toml"), path).close()
    return path


@pytest.fixture
def workplace(tmp_path: Path, figure_5: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in a folder with scenarios and a result, where `rubnoise` is a command."""
    here, commands = tmp_path / "workplace", tmp_path / "bin"
    here.mkdir()
    commands.mkdir()
    (here / "scenarios").symlink_to(ROOT / "scenarios")
    os.link(figure_5, here / "fig5.h5")
    shim = commands / "rubnoise"
    shim.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m rubnoise "$@"\n', encoding="utf-8")
    shim.chmod(0o755)
    monkeypatch.setenv("PATH", f"{commands}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(here)
    return here

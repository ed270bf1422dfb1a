"""The notebooks run as scripts from their first cell to their last, and what they claim on the way holds."""

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.py"))
NEEDED = ("marimo", "matplotlib", "h5netcdf", "xarray")
MISSING = [name for name in NEEDED if find_spec(name) is None]

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"notebooks need {', '.join(MISSING)} of the extra teach")


def _run(script: Path, folder: Path) -> "subprocess.CompletedProcess[str]":
    """Run a notebook without a screen, in a folder of its own."""
    return subprocess.run(
        [sys.executable, script],
        cwd=folder,
        env=os.environ | {"MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_there_are_two() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["lifetimes", "noise"]


@pytest.mark.torture
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs_as_a_script_and_leaves_nothing_behind(notebook: Path, tmp_path: Path) -> None:
    done = _run(notebook, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.torture
def test_a_wrong_claim_stops_it(tmp_path: Path) -> None:
    text = (ROOT / "notebooks" / "lifetimes.py").read_text(encoding="utf-8")
    right, wrong = "theory.length_biased_mean_diameter) < 4.0", "theory.mean_diameter) < 4.0"
    assert text.count(right) == 1
    (tmp_path / "wrong.py").write_text(text.replace(right, wrong), encoding="utf-8")
    done = _run(tmp_path / "wrong.py", tmp_path)
    assert done.returncode != 0
    assert "AssertionError" in done.stderr


def test_marimo_finds_nothing_wrong_with_their_cells() -> None:
    check = [sys.executable, "-m", "marimo", "check", "--strict", *NOTEBOOKS]
    done = subprocess.run(check, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr

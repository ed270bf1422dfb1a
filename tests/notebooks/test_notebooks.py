"""The notebooks run as scripts from their first cell to their last, and what they claim on the way holds."""

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from tests.architecture.sources import ROOT
from tools.export_notebooks import plain_notebook

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.py"))
NEEDED = ("marimo", "matplotlib", "h5netcdf", "xarray", "SurfaceTopography")
MISSING = [name for name in NEEDED if find_spec(name) is None]

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"notebooks need {', '.join(MISSING)}")


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


def test_there_are_four() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["first_run", "lifetimes", "noise", "surfaces"]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_plain_notebook_is_made_of_its_source(notebook: Path) -> None:
    """`dev.py generate notebooks` writes it."""
    text = notebook.with_suffix(".ipynb").read_text(encoding="utf-8")
    assert text == plain_notebook(notebook.read_text(encoding="utf-8"))
    cells = json.loads(text)["cells"]
    assert not any("marimo" in line or "mo." in line for cell in cells for line in code_of(cell))
    assert {cell["cell_type"] for cell in cells} == {"markdown", "code"}
    assert "_figure\n" not in [line for cell in cells for line in code_of(cell)]  # Jupyter would show it twice
    for cell in cells:
        compile("".join(code_of(cell)), notebook.name, "exec")


def code_of(cell: dict[str, Any]) -> list[str]:
    return list(cell["source"]) if cell["cell_type"] == "code" else []


@pytest.mark.slow
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs_as_a_script_and_leaves_nothing_behind(notebook: Path, tmp_path: Path) -> None:
    done = _run(notebook, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_wrong_claim_stops_it(tmp_path: Path) -> None:
    text = (ROOT / "notebooks" / "lifetimes.py").read_text(encoding="utf-8")
    right, wrong = "theory.length_biased_mean_diameter) < 4.0", "theory.mean_diameter) < 4.0"
    assert text.count(right) == 1
    (tmp_path / "wrong.py").write_text(text.replace(right, wrong), encoding="utf-8")
    done = _run(tmp_path / "wrong.py", tmp_path)
    assert done.returncode != 0
    assert "AssertionError" in done.stderr


@pytest.mark.slow
def test_marimo_finds_nothing_wrong_with_their_cells() -> None:
    check = [sys.executable, "-m", "marimo", "check", "--strict", *NOTEBOOKS]
    done = subprocess.run(check, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr

"""Imports go down only, as the contract in pyproject.toml says."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT

LINT = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"


def _lint(folder: Path) -> tuple[int, str]:
    environment = {**os.environ, "PYTHONPATH": str(folder / "src"), "COLUMNS": "200"}
    done = subprocess.run(
        [sys.executable, "-c", LINT], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    return done.returncode, done.stdout + done.stderr


def test_the_contract_is_kept() -> None:
    code, report = _lint(ROOT)
    assert code == 0, report


@pytest.mark.parametrize(
    ("module", "statement"),
    [
        ("contact/wrong.py", "from rubnoise.simulation import run"),
        ("theory/wrong.py", "def late():\n    from rubnoise.simulation import run"),
        ("streams/wrong.py", "from rubnoise import errors"),
        ("unlisted.py", ""),
    ],
    ids=["upwards", "sideways, inside a function", "sideways at the bottom", "outside of every layer"],
)
def test_a_breach_is_seen(tmp_path: Path, module: str, statement: str) -> None:
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    wrong = tmp_path / "src" / "rubnoise" / module
    if wrong.parent.name == "streams":
        wrong = wrong.parent.with_suffix(".py")
    wrong.write_text(f"{statement}\n", encoding="utf-8")
    code, report = _lint(tmp_path)
    assert code == 1, report

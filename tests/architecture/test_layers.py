"""Imports go down only, as the contract in pyproject.toml says."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

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


def test_breaches_are_seen(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    package = tmp_path / "src" / "rubnoise"
    for module, statement in {
        "contact/upwards": "from rubnoise.simulation import run",
        "theory/sideways": "def late():\n    from rubnoise.simulation import run",
        "inference/downwards": "from rubnoise.simulation import run",
        "unlisted": "",
    }.items():
        (package / f"{module}.py").write_text(f"{statement}\n", encoding="utf-8")
    (package / "streams.py").write_text("from rubnoise import errors\n", encoding="utf-8")
    code, report = _lint(tmp_path)
    assert code == 1, report
    for breach in (
        "rubnoise.contact.upwards -> rubnoise.simulation.run (l.1)",
        "rubnoise.theory.sideways -> rubnoise.simulation.run (l.2)",
        "rubnoise.streams -> rubnoise.errors (l.1)",
        "rubnoise.inference.downwards -> rubnoise.simulation.run (l.1)",
        "The following modules are not listed as layers:\n\n- rubnoise.unlisted\n",
    ):
        assert breach in report

"""An installation that cannot be written to, used without a home."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rubnoise


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """Return a folder with the package in it, none of which can be written."""
    folder = tmp_path / "installed"
    shutil.copytree(Path(rubnoise.__file__).parent, folder / "rubnoise", ignore=shutil.ignore_patterns("__pycache__"))
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    return folder


def test_a_run_works_where_kernels_cannot_be_kept(here: Path, installed: Path, unprivileged: tuple[str, ...]) -> None:
    environment = {name: text for name, text in os.environ.items() if not name.startswith(("NUMBA_", "XDG_"))}
    environment |= {"PYTHONPATH": str(installed), "HOME": str(installed / "nobody")}
    here.joinpath("where.py").write_text("import rubnoise.api\nprint(rubnoise.__file__)", encoding="utf-8")
    told = subprocess.run(
        [*unprivileged, sys.executable, "where.py"], env=environment, capture_output=True, text=True, check=False
    )
    assert told.stdout.startswith(str(installed)), told.stderr
    run = [sys.executable, "-m", "rubnoise", "run", "../given/contact.toml", "-o"]
    done = subprocess.run([*unprivileged, *run, "x.h5"], env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (0, 1), done.stderr
    assert done.stderr.startswith("Compiling the kernels")
    assert (here / "x.h5").stat().st_size > 10_000
    assert not [path for path in installed.rglob("*") if path.suffix in {".pyc", ".nbi", ".nbc"}]


def test_a_folder_that_cannot_be_written_is_refused(here: Path, installed: Path, unprivileged: tuple[str, ...]) -> None:
    run = [sys.executable, "-m", "rubnoise", "run", "../given/contact.toml", "-o", str(installed / "x.h5")]
    done = subprocess.run([*unprivileged, *run], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"{installed}: the folder is not writable\n"

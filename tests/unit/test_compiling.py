"""Machine code: when it is kept, the coefficients in it, and what a run is expected to cost."""

from __future__ import annotations

import errno
import os
import re
import runpy
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numba
import pytest

import rubnoise
from rubnoise import compiling

# Machine code that is kept is not used any more once a file has changed that was compiled into it.
PROGRAM = """
import numpy as np
from rubnoise.simulation.kernel import add_areas
lives = tuple(np.ones(1) for _ in range(6))
total = np.zeros(16)
add_areas(0, np.arange(16.0), 0, 1.0, lives, total)
print(sum(add_areas.stats.cache_hits.values()), total[5])
"""


@pytest.mark.slow
def test_a_changed_file_is_compiled_anew_into_others(tmp_path: Path) -> None:
    package = tmp_path / "rubnoise"
    shutil.copytree(Path(rubnoise.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))

    def output() -> list[str]:
        variables = {**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "kept")}
        command = [sys.executable, "-c", PROGRAM]
        return subprocess.run(command, env=variables, capture_output=True, text=True, check=True).stdout.split()

    assert output() == ["0", "0.0"]
    assert output() == ["1", "0.0"]
    other = package / "simulation" / "linear.py"
    other.write_text(other.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    hits, _ = output()
    assert hits == "0"


def test_every_file_that_is_compiled_into_others_is_known() -> None:
    """A file whose functions or constants others compile into theirs, and that was left out, would stay as it was."""
    package = Path(rubnoise.__file__).parent
    texts = {path.relative_to(package): path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    compiled = {
        path
        for path, text in texts.items()
        if re.search(r"^from rubnoise\.compiling import|import intrinsic", text, re.MULTILINE)
    }
    known = {path.relative_to(package) for pattern in compiling.SOURCES for path in package.glob(pattern)}
    imported = {
        path.with_name(module.split(".")[-1] + ".py")
        for importer in compiled
        for module in re.findall(r"^from rubnoise\.([\w.]+) import", texts[importer], re.MULTILINE)
        for path in [Path(*module.split("."))]
    }
    assert {path for path in imported & compiled if path not in known} == set()
    assert Path("simulation/kernel.py") in imported & compiled & known
    constants = {
        Path(*module.split(".")).with_suffix(".py")
        for importer in compiled & known
        for module, names in re.findall(
            r"^from rubnoise\.([\w.]+) import ([^(]+?$|\([^)]*\))", texts[importer], re.MULTILINE
        )
        if re.search(r"\b[A-Z]{2}[A-Z_]*\b|Kind\b", names)
    }
    assert constants - known == set()
    assert {Path("contact/pulses.py"), Path("record/rows.py")} <= constants


DOUBLING = """
from rubnoise.compiling import compiled


@compiled
def doubled(value):
    return 2.0 * value
"""


@pytest.fixture
def doubling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A module with a kernel, whose code is kept in a folder of its own."""
    module = tmp_path / "doubling.py"
    module.write_text(DOUBLING, encoding="utf-8")
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "kept"))
    compiling._folder.cache_clear()
    yield module
    compiling._folder.cache_clear()


def _kernel(module: Path) -> Any:
    """Call the kernel of a module as a new process would, and return it."""
    doubled: Any = runpy.run_path(str(module))["doubled"]
    assert doubled(21.0) == 42.0
    return doubled


def _hits(module: Path) -> int:
    """Return how often the code of the kernel of a module was found."""
    return sum(_kernel(module).stats.cache_hits.values())


def test_code_is_kept_in_the_folder_that_numba_is_told_and_the_three_newest_are_left(doubling: Path) -> None:
    kept = doubling.with_name("kept") / "rubnoise-kernels"
    for age in range(1, 5):
        (kept / f"{age:016x}").mkdir(parents=True)
        os.utime(kept / f"{age:016x}", (1e9 - age, 1e9 - age))
    others = (kept / "of-others", kept.with_name("rubnoise-demo"))
    for other in others:
        other.mkdir()
        os.utime(other, (0.0, 0.0))
    assert [_hits(doubling), _hits(doubling)] == [0, 1]
    (ours,) = {path.name for path in kept.iterdir()} - {"of-others", f"{1:016x}", f"{2:016x}"}
    assert list((kept / ours).rglob("*doubled*.nbc"))
    assert all(other.is_dir() for other in others)


def test_kernels_of_others_keep_their_code_where_they_did(doubling: Path) -> None:
    before = numba.config.CACHE_DIR
    _kernel(doubling)
    assert before == numba.config.CACHE_DIR == str(doubling.with_name("kept"))
    module = doubling.with_name("theirs.py")
    module.write_text(
        DOUBLING.replace("from rubnoise.compiling import compiled", "import numba\ncompiled = numba.njit(cache=True)")
    )
    assert not any(part.startswith("rubnoise-") for part in Path(_kernel(module).stats.cache_path).parts)


def test_where_code_cannot_be_kept_it_is_compiled_each_time_and_said_once(
    doubling: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    doubling.with_name("kept").write_text("no folder", encoding="utf-8")
    with pytest.warns(compiling.CodeNotKept, match=r"cannot be kept, .*: (Not a directory|File exists)") as warned:
        assert [_hits(doubling), _hits(doubling)] == [0, 0]
    assert len(warned) == 1
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", str(doubling / "absent"))
    compiling._folder.cache_clear()
    with pytest.warns(compiling.CodeNotKept, match="Not a directory"):
        assert not compiling.is_kept(_kernel(doubling))


def test_a_full_disk_keeps_no_code(doubling: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(**_how: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(compiling, "NamedTemporaryFile", full)
    with pytest.warns(compiling.CodeNotKept, match="No space left on device"):
        assert [_hits(doubling), _hits(doubling)] == [0, 0]


def test_what_is_compiled_is_announced(doubling: Path) -> None:
    said: list[str] = []
    compiling.before_compiling(lambda: said.append("compiling"))
    kernel = _kernel(doubling)
    assert (said, compiling.is_kept(kernel)) == (["compiling"], True)
    assert (_hits(doubling), said) == (1, ["compiling"])

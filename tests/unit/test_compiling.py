"""Machine code that is kept is not used any more once a file has changed that was compiled into it."""

import errno
import hashlib
import os
import re
import runpy
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest

import rubnoise
from rubnoise import compiling

PROGRAM = """
import numpy as np
from rubnoise.simulation.kernels.coarse import deposit_coarse_lives as deposit
total, nothing, one = np.zeros(16), np.empty(0), np.ones(1)
deposit(np.arange(16.0), 1.0, 0, 3, np.zeros(1), one, one, one, nothing, total, nothing, 0)
print(sum(deposit.stats.cache_hits.values()), total[1] + total[2])
"""


def test_a_changed_file_is_compiled_anew_into_others(tmp_path: Path) -> None:
    package = tmp_path / "rubnoise"
    shutil.copytree(Path(rubnoise.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))

    def output() -> list[str]:
        variables = {**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "kept")}
        command = [sys.executable, "-c", PROGRAM]
        return subprocess.run(command, env=variables, capture_output=True, text=True, check=True).stdout.split()

    assert output() == ["0", "0.0"]
    assert output() == ["1", "0.0"]
    grid = package / "simulation" / "kernels" / "grid.py"
    changed = grid.read_text(encoding="utf-8").replace("positions[index] < distance", "positions[index] <= distance")
    grid.write_text(changed, encoding="utf-8")
    hits, _ = output()
    assert hits == "0"


def test_of_two_processes_one_compiles_and_the_other_loads(tmp_path: Path) -> None:
    """As the workers of the tests do (tests/turns.py); without turns both would compile."""
    program = f"from tests.turns import take_turns\ntake_turns()\n{PROGRAM}"
    variables = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "NUMBA_CACHE_DIR": str(tmp_path)}
    words = [sys.executable, "-c", program]
    both = [subprocess.Popen(words, env=variables, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    assert sorted(each.communicate()[0].split()[0] for each in both) == ["0", "1"]


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
    assert Path("simulation/kernels/lens.py") in imported & compiled & known


GONE = b"\x80\x04\x8c\x12rubnoise.compiling\x8c\x04Gone\x93."
"""The pickle of a class that an earlier version had."""


def _gone(content: bytes) -> bytes:
    seal = hashlib.blake2b(GONE, digest_size=compiling.SEAL_BYTES, key=numba.__version__.encode()).digest()
    return seal + GONE


def _flipped(content: bytes) -> bytes:
    """Flip a bit in the middle, where the machine code is."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "a class that is gone": _gone,
    "empty": lambda _: b"",
    "cut off": lambda content: content[:-100],
    "zeros": lambda content: bytes(len(content)),
    "a flipped bit": _flipped,
}

DOUBLING = """
from rubnoise.compiling import compiled


@compiled
def doubled(value):
    return 2.0 * value
"""


@pytest.fixture
def doubling(tmp_path: Path) -> Path:
    """A module with a kernel, whose code is kept beside it."""
    module = tmp_path / "doubling.py"
    module.write_text(DOUBLING, encoding="utf-8")
    return module


def _hits(module: Path) -> int:
    """Call the kernel of a module as a new process would; return how often its code was found."""
    found: dict[str, Any] = runpy.run_path(str(module))
    assert found["doubled"](21.0) == 42.0
    return sum(found["doubled"].stats.cache_hits.values())


@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_kept_code_that_is_not_as_it_was_written_is_compiled_anew(doubling: Path, ending: str, damage: str) -> None:
    assert [_hits(doubling), _hits(doubling)] == [0, 1]
    (kept,) = (doubling.parent / "__pycache__").glob(f"*{ending}")
    kept.write_bytes(DAMAGES[damage](kept.read_bytes()))
    assert [_hits(doubling), _hits(doubling)] == [0, 1]


def test_where_code_cannot_be_kept_it_is_compiled_each_time_and_said_once(
    doubling: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_file: object, path: str, _what: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", path)

    monkeypatch.setattr(compiling, "_NOT_KEPT", [])
    monkeypatch.setattr(compiling._KeptFile, "_write", full)
    with pytest.warns(compiling.CodeNotKept, match=r"__pycache__: No space left on device") as warned:
        assert [_hits(doubling), _hits(doubling)] == [0, 0]
    assert len(warned) == 1


def test_what_is_compiled_is_announced(doubling: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    monkeypatch.setattr(compiling, "BEFORE_COMPILING", {lambda: said.append("compiling")})
    assert [_hits(doubling), said, _hits(doubling), said] == [0, ["compiling"], 1, ["compiling"]]
    monkeypatch.setattr(compiling, "njit", _nowhere)
    assert [_hits(doubling), said] == [0, ["compiling"] * 2]


def _nowhere(*, cache: bool = False, **how: Any) -> Any:
    if cache:
        raise RuntimeError("cannot cache function: no locator available")
    return numba.njit(**how)

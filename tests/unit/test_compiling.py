"""Machine code that is kept is not used any more once a file has changed that was compiled into it."""

import os
import pickle
import re
import runpy
import shutil
import subprocess
import sys
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
        path for path, text in texts.items() if re.search(r"from rubnoise\.compiling import|import intrinsic", text)
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


@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
@pytest.mark.parametrize("damage", [GONE, b"", b"no pickle"], ids=["a class that is gone", "cut off", "damaged"])
def test_kept_code_that_cannot_be_read_is_compiled_anew(tmp_path: Path, ending: str, damage: bytes) -> None:
    module = tmp_path / "doubling.py"
    module.write_text(
        "from rubnoise.compiling import compiled\n\n\n@compiled\ndef doubled(value):\n    return 2.0 * value\n",
        encoding="utf-8",
    )

    def hits() -> int:
        found: dict[str, Any] = runpy.run_path(str(module))
        assert found["doubled"](21.0) == 42.0
        return sum(found["doubled"].stats.cache_hits.values())

    assert hits() == 0
    assert hits() == 1
    (kept,) = (tmp_path / "__pycache__").glob(f"*{ending}")
    version = pickle.dumps(numba.__version__, protocol=-1) if ending == ".nbi" else b""
    kept.write_bytes(version + damage)
    assert hits() == 0
    assert hits() == 1

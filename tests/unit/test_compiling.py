"""Machine code that is kept is not used any more once a file has changed that was compiled into it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import rubnoise

PROGRAM = """
import numpy as np
from rubnoise.simulation.ticks import count_live
from rubnoise.simulation.kernels import deposit_areas
total = np.zeros(3)
deposit_areas(np.arange(3.0), np.zeros(1), np.ones(1), np.ones(1), np.ones(1), total)
print(sum(deposit_areas.stats.cache_hits.values()), total[1] + total[2])
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
    ticks = package / "simulation" / "ticks.py"
    changed = ticks.read_text(encoding="utf-8").replace("positions[index] < distance", "positions[index] <= distance")
    ticks.write_text(changed, encoding="utf-8")
    hits, _ = output()
    assert hits == "0"

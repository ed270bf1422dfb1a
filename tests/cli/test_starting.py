"""A run does not wait for what it does not need."""

import subprocess
import sys
from pathlib import Path

AFTER_A_RUN = """
import contextlib, sys
from rubnoise.cli.app import main
sys.argv = ["rubnoise", "run", "../given/slider.toml", "-q"]
with contextlib.suppress(SystemExit):
    main()
print("loaded:", *sorted({"scipy.linalg", "scipy.special", "scipy.stats", "matplotlib", "pint"} & set(sys.modules)))
import scipy.linalg.cython_blas, scipy.linalg
print(scipy.linalg.inv([[2.0]])[0, 0])
"""
MULTIPLYING = """
import rubnoise, numba, numpy as np
rubnoise.simulate(rubnoise.load("../given/slider.toml"))
print(numba.njit(lambda a: np.dot(a, a))(np.array([3.0, 4.0])))
"""


def _told(program: str) -> list[str]:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.splitlines()


def test_a_run_loads_no_linear_algebra_and_leaves_it_to_others(here: Path) -> None:
    assert _told(AFTER_A_RUN) == ["loaded:", "0.5"]


def test_from_python_the_compiled_functions_of_others_multiply_matrices(here: Path) -> None:
    assert _told(MULTIPLYING) == ["25.0"]

"""A run does not wait for what it does not need."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.terminal import spawn_program

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


QUESTIONS = """
import contextlib, sys
from rubnoise.cli.app import main
for words in (["check", "../given/slider.toml", "--json"], ["run", "../given/slider.toml", "--dry-run"]):
    sys.argv = ["rubnoise", *words]
    with contextlib.suppress(SystemExit):
        main()
print("loaded:", *sorted({"h5py", "matplotlib", "numba", "numpy.ma", "pandas", "pint", "scipy"} & set(sys.modules)))
"""
KEPT_CODE = """
import sys
import rubnoise
rubnoise.simulate("../given/slider.toml")
print(*sorted({"numba.np.arraymath", "numba.np.linalg"} & set(sys.modules)))
import numba
print(numba.njit(lambda a: (a * a).sum())(__import__("numpy").array([3.0, 4.0])))
"""


CLOSED = ([0], [1], [2], [1, 2], [0, 1, 2])
CLOSING = """
import os, sys
for number in map(int, sys.argv.pop(1).split()):
    os.close(number)
    setattr(sys, ("stdin", "stdout", "stderr")[number], None)
"""
AS_A_PROGRAM = f"{CLOSING}from rubnoise.__main__ import main; main()"
AS_A_LIBRARY = f"""{CLOSING}import rubnoise
with rubnoise.open(sys.argv[1]) as run:
    os._exit(10 + (run.trace["distance"][1] > 0.0))
"""


@pytest.mark.parametrize("numbers", CLOSED, ids=str)
def test_streams_that_are_closed_keep_nothing_from_being_written_and_read(here: Path, numbers: list[int]) -> None:
    closed = " ".join(map(str, numbers))
    answer = spawn_program(AS_A_PROGRAM, closed, "run", "../given/contact.toml", "-o", "x.h5")
    assert answer.code == 0
    assert answer.out.startswith("x.h5: ") is (1 not in numbers)
    assert spawn_program(AS_A_LIBRARY, closed, "x.h5").code == 11


def test_questions_about_a_scenario_load_no_compiler_and_no_file_format(here: Path) -> None:
    assert _told(QUESTIONS)[-1] == "loaded:"


def test_kept_code_is_loaded_without_what_compiles(here: Path) -> None:
    """Others may compile after it as before."""
    _told(KEPT_CODE)  # which keeps the code, where none is kept yet
    assert _told(KEPT_CODE) == ["", "25.0"]

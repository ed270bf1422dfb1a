"""The pulse kernel as a C program, compiled on this machine for this machine, where gcc is there."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.case import Case, Doubles
from rubnoise.simulation.kernel import LENS

FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")
"""The last two let gcc make vector instructions of a loop with sqrt and a choice in it."""

Deposit = Callable[[Case, Doubles, Doubles, Doubles, Doubles], None]


def available() -> bool:
    """Whether there is a gcc to compile it."""
    return shutil.which("gcc") is not None


@cache
def library() -> ctypes.CDLL:
    """Return the compiled program; raises CalledProcessError where gcc refuses."""
    coefficients = ",".join(map(repr, LENS))
    source = Path(__file__).with_name("kernel.c")
    with TemporaryDirectory() as folder:
        target = Path(folder) / "kernel.so"
        options = ["-shared", "-fPIC", f"-DCOEFFICIENTS={coefficients}", f"-o{target}"]
        subprocess.run(["gcc", *FLAGS, *options, str(source), "-lm"], check=True)
        return ctypes.CDLL(str(target))  # stays loaded when its file is gone


def deposit(way: str) -> Deposit:
    """Return the kernel `polynomial`, `roots` or `textbook`: it adds the areas (um^2) of junctions at the ticks."""
    function = library()[f"deposit_{way}"]
    function.restype = None

    def call(case: Case, ticks: Doubles, birth: Doubles, diameter: Doubles, total: Doubles) -> None:
        function(
            _pointer(ticks),
            ctypes.c_size_t(ticks.size),
            ctypes.c_double(case.tick),
            _pointer(birth),
            _pointer(diameter),
            ctypes.c_size_t(birth.size),
            _pointer(total),
        )

    return call


def _pointer(values: Doubles) -> ctypes.c_void_p:
    return ctypes.c_void_p(values.ctypes.data)

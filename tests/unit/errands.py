"""Functions that workers are sent: some of them end badly."""

import os
import signal
from pathlib import Path

from rubnoise.errors import Refused
from rubnoise.scenario.sweep import Point


def name_and_process(point: Point) -> tuple[str, int]:
    """Return who was asked and who answered."""
    return point.run_id, os.getpid()


def fail_some(point: Point) -> str:
    """Refuse every replicate of an odd number."""
    if point.replicate % 2:
        raise Refused(f"replicate {point.replicate} is odd")
    return point.run_id


def die_once(point: Point, folder: Path) -> str:
    """Die by SIGKILL at the replicates 3 and 20, the first time that each is tried."""
    mark = folder / point.run_id
    if point.replicate in {3, 20} and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return point.run_id


def die(point: Point, folder: Path) -> str:
    """Die by SIGSEGV at the replicate 3, and count how often it was tried."""
    if point.replicate == 3:
        with (folder / "tries").open("a", encoding="utf-8") as tries:
            tries.write("x")
        os.kill(os.getpid(), signal.SIGSEGV)
    return point.run_id


def threads(_point: Point) -> dict[str, str | None]:
    """Return the number of threads that the process has in its environment."""
    return {name: os.environ.get(name) for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")}

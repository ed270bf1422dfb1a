"""Sweeps for the tests of the command line, and what is in their folders."""

import subprocess
import time
from pathlib import Path

from tests.shell.terminal import columns, command, start

TABLE = """
[sweep]
replicates = 3
[sweep.grid]
interface.mean_junction_count = [10, 40]
"""
SLOW = ("--set", "sliding.distance=15 mm", "--set", "output.tick=0.005 um", "--set", "sweep.replicates=4")
"""Changes that make each run last the better part of a second."""


def runs_of(folder: Path) -> dict[str, dict[str, bytes]]:
    """Return the bytes of every column of every run in a folder, by name."""
    return {path.stem: columns(path) for path in sorted((folder / "runs").glob("*.h5"))}


def begin_sweep(folder: Path, *arguments: str | Path, cold: bool = False) -> "subprocess.Popen[str]":
    """Start a sweep in a process of its own, and return it when a run is being written."""
    begun = start(command(*arguments), cold=cold, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(12_000):
        if any((folder / "runs").glob("*.part")) or begun.poll() is not None:
            break
        time.sleep(0.01)
    assert begun.poll() is None, "the sweep ended before it began"
    return begun

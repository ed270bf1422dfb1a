"""The most memory that a whole run needs, each in a process of its own: `python -m bench.memory ENTRANT JUNCTIONS`."""

import json
import resource
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.case import Case, Drawn
from bench.entrants import OURS, Entrant

TICKS_PER_LIFE = 20.0
"""Few, so that ten million junctions are about as many ticks, and a disk holds them."""

LONGEST = 1_000_000
"""Junctions beyond which only rubnoise is asked: what holds everything at once would need gigabytes."""

STATUS = Path("/proc/self/status")


def peak_megabytes() -> float:
    """Return the largest resident memory of this process so far, in 1e6 bytes."""
    if STATUS.exists():
        # ru_maxrss of a child begins with what its parent had, this does not.
        line = next(line for line in STATUS.read_text(encoding="utf-8").splitlines() if line.startswith("VmHWM"))
        return float(line.split()[1]) * 1024.0 / 1e6
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def measured(entrants: Sequence[Entrant], lengths: Sequence[int], folder: Path) -> dict[str, dict[int, float]]:
    """Return the memory of whole runs by entrant and number of junctions, in 1e6 bytes."""
    return {
        each.name: {
            length: _in_a_child(each, length, folder)
            for length in lengths
            if length <= LONGEST or each.name.startswith(OURS)
        }
        for each in entrants
    }


def _in_a_child(entrant: Entrant, junctions: int, folder: Path) -> float:
    command = [sys.executable, "-m", "bench.memory", json.dumps(astuple(entrant)), str(junctions), str(folder)]
    return float(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)


def main(entrant: Entrant, junctions: int, folder: Path) -> None:
    """Make one run and print its peak."""
    case = Case(ticks_per_life=TICKS_PER_LIFE, junctions=junctions)
    with TemporaryDirectory(dir=folder) as inner:
        entrant.call(case, Drawn(case, seed=1), Path(inner) / "run.h5")
    print(peak_megabytes())


if __name__ == "__main__":
    main(Entrant(*json.loads(sys.argv[1])), int(sys.argv[2]), Path(sys.argv[3]))

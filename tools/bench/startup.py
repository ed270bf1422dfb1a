"""What a user waits for before anything is computed: new processes, the compiled code kept or not."""

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from bench.case import Case
from bench.clock import cpu_time

PROGRAM = Path(sys.executable).with_name("rubnoise")
FIGURE_5 = Path(__file__).resolve().parents[2] / "scenarios" / "paper" / "fig5.toml"
JUNCTIONS = 80
HELP = "rubnoise --help"
RUN = f"rubnoise run, {JUNCTIONS} junctions"
IMPORT = "import rubnoise's functions, read a scenario"
FIRST = "first run after that, beyond a second one"
COMPILING = "the same with nothing compiled before"
# Python keeps what it has compiled unless a variable forbids it, and the first of these processes is not counted.
VARIABLES = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
FRESH = f"""
import json, sys, time
def now():
    return time.perf_counter(), time.process_time()
times = [now()]
import bench.ours
from bench.case import Case
import rubnoise
scenario = bench.ours.scenario(Case(junctions={JUNCTIONS}), sys.argv[1])
rubnoise.simulate
for _ in range(3):
    times.append(now())
    rubnoise.simulate(scenario)
print(json.dumps(times))
"""


@dataclass(frozen=True, order=True)
class Wait:
    """What passes until something is there: on the clock, and of the processor's time, in s."""

    wall: float
    cpu: float

    def __sub__(self, other: "Wait") -> "Wait":
        """Return how much longer this one is."""
        return Wait(self.wall - other.wall, self.cpu - other.cpu)


def measured(engine: str, folder: Path, repeats: int) -> dict[str, Wait]:
    """Return the best waits of some; the one without any compiled code kept is taken once."""
    run = [str(PROGRAM), "run", str(FIGURE_5), f"--set=sliding.distance={JUNCTIONS * Case().mean_gap:.4g} um"]
    run += [f"--set=run.engine={engine}", "--force", "-q", f"--output={folder / 'small.h5'}"]
    _called(run)
    fresh = [_fresh(engine, VARIABLES) for _ in range(repeats)]
    nothing_kept = {**VARIABLES, "NUMBA_CACHE_DIR": str(folder / "compiled")}
    return {
        HELP: min(_called([str(PROGRAM), "--help"]) for _ in range(repeats)),
        RUN: min(_called(run) for _ in range(repeats)),
        IMPORT: min(imported for imported, _ in fresh),
        FIRST: min(first for _, first in fresh),
        COMPILING: _fresh(engine, nothing_kept)[1],
    }


def _called(command: list[str]) -> Wait:
    begin = Wait(perf_counter(), cpu_time())
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=VARIABLES)
    return Wait(perf_counter(), cpu_time()) - begin


def _fresh(engine: str, variables: Mapping[str, str]) -> tuple[Wait, Wait]:
    """Return what importing and reading takes in a new process, and what the first run takes beyond the second."""
    command = [sys.executable, "-c", FRESH, engine]
    told = subprocess.run(command, stdout=subprocess.PIPE, check=True, env=dict(variables)).stdout
    start, ready, second, third = (Wait(*each) for each in json.loads(told))
    return ready - start, (second - ready) - (third - second)

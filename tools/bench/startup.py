"""What a user waits for before anything is computed: wall time of fresh processes, the compiled code kept or not."""

import json
import os
import subprocess
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from statistics import median
from time import perf_counter

from bench.case import Case

PROGRAM = Path(sys.executable).with_name("rubnoise")
FIGURE_5 = Path(__file__).resolve().parents[2] / "scenarios" / "paper" / "fig5.toml"
JUNCTIONS = 80
HELP = "rubnoise --help"
RUN = f"rubnoise run, {JUNCTIONS} junctions"
IMPORT = "import rubnoise's functions, read a scenario"
FIRST = "first run after that, beyond a second one"
COMPILING = "the same with nothing compiled before"
FRESH = f"""
import json, sys, time
begin = time.perf_counter()
import bench.ours
from bench.case import Case
import rubnoise
scenario = bench.ours.scenario(Case(junctions={JUNCTIONS}), sys.argv[1])
times = [time.perf_counter()]
for _ in range(2):
    rubnoise.simulate(scenario)
    times.append(time.perf_counter())
print(json.dumps([times[0] - begin, (times[1] - times[0]) - (times[2] - times[1])]))
"""


def measured(engine: str, folder: Path, repeats: int) -> dict[str, float]:
    """Return wall times in s, medians; one without any compiled code kept is taken once."""
    run = [str(PROGRAM), "run", str(FIGURE_5), f"--set=sliding.distance={JUNCTIONS * Case().mean_gap:.4g} um"]
    run += [f"--set=run.engine={engine}", "--force", "-q", f"--output={folder / 'small.h5'}"]
    _wall(run)
    fresh = [_fresh(engine, os.environ) for _ in range(repeats)]
    nothing_kept = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "compiled")}
    return {
        HELP: median(_walls([str(PROGRAM), "--help"], repeats)),
        RUN: median(_walls(run, repeats)),
        IMPORT: median(imported for imported, _ in fresh),
        FIRST: median(first for _, first in fresh),
        COMPILING: _fresh(engine, nothing_kept)[1],
    }


def _walls(command: list[str], repeats: int) -> Iterable[float]:
    return (_wall(command) for _ in range(repeats))


def _wall(command: list[str]) -> float:
    begin = perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return perf_counter() - begin


def _fresh(engine: str, variables: Mapping[str, str]) -> tuple[float, float]:
    """Return what importing and reading takes in a new process, and what the first run takes beyond the second."""
    command = [sys.executable, "-c", FRESH, engine]
    told = subprocess.run(command, stdout=subprocess.PIPE, check=True, env=dict(variables)).stdout
    imported, first = json.loads(told)
    return imported, first

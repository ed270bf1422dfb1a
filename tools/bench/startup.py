"""What a user waits for before anything is computed, and what is small beside the least that it needs."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter

import rubnoise
from bench import ours
from bench.case import Case
from bench.checks import Wrong
from bench.clock import Task, Timing, cpu_time, interleaved
from bench.entrants import FASTEST
from rubnoise.scenario.text import text_of

PROGRAM = Path(sys.executable).with_name("rubnoise")
FIGURE_5 = Path(__file__).resolve().parents[2] / "scenarios" / "paper" / "fig5.toml"
JUNCTIONS = 80
HELP = "rubnoise --help"
RUN = f"rubnoise run, {JUNCTIONS} junctions"
THEORY = "rubnoise theory, Weibull sizes"
REPORT = "rubnoise report, Figure 5"
IMPORT = "import rubnoise's functions, read a scenario"
FIRST = "first run after that, beyond a second one"
COMPILING = "the same with nothing compiled before"
KEPT = ("runs", "summary")
"""What a sweep may keep of each run: a file, or what its summary says."""

FEW = 3
"""Repeats of what takes seconds."""

# As a user has it. Python keeps what it has compiled unless a variable forbids it, and the first of these processes is
# not counted. Libraries begin with a thread for each processor, which the rest of the benchmark forbids.
VARIABLES = {
    name: value
    for name, value in os.environ.items()
    if name != "PYTHONDONTWRITEBYTECODE" and not name.endswith("_NUM_THREADS")
}
FRESH = f"""
import json, time
def now():
    return time.perf_counter(), time.process_time()
times = [now()]
import bench.ours
from bench.case import Case
import rubnoise
scenario = bench.ours.scenario(Case(junctions={JUNCTIONS}), "{FASTEST}")
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


def measured(folder: Path, repeats: int) -> dict[str, Wait]:
    """Return the best waits of some; the one without any compiled code kept is taken once."""
    run = _run(folder)
    _called(run)
    fresh = [_fresh(VARIABLES) for _ in range(repeats)]
    whole, page = str(folder / "whole.h5"), str(folder / "page.html")
    _called([str(PROGRAM), "run", str(FIGURE_5), "--force", "-q", f"--output={whole}"])
    theory = [str(PROGRAM), "theory", str(FIGURE_5), "--set=diameter.law=weibull", "--set=diameter.spread=50 %"]
    report = [str(PROGRAM), "report", whole, "--force", f"--output={page}"]
    nothing_kept = {**VARIABLES, "NUMBA_CACHE_DIR": str(folder / "compiled")}
    return {
        HELP: min(_called([str(PROGRAM), "--help"]) for _ in range(repeats)),
        RUN: min(_called(run) for _ in range(repeats)),
        THEORY: min(_called(theory) for _ in range(repeats)),
        REPORT: min(_called(report) for _ in range(min(repeats, FEW))),
        IMPORT: min(imported for imported, _ in fresh),
        FIRST: min(first for _, first in fresh),
        COMPILING: _fresh(nothing_kept)[1],
    }


@dataclass(frozen=True)
class Beside:
    """CPU times of something of ours and of the least that it needs, taken in turns."""

    what: str
    ours: Timing
    least: str
    bare: Timing

    @property
    def ratio(self) -> float:
        """Return how many times as long ours takes."""
        return self.ours.each / self.bare.each


def beside(folder: Path, *, repeats: int, swept: int, junctions: int) -> Iterator[Beside]:
    """Yield what ours takes beside the least that it needs: ``swept`` short runs, a run of many ``junctions``."""
    short = [ours.scenario(Case(junctions=JUNCTIONS), FASTEST, seed=seed) for seed in range(1, swept + 1)]
    long, path = ours.scenario(Case(junctions=junctions), FASTEST), folder / "verified.h5"
    sweeps = {keep: _sweep_file(folder, short[0], swept, keep) for keep in KEPT}

    def sweep(keep: str) -> None:
        with rubnoise.sweep(sweeps[keep], jobs=1) as made:
            if made.count("done") != swept:
                raise Wrong(f"a sweep: only {made.count('done')} of {swept} runs were made")

    def verify() -> None:
        with rubnoise.open(path) as made:
            if not made.verify().passed:
                raise Wrong("verify: a run that was just made differs")

    many = f"{junctions:,} junctions".replace(",", " ")
    check = [str(PROGRAM), "check", str(FIGURE_5)]
    pairs = (
        ("rubnoise check", _process(check), "import numpy", _process([sys.executable, "-c", "import numpy"])),
        (RUN, _process(_run(folder)), "import numba", _process([sys.executable, "-c", "import numba"])),
        *(
            (
                f'a run of {JUNCTIONS} junctions in a sweep, keep = "{keep}"',
                Task(partial(sweep, keep), swept),
                "the same in memory",
                Task(lambda: [rubnoise.simulate(each) for each in short], swept),
            )
            for keep in KEPT
        ),
        (
            f"verify a run of {many}",
            Task(verify, junctions),
            "the run, into a file",
            Task(lambda: rubnoise.run(long, path, force=True).close(), junctions),
        ),
    )
    for what, task, least, bare in pairs:
        bare.call()
        task.call()
        times = interleaved({least: bare, what: task}, repeats)
        yield Beside(what, times[what], least, times[least])


def _sweep_file(folder: Path, scenario: rubnoise.Scenario, replicates: int, keep: str) -> Path:
    path = folder / f"{keep}.toml"
    path.write_text(text_of({**scenario.resolved(), "sweep": {"replicates": replicates, "keep": keep}}))
    return path


def _process(command: list[str]) -> Task:
    return Task(lambda: _called(command), 1.0)


def _run(folder: Path) -> list[str]:
    run = [str(PROGRAM), "run", str(FIGURE_5), f"--set=sliding.distance={JUNCTIONS * Case().mean_gap:.4g} um"]
    return [*run, f"--set=run.engine={FASTEST}", "--force", "-q", f"--output={folder / 'small.h5'}"]


def _called(command: list[str]) -> Wait:
    begin = Wait(perf_counter(), cpu_time())
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=VARIABLES)
    return Wait(perf_counter(), cpu_time()) - begin


def _fresh(variables: Mapping[str, str]) -> tuple[Wait, Wait]:
    """Return what importing and reading takes in a new process, and what the first run takes beyond the second."""
    told = subprocess.run([sys.executable, "-c", FRESH], stdout=subprocess.PIPE, check=True, env=dict(variables)).stdout
    start, ready, second, third = (Wait(*each) for each in json.loads(told))
    return ready - start, (second - ready) - (third - second)

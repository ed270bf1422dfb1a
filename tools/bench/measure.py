"""What the benchmark measures: CPU time, memory and start-up, each after every tool's runs were found right."""

import gc
import json
import os
import platform
import re
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass
from functools import partial
from importlib import import_module
from importlib.metadata import version
from itertools import count
from pathlib import Path
from statistics import median

from bench import checks
from bench.case import Case, Drawn, Draws
from bench.checks import OURS, Verdict, Wrong

PACKAGES = ("numpy", "scipy", "numba", "simpy", "h5py", "superposed-pulses")
FIGURE_5 = Path(__file__).resolve().parents[2] / "scenarios" / "paper" / "fig5.toml"
TICKS_PER_LIFE = 20.0
"""Of the runs whose memory is taken: few, so that a disk holds ten million junctions."""

LONGEST = 1_000_000
"""Junctions beyond which only rubnoise is asked for memory: what holds everything at once would need gigabytes."""


def cpu_time() -> float:
    """Return the CPU time in s that this process and its ended children have used."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


@dataclass(frozen=True)
class Timing:
    """CPU times of the repeats of one task in s, and how many units (junctions, ticks) each repeat worked on."""

    seconds: tuple[float, ...]
    units: float

    @property
    def each(self) -> float:
        """Median CPU time in s of one unit."""
        return median(self.seconds) / self.units

    @property
    def spread(self) -> float:
        """Half the range of the repeats over their median."""
        return (max(self.seconds) - min(self.seconds)) / (2.0 * median(self.seconds))


@dataclass(frozen=True)
class Task:
    """Something to be timed, its number of units, and what is done before it and not timed."""

    call: Callable[[], object]
    units: float
    prepare: Callable[[], object] = lambda: None


def interleaved(tasks: Mapping[str, Task], repeats: int) -> dict[str, Timing]:
    """Return the timings of tasks that take turns, A B C A B C ..., so that a slow minute hits all of them."""
    seconds: dict[str, list[float]] = {name: [] for name in tasks}
    for _ in range(repeats):
        for name, task in tasks.items():
            task.prepare()
            seconds[name].append(_timed(task.call))
    return {name: Timing(tuple(taken), tasks[name].units) for name, taken in seconds.items()}


def _timed(call: Callable[[], object]) -> float:
    gc.collect()
    begin = cpu_time()
    call()
    return cpu_time() - begin


@dataclass(frozen=True)
class Entrant:
    """A tool that makes whole runs: its name, its module of bench, how many junctions it is given in one repeat.

    engine: of ours.
    """

    name: str
    module: str
    junctions: int
    engine: str = ""

    def call(self, case: Case, draws: Draws, path: Path) -> None:
        """Make a run, into a file; its library is loaded here and not before."""
        run = import_module(f"bench.{self.module}").run
        run(case, draws, path, **({"engine": self.engine} if self.engine else {}))

    def case(self, share: float, ticks_per_life: float = 221.0) -> Case:
        """Return a case of at most twice the ticks that it has at 221 ticks a life."""
        junctions = round(share * self.junctions)
        return Case(20.0, ticks_per_life, min(junctions, round(2.0 * junctions * 221.0 / ticks_per_life)))


RUNS = (
    *(Entrant(f"{OURS}{engine}", "ours", 100_000, engine) for engine in ("batch", "events")),
    Entrant("numba loops, RK4", "peers.numba_loops", 100_000),
    Entrant("superposed-pulses, lsim", "peers.superposed", 10_000),
    Entrant("naive NumPy, lsim", "peers.naive_numpy", 10_000),
    Entrant("naive SimPy, RK4", "peers.naive_simpy", 5_000),
)
"""Tools, each of which makes births, area, force, slider, and a file of it all."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Repeats, the share of its junctions that each tool is given, and the points of growth and memory."""

    repeats: int
    growth_repeats: int
    share: float
    ticks: tuple[float, ...]
    memory: tuple[int, ...]


FULL = Plan(
    repeats=21,
    growth_repeats=3,
    share=1.0,
    ticks=(10.0, 30.0, 220.0, 2200.0),
    memory=(100, 100_000, 1_000_000, 10_000_000),
)
QUICK = Plan(
    repeats=3,
    growth_repeats=1,
    share=0.2,
    ticks=(30.0, 220.0),
    memory=(100_000,),
)

Growth = dict[str, dict[float, Timing]]
"""By entrant, then by the number that grows."""


@dataclass(frozen=True, kw_only=True)
class Results:
    """Verdicts on correctness, timings by entrant, and what else was measured; ``machine`` as two lines of text."""

    machine: tuple[str, str]
    verdicts: tuple[Verdict, ...]
    runs: dict[str, Timing]
    growth: Growth
    memory: dict[str, dict[int, float]]
    waits: dict[str, tuple[float, float]]

    def faults(self) -> Iterator[str]:
        """Yield a sentence for everything that was computed wrong, or was timed and never checked."""
        for verdict in self.verdicts:
            yield from verdict.faults()
        checked = {verdict.name for verdict in self.verdicts}
        yield from (f"{name}: never checked" for name in self.runs if name not in checked)


def measured(plan: Plan, folder: Path, tell: Callable[[str], None]) -> Results:
    """Measure everything, in a folder for files; raises Wrong before any time is taken if a tool is wrong."""
    path = folder / "run.h5"
    tell("correctness: each tool makes small runs")
    verdicts = tuple(_verdicts(folder, checks.cases(plan.ticks)))
    if faults := [fault for verdict in verdicts for fault in verdict.faults()]:
        raise Wrong(*faults)
    tell("whole runs")
    whole = timed(RUNS, plan, path)
    tell("growth")
    growth = _growth(plan, path)
    tell("memory and start-up")
    memory = {
        each.name: {n: _peak(each, n, folder) for n in plan.memory if n <= LONGEST or each.name.startswith(OURS)}
        for each in RUNS
    }
    return Results(
        machine=machine(),
        verdicts=verdicts,
        runs=whole,
        growth=growth,
        memory=memory,
        waits=waits(folder, min(plan.repeats, 5)),
    )


def _verdicts(folder: Path, wanted: Sequence[Case]) -> Iterator[Verdict]:
    for case in wanted:
        known = checks.truth(case)
        for entrant in RUNS:
            entrant.call(case, known, folder / "check.h5")
            yield checks.judged(entrant.name, checks.written(folder / "check.h5"), known)


def _task(entrant: Entrant, case: Case, path: Path) -> Task:
    """Return a run as a task, in units of junctions; each repeat has a seed of its own and writes a new file."""
    seeds = count(1)

    def call() -> None:
        entrant.call(case, Drawn(case, seed=next(seeds)), path)

    return Task(call, case.junctions, partial(path.unlink, missing_ok=True))


def timed(entrants: Sequence[Entrant], plan: Plan, path: Path) -> dict[str, Timing]:
    """Return the timings of all tools on the contact of Figure 5, each after a run that loads and compiles."""
    for each in entrants:
        _task(each, Case(junctions=100), path).call()
    return interleaved({each.name: _task(each, each.case(plan.share), path) for each in entrants}, plan.repeats)


def _growth(plan: Plan, path: Path) -> Growth:
    found: Growth = {each.name: {} for each in RUNS}
    for ticks in plan.ticks:
        tasks = {each.name: _task(each, each.case(plan.share, ticks), path) for each in RUNS}
        for name, timing in interleaved(tasks, plan.growth_repeats).items():
            found[name][ticks] = timing
    return found


def _peak(entrant: Entrant, junctions: int, folder: Path) -> float:
    """Return the most memory of a whole run in a process of its own, in 1e6 bytes."""
    command = [sys.executable, "-m", "bench.measure", json.dumps(astuple(entrant)), str(junctions), str(folder)]
    return float(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)


def peak_of(entrant: Entrant, junctions: int, folder: Path) -> None:
    """Make one run in this process and print its peak."""
    case, path = Case(ticks_per_life=TICKS_PER_LIFE, junctions=junctions), folder / "peak.h5"
    entrant.call(case, Drawn(case, seed=1), path)
    path.unlink()
    status = Path("/proc/self/status")
    if status.exists():  # ru_maxrss of a child begins with what its parent had, this does not
        line = next(line for line in status.read_text(encoding="utf-8").splitlines() if line.startswith("VmHWM"))
        print(float(line.split()[1]) * 1024.0 / 1e6)
    else:
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6)


def waits(folder: Path, repeats: int) -> dict[str, tuple[float, float]]:
    """Return what a user waits for, on the clock and of the processor (s): the best of some new processes."""
    program, whole = str(Path(sys.executable).with_name("rubnoise")), str(folder / "whole.h5")
    run = [program, "run", str(FIGURE_5), "--force", "-q", f"--output={whole}"]
    short = [*run, "--set=sliding.distance=100 um"]
    # As a user has it: Python keeps what it has compiled, and libraries begin with a thread for each processor.
    plain = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE" and not k.endswith("_NUM_THREADS")}
    subprocess.run(run, check=True, env=plain)
    wanted: dict[str, tuple[list[str], dict[str, str]]] = {
        "rubnoise --help": ([program, "--help"], plain),
        "rubnoise page --as report, Figure 5": (
            [program, "page", "--as", "report", whole, "--force", f"--output={folder / 'page.html'}"],
            plain,
        ),
        "rubnoise run, 0.1 mm of Figure 5": (short, plain),
    }
    found = {name: min(_waited(*each) for _ in range(repeats)) for name, each in wanted.items()}
    nothing_kept = {**plain, "NUMBA_CACHE_DIR": str(folder / "compiled")}
    return {**found, "the same with nothing compiled before": _waited(short, nothing_kept)}


def _waited(command: list[str], variables: dict[str, str]) -> tuple[float, float]:
    begin, before = time.perf_counter(), os.times()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=variables)
    after = os.times()
    return time.perf_counter() - begin, sum(after[2:4]) - sum(before[2:4])


def machine() -> tuple[str, str]:
    """Return a line on the processor and one on the versions; nothing names whose machine it is."""
    listing = Path("/proc/cpuinfo")
    model = re.search(r"^model name\s*:\s*(.+)$", listing.read_text(), re.MULTILINE) if listing.exists() else None
    versions = [f"Python {platform.python_version()}", *(f"{name} {version(name)}" for name in PACKAGES)]
    busy = f"load average {os.getloadavg()[0]:.1f}"
    here = f"{model[1].strip() if model else platform.processor()}, {os.cpu_count()} cores"
    return f"{here}, {platform.system()} on {platform.machine()}, {busy}", ", ".join(versions)


if __name__ == "__main__":
    peak_of(Entrant(*json.loads(sys.argv[1])), int(sys.argv[2]), Path(sys.argv[3]))

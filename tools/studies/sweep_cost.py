"""What a sweep costs beside its bare runs: processor time of each run, and how well two processes share the work.

    .venv/bin/python tools/studies sweep_cost [--replicates 40] [--jobs 2] [--repeats 3] [--scenario FILE]

Every run is made bare, one after another in this process, into a file each; then the same sweep by one worker process,
and by several; and all of that so many times. The machine should have nothing else to do; processor times bear some of
it, wall times none. Exit code 1, and no costs, if a sweep leaves a run out or the runs disagree with the theory.
"""

import argparse
import resource
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median

import rubnoise

ROOT = Path(__file__).resolve().parents[2]
LARGEST_Z = 4.5
"""A standard score that the worst of a hundred right points exceeds once in more than a thousand times."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """Seconds on the clock, and of processors in this process and in those that it waited for."""

    wall: float
    processor: float


def cost_of(work: Callable[[], object]) -> Cost:
    """Return what a piece of work costs."""
    began, before = time.monotonic(), _processor()
    work()
    return Cost(wall=time.monotonic() - began, processor=_processor() - before)


def _processor() -> float:
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)


def bare(scenario: Path, replicates: int, folder: Path) -> int:
    """Make every run of a sweep in this process, and return how many there are."""
    points = rubnoise.expand(rubnoise.load_sweep(scenario, [f"sweep.replicates={replicates}"]))
    for point in points:
        rubnoise.run(point.scenario, folder / f"{point.run_id}.h5").close()
    return len(points)


def swept(scenario: Path, replicates: int, folder: Path, jobs: int) -> None:
    """Make the same runs by a sweep; ends the program if one is left out, since its cost is then that of less work."""
    sweep = rubnoise.load_sweep(scenario, [f"sweep.replicates={replicates}"])
    with rubnoise.run_sweep(sweep, folder, jobs=jobs) as made:
        done, wanted = made.count("done"), len(rubnoise.expand(sweep))
    if done != wanted:
        raise SystemExit(f"sweep_cost: only {done} of {wanted} runs were made")


def tell_spreads(folder: Path) -> None:
    """Print how far the standard deviation of the area is from the exact one at the worst point, and its drops.

    Ends the program if that is farther than chance takes it.
    """
    with rubnoise.open_sweep(folder) as sweep:
        grid = sweep.to_xarray()
    seen = ((grid["real_contact_area_std"] ** 2).mean("replicate")) ** 0.5
    exact = grid["real_contact_area_std_exact"].isel(replicate=0)
    error = grid["real_contact_area_std_standard_error"].isel(replicate=0) / grid.sizes["replicate"] ** 0.5
    worst = float(abs((seen - exact) / error).max(skipna=False))
    print(f"worst of {seen.size} points: {worst:.2f} standard errors from the exact standard deviation")
    if not worst <= LARGEST_Z:
        raise SystemExit(f"sweep_cost: no costs of wrong runs: {worst:.2f} is more than {LARGEST_Z:g} standard errors")
    count, area = "interface.mean_junction_count", "interface.mean_real_contact_area"
    if {count, area} <= set(seen.dims):
        for size in (seen[area].values.min(), seen[area].values.max()):
            ends = {"seen": seen.sel({area: size}), "error": error.sel({area: size}), "exact": exact.sel({area: size})}
            fall = {name: values.values[[0, -1]] for name, values in ends.items()}
            drop, told = fall["seen"][0] - fall["seen"][1], fall["exact"][0] - fall["exact"][1]
            half = 1.96 * (fall["error"] ** 2).sum() ** 0.5
            print(f"drop at {size:g} um^2: {drop:.2f} +- {half:.2f} um^2 (95 %), exact {told:.2f}")


def main() -> int:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenario", type=Path, default=ROOT / "scenarios" / "paper" / "fig7.toml")
    parser.add_argument("--replicates", type=int, default=40)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=".") as name:
        folder = Path(name)
        (folder / "warm").mkdir()
        bare(given.scenario, 1, folder / "warm")  # kernels compiled, libraries loaded
        costs: dict[str, list[Cost]] = {}
        runs = 0
        for turn in range(given.repeats):
            (place := folder / f"bare{turn}").mkdir()

            def make_bare(place: Path = place) -> None:
                nonlocal runs
                runs = bare(given.scenario, given.replicates, place)

            costs.setdefault("bare runs", []).append(cost_of(make_bare))
            for jobs in (1, given.jobs):
                place = folder / f"jobs{jobs}-{turn}"
                make = partial(swept, given.scenario, given.replicates, place, jobs)
                title = f"sweep, {jobs} {'process' if jobs == 1 else 'processes'}"
                costs.setdefault(title, []).append(cost_of(make))
        tell_spreads(place)
    _print(costs, runs, given.jobs)
    return 0


def _print(costs: dict[str, list[Cost]], runs: int, jobs: int) -> None:
    """Print medians of the turns; every ratio is that of a turn, whose sides were measured one after another."""
    first, one, several = costs.values()
    print(f"{runs} runs, medians of {len(first)}")
    print(f"{'':<24}{'wall (s)':>10}{'processor (s)':>15}{'a run (ms)':>12}{'beside bare':>13}")
    for name, turns in costs.items():
        wall, processor = median(cost.wall for cost in turns), median(cost.processor for cost in turns)
        beside = median(cost.processor / bare.processor for cost, bare in zip(turns, first, strict=True))
        print(f"{name:<24}{wall:>10.2f}{processor:>15.2f}{1000.0 * processor / runs:>12.2f}{beside:>13.3f}")
    for name, alone in (("one worker", one), ("the bare runs", first)):
        shares = sorted(a.wall / (jobs * b.wall) for a, b in zip(alone, several, strict=True))
        told = f"parallel efficiency of {jobs} processes, of {name}: {median(shares):.3f}"
        print(f"{told} (from {shares[0]:.3f} to {shares[-1]:.3f})")

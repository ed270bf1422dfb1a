"""The slider that pushes back: whole runs of ours beside peers that are just as right, by junction and by second."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path

import h5py

import rubnoise
from bench import checks, oracle
from bench.case import DAMPING, MASS, SPEED, STIFFNESS, Doubles, doubles
from bench.clock import Task, Timing, interleaved
from bench.peers import coupled_sliders
from bench.peers.coupled_sliders import Mover, Stretch

FIGURE_5 = Path(__file__).resolve().parents[2] / "scenarios" / "paper" / "fig5_two_way.toml"
OURS = "rubnoise, batch"
SOLVER = "solve_ivp, numpy force"
COMPILED_SOLVER = "solve_ivp, compiled force"
STEPS = "RK4, numba"

BOUND = 1e-9
"""Largest error of all tools, over the largest displacement: each other tool gets the loosest setting that keeps it."""

FIGURE_5_COUNT = 20.0
MEAN_COUNTS = (FIGURE_5_COUNT, 5.0)
"""By N_jm, of Figure 5 and of few junctions that slip far: how many times as long as ours solve_ivp should take."""

JUNCTIONS = {20.0: 150, 5.0: 40}
"""Of a stretch on which all are checked and peers are timed: too few for chaos to make much of an error."""

SEEDS = (1, 2, 3)
"""Of the stretches."""

REFERENCE_TOLERANCE = 1e-13


@dataclass(frozen=True)
class Peer:
    """Who else can do it: how, and tolerances, or steps in s, the loosest first."""

    move: Mover
    ways: tuple[float, ...]


TOLERANCES = (1e-10, 1e-11, 3e-12, 1e-12, 3e-13, 1e-13)
PEERS = {
    SOLVER: Peer(coupled_sliders.solve_numpy, TOLERANCES),
    COMPILED_SOLVER: Peer(coupled_sliders.solve_compiled, TOLERANCES),
    STEPS: Peer(coupled_sliders.rk4_compiled, tuple(1e-6 * 0.5**n for n in range(7))),
}


@dataclass(frozen=True)
class CoupledTimings:
    """At one N_jm: timings in units of junctions, junctions in a second of sliding, errors, and the peers' ways."""

    timings: dict[str, Timing]
    rate: float
    errors: dict[str, float]
    ways: dict[str, float]

    def seconds(self, name: str) -> float:
        """Return the CPU time in s of a second of motion."""
        return self.timings[name].each * self.rate

    def faults(self) -> Iterator[str]:
        """Yield a sentence for each motion that is wrong or unchecked."""
        for name in self.timings:
            yield from checks.beyond(f"two-way slider, {name}", "displacement", self.errors.get(name), BOUND)


@dataclass(frozen=True)
class Known:
    """A short run: what peers are given of it, displacements (um) by ours and by the reference."""

    stretch: Stretch
    ours: Doubles
    right: Doubles

    def error(self, found: Doubles) -> float:
        """Return the largest error over the largest displacement."""
        return checks.relative_error(found, self.right)


def scenario(mean_count: float, junctions: int, seed: int) -> rubnoise.Scenario:
    """Return Figure 5, two-way, for another mean number of junctions, as long as so many are born in the mean."""
    changes = (f"interface.mean_junction_count={mean_count:g}", "run.engine=batch", f"run.seed={seed}")
    spacing = rubnoise.load(FIGURE_5, changes).model().mean_birth_spacing
    return rubnoise.load(FIGURE_5, (*changes, f"sliding.distance={junctions * spacing:.6g} um"))


def run(mean_count: float, junctions: int, seed: int, path: Path) -> None:
    """Make a whole run of ours, everything in a file."""
    rubnoise.run(scenario(mean_count, junctions, seed), path, force=True, command=["bench"]).close()


def known(mean_count: float, junctions: int, seed: int, path: Path) -> Known:
    """Return a short run of ours from its file, beside the reference."""
    run(mean_count, junctions, seed, path)
    with h5py.File(path) as file:
        rows, slider = file["junctions"], file["slider"]
        displacement = doubles(slider["displacement"])
        stretch = Stretch(
            birth=doubles(rows["birth_distance"]),
            diameter=doubles(rows["diameter"]),
            strength=doubles(rows["shear_strength"]),
            mass=MASS,
            stiffness=STIFFNESS,
            damping=DAMPING,
            speed=SPEED,
            displacement=float(displacement[0]),
            times=doubles(slider["time"]),
        )
    return Known(stretch, displacement, oracle.coupled_displacement(stretch, REFERENCE_TOLERANCE))


def loosest(peer: Peer, stretches: Sequence[Known]) -> tuple[float, float]:
    """Return the loosest of a peer's ways that keeps the bound on all stretches, and its error; else the last one's."""
    way, error = peer.ways[0], float("inf")
    for way in peer.ways:
        errors = (each.error(peer.move(each.stretch, way)) for each in stretches)
        error = 0.0
        while error <= BOUND and (one := next(errors, None)) is not None:
            error = max(error, one)
        if error <= BOUND:
            break
    return way, error


def measured(junctions: int, repeats: int, folder: Path) -> dict[float, CoupledTimings]:
    """Return times and errors of all tools at each N_jm.

    Ours is a whole run, long enough for what does not grow with it to count little; peers move in memory through the
    stretches on which they have been checked.
    """
    return {mean_count: _measured(mean_count, junctions, repeats, folder) for mean_count in MEAN_COUNTS}


def _measured(mean_count: float, junctions: int, repeats: int, folder: Path) -> CoupledTimings:
    path = folder / "two_way.h5"
    stretches = [known(mean_count, JUNCTIONS[mean_count], seed, path) for seed in SEEDS]
    errors, ways = {OURS: max(each.error(each.ours) for each in stretches)}, {}
    for name, peer in PEERS.items():
        ways[name], errors[name] = loosest(peer, stretches)
    seeds = count(len(SEEDS) + 1)
    path.unlink()
    tasks = {
        OURS: Task(
            lambda: run(mean_count, junctions, next(seeds), path), junctions, partial(path.unlink, missing_ok=True)
        )
    }
    passed = len(SEEDS) * JUNCTIONS[mean_count]
    for name, peer in PEERS.items():
        tasks[name] = Task(partial(_moved, peer.move, stretches, ways[name]), passed)
    timings = interleaved(tasks, repeats)
    path.unlink()
    rate = SPEED / scenario(mean_count, junctions, 1).model().mean_birth_spacing
    return CoupledTimings(timings, rate, errors, ways)


def _moved(move: Mover, stretches: Sequence[Known], way: float) -> None:
    for each in stretches:
        move(each.stretch, way)

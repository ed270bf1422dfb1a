"""Everything that one call of the benchmark has found out."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from bench import checks, kernel, machine, memory, motion, off_centre, speed, startup, two_way
from bench.checks import Verdict, Wrong
from bench.entrants import AREAS, BIRTHS, IN_MEMORY, RUNS
from bench.kernel import KernelTimings
from bench.motion import MotionTimings
from bench.off_centre import Contact, OffCentreTimings
from bench.peers import c_kernel
from bench.plan import Plan
from bench.speed import Growth, Timings
from bench.startup import Beside, Wait
from bench.two_way import CoupledTimings

Tell = Callable[[str], None]


@dataclass(frozen=True, kw_only=True)
class Results:
    """Verdicts on correctness, timings by entrant, and what else was measured; ``machine`` as two lines of text."""

    plan: Plan
    machine: tuple[str, str]
    verdicts: tuple[Verdict, ...]
    runs: Timings
    areas: Timings
    births: Timings
    kernel: KernelTimings
    kernel_over_ticks: dict[float, KernelTimings]
    motion: MotionTimings
    two_way: dict[float, CoupledTimings]
    off_centre: dict[Contact, OffCentreTimings]
    growth: dict[str, Growth]
    in_memory: Growth
    memory: dict[str, dict[int, float]]
    startup: dict[str, Wait]
    beside: tuple[Beside, ...]

    def faults(self) -> Iterator[str]:
        """Yield a sentence for everything that was computed wrong, or was timed and never checked."""
        for verdict in self.verdicts:
            yield from verdict.faults()
        checked = {(verdict.part, verdict.name) for verdict in self.verdicts}
        for part, timings in (
            ("runs", self.runs),
            ("in memory", self.in_memory),
            ("areas", self.areas),
            ("births", self.births),
        ):
            yield from (f"{part}, {name}: never checked" for name in timings if (part, name) not in checked)
        for pulses in (self.kernel, *self.kernel_over_ticks.values()):
            yield from pulses.faults()
        yield from self.motion.faults()
        for coupled in self.two_way.values():
            yield from coupled.faults()
        for contact, passes in self.off_centre.items():
            yield from passes.faults(contact)


def measured(plan: Plan, folder: Path, tell: Tell) -> Results:
    """Measure everything that is planned, in a folder for the files that are written; tell what comes next.

    Raises Wrong before any time is taken if an entrant computes something wrong.
    """
    here = machine.described(gcc=c_kernel.available())
    path = folder / "run.h5"
    tell("correctness: each entrant makes small runs")
    verdicts = tuple(checks.verdicts(folder, checks.cases(plan.counts, plan.ticks)))
    if faults := [fault for verdict in verdicts for fault in verdict.faults()]:
        raise Wrong(*faults)
    tell("whole runs")
    whole = speed.timed(RUNS, plan, path)
    tell("the area alone, and births alone")
    bare, born = speed.timed(AREAS, plan), speed.timed(BIRTHS, plan)
    tell("the pulse kernel and the slider")
    pulses, motions = kernel.measured(plan.repeats), motion.measured(plan.repeats)
    over_ticks = kernel.measured_over_ticks(plan.repeats, plan.kernel_ticks)
    tell("the slider that pushes back")
    coupled = two_way.measured(plan.two_way, plan.two_way_repeats, folder)
    tell("junctions off the centre line")
    passes = off_centre.measured(plan.off_centre, plan.off_centre_repeats, folder)
    tell("growth")
    growth = speed.growths(RUNS, plan, path)
    kept = speed.over_ticks(IN_MEMORY, plan, plan.ticks)
    path.unlink()
    tell("memory and start-up")
    return Results(
        plan=plan,
        machine=here,
        verdicts=verdicts,
        runs=whole,
        areas=bare,
        births=born,
        kernel=pulses,
        kernel_over_ticks=over_ticks,
        motion=motions,
        two_way=coupled,
        off_centre=passes,
        growth=growth,
        in_memory=kept,
        memory=memory.measured(RUNS, plan.memory, folder),
        startup=startup.measured(folder, repeats=plan.repeats),
        beside=tuple(startup.beside(folder, repeats=plan.repeats, swept=plan.swept, junctions=plan.two_way)),
    )

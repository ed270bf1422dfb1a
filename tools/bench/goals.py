"""The goals of the benchmark, as ratios within one call, and the values reached."""

from collections.abc import Iterator
from dataclasses import dataclass

from bench import kernel, motion, off_centre, startup, two_way
from bench.clock import Timing
from bench.entrants import CIW, NAIVE_SIMPY, OURS, SUPERPOSED, SUPERPOSED_AREA
from bench.results import Results


@dataclass(frozen=True)
class Goal:
    """A number that should be at least ``bound``, or at most where ``least`` is false; None if it was not measured."""

    what: str
    value: float | None
    bound: float
    unit: str = ""
    least: bool = True

    @property
    def reached(self) -> bool:
        """Whether it is; one that is not measured is not reached."""
        if self.value is None:
            return False
        return self.value >= self.bound if self.least else self.value <= self.bound


def grouped(number: float) -> str:
    """Return a whole number with its thousands apart."""
    return f"{number:,.0f}".replace(",", " ")


def goals(found: Results) -> Iterator[Goal]:
    """Yield every goal; what this call could not measure, as without a compiler, has no value."""
    yield from _events(found)
    yield from _batch(found)
    program = "C, the same polynomial"
    yield Goal("pulse kernel: ours over C", _ratio(found.kernel.timings, kernel.OURS, program), 1.15, least=False)
    for ticks, pulses in found.kernel_over_ticks.items():
        what = f"pulse kernel: numba's loops over ours, {grouped(ticks)} ticks in a mean life"
        yield Goal(what, _ratio(pulses.timings, kernel.NUMBA, kernel.OURS), 1.0)
    yield Goal(
        "slider: error of lsim at equal ticks over ours",
        found.motion.errors["lsim"] / found.motion.errors[motion.OURS],
        1e5,
    )
    yield Goal("slider: CPU of lsim over ours", _ratio(found.motion.timings, "lsim", motion.OURS), 5.0)
    yield from _two_way(found)
    yield from _off_centre(found)
    yield from _waits(found)


def _ratio(timings: dict[str, Timing], slow: str, fast: str) -> float | None:
    return timings[slow].each / timings[fast].each if {slow, fast} <= timings.keys() else None


def _events(found: Results) -> Iterator[Goal]:
    name = f"{OURS}events"
    yield Goal("whole run: naive SimPy over `events`", _ratio(found.runs, NAIVE_SIMPY, name), 25.0)
    yield Goal("whole run: superposed-pulses and lsim over `events`", _ratio(found.runs, SUPERPOSED, name), 13.0)


def _batch(found: Results) -> Iterator[Goal]:
    name = f"{OURS}batch"
    yield Goal("whole run: naive SimPy over `batch`", _ratio(found.runs, NAIVE_SIMPY, name), 110.0)
    yield Goal("whole run: superposed-pulses and lsim over `batch`", _ratio(found.runs, SUPERPOSED, name), 60.0)
    births = _ratio(found.births | found.runs, CIW, name)
    yield Goal("Ciw's births and deaths over a whole run of `batch`", births, 15.0)
    yield Goal("area alone: superposed-pulses over `batch`", _ratio(found.areas, SUPERPOSED_AREA, name), 35.0)


def _two_way(found: Results) -> Iterator[Goal]:
    for mean_count, bound in two_way.GOALS.items():
        timings = found.two_way[mean_count].timings
        what = f"two-way slider, N_jm = {mean_count:g}: {two_way.SOLVER} over `batch`"
        yield Goal(what, _ratio(timings, two_way.SOLVER, two_way.OURS), bound)
    each = 1e6 * found.two_way[two_way.FIGURE_5_COUNT].timings[two_way.OURS].each
    yield Goal("two-way slider, Figure 5: CPU of a junction, whole run of `batch`", each, 3.0, " us", least=False)


def _off_centre(found: Results) -> Iterator[Goal]:
    """Yield the largest ratio of the area alone, and with a slider."""
    for bound in (off_centre.AREA_GOAL, off_centre.SLIDER_GOAL):
        ratios = {contact: each.ratio for contact, each in found.off_centre.items() if contact.goal == bound}
        worst = max(ratios, key=lambda contact: ratios[contact])
        what = f"off the centre line over centred, {worst.what}: the largest of {len(ratios)}"
        yield Goal(what, ratios[worst], bound, least=False)


def _waits(found: Results) -> Iterator[Goal]:
    for name, bound in ((startup.HELP, 0.25), (startup.RUN, 1.2), (startup.FIRST, 0.4)):
        yield Goal(f"wall time: {name}", found.startup[name].wall, bound, " s", least=False)
    largest = max(found.plan.memory)
    for engine in found.engines:
        peak = found.memory[f"{OURS}{engine}"][largest]
        yield Goal(f"memory: {grouped(largest)} junctions, `{engine}`", peak, 400.0, " MB", least=False)

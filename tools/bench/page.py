"""The page docs/performance.md: page.md, its gaps filled with what was measured."""

import re
from collections.abc import Iterable, Iterator, Mapping
from datetime import date
from pathlib import Path

from bench import kernel, motion, off_centre, two_way
from bench.checks import OUR_MOTION_BOUND, SMALL, Wrong
from bench.clock import Timing
from bench.entrants import FASTEST, OURS
from bench.results import Results
from bench.speed import Growth

TEXT = Path(__file__).with_suffix(".md")
GAP = re.compile(r"\[\[([\w -]+)\]\]")
SPEED = ("µs a junction", "±", "times the fastest", "junctions")
TWO_WAY = ("µs a junction", "±", "times ours", "s a second", "junctions", "error", "tolerance, step in s")
OFF_CENTRE = ("$N_{jm}$", "ticks in a life", "centred, µs", "off the line, µs", "ratio", "error of area, motion")


def page(found: Results, today: date) -> str:
    """Return the whole page; raises Wrong, and makes none, if anything was computed wrong or never checked."""
    if faults := list(found.faults()):
        raise Wrong(*faults)
    parts = {**_words(found, today), **_tables(found)}
    return GAP.sub(lambda gap: parts[gap[1]], TEXT.read_text(encoding="utf-8"))


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table of Markdown: the first column to the left, numbers to the right."""
    first, *others = [f"| {' | '.join(row)} |" for row in (head, *rows)]
    return "\n".join([first, "|---|" + "---:|" * (first.count(" | ")), *others])


def grouped(value: float) -> str:
    """Return a whole number with its thousands apart."""
    return f"{value:,.0f}".replace(",", " ")


def _words(found: Results, today: date) -> dict[str, str]:
    hardware, software = found.machine
    ours = [max(peaks.values()) for name, peaks in found.memory.items() if name.startswith(OURS)]
    has_gcc = "C, the same polynomial" in found.kernel.timings
    return {
        "measured": f"Measured on {today:%d %B %Y}: {hardware}.\n{software}.",
        "closest": next(name for name, _ in _by_speed(found.runs) if not name.startswith(OURS)),
        "motion bound": f"{OUR_MOTION_BOUND:.0e}",
        "largest memory": f"{max(ours):.0f}",
        "without gcc": "" if has_gcc else "\nThere is no gcc here, so the C program is missing.",
        "two-way bound": f"{two_way.BOUND:.0e}",
        "reference tolerance": f"{two_way.REFERENCE_TOLERANCE:.0e}",
        "refined": str(off_centre.REFINED),
        "engine": FASTEST,
        "swept": str(found.plan.swept),
    }


def _tables(found: Results) -> dict[str, str]:
    small = {(each.part, each.name): each for each in found.verdicts if each.case == SMALL}
    whole = {name: f"{_error(small['runs', name].area)}, {_error(small['runs', name].motion)}" for name in found.runs}
    areas = {name: _error(small["areas", name].area) for name in found.areas}
    births = {name: _error(small["births", name].life) for name in found.births}
    ticks = "ticks in a mean life"
    return {
        "whole runs": table(("who", *SPEED, "error of area, motion"), _speeds(found.runs, whole)),
        "areas": table(("who", *SPEED, "error"), _speeds(found.areas, areas)),
        "births": table(("who", *SPEED, "error"), _speeds(found.births, births)),
        "kernel": table((f"who ({kernel.OURS} is numba too)", "ns", "±", "error"), _kernel(found)),
        "kernel over ticks": _kernel_over_ticks(found),
        "motion": table(("method", "ns a tick", "times ours", "error"), _motion(found)),
        "two-way": "\n\n".join(
            table((f"$N_{{jm}}$ = {mean_count:g}", *TWO_WAY), _two_way(coupled))
            for mean_count, coupled in found.two_way.items()
        ),
        "off-centre": table(("part", *OFF_CENTRE), _off_centre(found)),
        "growth by count": _growth("mean number of junctions $N_{jm}$", _fast(found.growth["count"])),
        "growth by ticks": _growth(ticks, found.growth["ticks"]),
        "errors by ticks": _errors_by_ticks(found),
        "in memory": _growth(f"{ticks}, in memory", found.in_memory),
        "growth by length": _growth("junctions in a run", _fast(found.growth["length"])),
        "memory": table(("junctions", *map(grouped, found.plan.memory)), _memory(found)),
        "starting": table(
            ("what", "clock, s", "CPU, s"),
            ((name, f"{wait.wall:.2f}", f"{wait.cpu:.2f}") for name, wait in found.startup.items()),
        ),
        "beside": table(
            ("what", "CPU, ms", "the least", "CPU, ms", "times"),
            (
                (
                    each.what,
                    f"{1e3 * each.ours.each:.3g}",
                    each.least,
                    f"{1e3 * each.bare.each:.3g}",
                    f"{each.ratio:.3g}",
                )
                for each in found.beside
            ),
        ),
    }


def _by_speed(timings: Mapping[str, Timing]) -> list[tuple[str, Timing]]:
    return sorted(timings.items(), key=lambda item: item[1].each)


def _spread(timing: Timing) -> str:
    return f"{100.0 * timing.spread:.0f} %"


def _error(value: float | None) -> str:
    return "-" if value is None else f"{value:.0e}" if value else "0"


def _speeds(timings: Mapping[str, Timing], errors: Mapping[str, str]) -> Iterator[tuple[str, ...]]:
    rows = _by_speed(timings)
    _, fastest = rows[0]
    for name, timing in rows:
        ratio = f"{timing.each / fastest.each:.3g}"
        yield name, f"{1e6 * timing.each:.3g}", _spread(timing), ratio, grouped(timing.units), errors[name]


def _kernel(found: Results) -> Iterator[tuple[str, ...]]:
    for name, timing in _by_speed(found.kernel.timings):
        yield name, f"{1e9 * timing.each:.3g}", _spread(timing), _error(found.kernel.errors.get(name))


def _kernel_over_ticks(found: Results) -> str:
    points = found.kernel_over_ticks
    rows = (
        (name, *(f"{1e9 * each.timings[name].each:.3g}" for each in points.values()))
        for name in (kernel.OURS, kernel.NUMBA)
    )
    return table(("ticks in a mean life", *map(grouped, points)), rows)


def _motion(found: Results) -> Iterator[tuple[str, ...]]:
    ours = found.motion.timings[motion.OURS].each
    for name, timing in _by_speed(found.motion.timings):
        yield name, f"{1e9 * timing.each:.4g}", f"{timing.each / ours:.3g}", _error(found.motion.errors[name])


def _two_way(coupled: two_way.CoupledTimings) -> Iterator[tuple[str, ...]]:
    ours = coupled.timings[two_way.OURS].each
    for name, timing in _by_speed(coupled.timings):
        yield (
            name,
            f"{1e6 * timing.each:.3g}",
            _spread(timing),
            f"{timing.each / ours:.3g}",
            f"{coupled.seconds(name):.2g}",
            grouped(timing.units),
            _error(coupled.errors.get(name)),
            f"{coupled.ways[name]:.1g}" if name in coupled.ways else "default",
        )


def _off_centre(found: Results) -> Iterator[tuple[str, ...]]:
    for contact, passes in found.off_centre.items():
        yield (
            contact.what,
            f"{contact.mean_count:g}",
            f"{contact.ticks_per_life:g}",
            *(f"{1e6 * passes.timings[offset].each:.3g}" for offset in off_centre.OFFSETS),
            f"{passes.ratio:.2f}",
            f"{_error(passes.errors.get('area'))}, {_error(passes.errors.get('displacement'))}",
        )


def _fast(growth: Growth) -> Growth:
    """Return the growth of rubnoise and of the tool that comes closest; the picture shows that of all."""
    best = {name: min(each.each for each in timings.values()) for name, timings in growth.items()}
    peers = sorted((name for name in growth if not name.startswith(OURS)), key=best.__getitem__)
    return {name: timings for name, timings in growth.items() if name.startswith(OURS) or name in peers[:1]}


def _points(growth: Growth) -> list[float]:
    return sorted({point for timings in growth.values() for point in timings})


def _growth(what: str, growth: Growth) -> str:
    points = _points(growth)
    rows = (
        (name, *(f"{1e6 * timings[point].each:.3g}" if point in timings else "-" for point in points))
        for name, timings in growth.items()
    )
    return table((what, *map(grouped, points)), rows)


def _errors_by_ticks(found: Results) -> str:
    """Return by number of ticks the error of each tool's motion that was made in those times; equal rows are one."""
    growth = found.growth["ticks"]
    errors = {
        (each.name, each.case.ticks_per_life): each.motion
        for each in found.verdicts
        if each.part == "runs" and each.case.mean_count == SMALL.mean_count and each.case != SMALL
    }
    alike: dict[tuple[str, ...], list[str]] = {}
    for name in growth:
        alike.setdefault(tuple(_error(errors.get((name, point))) for point in _points(growth)), []).append(name)
    rows = (("; ".join(names), *cells) for cells, names in alike.items())
    return table(("ticks in a mean life", *map(grouped, _points(growth))), rows)


def _memory(found: Results) -> Iterator[tuple[str, ...]]:
    for name, peaks in found.memory.items():
        yield name, *(f"{peaks[count]:.0f}" if count in peaks else "-" for count in found.plan.memory)

"""The page docs/performance.md: page.md, its gaps filled with what was measured."""

import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import date
from pathlib import Path

from bench.checks import OUR_MOTION_BOUND, OURS, SMALL, Wrong
from bench.measure import Growth, Results, Timing

TEXT = Path(__file__).with_suffix(".md")
GAP = re.compile(r"\[\[([\w -]+)\]\]")
SPEED = ("who", "µs a junction", "±", "times the fastest", "junctions")


def page(found: Results, today: date) -> str:
    """Return the whole page; raises Wrong, and makes none, if anything was computed wrong or never checked."""
    if faults := list(found.faults()):
        raise Wrong(*faults)
    hardware, software = found.machine
    small = {each.name: f"{_error(each.area)}, {_error(each.motion)}" for each in found.verdicts if each.case == SMALL}
    parts = {
        "measured": f"Measured on {today:%d %B %Y}: {hardware}.\n{software}.",
        "closest": next(name for name, _ in _by_speed(found.runs) if not name.startswith(OURS)),
        "motion bound": f"{OUR_MOTION_BOUND:.0e}",
        "whole runs": table((*SPEED, "error of area, motion"), list(_speeds(found.runs, small))),
        "growth by ticks": _growth("ticks in a mean life", found.growth),
        "errors by ticks": _errors_by_ticks(found),
        "memory": _memory(found),
        "starting": table(
            ("what", "clock, s", "CPU, s"),
            [(name, f"{wall:.2f}", f"{cpu:.2f}") for name, (wall, cpu) in found.waits.items()],
        ),
    }
    return GAP.sub(lambda gap: parts[gap[1]], TEXT.read_text(encoding="utf-8"))


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of Markdown: the first column to the left, numbers to the right."""
    first, *others = [f"| {' | '.join(row)} |" for row in (head, *rows)]
    return "\n".join([first, "|---|" + "---:|" * (len(head) - 1), *others])


def grouped(value: float) -> str:
    """Return a whole number with its thousands apart."""
    return f"{value:,.0f}".replace(",", " ")


def _by_speed(timings: Mapping[str, Timing]) -> list[tuple[str, Timing]]:
    return sorted(timings.items(), key=lambda item: item[1].each)


def _error(value: float) -> str:
    return f"{value:.0e}" if value else "0"


def _speeds(timings: Mapping[str, Timing], errors: Mapping[str, str]) -> Iterator[tuple[str, ...]]:
    rows = _by_speed(timings)
    _, fastest = rows[0]
    for name, timing in rows:
        spread, ratio = f"{100.0 * timing.spread:.0f} %", f"{timing.each / fastest.each:.3g}"
        yield name, f"{1e6 * timing.each:.3g}", spread, ratio, grouped(timing.units), errors[name]


def _growth(what: str, growth: Growth) -> str:
    points = list(next(iter(growth.values())))
    rows = [(name, *(f"{1e6 * timings[each].each:.3g}" for each in points)) for name, timings in growth.items()]
    return table((what, *map(grouped, points)), rows)


def _errors_by_ticks(found: Results) -> str:
    """Return by number of ticks the error of each tool's motion; equal rows are one."""
    growth = found.growth
    points = list(next(iter(growth.values())))
    errors = {(each.name, each.case.ticks_per_life): _error(each.motion) for each in found.verdicts}
    alike: dict[tuple[str, ...], list[str]] = {}
    for name in growth:
        alike.setdefault(tuple(errors[name, point] for point in points), []).append(name)
    return table(
        ("ticks in a mean life", *map(grouped, points)), [("; ".join(who), *row) for row, who in alike.items()]
    )


def _memory(found: Results) -> str:
    lengths = sorted({length for peaks in found.memory.values() for length in peaks})
    rows = [
        (name, *(f"{peaks[length]:.0f}" if length in peaks else "-" for length in lengths))
        for name, peaks in found.memory.items()
    ]
    return table(("junctions", *map(grouped, lengths)), rows)

"""The page docs/performance.md, written from what was measured."""

from collections.abc import Iterable, Iterator, Mapping
from datetime import date

from bench import kernel, motion, off_centre, two_way
from bench.checks import OUR_MOTION_BOUND, SMALL, Verdict, Wrong
from bench.clock import Timing
from bench.entrants import OURS
from bench.results import Results
from bench.speed import Growth
from bench.two_way import CoupledTimings

HEAD = """# Performance

This page shows speed, accuracy and memory of rubnoise and of other tools for the same work. `python3 tools/dev.py
bench` writes it in some ten minutes; `bench --quick` prints a short version.

![CPU time for each junction of whole runs, of the area and of births, and its growth](pictures/performance.png)
"""
FAIR = """## What is compared, and how

- **The work.** Figure 5's contact and slider ($A_{rm}$ = 200 µm², $N_{jm}$ = 20, some 221 ticks in a mean life), from
  an empty start. A *whole run* draws births and diameters, sums the area at every tick, moves the slider, and writes
  junctions, trace and motion into an HDF5 file. rubnoise also writes exact theory into it and hashes every column.
- **Correct first.** All tools get the same junctions. Their whole runs are compared with the slow references of
  `tests/oracle`, which share no code with them. One wrong result ends the benchmark, and no page is written.
- **Written as a user would write it**, with a file for each tool under `tools/bench/peers`. If a tool has a faster way
  of its own, its file uses it.
- **CPU time** of the process and its children, warm, on one thread. The tools take turns (A B C A B C), each repeat has
  its own seed, and the tables show medians. ± is half the range of the repeats. Slow tools run shorter: they have no
  fixed cost that a longer run would spread; rubnoise has one.

"""


_TWO_WAY_HEAD = ("µs a junction", "±", "times ours", "s a second", "junctions", "error", "tolerance, step in s")


def page(found: Results, today: date) -> str:
    """Return the whole page; raises Wrong, and makes none, if anything was computed wrong or never checked."""
    if faults := list(found.faults()):
        raise Wrong(*faults)
    return "\n".join(_lines(found, today)).rstrip() + "\n"


def _lines(found: Results, today: date) -> Iterator[str]:
    hardware, software = found.machine
    yield from (HEAD, f"Measured on {today:%d %B %Y}: {hardware}.", f"{software}.", "")
    yield from (FAIR, *_not_compared(found), "")
    yield from ("## Whole runs", "", *_whole(found), "")
    yield from ("## Parts of it", "", *_parts(found), "")
    yield from ("## The pulse kernel", "", *_kernel(found), "")
    yield from ("## The slider", "", *_motion(found), "")
    yield from ("## The slider that pushes back", "", *_two_way(found), "")
    yield from ("## Off the centre line", "", *_off_centre(found), "")
    yield from ("## Growth", "", *_growth(found), "")
    yield from ("## Memory", "", *_memory(found), "")
    yield from ("## Starting", "", *_starting(found), "")


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> Iterator[str]:
    """Yield a table of Markdown: the first column to the left, numbers to the right."""
    words = list(head)
    yield "| " + " | ".join(words) + " |"
    yield "|---|" + "---:|" * (len(words) - 1)
    for row in rows:
        yield "| " + " | ".join(row) + " |"


def number(value: float) -> str:
    """Return a number in three digits, large ones whole."""
    if value >= 1e4 or 0.0 < value < 1e-3:
        return f"{value:.1e}"
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def grouped(value: float) -> str:
    """Return a whole number with its thousands apart."""
    return f"{value:,.0f}".replace(",", " ")


def _speed_rows(timings: Mapping[str, Timing], errors: Mapping[str, str]) -> Iterator[tuple[str, ...]]:
    fastest = min(timings.values(), key=lambda timing: timing.each)
    for name, timing in sorted(timings.items(), key=lambda item: item[1].each):
        each, spread = f"{1e6 * timing.each:.3g}", f"{100.0 * timing.spread:.0f} %"
        ratio = f"{timing.each / fastest.each:.3g}"
        yield name, each, spread, ratio, grouped(timing.units), errors.get(name, "-")


def _not_compared(found: Results) -> Iterator[str]:
    whole = sorted(found.runs.items(), key=lambda item: item[1].each)
    peer = next(name for name, _ in whole if not name.startswith(OURS))
    peak = max(max(peaks.values()) for name, peaks in found.memory.items() if name.startswith(OURS))
    yield f"Of the other tools, {peer} comes closest in a whole run. rubnoise adds a motion that is right to"
    yield f"{OUR_MOTION_BOUND:.0e} of the largest displacement, and needs at most {peak:.0f} MB in every run below."


def _small(found: Results, part: str) -> dict[str, Verdict]:
    return {each.name: each for each in found.verdicts if each.part == part and each.case == SMALL}


def _whole(found: Results) -> Iterator[str]:
    errors = {name: f"{_error(each.area)}, {_error(each.motion)}" for name, each in _small(found, "runs").items()}
    head = ("who", "µs a junction", "±", "times the fastest", "junctions", "error of area, motion")
    yield from table(head, _speed_rows(found.runs, errors))
    yield ""
    yield "The error is the largest at any tick over the largest value, in a short run of the same contact."


def _parts(found: Results) -> Iterator[str]:
    yield "Births and the trace of the area, in memory:"
    yield ""
    errors = {name: _error(each.area) for name, each in _small(found, "areas").items()}
    head = ("who", "µs a junction", "±", "times the fastest", "junctions", "error")
    yield from table(head, _speed_rows(found.areas, errors))
    yield ""
    yield "Births and deaths alone, with no area and no file:"
    yield ""
    errors = {name: _error(each.life) for name, each in _small(found, "births").items()}
    yield from table(head, _speed_rows(found.births, errors))


def _error(value: float | None) -> str:
    return "-" if value is None else f"{value:.0e}" if value else "0"


def _kernel(found: Results) -> Iterator[str]:
    yield "ns for each tick of each junction. The square roots alone are a bound for any kernel that uses one."
    if "C, the same polynomial" not in found.kernel.timings:
        yield "There is no gcc here, so the C program is missing."
    yield ""
    rows = (
        (name, f"{1e9 * timing.each:.3g}", f"{100.0 * timing.spread:.0f} %", _error(found.kernel.errors.get(name)))
        for name, timing in sorted(found.kernel.timings.items(), key=lambda item: item[1].each)
    )
    yield from table((f"who ({kernel.OURS} is numba too)", "ns", "±", "error"), rows)
    yield ""
    yield "The same, from coarse ticks to fine ones:"
    yield ""
    points = found.kernel_over_ticks
    rows_over_ticks = (
        (name, *(f"{1e9 * each.timings[name].each:.3g}" for each in points.values()))
        for name in (kernel.OURS, kernel.NUMBA)
    )
    yield from table(("ticks in a mean life", *map(grouped, points)), rows_over_ticks)


def _motion(found: Results) -> Iterator[str]:
    yield "All methods use the same ticks. The error is compared with exact convolution. For rubnoise, the time is"
    yield "that of a run in memory with the slider less one without it, with the force's integrals. The others get"
    yield "the force at the ticks. solve_ivp with the exact force gets the junctions."
    yield ""
    rows = (
        (
            name,
            f"{1e9 * timing.each:.4g}",
            f"{timing.each / found.motion.timings[motion.OURS].each:.3g}",
            _error(found.motion.errors[name]),
        )
        for name, timing in sorted(found.motion.timings.items(), key=lambda item: item[1].each)
    )
    yield from table(("method", "ns a tick", "times ours", "error"), rows)


def _two_way(found: Results) -> Iterator[str]:
    yield "`scenarios/paper/fig5_two_way.toml` at 1 mm/s. For rubnoise, the time is that of a whole run into a"
    yield "file. The other tools get the junctions and keep displacements in memory. The motion is chaotic, so they"
    yield "compute short stretches of it; their time for a second of sliding is scaled from there. All are right to"
    yield f"{two_way.BOUND:.0e} of the largest displacement, compared with the slow reference at a tolerance of"
    yield f"{two_way.REFERENCE_TOLERANCE:.0e}. rubnoise uses its default tolerance, each other tool the loosest"
    yield "tolerance or longest step that reaches this. solve_ivp (DOP853) starts again at every birth, mid-life"
    yield "and death."
    for mean_count, coupled in found.two_way.items():
        yield ""
        yield from table((f"$N_{{jm}}$ = {mean_count:g}", *_TWO_WAY_HEAD), _two_way_rows(coupled))


def _two_way_rows(coupled: CoupledTimings) -> Iterator[tuple[str, ...]]:
    ours = coupled.timings[two_way.OURS].each
    for name, timing in sorted(coupled.timings.items(), key=lambda item: item[1].each):
        yield (
            name,
            f"{1e6 * timing.each:.3g}",
            f"{100.0 * timing.spread:.0f} %",
            f"{timing.each / ours:.3g}",
            f"{coupled.seconds(name):.2g}",
            grouped(timing.units),
            _error(coupled.errors.get(name)),
            f"{coupled.ways[name]:.1g}" if name in coupled.ways else "default",
        )


def _off_centre(found: Results) -> Iterator[str]:
    yield "Junctions that miss each other's centre line (`pulse.offset`), beside centred ones: whole runs of `batch`"
    yield "with the same mean area, $N_{jm}$ and tick. Off it, diameters are 1.3 times as large, and lives as long."
    yield "Each area costs a root more, and the slider's moments have no closed form. The time is for each junction of"
    yield "the centred run. The errors are those off the line: of the area against the formula, and of the motion"
    yield f"against a run with {off_centre.REFINED} times as many ticks."
    yield ""
    head = (
        "part",
        "$N_{jm}$",
        "ticks in a life",
        "centred, µs",
        "off the line, µs",
        "ratio",
        "error of area, motion",
    )
    yield from table(head, map(_off_centre_row, found.off_centre.items()))


def _off_centre_row(item: tuple[off_centre.Contact, off_centre.OffCentreTimings]) -> tuple[str, ...]:
    contact, passes = item
    return (
        contact.what,
        f"{contact.mean_count:g}",
        f"{contact.ticks_per_life:g}",
        *(f"{1e6 * passes.timings[offset].each:.3g}" for offset in off_centre.OFFSETS),
        f"{passes.ratio:.2f}",
        f"{_error(passes.errors.get('area'))}, {_error(passes.errors.get('displacement'))}",
    )


def _growth(found: Results) -> Iterator[str]:
    yield "µs a junction of whole runs. One number changes, the others are as in Figure 5. With few ticks in a"
    yield "life, two parts of a rubnoise run take the most time. One is the same for every run: exact theory, the"
    yield "file's structure, hashes, and waiting for the disk. The other is the motion: its cells are then finer"
    yield f"than ticks, so that it is right to {OUR_MOTION_BOUND:.0e}. The other tools move from tick to tick and"
    yield "check nothing. With 3 ticks in a life, which have no column, none of their sliders is right to 1 %."
    words = {
        "count": "mean number of junctions $N_{jm}$",
        "ticks": "ticks in a mean life",
        "length": "junctions in a run",
    }
    for what, growth in found.growth.items():
        yield ""
        yield from _growth_table(words[what], growth if what == "ticks" else _fast(growth))
        if what == "ticks":
            yield ""
            yield from _growth_of_errors(found, growth)
            yield ""
            yield from _in_memory(found)


def _fast(growth: Growth) -> Growth:
    """Return the growth of rubnoise and of the tool that comes closest; the picture shows that of all."""
    peers = sorted((name for name in growth if not name.startswith(OURS)), key=lambda name: min(_each(growth[name])))
    return {name: timings for name, timings in growth.items() if name.startswith(OURS) or name in peers[:1]}


def _each(timings: Mapping[float, Timing]) -> list[float]:
    return [timing.each for timing in timings.values()]


def _growth_of_errors(found: Results, growth: Growth) -> Iterator[str]:
    """Yield by number of ticks the error of each tool's motion that was made in those times; equal rows are one."""
    points = sorted({point for timings in growth.values() for point in timings})
    errors = {
        (each.name, each.case.ticks_per_life): each.motion
        for each in found.verdicts
        if each.part == "runs" and each.case.mean_count == SMALL.mean_count and each.case != SMALL
    }
    yield "The errors of the motion in these runs, over its largest displacement:"
    yield ""
    alike: dict[tuple[str, ...], list[str]] = {}
    for name in growth:
        alike.setdefault(tuple(_error(errors.get((name, point))) for point in points), []).append(name)
    rows = (("; ".join(names), *cells) for cells, names in alike.items())
    yield from table(("ticks in a mean life", *map(grouped, points)), rows)


def _in_memory(found: Results) -> Iterator[str]:
    yield "The same in memory, without file, theory or hashes: births and area, and these with the motion, whose"
    yield "errors are those above. Our motion takes three moments of the force over every cell, and by 10 ticks in a"
    yield "life a tick has eight cells. The loops take the force at the ticks alone. Their error falls with the square"
    yield f"of a tick: for {OUR_MOTION_BOUND:.0e} they would need some 20 000 ticks in a life."
    yield ""
    yield from _growth_table("ticks in a mean life, in memory", found.in_memory)


def _growth_table(what: str, growth: Growth) -> Iterator[str]:
    points = sorted({point for timings in growth.values() for point in timings})
    rows = (
        (name, *(f"{1e6 * timings[point].each:.3g}" if point in timings else "-" for point in points))
        for name, timings in growth.items()
    )
    yield from table((what, *map(grouped, points)), rows)


def _memory(found: Results) -> Iterator[str]:
    yield "Peak resident memory of a whole run in a process of its own, in MB (1e6 bytes), with 20 ticks in a mean"
    yield "life."
    if not found.plan.quick:
        yield "With 100 junctions it is the memory of Python and the libraries."
    yield ""
    head = ("junctions", *map(grouped, found.plan.memory))
    rows = (
        (name, *(f"{peaks[count]:.0f}" if count in peaks else "-" for count in found.plan.memory))
        for name, peaks in found.memory.items()
    )
    yield from table(head, rows)


def _starting(found: Results) -> Iterator[str]:
    yield f"The best of some new processes, with the engine `{found.engines[-1]}`. Compiled code is kept from"
    yield "earlier runs, except in the last line."
    yield ""
    rows = ((name, f"{wait.wall:.2f}", f"{wait.cpu:.2f}") for name, wait in found.startup.items())
    yield from table(("what", "clock, s", "CPU, s"), rows)
    yield ""
    yield "The next table shows CPU times beside those of the least that is needed. Both take turns, and the ratio is"
    yield "that of their medians. A sweep writes a file for each run; its time includes the start of a process, shared"
    yield f"by {found.plan.swept} runs."
    yield ""
    pairs = ((each.what, _ms(each.ours), each.least, _ms(each.bare), f"{each.ratio:.3g}") for each in found.beside)
    yield from table(("what", "CPU, ms", "the least", "CPU, ms", "times"), pairs)


def _ms(timing: Timing) -> str:
    return f"{1e3 * timing.each:.3g}"

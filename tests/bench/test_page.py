"""What the benchmark makes of its numbers, and the cost of a sweep."""

from dataclasses import replace
from datetime import date
from itertools import count
from pathlib import Path

import pytest
from bench import __main__ as program
from bench import clock, kernel, motion, off_centre, startup, two_way
from bench import results as results_module
from bench.checks import Verdict, Wrong
from bench.clock import Task, Timing, interleaved
from bench.entrants import areas, births, in_memory, runs
from bench.kernel import KernelTimings
from bench.motion import MotionTimings
from bench.off_centre import OffCentreTimings
from bench.page import page
from bench.plan import FULL, QUICK
from bench.results import Results
from bench.two_way import CoupledTimings

# What the benchmark makes of its numbers: medians, ratios, a page and a picture.
ENGINES = ("events", "batch")
PNG = b"\x89PNG"


def timing(microseconds: float) -> Timing:
    return Timing((1e-6 * microseconds,) * 3, 1.0)


def coupled(ours: float) -> CoupledTimings:
    """Return a two-way slider of ours at some us a junction, beside peers of five ms and bounds that all keep."""
    times = {two_way.OURS: timing(ours), **{name: timing(5000.0) for name in two_way.PEERS}}
    ways = {name: peer.ways[-1] for name, peer in two_way.PEERS.items()}
    return CoupledTimings(times, 1800.0, dict.fromkeys(times, 1e-10), ways)


def passes(ratio: float) -> OffCentreTimings:
    """Return a contact off the centre line that takes so many times as long as a centred one, and is right."""
    times = {"none": timing(2.0), "uniform": timing(2.0 * ratio)}
    return OffCentreTimings(times, {"area": 1e-15, "displacement": 1e-11})


def results(*, batch: float = 0.9, area_error: float = 1e-15) -> Results:
    """Return right numbers, with made-up times of all tools."""
    times = {"rubnoise, batch": batch, "rubnoise, events": 4.0, "numba loops, RK4": 3.0}
    whole = {each.name: timing(times.get(each.name, 110.0)) for each in runs(ENGINES)}
    bare = {each.name: timing(9.0 if "rubnoise" not in each.name else 0.25) for each in areas(ENGINES)}
    verdicts = [Verdict("runs", name, area_error, 1e-12, 0.0) for name in whole]
    verdicts += [Verdict("areas", name, 1e-15, life=0.0) for name in bare]
    pulses = {kernel.OURS: timing(1.0), "C, the same polynomial": timing(0.95), kernel.ROOTS: timing(0.6)}
    loops = {kernel.OURS: timing(1.0), kernel.NUMBA: timing(3.0)}
    kept = [each.name for each in in_memory(ENGINES)]
    verdicts += [Verdict("in memory", name, 1e-15, life=0.0) for name in kept]
    points = {"count": FULL.counts, "ticks": FULL.ticks, "length": FULL.lengths}
    return Results(
        plan=FULL,
        machine=("a processor", "some versions"),
        engines=ENGINES,
        verdicts=(*verdicts, *(Verdict("births", each.name, life=0.0) for each in births())),
        runs=whole,
        areas=bare,
        births={each.name: timing(16.0) for each in births()},
        kernel=KernelTimings(pulses, dict.fromkeys(pulses, 1e-15)),
        kernel_over_ticks=dict.fromkeys(FULL.kernel_ticks, KernelTimings(loops, dict.fromkeys(loops, 1e-15))),
        motion=MotionTimings({"lsim": timing(5.0), motion.OURS: timing(0.1)}, {"lsim": 1e-5, motion.OURS: 1e-14}),
        two_way={count: coupled(2.5) for count in two_way.MEAN_COUNTS},
        off_centre={contact: passes(1.25) for contact in off_centre.CONTACTS},
        growth={what: {name: dict.fromkeys(p, each) for name, each in whole.items()} for what, p in points.items()},
        in_memory={name: dict.fromkeys(FULL.ticks, timing(0.5)) for name in kept},
        memory={name: dict.fromkeys(FULL.memory, 150.0) for name in whole},
        startup=dict.fromkeys((startup.HELP, startup.RUN, startup.FIRST), startup.Wait(0.1, 0.1)),
    )


def test_tasks_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = count()
    monkeypatch.setattr(clock, "cpu_time", lambda: float(next(ticks) ** 2))
    turns: list[str] = []
    tasks = {name: Task(lambda name=name: turns.append(name), 2.0) for name in "ABC"}
    found = interleaved(tasks, repeats=3)
    assert "".join(turns) == "ABCABCABC"
    assert found["A"].seconds == (1.0, 13.0, 25.0)
    assert found["A"].each == 6.5
    assert found["A"].spread == pytest.approx(12.0 / 13.0)


def test_ratios_are_of_the_same_call() -> None:
    text = page(results(batch=2.0), date(2026, 11, 21))
    assert "21 November 2026: a processor." in text
    assert "| rubnoise, batch | 2 | 0 % | 1 |" in text
    assert "| naive SimPy, RK4 | 110 | 0 % | 55 |" in text


def test_what_is_not_measured_is_said_to_be_missing() -> None:
    right, words = results(), "There is no gcc here"
    timings = {name: each for name, each in right.kernel.timings.items() if name != "C, the same polynomial"}
    without = page(replace(right, kernel=replace(right.kernel, timings=timings)), date(2026, 11, 21))
    assert words in without
    assert words not in page(right, date(2026, 11, 21))


def _wrong_kernel(error: float | None) -> Results:
    right = results()
    errors = right.kernel.errors | {kernel.OURS: error}
    return replace(right, kernel=replace(right.kernel, errors={k: e for k, e in errors.items() if e is not None}))


def _wrong_slider(name: str, error: float) -> Results:
    right = results()
    return replace(right, motion=replace(right.motion, errors=right.motion.errors | {name: error}))


def _wrong_coupling(name: str, error: float | None) -> Results:
    right = results()
    few = right.two_way[5.0]
    errors = {who: each for who, each in (few.errors | {name: error}).items() if each is not None}
    return replace(right, two_way=right.two_way | {5.0: replace(few, errors=errors)})


WRONG = {
    "our two-way slider": (
        _wrong_coupling(two_way.OURS, 2e-9),
        "two-way slider, rubnoise, batch: the displacement is off by 2.0e-09, more than 1e-09",
    ),
    "a two-way peer unchecked": (
        _wrong_coupling(two_way.SOLVER, None),
        "two-way slider, solve_ivp, numpy force: the displacement was never checked",
    ),
    "an area": (results(area_error=1e-3), "the area is off by 1.0e-03, more than 1e-09"),
    "no number": (results(area_error=float("nan")), "the area is off by nan"),
    "the kernel's area": (_wrong_kernel(4e-2), "pulse kernel, rubnoise: the area is off by 4.0e-02, more than 1e-09"),
    "the kernel's area unchecked": (_wrong_kernel(None), "pulse kernel, rubnoise: the area was never checked"),
    "a slider": (_wrong_slider("lsim", 0.5), "slider, lsim: the displacement is off by 5.0e-01, more than 1e-02"),
    "our slider": (_wrong_slider(motion.OURS, 1e-5), "slider, rubnoise: the displacement is off by 1.0e-05"),
    "no verdict at all": (replace(results(), verdicts=results().verdicts[1:]), "runs, rubnoise, batch: never checked"),
    "no motion": (
        replace(results(), verdicts=(replace(results().verdicts[0], motion=None), *results().verdicts[1:])),
        "221 ticks a life: the motion was never checked",
    ),
}


@pytest.mark.parametrize("what", WRONG)
@pytest.mark.parametrize("options", [["--quick"], ["--output"]], ids=["printed", "written"])
def test_nothing_is_written_where_anything_is_wrong(
    what: str, options: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    found, sentence = WRONG[what]
    monkeypatch.setattr("bench.results.measured", lambda *_: found)
    assert program.main([*options, *([str(tmp_path)] if options == ["--output"] else [])]) == 1
    output, error = capsys.readouterr()
    assert not output
    assert "bench: wrong: " in error
    assert sentence in error
    assert not list(tmp_path.iterdir())
    with pytest.raises(Wrong):
        page(found, date(2026, 11, 21))


def test_time_is_not_taken_of_what_is_wrong(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("bench.checks.verdicts", lambda *_: [Verdict("runs", "a peer", 1e-3, 0.0, 0.0)])
    monkeypatch.setattr("bench.machine.described", lambda **_: ("", ""))
    monkeypatch.setattr("bench.speed.timed", lambda *_: pytest.fail("time was taken"))
    with pytest.raises(Wrong, match="runs, a peer, 20 junctions, 221 ticks a life: the area is off"):
        results_module.measured(QUICK, tmp_path, lambda _: None)


def test_the_page_and_its_picture_are_written_where_asked(
    tmp_path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("bench.results.measured", lambda *_: results())
    assert program.main(["--output", str(tmp_path)]) == 0
    text = (tmp_path / "performance.md").read_text(encoding="utf-8")
    assert "](pictures/performance.png)" in text
    assert (tmp_path / "pictures" / "performance.png").read_bytes().startswith(PNG)
    assert "written" in capsys.readouterr().out


# The cost of a sweep is printed only if all its runs are there and right.

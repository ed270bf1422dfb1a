"""The benchmark: its judge, what it makes of its numbers, a page and a picture."""

import re
import shutil
from dataclasses import replace
from datetime import date
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from bench import __main__ as program
from bench import checks, clock, kernel, motion, off_centre, ours, startup, two_way
from bench import results as results_module
from bench.case import Case, Drawn, Given, Output
from bench.checks import Truth, Verdict, Wrong, judged, relative_error, whole_run
from bench.clock import Task, Timing, interleaved
from bench.entrants import AREAS, BIRTHS, IN_MEMORY, RUNS, Entrant
from bench.kernel import KernelTimings
from bench.motion import MotionTimings
from bench.off_centre import OffCentreTimings
from bench.page import page
from bench.peers import c_kernel, naive_numpy, sliders
from bench.plan import FULL, QUICK
from bench.results import Results
from bench.two_way import CoupledTimings

# The benchmark's judge: a right result passes, and one that is a little wrong does not.
ELSEWHERE = {"peers.superposed"}
"""Their libraries are in the benchmark's environment only."""

HERE = [each for each in (*RUNS, *AREAS) if each.module not in ELSEWHERE]


@pytest.fixture(scope="module")
def known() -> Truth:
    return checks.truth(Case(junctions=30))


@pytest.mark.parametrize("entrant", HERE, ids=lambda each: f"{each.function} {each.name}")
def test_who_is_right_passes(entrant: Entrant, known: Truth, tmp_path: Path) -> None:
    whole = entrant.function == "run"
    given = Given(known.birth, known.diameter)
    made = whole_run(entrant, known, tmp_path) if whole else entrant.call(known.case, given)
    verdict = judged("runs" if whole else "areas", entrant.name, made, known)
    assert verdict.passed, list(verdict.faults())
    assert (verdict.motion is not None) == whole
    assert None not in (verdict.area, verdict.life)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda made: replace(made, area=made.area * (1.0 + 1e-8)),
        lambda made: replace(made, area=np.roll(made.area, 1)),
        lambda made: replace(made, area=made.area[:-1]),
        lambda made: replace(made, area=np.full_like(made.area, np.nan)),
        lambda made: replace(made, displacement=1.02 * made.displacement),
        lambda made: replace(made, birth=made.birth[1:], death=made.death[1:]),
        lambda made: replace(made, death=made.death + 1e-6),
        lambda made: replace(made, area=None),
        lambda made: replace(made, displacement=None),
        lambda _: Output(),
    ],
    ids=["scaled", "late", "short", "no number", "another motion", "one less", "longer lives", "no area", "still", "-"],
)
def test_who_is_wrong_does_not(wrong, known: Truth, tmp_path: Path) -> None:
    made = naive_numpy.run(known.case, Given(known.birth, known.diameter), tmp_path / "run.h5")
    assert judged("runs", "peer", made, known).passed
    assert not judged("runs", "peer", wrong(made), known).passed


def test_rubnoise_has_to_move_right_to_nine_digits(known: Truth) -> None:
    record = ours.output(ours.in_memory(known.case, "events"), slider=True)
    assert judged("runs", "rubnoise, events", record, known).passed
    other = replace(record, displacement=record.displacement * (1.0 + 1e-8))
    assert not judged("runs", "rubnoise, events", other, known).passed
    assert judged("runs", "peer", other, known).passed


def test_methods_for_the_slider_err_as_they_should(known: Truth) -> None:
    errors = {
        name: relative_error(move(known.case, known.area), known.displacement) for name, move in motion.MOVERS.items()
    }
    errors["exact"] = relative_error(sliders.solve_exactly(known.case, known.birth, known.diameter), known.displacement)
    assert errors.pop("exact") < 1e-5
    assert all(1e-7 < error < 1e-3 for error in errors.values()), errors


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")
@pytest.mark.parametrize("way", ["polynomial", "textbook"])
def test_the_kernels_in_c_are_right(way: str, known: Truth) -> None:
    total = np.zeros(known.area.size)
    c_kernel.deposit(way)(known.case, known.case.ticks, known.birth, known.diameter, total)
    assert relative_error(total, known.area) < checks.AREA_BOUND


def test_kernels_are_fed_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel, "CASE", Case(junctions=200))
    found = kernel.measured(repeats=1)
    assert not list(found.faults())
    assert {kernel.OURS, "numba loops"} <= set(found.timings)
    assert kernel.ROOTS not in found.errors


def test_rubnoise_is_right_at_every_number_of_ticks_and_junctions_that_is_timed(tmp_path: Path) -> None:
    ours_alone = next(each for each in RUNS if each.engine == "events")
    for case in (Case(20.0, 30.0, 60), Case(20.0, 2200.0, 20), Case(100.0, 220.0, 300)):
        given = checks.truth(case)
        verdict = judged("runs", ours_alone.name, whole_run(ours_alone, given, tmp_path), given)
        assert verdict.passed, list(verdict.faults())


@pytest.mark.parametrize("mean_count", [10.0, 1000.0])
def test_drawn_junctions_are_those_of_the_paper(mean_count: float) -> None:
    case = Case(mean_count=mean_count, junctions=40_000)
    draws = Drawn(case, seed=5)
    birth, many = draws.rows()
    gaps = np.array([draws.gap() for _ in range(40_000)])
    few = np.array([draws.diameter() for _ in range(40_000)])
    assert abs(birth.size - case.distance / case.mean_gap) <= 4.0 * np.sqrt(case.junctions)
    assert abs(gaps.mean() / case.mean_gap - 1.0) <= 4.0 / np.sqrt(gaps.size)
    for diameters in (many, few):
        assert abs(diameters.mean() - case.mean_diameter) <= 4.0 * case.diameter_std / np.sqrt(diameters.size)
        assert abs(diameters.std() / case.diameter_std - 1.0) <= 4.0 / np.sqrt(2.0 * diameters.size)


# What the benchmark makes of its numbers, and the cost of a sweep.
# What the benchmark makes of its numbers: medians, ratios, a page and a picture.
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
    whole = {each.name: timing(times.get(each.name, 110.0)) for each in RUNS}
    bare = {each.name: timing(9.0 if "rubnoise" not in each.name else 0.25) for each in AREAS}
    verdicts = [Verdict("runs", name, area_error, 1e-12, 0.0) for name in whole]
    verdicts += [Verdict("areas", name, 1e-15, life=0.0) for name in bare]
    pulses = {kernel.OURS: timing(1.0), "C, the same polynomial": timing(0.95), kernel.ROOTS: timing(0.6)}
    loops = {kernel.OURS: timing(1.0), kernel.NUMBA: timing(3.0)}
    kept = [each.name for each in IN_MEMORY]
    verdicts += [Verdict("in memory", name, 1e-15, life=0.0) for name in kept]
    points = {"count": FULL.counts, "ticks": FULL.ticks, "length": FULL.lengths}
    return Results(
        plan=FULL,
        machine=("a processor", "some versions"),
        verdicts=(*verdicts, *(Verdict("births", each.name, life=0.0) for each in BIRTHS)),
        runs=whole,
        areas=bare,
        births={each.name: timing(16.0) for each in BIRTHS},
        kernel=KernelTimings(pulses, dict.fromkeys(pulses, 1e-15)),
        kernel_over_ticks=dict.fromkeys(FULL.kernel_ticks, KernelTimings(loops, dict.fromkeys(loops, 1e-15))),
        motion=MotionTimings({"lsim": timing(5.0), motion.OURS: timing(0.1)}, {"lsim": 1e-5, motion.OURS: 1e-14}),
        two_way={count: coupled(2.5) for count in two_way.MEAN_COUNTS},
        off_centre={contact: passes(1.25) for contact in off_centre.CONTACTS},
        growth={what: {name: dict.fromkeys(p, each) for name, each in whole.items()} for what, p in points.items()},
        in_memory={name: dict.fromkeys(FULL.ticks, timing(0.5)) for name in kept},
        memory={name: dict.fromkeys(FULL.memory, 150.0) for name in whole},
        startup=dict.fromkeys((startup.HELP, startup.RUN, startup.FIRST), startup.Wait(0.1, 0.1)),
        beside=(startup.Beside(startup.RUN, timing(5.0), "import numba", timing(2.0)),),
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
    assert re.search(r"\| rubnoise run, 80 junctions \| \S+ \| import numba \| \S+ \| 2.5 \|", text)


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

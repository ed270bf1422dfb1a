"""What the benchmark makes of its numbers, and the cost of a sweep."""

from dataclasses import replace
from datetime import date
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Self

import pytest
from bench import __main__ as program
from bench import clock, kernel, motion, off_centre, startup, two_way
from bench import results as results_module
from bench.case import Case
from bench.checks import Verdict, Wrong
from bench.clock import Task, Timing, interleaved
from bench.entrants import CIW, areas, births, in_memory, runs
from bench.kernel import KernelTimings
from bench.motion import MotionTimings
from bench.off_centre import OffCentreTimings
from bench.page import number, page
from bench.picture import picture
from bench.plan import FULL, QUICK
from bench.results import Results
from bench.two_way import CoupledTimings

import rubnoise
from tests.architecture.sources import ROOT
from tools.studies import sweep_cost

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


def test_no_time_however_long_fails(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("bench.results.measured", lambda *_: results(batch=1e6))
    assert program.main(["--quick"]) == 0
    output, error = capsys.readouterr()
    assert output.startswith("# Performance\n")
    assert not error


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


def test_how_wrong_a_motion_is_stands_beside_its_time() -> None:
    right = results()
    coarse = [Verdict("runs", each.name, 1e-15, 4e-3, 0.0, Case(ticks_per_life=10.0)) for each in runs(ENGINES)]
    text = page(replace(right, verdicts=(*right.verdicts, *coarse[2:])), date(2026, 11, 21))
    assert f"| {coarse[-1].name} | 4e-03 | - | - | - |" in text
    assert "| rubnoise, batch | - | - | - | - |" in text


def test_a_two_way_slider_has_a_row_for_each_and_a_second_of_its_own() -> None:
    text = page(results(), date(2026, 11, 21))
    assert "| N_jm = 5 | us a junction | +- | times ours | s a second | junctions | error |" in text
    assert "| rubnoise, batch | 2.5 | 0 % | 1 | 0.0045 | 1 | 1e-10 | default |" in text
    assert "| solve_ivp, numpy force | 5e+03 | 0 % | 2e+03 | 9 | 1 | 1e-10 | 1e-13 |" in text


def test_junctions_off_the_centre_line_have_a_row_for_each_contact() -> None:
    text = page(results(), date(2026, 11, 21))
    assert "| area alone | 20 | 300 | 2 | 2.5 | 1.25 | 1e-15, 1e-11 |" in text
    wrong = replace(passes(1.25), errors={"area": 1e-11})
    with pytest.raises(Wrong) as raised:
        page(replace(results(), off_centre={off_centre.CONTACTS[-1]: wrong}), date(2026, 11, 21))
    assert [fault.split(": ")[1].split(" ")[1] for fault in raised.value.args] == ["area", "displacement"]


def test_the_page_names_the_closest_peer_and_the_largest_memory() -> None:
    text = page(results(), date(2026, 11, 21))
    assert "numba loops, RK4 comes closest in a whole run." in text
    assert "needs at most 150 MB" in text
    other = results()
    runs_of = other.runs | {"naive SimPy, RK4": timing(2.0)}
    assert "naive SimPy, RK4 comes closest" in page(replace(other, runs=runs_of), date(2026, 11, 21))


def test_the_page_and_its_picture_are_written_where_asked(
    tmp_path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("bench.results.measured", lambda *_: results())
    assert program.main(["--output", str(tmp_path)]) == 0
    text = (tmp_path / "performance.md").read_text(encoding="utf-8")
    assert "](pictures/performance.png)" in text
    assert (tmp_path / "pictures" / "performance.png").read_bytes().startswith(PNG)
    assert "written" in capsys.readouterr().out


def test_the_picture_draws_what_it_is_given() -> None:
    assert picture(results()) == picture(results())
    assert picture(results()) != picture(results(batch=2.0))


def test_a_quick_look_asks_less_of_everybody() -> None:
    for each in (*runs(ENGINES), *areas(ENGINES), *births()):
        assert QUICK.junctions(each) <= FULL.junctions(each)
    assert CIW in {each.name for each in births()}


def test_many_ticks_shorten_a_run_and_few_do_not() -> None:
    entrant = runs(ENGINES)[0]
    base = FULL.case(entrant)
    assert base.junctions == entrant.junctions
    assert FULL.case(entrant, ticks_per_life=2200.0).tick_count <= 2.01 * base.tick_count
    assert FULL.case(entrant, mean_count=1000.0).junctions == entrant.junctions


@pytest.mark.parametrize(
    ("value", "text"), [(0.123456, "0.123"), (1234.0, "1234"), (20_000.0, "2.0e+04"), (1e-5, "1.0e-05"), (0.0, "0")]
)
def test_numbers_have_three_digits(value: float, text: str) -> None:
    assert number(value) == text


# The cost of a sweep is printed only if all its runs are there and right.
SCENARIO = ROOT / "scenarios" / "paper" / "fig9.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of two points and two replicates."""
    place = tmp_path_factory.mktemp("sweep") / "folder"
    counts = "sweep.grid.interface.mean_junction_count=[10, 20]"
    changes = ["sweep.replicates=2", "sliding.distance=3 mm", "output.tick=0.5 um", counts]
    sweep = rubnoise.load_sweep(SCENARIO, changes)
    rubnoise.run_sweep(sweep, place, jobs=1).close()
    return place


def altered(monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
    """Let an opened sweep tell its standard deviations as so many times of what they are."""
    load = rubnoise.open_sweep

    class Altered:
        def __init__(self, sweep: rubnoise.SweepResult) -> None:
            self.sweep = sweep

        def __enter__(self) -> Self:
            return self

        def __exit__(self, *_: object) -> None:
            self.sweep.close()

        def to_xarray(self):
            grid = self.sweep.to_xarray()
            grid["real_contact_area_std"] = factor * grid["real_contact_area_std"]
            return grid

    monkeypatch.setattr(rubnoise, "open_sweep", lambda place: Altered(load(place)))


def test_right_runs_are_told(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sweep_cost.tell_spreads(folder)
    assert "worst of 2 points: " in capsys.readouterr().out


@pytest.mark.parametrize("factor", [3.0, float("nan")])
def test_wrong_runs_end_the_program(folder: Path, factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    altered(monkeypatch, factor)
    with pytest.raises(SystemExit, match="no costs of wrong runs"):
        sweep_cost.tell_spreads(folder)


def test_a_run_that_is_left_out_ends_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Made(SimpleNamespace):
        def __enter__(self) -> Self:
            return self

        def __exit__(self, *_: object) -> None: ...

    monkeypatch.setattr(rubnoise, "run_sweep", lambda *_, **__: Made(count=lambda state: 9 if state == "done" else 0))
    with pytest.raises(SystemExit, match="only 9 of 10 runs were made"):
        sweep_cost.swept(SCENARIO, 2, tmp_path, jobs=1)

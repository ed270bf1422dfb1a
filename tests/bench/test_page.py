"""What the benchmark makes of its numbers: medians, ratios, goals, a page and a picture."""

from datetime import date
from itertools import count

import pytest
from bench import __main__ as program
from bench import clock, kernel, motion, startup
from bench.checks import Verdict
from bench.clock import Task, Timing, interleaved
from bench.entrants import CIW, areas, births, runs
from bench.goals import goals
from bench.kernel import KernelTimings
from bench.motion import MotionTimings
from bench.page import number, page
from bench.picture import picture
from bench.plan import FULL, QUICK
from bench.results import Results

ENGINES = ("events", "batch")
PNG = b"\x89PNG"


def timing(microseconds: float) -> Timing:
    return Timing((1e-6 * microseconds,) * 3, 1.0)


def results(*, batch: float = 0.9, area_error: float = 1e-15) -> Results:
    """Return numbers that reach every goal, with everybody's time made up."""
    times = {"rubnoise, batch": batch, "rubnoise, events": 4.0, "numba loops, RK4": 3.0}
    whole = {each.name: timing(times.get(each.name, 110.0)) for each in runs(ENGINES)}
    bare = {each.name: timing(9.0 if "rubnoise" not in each.name else 0.25) for each in areas(ENGINES)}
    verdicts = [Verdict(name, area_error, 1e-12, 0.0) for name in whole]
    pulses = {kernel.OURS: timing(1.0), "C, the same polynomial": timing(0.95), kernel.ROOTS: timing(0.6)}
    points = {"count": FULL.counts, "ticks": FULL.ticks, "length": FULL.lengths}
    return Results(
        plan=FULL,
        machine=("a processor", "some versions"),
        engines=ENGINES,
        verdicts=(*verdicts, *(Verdict(each.name, life=0.0) for each in births())),
        runs=whole,
        areas=bare,
        births={each.name: timing(16.0) for each in births()},
        kernel=KernelTimings(pulses, dict.fromkeys(pulses, 1e-15)),
        motion=MotionTimings({"lsim": timing(5.0), motion.OURS: timing(0.1)}, {"lsim": 1e-5, motion.OURS: 1e-14}),
        growth={what: {name: dict.fromkeys(p, each) for name, each in whole.items()} for what, p in points.items()},
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


def test_every_goal_of_both_engines_is_on_the_page() -> None:
    text = page(results(), date(2026, 11, 21))
    wanted = list(goals(results()))
    assert len(wanted) == 14
    assert all(f"| {goal.what} |" in text for goal in wanted)
    assert "Every goal is reached here." in text
    assert "**no**" not in text
    assert "21 November 2026: a processor." in text


def test_a_goal_that_is_missed_is_said_to_be() -> None:
    slow = results(batch=9.0)
    missed = [goal.what for goal in goals(slow) if not goal.reached]
    assert missed == [
        "whole run: naive SimPy over `batch`",
        "whole run: superposed-pulses and lsim over `batch`",
        "Ciw's births and deaths over a whole run of `batch`",
    ]
    assert "Not reached here: 3 of 14." in page(slow, date(2026, 11, 21))
    assert page(slow, date(2026, 11, 21)).count("**no**") == 3


def test_ratios_are_of_the_same_call() -> None:
    found = {goal.what: goal.value for goal in goals(results(batch=2.0))}
    assert found["whole run: naive SimPy over `batch`"] == pytest.approx(55.0)
    assert found["Ciw's births and deaths over a whole run of `batch`"] == pytest.approx(8.0)
    assert found["pulse kernel: ours over C"] == pytest.approx(1.0 / 0.95)


@pytest.mark.parametrize(("area_error", "code"), [(1e-15, 0), (1e-3, 1)])
def test_only_a_wrong_answer_fails(
    area_error: float, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("bench.results.measured", lambda *_: results(batch=1e6, area_error=area_error))
    assert program.main(["--quick"]) == code
    output, error = capsys.readouterr()
    assert output.startswith("# Performance\n")
    assert ("bench: wrong" in error) == bool(code)


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

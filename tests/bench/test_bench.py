"""The benchmark: its judge, its draws, and the page that it makes of its numbers."""

from dataclasses import replace
from datetime import date
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from bench import __main__ as program
from bench import checks, measure, ours
from bench.case import Case, Drawn
from bench.checks import Truth, Verdict, Wrong, judged
from bench.measure import FULL, QUICK, RUNS, Entrant, Results, Task, Timing, interleaved
from bench.page import page
from bench.peers import naive_numpy

pytestmark = pytest.mark.slow

# The benchmark's judge: a right result passes, and one that is a little wrong does not.
HERE = [each for each in RUNS if each.module != "peers.superposed"]
"""That peer's library is in the benchmark's environment only."""


@pytest.fixture(scope="module")
def known() -> Truth:
    return checks.truth(Case(junctions=30))


@pytest.mark.parametrize("entrant", HERE, ids=lambda each: each.name)
def test_who_is_right_passes(entrant: Entrant, known: Truth, tmp_path: Path) -> None:
    entrant.call(known.case, known, tmp_path / "run.h5")
    assert list(judged(entrant.name, checks.written(tmp_path / "run.h5"), known).faults()) == []


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
    ],
    ids=["scaled", "late", "short", "no number", "another motion", "one less", "longer lives"],
)
def test_who_is_wrong_does_not(wrong, known: Truth, tmp_path: Path) -> None:
    naive_numpy.run(known.case, known, tmp_path / "run.h5")
    made = checks.written(tmp_path / "run.h5")
    assert not list(judged("peer", made, known).faults())
    assert list(judged("peer", wrong(made), known).faults())


def test_rubnoise_has_to_move_right_to_nine_digits(known: Truth) -> None:
    record = ours.output(ours.in_memory(known.case, "events"))
    assert not list(judged("rubnoise, events", record, known).faults())
    other = replace(record, displacement=record.displacement * (1.0 + 1e-8))
    assert list(judged("rubnoise, events", other, known).faults())
    assert not list(judged("peer", other, known).faults())


@pytest.mark.parametrize("mean_count", [10.0, 1000.0])
def test_drawn_junctions_are_those_of_the_paper(mean_count: float) -> None:
    case = Case(mean_count=mean_count, junctions=40_000)
    draws = Drawn(case, seed=5)
    birth, diameters = draws.rows()
    gaps = np.diff(birth, prepend=0.0)
    assert abs(birth.size - case.distance / case.mean_gap) <= 4.0 * np.sqrt(case.junctions)
    assert abs(gaps.mean() / case.mean_gap - 1.0) <= 4.0 / np.sqrt(gaps.size)
    assert abs(diameters.mean() - case.mean_diameter) <= 4.0 * case.diameter_std / np.sqrt(diameters.size)
    assert abs(diameters.std() / case.diameter_std - 1.0) <= 4.0 / np.sqrt(2.0 * diameters.size)


# What the benchmark makes of its numbers: medians, ratios and a page.
def timing(microseconds: float) -> Timing:
    return Timing((1e-6 * microseconds,) * 3, 1.0)


def results(*, batch: float = 0.9, area_error: float = 1e-15) -> Results:
    """Return right numbers, with made-up times of all tools."""
    whole = {each.name: timing(110.0) for each in RUNS} | {"rubnoise, batch": timing(batch)}
    cases = checks.cases(FULL.ticks)
    return Results(
        machine=("a processor", "some versions"),
        verdicts=tuple(Verdict(name, area_error, 1e-12, 0.0, case) for name in whole for case in cases),
        runs=whole,
        growth={name: dict.fromkeys(FULL.ticks, each) for name, each in whole.items()},
        memory={name: dict.fromkeys(FULL.memory, 150.0) for name in whole},
        waits={"rubnoise --help": (0.1, 0.1)},
    )


def test_tasks_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = count()
    monkeypatch.setattr(measure, "cpu_time", lambda: float(next(ticks) ** 2))
    turns: list[str] = []
    tasks = {name: Task(lambda name=name: turns.append(name), 2.0) for name in "ABC"}
    found = interleaved(tasks, repeats=3)
    assert "".join(turns) == "ABCABCABC"
    assert found["A"].seconds == (1.0, 13.0, 25.0)
    assert found["A"].each == 6.5
    assert found["A"].spread == pytest.approx(12.0 / 13.0)


def test_ratios_are_of_the_same_call_and_the_page_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = page(results(batch=2.0), date(2026, 11, 21))
    assert "21 November 2026: a processor." in text
    assert "| rubnoise, batch | 2 | 0 % | 1 |" in text
    assert "| naive SimPy, RK4 | 110 | 0 % | 55 |" in text
    monkeypatch.setattr(measure, "measured", lambda *_: results(batch=2.0))
    assert program.main(["--output", str(tmp_path)]) == 0
    assert "| naive SimPy, RK4 | 110 | 0 % | 55 |" in (tmp_path / "performance.md").read_text(encoding="utf-8")


WRONG = {
    "an area": (results(area_error=1e-3), "the area is off by 1.0e-03, more than 1e-09"),
    "no number": (results(area_error=float("nan")), "the area is off by nan"),
    "no verdict at all": (replace(results(), verdicts=results().verdicts[5:]), "rubnoise, batch: never checked"),
}


@pytest.mark.parametrize("what", WRONG)
def test_nothing_is_written_where_anything_is_wrong(
    what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    found, sentence = WRONG[what]
    monkeypatch.setattr(measure, "measured", lambda *_: found)
    assert program.main(["--output", str(tmp_path)]) == 1
    output, error = capsys.readouterr()
    assert not output
    assert "bench: wrong: " in error
    assert sentence in error
    assert not list(tmp_path.iterdir())


def test_time_is_not_taken_of_what_is_wrong(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(measure, "_verdicts", lambda *_: [Verdict("a peer", 1e-3, 0.0, 0.0)])
    monkeypatch.setattr(measure, "timed", lambda *_: pytest.fail("time was taken"))
    with pytest.raises(Wrong, match="a peer, 221 ticks a life: the area is off"):
        measure.measured(QUICK, tmp_path, lambda _: None)

"""The benchmark's judge: a right result passes, and one that is a little wrong does not."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench import checks, kernel, motion, ours
from bench.case import Case, Drawn, Given, Output
from bench.checks import Truth, judged, relative_error, whole_run
from bench.entrants import Entrant, areas, runs
from bench.peers import c_kernel, naive_numpy, sliders

from rubnoise.simulation.kernels.fine import FINEST

ELSEWHERE = {"peers.superposed"}
"""Their libraries are in the benchmark's environment only."""

HERE = [each for each in (*runs(("events",)), *areas(("events",))) if each.module not in ELSEWHERE]


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


def test_the_kernel_adds_every_life_also_those_too_short_for_series(monkeypatch: pytest.MonkeyPatch) -> None:
    case = Case(junctions=200, ticks_per_life=2.0 * FINEST)
    monkeypatch.setattr(kernel, "CASE", case)
    _, diameter = Drawn(case, seed=1).rows()
    assert 0 < (diameter < FINEST * case.tick).sum() < diameter.size
    found = kernel.measured(repeats=1)
    assert found.errors[kernel.OURS] <= checks.AREA_BOUND
    assert not list(found.faults())


def test_rubnoise_is_right_at_every_number_of_ticks_and_junctions_that_is_timed(tmp_path: Path) -> None:
    ours_alone = runs(("events",))[0]
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

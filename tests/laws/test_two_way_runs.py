"""Two-way sliders in whole runs: equal bits of both engines, and statistics against another program."""

from dataclasses import dataclass, replace
from math import hypot
from typing import Any

import numpy as np
import pytest
from scipy.special import stdtrit

from rubnoise.analysis.figures import expected_figure, summarise
from rubnoise.analysis.measured import Measured
from rubnoise.analysis.replicates import PooledEstimate, pooled, ratio_of_pairs
from rubnoise.model import Model
from rubnoise.scenario import load
from rubnoise.scenario.sweep import Case, points_of
from rubnoise.simulation.draws import Engine
from rubnoise.simulation.run import simulate
from tests.architecture.sources import ROOT
from tests.models import UNEQUAL, contents, model, recorded, run_to_end
from tools.studies import two_way as reference

# A two-way slider in whole runs: the contact of the one-way run, equal bits from both engines and after every cut.
TIMES = {("junctions", "birth_time"), ("junctions", "death_time")}
RUNS: dict[str, dict[str, Any]] = {
    "fig5": {"distance": 2000.0},
    "thin": {"distance": 1500.0, "count": 0.2},
    "empty": {"distance": 600.0, "start": "empty"},
    "regular": {"distance": 800.0, "births": "regular"},
    "gamma": {"distance": 400.0, "births": "gamma", "count": 5.0},
    "clustered": {"distance": 400.0, "births": "clustered", "count": 5.0},
    "unequal": {"distance": 1500.0, "strength": UNEQUAL, "speed": 10_000.0},
    "wide": {"distance": 800.0, "tick": 3.0},
}


def two_way(run: Model, **changes: Any) -> Model:
    assert run.slider is not None
    return replace(run, slider=replace(run.slider, coupling="two-way", **changes))


@pytest.mark.slow("gamma-events")
@pytest.mark.parametrize("engine", ["events", "batch"])
@pytest.mark.parametrize("changes", RUNS.values(), ids=RUNS)
def test_the_contact_is_that_of_the_one_way_run(changes: dict[str, Any], engine: Engine) -> None:
    run = model(**changes)
    there, here = contents(recorded(run, 3)), contents(recorded(two_way(run), 3, engine=engine))
    shared = [name for name in there if name[0] in {"junctions", "trace", "life_curve"} and name not in TIMES]
    assert len(shared) > 8
    assert all(here[name] == there[name] for name in shared)


@pytest.mark.parametrize("changes", RUNS.values(), ids=RUNS)
def test_engines_give_equal_bits(changes: dict[str, Any]) -> None:
    run = two_way(model(**changes))
    told, last = run_to_end(run, 3, engine="events")
    filled, end = run_to_end(run, 3, engine="batch")
    assert contents(told) == contents(filled)
    assert (last.ticks, last.junctions) == (end.ticks, end.junctions)


def test_first_passages_are_those_of_the_rows() -> None:
    """A birth or death lies between the rows of /slider in which the farthest distance so far passes it."""
    record = recorded(two_way(model(distance=1500.0, count=3.0)), 14)
    junctions, slider = record["junctions"], record["slider"]
    farthest = np.maximum.accumulate(slider["distance"])
    assert (np.diff(slider["distance"]) < 0.0).any()
    for event in ("birth", "death"):
        place, time = junctions[f"{event}_distance"], junctions[f"{event}_time"]
        assert np.array_equal(np.isnan(time), np.signbit(place) | (place > 1500.0))
        known = np.flatnonzero(~np.isnan(time) & (place < farthest[-1]))
        row = np.searchsorted(farthest, place[known])
        assert known.size > 100
        assert np.all(time[known] <= slider["time"][row] + 1e-9)
        assert np.all(time[known] >= slider["time"][np.maximum(row - 1, 0)] - 1e-9)
    assert (junctions["birth_time"][1:] >= junctions["birth_time"][:-1])[~np.isnan(junctions["birth_time"][:-1])].all()


def test_rows_are_uniform_in_time_and_landmarks_take_turns() -> None:
    record = recorded(two_way(model(distance=1000.0)), 5)
    slider, landmarks = record["slider"], record["landmarks"]
    assert slider["time"] == pytest.approx(np.arange(slider["time"].size) * 1e-4, rel=1e-14)
    assert slider["phase"].dtype == landmarks["kind"].dtype == np.uint8
    assert slider["distance"].size != record["trace"]["distance"].size
    assert 0.3 < (slider["phase"] == 1).mean() < 1.0
    assert landmarks["landmark"].tolist() == list(range(landmarks["kind"].size))
    kind = landmarks["kind"][np.isin(landmarks["kind"], (0, 1))]
    assert kind.size > 20
    assert (kind[1:] != kind[:-1]).all()


# Statistics of two-way runs on fields of their own, against reference values and those of another program.
POINTS = reference.kept()
NAMES = [f"{1e-3 * point['speed']:g} mm/s, {point['junctions']:g}" for point in POINTS]
FOUR_SIGMA = 1.0 - 3.1671241833119857e-05
"""Chance that a normal number lies no more than four standard deviations above its mean."""

FIELDS = 12


@dataclass(frozen=True, slots=True)
class Score:
    """A figure of some fields beside the reference, and by how much they may differ."""

    name: str
    difference: float
    bound: float

    @property
    def agrees(self) -> bool:
        return abs(self.difference) <= self.bound


def case_of(point: dict[str, Any], distance: float, coupling: str = "two-way", *changes: str) -> Case:
    """Return a point over a distance (um) on fields that the reference has not seen."""
    values = {
        "sliding.speed": f"{point['speed']} um/s",
        "sliding.distance": f"{distance} um",
        "interface.mean_junction_count": point["junctions"],
        "slider.coupling": coupling,
        "output.tick": "2 um",
        "run.seed": 21,
    }
    changes = (*(f"{key}={value}" for key, value in values.items()), *changes)
    return Case(values=values, scenario=load(ROOT / "scenarios" / "paper" / "fig5.toml", changes))


def figures_of(case: Case, fields: int) -> dict[str, list[float]]:
    """Return every figure of so many runs."""
    found: dict[str, list[float]] = {}
    for point in points_of([case], fields):
        model = point.scenario.model()
        for figure in summarise(_summed(model, point.seed)):
            found.setdefault(figure.name, []).append(figure.value)
    return found


def _summed(model: Model, seed: int) -> Measured:
    seen = Measured(model)
    simulate(model, seed, seen, engine="batch")
    return seen


def scores(point: dict[str, Any], found: dict[str, list[float]]) -> list[Score]:
    return [_score(name, point[name], pooled(name, found[name])) for name in reference.FIGURES]


def _score(name: str, known: list[float], seen: PooledEstimate) -> Score:
    """Return a score: four joint standard errors, ours by Student's law of few fields."""
    student = float(stdtrit(seen.runs - 1, FOUR_SIGMA))
    return Score(name, seen.value - known[0], hypot(student * seen.standard_error, 4.0 * known[1]))


def test_two_programs_agree() -> None:
    assert list(reference.disagreements(POINTS)) == []
    seconds = {(point["speed"], point["junctions"]): point["seconds"] for point in POINTS}
    assert seconds[1000.0, 20] >= 1000.0
    # A drive that is 1 % too fast is told by the displacement, which friction and spring alone decide, to 0.1 %.
    wrong = [{**point, "displacement_mean": [1.01 * point["displacement_mean"][0], 0.0]} for point in POINTS]
    assert list(reference.disagreements(wrong))


def of_figure_5() -> dict[str, Any]:
    return next(each for each in POINTS if (each["speed"], each["junctions"]) == (1000.0, 20))


@pytest.mark.slow
def test_another_slider_is_told_from_that_of_the_reference() -> None:
    """With a spring 5 % stiffer, or one-way, figures lie beyond the bound."""
    point = of_figure_5()
    stiffer = figures_of(case_of(point, 12e3, "two-way", "slider.stiffness=315 N/m"), FIELDS)
    assert "displacement_mean" in {score.name for score in scores(point, stiffer) if not score.agrees}
    one_way = figures_of(case_of(point, 12e3, "one-way"), FIELDS)["displacement_std"]
    assert not _score("displacement_std", point["displacement_std"], pooled("displacement_std", one_way)).agrees


MANY, SHARE = 24, 0.04
"""So many fields, each of this share of the length of one of the reference; Student's law of few would be wider."""
FAST = 1e5
"""From this speed (um/s) on one-way coupling, whose figures are exact, moves the slider alike on the same junctions."""


@pytest.mark.slow
@pytest.mark.parametrize("point", POINTS, ids=NAMES)
def test_longer_fields_agree_with_the_reference(point: dict[str, Any]) -> None:
    distance = SHARE * point["seconds"] * point["speed"] / point["runs"]
    cases = [case_of(point, distance, coupling, "output.tick=5 um") for coupling in ("two-way", "one-way")]
    found, one_way = (figures_of(case, MANY) for case in cases)
    ratio = ratio_of_pairs("displacement_std", found["displacement_std"], one_way["displacement_std"])
    told = [*scores(point, found), _score(reference.RATIO, point[reference.RATIO], ratio)]
    if point["speed"] >= FAST:
        model = cases[1].scenario.model()
        beside = {name: _beside(name, found, one_way, model) for name in EXACT}
        told += [_score(name, point[name], each) for name, each in beside.items()]
        wrong = {name: [1.2 * point[name][0], point[name][1]] for name in EXACT}
        assert not any(_score(name, wrong[name], each).agrees for name, each in beside.items())
    assert [score for score in told if not score.agrees] == []


EXACT = ("displacement_mean", "displacement_std", "velocity_std")


def _beside(name: str, found: dict[str, list[float]], one_way: dict[str, list[float]], model: Model) -> PooledEstimate:
    """Return a figure from how it differs from that of one-way coupling on the same fields, which is known."""
    exact = expected_figure(model, name)
    if name == "displacement_mean":
        apart = pooled(name, np.subtract(found[name], one_way[name]).tolist())
        return replace(apart, value=apart.value + exact)
    ratio = ratio_of_pairs(name, found[name], one_way[name])
    return replace(ratio, value=ratio.value * exact, standard_error=ratio.standard_error * exact)

"""Statistics of two-way runs on fields of their own, against reference values and those of another program.

`tests/reference/coupling.json` holds the values of the sweep scenarios/studies/coupling_reference.toml, taken from its
folder by `tools/studies two_way --reference DIR`; `two_way.json` comes from elsewhere.
"""

from dataclasses import dataclass
from math import hypot
from typing import Any

import pytest
from scipy.special import stdtrit

from rubnoise.analysis.replicates import Estimate, pooled, ratio_of_pairs
from rubnoise.analysis.summary import summarise
from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.scenario import load
from rubnoise.scenario.points import Case, points_of
from rubnoise.simulation.run import simulate
from tests.architecture.sources import ROOT
from tools.studies import two_way_reference as reference

POINTS = reference.kept()
NAMES = [f"{1e-3 * point['speed']:g} mm/s, {point['junctions']:g}" for point in POINTS]
FOUR_SIGMA = 1.0 - 3.1671241833119857e-05
"""Chance that a normal number lies no more than four standard deviations above its mean."""

BRIEF = {(300.0, 20): 6e3, (1000.0, 20): 12e3, (10_000.0, 20): 20e3, (1000.0, 5): 20e3, (1000.0, 2): 40e3}
"""Points for every day, by speed (um/s) and junctions, and how far (um) they run on each of so many fields."""
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
        for figure in summarise(model, _tally(model, point.seed)):
            found.setdefault(figure.name, []).append(figure.observed)
    return found


def _tally(model: Model, seed: int) -> Tally:
    tally = Tally.of(model)
    simulate(model, seed, tally, engine="batch")
    return tally


def scores(point: dict[str, Any], found: dict[str, list[float]]) -> list[Score]:
    return [_score(name, point[name], pooled(name, found[name])) for name in reference.FIGURES]


def _score(name: str, known: list[float], seen: Estimate) -> Score:
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


def test_values_that_disagree_are_not_taken() -> None:
    wrong = [{**point, "velocity_std": [1.05 * point["velocity_std"][0], 1.0]} for point in POINTS]
    before = reference.KEPT.read_bytes()
    with pytest.raises(ValueError, match=r"velocity_std at \(1000.0, 20\)"):
        reference.keep(wrong)
    assert reference.KEPT.read_bytes() == before


def test_the_page_has_the_table_of_the_reference() -> None:
    page = (ROOT / "docs" / "two-way.md").read_text(encoding="utf-8")
    assert "\n".join(["<!-- generated: reference -->", "", *reference.table(POINTS), ""]) in page


@pytest.mark.parametrize("value", [(0.741322, 0.00152, "0.7413(15)"), (4057.83, 24.6, "4058(25)"), (2.0, 0.0, "2")])
def test_errors_stand_in_the_last_digits(value: tuple[float, float, str]) -> None:
    assert reference.in_digits(*value[:2]) == value[2]


def of_figure_5() -> dict[str, Any]:
    return next(each for each in POINTS if (each["speed"], each["junctions"]) == (1000.0, 20))


@pytest.mark.parametrize("place", BRIEF, ids=lambda place: f"{1e-3 * place[0]:g} mm/s, {place[1]}")
def test_a_few_fields_agree_with_the_reference(place: tuple[float, int]) -> None:
    point = next(each for each in POINTS if (each["speed"], each["junctions"]) == place)
    found = figures_of(case_of(point, BRIEF[place]), FIELDS)
    assert [score for score in scores(point, found) if not score.agrees] == []


def test_another_slider_is_told_from_that_of_the_reference() -> None:
    """With a spring 5 % stiffer, or one-way, figures lie beyond the bound."""
    point = of_figure_5()
    stiffer = figures_of(case_of(point, 12e3, "two-way", "slider.stiffness=315 N/m"), FIELDS)
    assert "displacement_mean" in {score.name for score in scores(point, stiffer) if not score.agrees}
    one_way = figures_of(case_of(point, 12e3, "one-way"), FIELDS)["displacement_std"]
    assert not _score("displacement_std", point["displacement_std"], pooled("displacement_std", one_way)).agrees


@pytest.mark.parametrize("point", POINTS, ids=NAMES)
def test_fields_as_long_agree_with_the_reference(point: dict[str, Any]) -> None:
    distance = point["seconds"] * point["speed"] / point["runs"]
    found, one_way = (figures_of(case_of(point, distance, coupling), 6) for coupling in ("two-way", "one-way"))
    ratio = ratio_of_pairs("displacement_std", found["displacement_std"], one_way["displacement_std"])
    told = [*scores(point, found), _score(reference.RATIO, point[reference.RATIO], ratio)]
    assert [score for score in told if not score.agrees] == []

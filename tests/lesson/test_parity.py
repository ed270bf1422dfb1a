"""The page's model beside the package's on the same junctions: area below 1e-9 um^2, count, slider."""

from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

import rubnoise
from rubnoise.contact.off_centre import OFF_CENTRE_LENS, area_of, half_life
from rubnoise.contact.pulses import PULSES
from rubnoise.lesson.replay import record_of
from tests.lesson.node import answer
from tests.lesson.worlds import scenario_of, world_with

REPLAY = """
rub.begin({ world, distance: 400, sliderStart: 'equilibrium', record });
rub.run.renew({ keep: false });
rub.run.goTo(record.distance);
const { trace } = rub.run;
const column = (name) => trace[name].subarray(0, trace.ready);
return { area: column('area'), count: column('count'), force: column('force'), displacement: column('displacement'),
  velocity: column('velocity'), rows: trace.rows, end: rub.run.end };
"""
LARGEST_AREA_ERROR = 1e-9  # um^2
LARGEST_MOTION_ERROR = 2e-6  # of the largest motion: the force between two ticks is not quite a parabola
SLOW_MOTION_ERROR = 2e-4  # where a tick lasts half a radian of the slider's own motion
SLOW = {"speed": 50.0}

AREAS = "return since.map((s, i) => rub.model.pulses[shape].area(s, diameters[i]));"
OFF_CENTRE = """
const { area, between } = rub.model.pulses.offCentre;
return since.map((s, i) => [area(s, diameters[i], offsets[i]), between(s, s + step, diameters[i], offsets[i])]);
"""


@pytest.mark.parametrize("shape", ["lens", "triangle"])
def test_one_life_has_the_same_area(shape: str) -> None:
    source = np.random.default_rng(20)
    diameters = source.uniform(0.01, 50.0, 400)
    since = source.uniform(0.001, 1.999, 400) * diameters
    found = answer(AREAS, shape=shape, since=since.tolist(), diameters=diameters.tolist())
    np.testing.assert_allclose(found, PULSES[shape].area(since, diameters), rtol=1e-10, atol=1e-11)


def test_a_pass_off_the_centre_line_has_the_same_area() -> None:
    source = np.random.default_rng(21)
    diameters = source.uniform(0.5, 50.0, 400)
    offsets = source.uniform(-1.0, 1.0, 400) * diameters
    life, step = 2.0 * half_life(diameters, offsets), 0.01
    since = source.uniform(0.001, 1.0, 400) * (life - step)
    given = {"since": since.tolist(), "diameters": diameters.tolist(), "offsets": offsets.tolist(), "step": step}
    found = np.array(answer(OFF_CENTRE, **given))
    expected = area_of(OFF_CENTRE_LENS, since, diameters, offsets)
    np.testing.assert_allclose(found[:, 0], expected, rtol=1e-9, atol=1e-10)
    for (d, b), start, sum_found in zip(zip(diameters, offsets, strict=True), since[:40], found[:40, 1], strict=False):
        expected_sum = quad(lambda s, d=d, b=b: float(area_of(OFF_CENTRE_LENS, s, d, b)), start, start + step)[0]
        assert sum_found == pytest.approx(expected_sum, rel=1e-7)
    centred = PULSES["lens"].area(since, diameters)
    assert np.median(np.abs(centred - expected) / expected) > 0.1, "a pass through both centres would be noticed"


def test_a_life_begins_and_ends_as_the_power_of_one_and_a_half() -> None:
    age = np.array([1e-12, 1e-10, 1e-8])
    expected = (2.0 * sqrt(2.0) / 3.0) * sqrt(5.0) * age**1.5
    since = [*age.tolist(), *(10.0 - age).tolist(), 0.0, 10.0, -1.0, 11.0]
    found = answer(AREAS, shape="lens", since=since, diameters=[5.0] * len(since))
    np.testing.assert_allclose(found[:3], expected, rtol=1e-6)
    np.testing.assert_allclose(found[4:6], expected[1:], rtol=1e-4)
    assert found[6:] == [0.0] * 4


def replayed(world: dict[str, Any], folder: Path) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]:
    """Return what the page makes of a run of the package, and the run."""
    with rubnoise.run(scenario_of(world, distance=400.0), folder / "run.h5") as run:
        columns = {
            "area": run.trace["real_contact_area"][:],
            "count": run.trace["junction_count"][:],
            "force": run.trace["friction_force"][:],
            "displacement": run.groups()["slider"]["displacement"][:],
            "velocity": run.groups()["slider"]["velocity"][:],
            "birth": run.junctions["birth_distance"][:],
            "diameter": run.junctions["diameter"][:],
            "death": run.junctions["death_distance"][:],
        }
        return answer(REPLAY, world=world, record=record_of(run)), columns


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"births": "regular", "spread": 1.0},
        {"pulse": "triangle", "calibration": "exact"},
        {"damping": 5.0},
        SLOW,
        {"meanCount": 2.0, "stiffness": 3000.0},
        {"offset": "uniform", "calibration": "exact", "spread": 1.0},
    ],
    ids=str,
)
def test_a_replayed_run_is_the_run(changes: dict[str, Any], tmp_path: Path) -> None:
    page, run = replayed(world_with(**changes), tmp_path)
    assert page["end"] == 400.0
    assert [row["birth"] for row in page["rows"]] == run["birth"].tolist()
    assert [row["diameter"] for row in page["rows"]] == run["diameter"].tolist()
    np.testing.assert_allclose([row["death"] for row in page["rows"]], run["death"], rtol=0.0, atol=1e-11)
    assert np.abs(np.array(page["area"]) - run["area"]).max() < LARGEST_AREA_ERROR
    assert page["count"] == run["count"].tolist()
    np.testing.assert_allclose(page["force"], run["force"], atol=250.0 * LARGEST_AREA_ERROR)
    for name in ("displacement", "velocity"):
        error = np.abs(np.array(page[name]) - run[name]).max()
        assert error < (SLOW_MOTION_ERROR if changes == SLOW else LARGEST_MOTION_ERROR) * np.abs(run[name]).max(), name


def test_another_junction_would_be_noticed(tmp_path: Path) -> None:
    page, run = replayed(world_with(), tmp_path)
    assert np.abs(np.array(page["area"]) * (1.0 + 1e-10) - run["area"]).max() > LARGEST_AREA_ERROR


def test_a_long_run_is_cut_where_the_page_is_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rubnoise.lesson.replay.MOST_ROWS", 100)
    page, run = replayed(world_with(), tmp_path)
    assert len(page["rows"]) == 100
    assert page["end"] == run["birth"][100]
    ticks = len(page["area"])
    assert np.abs(np.array(page["area"])[: ticks - 3] - run["area"][: ticks - 3]).max() < LARGEST_AREA_ERROR

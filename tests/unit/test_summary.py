"""The figures of a run beside the exact ones: which there are, and when a standard error is promised."""

from dataclasses import replace
from typing import Any

import pytest

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.summary import FEWEST_LIVES, missing_for_motion, summarise
from rubnoise.contact.laws import Fixed, Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.simulation.run import simulate
from rubnoise.theory.motion_errors import motion_errors
from rubnoise.theory.response import response
from tests.models import FIG5_SLIDER, bare, model
from tests.verification.seeds import seed_of

AREA = [
    "real_contact_area_mean",
    "real_contact_area_std",
    "real_contact_area_skewness",
    "real_contact_area_excess_kurtosis",
    "junction_count_mean",
    "junction_count_std",
]
FORCE = ["friction_force_mean", "friction_force_std"]
MOTION = ["displacement_mean", "displacement_std", "velocity_std", "one_way_validity"]


def _tally(run: Model, seed: int = 1) -> Tally:
    tally = Tally()
    simulate(run, seed, tally)
    return tally


def _figures(run: Model, tally: Tally | None = None) -> dict[str, Agreement]:
    return {figure.name: figure for figure in summarise(run, _tally(run) if tally is None else tally)}


@pytest.mark.parametrize(
    ("run", "names"),
    [
        (bare(), AREA),
        (model(slider=None, speed=None), AREA + FORCE),
        (model(slider=None), AREA + FORCE),
        (model(), AREA + FORCE + MOTION),
    ],
    ids=["contact", "force", "force in time", "slider"],
)
def test_what_a_run_has_is_summarised_in_order(run: Model, names: list[str]) -> None:
    assert list(_figures(run)) == names


def test_exact_values_are_those_of_figure_5() -> None:
    figures = _figures(model(distance=1000.0))
    expected = {
        "real_contact_area_mean": 204.6736,
        "real_contact_area_std": 56.42936,
        "junction_count_mean": 20.0,
        "friction_force_mean": 51168.4,
        "friction_force_std": 14107.34,
        "displacement_std": 195.3059,
        "velocity_std": 47241.1,
        "one_way_validity": 47.2411,
    }
    assert {name: figures[name].expected for name in expected} == pytest.approx(expected, rel=1e-6)
    assert figures["one_way_validity"].observed == figures["velocity_std"].observed / 1000.0


def test_figures_are_those_of_the_tally() -> None:
    run = model()
    tally = _tally(run)
    figures = _figures(run, tally)
    area, place = tally.moments["real_contact_area"], tally.moments["displacement"]
    assert figures["real_contact_area_mean"].observed == area.mean
    assert figures["real_contact_area_excess_kurtosis"].observed == area.excess_kurtosis
    assert figures["junction_count_std"].observed == tally.moments["junction_count"].std
    assert figures["displacement_mean"].observed == place.mean


def test_force_and_area_are_off_by_the_same_score() -> None:
    figures = _figures(model(slider=None, distance=1000.0))
    for end in ("mean", "std"):
        assert figures[f"friction_force_{end}"].z == pytest.approx(figures[f"real_contact_area_{end}"].z, rel=1e-9)


def _promised(run: Model) -> set[str]:
    return {name for name, figure in _figures(run).items() if figure.standard_error is not None}


def test_an_empty_start_promises_nothing() -> None:
    assert _promised(model(start="empty", distance=1000.0)) == set()


def test_regular_births_promise_their_means_alone() -> None:
    run = model(distance=1000.0, births="regular")
    means = {"real_contact_area_mean", "junction_count_mean", "friction_force_mean"}
    assert means <= _promised(run) <= means | {"displacement_mean"}
    assert all(abs(_figures(run)[name].z) <= 4.0 for name in means)


def test_a_constant_area_has_no_shape_to_expect() -> None:
    figures = _figures(bare(births="regular", pulse=TRIANGLE, spread=Spread(absolute=0.0)))
    assert figures["real_contact_area_std"].expected == 0.0
    assert figures["real_contact_area_std"].observed < 1e-12 * figures["real_contact_area_mean"].observed
    assert figures["real_contact_area_skewness"].expected is None
    assert figures["real_contact_area_mean"].z is None


def test_short_runs_promise_their_mean_alone() -> None:
    run = bare(tick=0.5)
    border = FEWEST_LIVES * run.mean_life_distance
    means = {"real_contact_area_mean", "junction_count_mean"}
    assert _promised(bare(tick=0.5, distance=border - 1.0)) == means
    longer = _promised(bare(tick=0.5, distance=border + 1.0))
    assert longer == {*means, *AREA[1:4]}


# Twice the mass over the damping is 0.2 s, so that ten decay times are 20 um at 10 um/s.
@pytest.mark.parametrize(
    ("changes", "promised"),
    [
        ({"speed": 10.0, "distance": 19.0}, False),
        ({"speed": 10.0, "distance": 21.0}, True),
        ({"distance": 500.0}, False),
        ({"speed": 10.0, "distance": 40.0, "start": "empty"}, False),
        ({"speed": 10.0, "distance": 40.0, "slider": replace(FIG5_SLIDER, damping=0.0)}, False),
    ],
    ids=["just too short", "just long enough", "short", "empty", "undamped"],
)
def test_motion_is_promised_after_ten_decay_times(changes: dict[str, Any], *, promised: bool) -> None:
    figures = _figures(model(**changes))
    assert {figures[name].standard_error is not None for name in MOTION} == {promised}


def test_a_run_too_short_for_its_motion_says_what_it_needs() -> None:
    """Over that length theory knows the standard deviation of the motion to a tenth."""
    short = model(distance=500.0)
    missing = missing_for_motion(short)
    assert missing is not None
    assert missing.decays == pytest.approx(2.5)
    errors, exact = motion_errors(short, missing.needed), response(short)
    relative = errors.displacement_std / exact.displacement_std, errors.velocity_std / exact.velocity_std
    assert max(relative) == pytest.approx(0.1)
    assert missing_for_motion(model(distance=missing.needed)) is None


def test_ten_decay_times_are_needed_at_least() -> None:
    """The motion of a stiff slider is known to a tenth before the first-order errors hold."""
    stiff = replace(FIG5_SLIDER, stiffness=3e5, damping=500.0)
    missing = missing_for_motion(model(distance=0.5, tick=0.1, slider=stiff, speed=30_000.0))
    assert missing is not None
    assert missing.needed >= 10.0 * 0.5 / missing.decays
    regular = missing_for_motion(model(distance=500.0, births="regular"))
    assert regular is not None
    assert regular.needed == pytest.approx(2000.0)  # of the mean alone


@pytest.mark.parametrize(
    "changes",
    [
        {"distance": 2000.0},
        {"start": "empty"},
        {"slider": replace(FIG5_SLIDER, damping=0.0)},
        {"slider": None},
    ],
    ids=["long", "empty", "undamped", "no slider"],
)
def test_nothing_is_missing_where_there_is_enough_or_no_length_would_do(changes: dict[str, Any]) -> None:
    assert missing_for_motion(model(**{"distance": 500.0} | changes)) is None


def test_a_run_agrees_with_its_theory_and_not_with_another() -> None:
    run = bare(distance=40_000.0, tick=0.5)
    tally = _tally(run, seed_of("summary/agreement"))
    promised = [figure for figure in summarise(run, tally) if figure.z is not None]
    assert len(promised) == 5
    assert all(abs(figure.z or 0.0) <= 4.0 for figure in promised)
    other = bare(distance=40_000.0, tick=0.5, area=215.0)
    score = _figures(other, tally)["real_contact_area_mean"].z
    assert score is not None
    assert score < -4.0


def test_the_force_of_another_strength_is_not_agreed_with() -> None:
    run = model(slider=None, distance=2000.0)
    tally = _tally(run, seed_of("summary/force"))
    assert abs(_figures(run, tally)["friction_force_mean"].z or 0.0) <= 4.0
    stronger = replace(run, strengths=Fixed(value=330.0))
    assert (_figures(stronger, tally)["friction_force_mean"].z or 0.0) < -4.0

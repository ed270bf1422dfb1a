"""The figures of a run beside the exact ones, and their scores."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rubnoise.analysis import findings
from rubnoise.analysis.comparison import compare
from rubnoise.analysis.figures import summarise
from rubnoise.analysis.measured import Measured
from rubnoise.analysis.moments import FEWEST_LIVES, forgetting, needed_for_motion
from rubnoise.answer import Row
from rubnoise.contact.distributions import Gamma, Lognormal, Weibull
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.simulation.run import simulate
from rubnoise.theory.motion import response
from rubnoise.theory.sampling import motion_errors
from rubnoise.theory.second_order import area_noise
from tests.laws.scores import seed_of
from tests.models import FIG5_SLIDER, bare, model, recorded
from tests.unit.theory_models import model_of

# The figures of a run beside the exact ones: which there are, and when a standard error is promised.
AREA = [
    "real_contact_area_mean",
    "real_contact_area_std",
    "real_contact_area_skewness",
    "real_contact_area_excess_kurtosis",
    "junction_count_mean",
    "junction_count_std",
]
MOTION = ["displacement_mean", "displacement_std", "velocity_std", "one_way_validity"]


def _seen(run: Model, seed: int = 1) -> Measured:
    seen = Measured(run)
    simulate(run, seed, seen)
    return seen


def _figures(run: Model) -> dict[str, Row]:
    return {each.name: each for each in summarise(_seen(run))}


def test_exact_values_are_those_of_figure_5() -> None:
    figures = _figures(replace(model(distance=1000.0), hardness=1e3))
    expected = {
        "real_contact_area_mean": 204.6736,
        "real_contact_area_std": 56.42936,
        "real_contact_area_skewness": 0.3188999,
        "real_contact_area_excess_kurtosis": 0.1098517,
        "junction_count_mean": 20.0,
        "junction_count_std": np.sqrt(20.0),
        "friction_force_mean": 51168.4,
        "friction_force_std": 14107.34,
        "friction_coefficient": 0.255842,
        "displacement_mean": 170.5613,
        "displacement_std": 195.3059,
        "velocity_std": 47241.1,
        "one_way_validity": 47.2411,
    }
    assert {name: each.exact for name, each in figures.items()} == pytest.approx(expected, rel=1e-6)
    assert figures["one_way_validity"].value == figures["velocity_std"].value / 1000.0


def _promised(run: Model) -> set[str]:
    return {name for name, each in _figures(run).items() if each.error is not None}


def test_a_short_run_from_an_empty_start_promises_nothing() -> None:
    assert _promised(model(start="empty", distance=500.0)) == set()


def test_the_start_is_forgotten_where_the_run_is_long_enough() -> None:
    """Figures are those of the last part of the rows, as in a comparison, and agree with theory."""
    run = bare(start="empty", distance=40_000.0, tick=0.5)
    seen, record = _seen(run, seed_of("summary/empty")), recorded(run, seed_of("summary/empty"))
    first, area, *others = forgetting(run)["trace"], *summarise(seen)
    assert area.value == pytest.approx(record["trace"]["real_contact_area"][first:].mean(), rel=1e-12)
    assert area.error == compare(run, record)["real_contact_area_mean"].error
    assert all(abs(each.z) <= 4.0 for each in (area, *others) if each.z is not None)


@pytest.mark.slow
def test_regular_births_promise_their_means_alone() -> None:
    run = model(distance=1000.0, births="regular")
    means = {"real_contact_area_mean", "junction_count_mean", "friction_force_mean"}
    assert means <= _promised(run) <= means | {"displacement_mean"}
    assert all(abs(_figures(run)[name].z) <= 4.0 for name in means)


@pytest.mark.slow
def test_a_constant_area_has_no_shape_to_expect() -> None:
    figures = _figures(bare(births="regular", pulse=TRIANGLE, spread=Spread(absolute=0.0)))
    assert figures["real_contact_area_std"].exact == 0.0
    assert figures["real_contact_area_std"].value < 1e-12 * figures["real_contact_area_mean"].value
    assert figures["real_contact_area_skewness"].exact is None
    assert figures["real_contact_area_mean"].z is None


def test_short_runs_promise_their_mean_alone() -> None:
    run = bare(tick=0.5)
    border = FEWEST_LIVES * run.mean_life_distance
    means = {"real_contact_area_mean", "junction_count_mean"}
    assert _promised(bare(tick=0.5, distance=border - 1.0)) == means
    longer = _promised(bare(tick=0.5, distance=border + 1.0))
    assert longer == {*means, *AREA[1:4]}


# Twice the mass over the damping is 0.2 s: at 10 um/s ten decay times are 20 um, after 14 um that forget the start.
@pytest.mark.parametrize(
    ("changes", "promised"),
    [
        ({"speed": 10.0, "distance": 33.0}, False),
        ({"speed": 10.0, "distance": 35.0}, True),
        ({"distance": 500.0}, False),
        ({"speed": 10.0, "distance": 40.0, "start": "empty"}, False),
        ({"speed": 10.0, "distance": 40.0, "slider": replace(FIG5_SLIDER, damping=0.0)}, False),
    ],
    ids=["just too short", "just long enough", "short", "empty", "undamped"],
)
def test_motion_is_promised_after_ten_decay_times(changes: dict[str, Any], *, promised: bool) -> None:
    figures = _figures(model(**changes))
    assert {figures[name].error is not None for name in MOTION} == {promised}


def test_a_run_too_short_for_its_motion_says_what_it_needs() -> None:
    """Over that length theory knows the standard deviation of the motion to a tenth."""
    short = model(distance=500.0)
    needed = needed_for_motion(short)
    assert needed is not None
    left = needed - forgetting(short)["slider"] * short.tick
    errors, exact = motion_errors(short, left), response(short)
    relative = errors["displacement_std"] / exact.displacement_std, errors["velocity_std"] / exact.velocity_std
    assert max(relative) == pytest.approx(0.1)
    assert needed_for_motion(model(distance=needed)) is None


def test_a_run_agrees_with_its_theory_and_not_with_another() -> None:
    run = bare(distance=40_000.0, tick=0.5)
    seen = _seen(run, seed_of("summary/agreement"))
    promised = [each for each in summarise(seen) if each.z is not None]
    assert len(promised) == 5
    assert all(abs(each.z or 0.0) <= 4.0 for each in promised)
    seen.model = bare(distance=40_000.0, tick=0.5, area=215.0)
    score = next(each.z for each in summarise(seen) if each.name == "real_contact_area_mean")
    assert score is not None
    assert score < -4.0


# Measured beside exact: scores, and the way into a file and back.
FULL = findings.figure("real_contact_area_mean", 206.0, 204.0, 0.5, unit="um^2")


def test_a_score_counts_standard_errors() -> None:
    assert FULL.z == 4.0


@pytest.mark.parametrize(
    ("below", "above", "z"),
    [(1.0, 0.0013499, 3.0), (0.0013499, 1.0, -3.0), (0.7, 0.6, 0.0), (0.0, 1.0, -37.05), (1.0, 0.0, 37.05)],
)
def test_a_deviate_has_the_tail_of_the_figure(below: float, above: float, z: float) -> None:
    assert findings.normal_deviate(below, above) == pytest.approx(z, abs=0.01)


def test_the_bound_of_a_family_is_bonferronis() -> None:
    from scipy.special import ndtr

    for count in (1, 40, 1000):
        assert 2.0 * count * ndtr(-findings.family_wise_bound(count)) == pytest.approx(1e-3)
    assert findings.family_wise_bound(10, 0.05) == pytest.approx(2.807, abs=1e-3)
    assert findings.family_wise_bound(0) == findings.family_wise_bound(1)


# Sums that their largest junctions rule: how skewed they are, and right runs that hold such a junction.
LENGTH = 5000.0


def births(model: Model) -> float:
    return model.birth_rate * LENGTH


def test_exponential_sizes_have_the_skewness_of_their_moments() -> None:
    """E[d^n] = n!; what is too rare for the record to hold is 1e-5 of a junction, and takes little from the third."""
    model = model_of(Weibull(mean=5.0, std=5.0), 5.0)
    assert findings.tail_of(model, LENGTH, 1).skewness == pytest.approx(6.0 / 2.0**1.5 / births(model) ** 0.5, rel=0.01)


@pytest.mark.slow
def test_sums_that_are_drawn_are_as_skewed() -> None:
    law = Gamma(mean=1.0, std=0.4)
    generator = np.random.default_rng(seed_of("tails/gamma"))
    numbers = generator.poisson(200.0, 10_000)
    cubes = law.quantile(generator.random(int(numbers.sum()))) ** 3
    sums = np.add.reduceat(cubes, np.concatenate([[0], np.cumsum(numbers)[:-1]]))
    z = (sums - sums.mean()) / sums.std()
    seen, error = float(np.mean(z**3)), float(np.std(z**3) / z.size**0.5)
    tail = findings.tail_of(model_of(law, 1.0, mean_count=2.0), 200.0, 3)
    assert abs(seen - tail.skewness) <= 4.0 * error
    assert abs(seen - findings.NORMAL.skewness) > 5.0 * error


def test_squares_of_a_wide_law_need_more_draws_than_those_of_a_narrow_one() -> None:
    wide = findings.tail_of_squares(Lognormal(mean=5.0, std=5.0), 5.0, 1000.0, 500.0)
    narrow = findings.tail_of_squares(Lognormal(mean=5.0, std=0.5), 5.0, 1000.0, 500.0)
    assert narrow.needed <= 500.0
    assert wide.needed > 500.0
    assert wide.skewness > narrow.skewness


def test_a_skewed_mean_is_scored_on_its_own_scale() -> None:
    tail = findings.Tail(skewness=0.3, needed=0.0)
    high, low = (findings.judged("x", value, 0.0, 1.0, length=10.0, skewness=0.0, tail=tail) for value in (5.0, -5.0))
    assert high.z == pytest.approx(10.0 * np.log1p(0.5))
    assert low.z == -5.0


@pytest.mark.slow
def test_a_right_run_that_holds_one_huge_junction_is_accepted() -> None:
    """Of some hundred such runs one has a mean that a normal law would call impossible."""
    run = replace(bare(distance=LENGTH, tick=2.0), sizes=Lognormal(mean=5.4772, std=3.834))
    record = recorded(run, 4862)
    found = compare(run, record)
    assert found.outside == ()
    assert "real_contact_area_mean" in found.left_out
    mean = float(record["trace"]["real_contact_area"].mean())
    assert mean - run.stationary_mean_area > 8.0 * area_noise(run).error_of_mean()


def test_a_row_of_an_answer_has_the_score_and_the_unit() -> None:
    row = {"value": 206.0, "unit": "um^2", "exact": 204.0, "error": 0.5, "z": 4.0}
    assert FULL.to_json() == row
    assert findings.figure("events", 73084.0, None, None).to_json() == {"value": 73084.0}

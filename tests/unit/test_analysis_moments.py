"""Moments of a record: their errors from theory and from batches, and when they are refused."""

from dataclasses import fields
from functools import cache

import numpy as np
import pytest

from rubnoise.analysis.moments import SampleMoments, needed_for_mean, over_ticks, sample_moments
from rubnoise.analysis.records import (
    FEWEST_BATCHES,
    Estimate,
    RecordTooShort,
    batch_length,
    error_of_mean,
    integrated_autocorrelation,
    longer,
)
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from tests.models import bare, recorded
from tests.unit.records import Doubles, memory, white
from tests.verification.seeds import seed_of

CONTACT = bare(tick=0.25, distance=5000.0)
SHORT = bare(tick=0.25, distance=800.0)
BOUND, REJECTED = 4.0, 5.0


@cache
def area(run: Model, name: str) -> Doubles:
    found: Doubles = recorded(run, seed_of(f"moments/{name}"))["trace"]["real_contact_area"]
    return found


def scores(found: SampleMoments, expected: tuple[float, ...]) -> list[float]:
    figures: list[Estimate] = [getattr(found, field.name) for field in fields(found)]
    return [(each.value - value) / each.standard_error for each, value in zip(figures, expected, strict=True)]


def values_of(run: Model) -> tuple[float, ...]:
    exact = area_cumulants(run)
    return exact.mean, exact.std, exact.skewness, exact.excess_kurtosis


@pytest.mark.parametrize("model", [CONTACT, None], ids=["theory", "batches"])
def test_moments_of_a_run_are_those_of_its_model(model: Model | None) -> None:
    found = sample_moments(area(CONTACT, "run"), CONTACT.tick, model)
    assert max(map(abs, scores(found, values_of(CONTACT)))) <= BOUND
    assert abs(scores(found, values_of(bare(area=230.0)))[0]) > REJECTED


def test_errors_from_theory_and_from_batches_agree() -> None:
    theory = sample_moments(area(CONTACT, "run"), CONTACT.tick, CONTACT)
    batches = sample_moments(area(CONTACT, "run"), CONTACT.tick)
    # 45 batches and more tell an error to some 10 %.
    assert batches.mean.standard_error == pytest.approx(theory.mean.standard_error, rel=0.4)
    assert batches.std.standard_error == pytest.approx(theory.std.standard_error, rel=0.4)


def test_errors_of_independent_values_are_the_textbook_ones() -> None:
    found = sample_moments(white(100_000, seed_of("white")), 1.0)
    assert found.mean.standard_error == pytest.approx(100_000**-0.5, rel=0.2)
    assert found.std.standard_error == pytest.approx(200_000**-0.5, rel=0.2)
    assert found.skewness.standard_error == pytest.approx((6.0 / 100_000) ** 0.5, rel=0.2)
    assert found.excess_kurtosis.standard_error == pytest.approx((24.0 / 100_000) ** 0.5, rel=0.25)


@pytest.mark.parametrize("model", [SHORT, None], ids=["theory", "batches"])
def test_a_short_record_is_refused_with_its_estimate_and_the_length_needed(model: Model | None) -> None:
    values = area(SHORT, "short")
    with pytest.raises(RecordTooShort, match=r"moments: 800\.25 um of sliding are too short") as refused:
        sample_moments(values, SHORT.tick, model)
    estimate = refused.value.estimate
    assert isinstance(estimate, SampleMoments)
    assert estimate.mean.value == pytest.approx(values.mean())
    assert refused.value.needed > 800.0
    assert refused.value.exit_code == 2


def test_what_is_needed_is_enough() -> None:
    with pytest.raises(RecordTooShort) as refused:
        sample_moments(area(SHORT, "short"), SHORT.tick, SHORT)
    ticks = int(1.02 * refused.value.needed / SHORT.tick)
    assert ticks < area(CONTACT, "run").size
    sample_moments(area(CONTACT, "run")[:ticks], SHORT.tick, SHORT)


def test_a_record_without_end_in_sight_says_so() -> None:
    with pytest.raises(RecordTooShort) as refused:
        sample_moments(np.arange(4.0), 1.0)
    assert refused.value.needed == float("inf")
    assert str(refused.value) == "moments: 4 um of sliding are too short for it"


def test_a_constant_has_no_error() -> None:
    found = sample_moments(np.full(1000, 7.0), 1.0)
    assert found.mean == Estimate(value=7.0, standard_error=0.0)
    assert found.excess_kurtosis == Estimate(value=0.0, standard_error=0.0)


def test_a_mean_needs_lives_and_births() -> None:
    dense, thin = bare(count=200.0), bare(count=0.5)
    assert needed_for_mean(dense) == 50.0 * dense.mean_life_distance
    assert needed_for_mean(thin) == 1000.0 * thin.mean_birth_spacing


def test_a_stretch_has_its_own_length() -> None:
    stretch = over_ticks(bare(start="empty"), 401, 0.5)
    assert (stretch.start, stretch.tick_count, stretch.distance) == ("stationary", 400, 200.0)


def test_errors_fall_as_one_over_the_root_of_the_length() -> None:
    assert longer(100.0, 0.3, 0.1) == pytest.approx(900.0)


# Batch means of a record whose autocorrelation is known.


def test_the_integrated_autocorrelation_is_that_of_the_law() -> None:
    found = integrated_autocorrelation(memory(200_000, seed_of("memory")))
    assert found == pytest.approx(1.9 / 0.1, rel=0.15)
    assert integrated_autocorrelation(white(200_000, seed_of("white"))) == pytest.approx(1.0, abs=0.1)


def test_batches_know_of_the_correlation() -> None:
    values = memory(200_000, seed_of("memory"))
    length = batch_length(values, 1.0, "mean", None)
    error = float(error_of_mean(values, length))
    assert error == pytest.approx((19.0 / 200_000) ** 0.5, rel=0.25)
    assert error > 3.0 * values.std() / values.size**0.5


def test_batches_are_many_and_long() -> None:
    values = memory(20_000, seed_of("memory"))
    length = batch_length(values, 1.0, "mean", None)
    assert 10.0 * integrated_autocorrelation(values) <= length <= values.size // FEWEST_BATCHES
    with pytest.raises(RecordTooShort, match=r"mean: 1000 um of sliding are too short for it; it needs about .* um"):
        batch_length(values[:1000], 1.0, "mean", None)

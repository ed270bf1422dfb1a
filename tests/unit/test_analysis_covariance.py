"""Autocovariances: of arrays, of streams, and their errors from theory and from batches."""

from functools import cache

import numpy as np
import pytest

from rubnoise.analysis.covariance import LaggedProducts, autocovariance
from rubnoise.analysis.moments import Covariances, covariance_errors, sample_covariances
from rubnoise.analysis.records import RecordTooShort
from rubnoise.model import Model
from rubnoise.theory import correlation
from rubnoise.theory.sampling import variance_of_time_mean
from tests.models import bare, recorded
from tests.unit.records import Doubles, memory
from tests.verification.seeds import seed_of

VALUES = memory(3000, seed_of("covariance"))
LAGS = (0, 1, 5, 40, 700, 2999)
CONTACT = bare(tick=0.25, distance=6000.0)
RUNS = 60


def naive(values: Doubles, lag: int) -> float:
    away = values - values.mean()
    return float((away[: values.size - lag] * away[lag:]).sum())


def test_an_array_is_what_the_definition_says() -> None:
    found = autocovariance(VALUES, 50)
    assert found == pytest.approx([naive(VALUES, j) / VALUES.size for j in range(51)], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("pieces", [1, 3, 40, 3000])
def test_a_stream_may_come_in_pieces(pieces: int) -> None:
    products = LaggedProducts(LAGS, 0.1)
    for piece in np.array_split(VALUES, pieces):
        products.add(piece)
    expected = [naive(VALUES, j) / (VALUES.size - j) for j in LAGS]
    assert products.covariances() == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_a_lag_beyond_the_record_has_no_value() -> None:
    products = LaggedProducts((1, 4), 0.0)
    products.add(np.array([1.0, 2.0, 3.0]))
    first, beyond = products.covariances()
    assert first == pytest.approx(0.0)
    assert np.isnan(beyond)


@cache
def area() -> Doubles:
    found: Doubles = recorded(CONTACT, seed_of("covariance/run"))["trace"]["real_contact_area"]
    return found


@pytest.mark.parametrize("model", [CONTACT, None], ids=["theory", "batches"])
def test_a_run_has_the_autocovariance_of_its_model(model: Model | None) -> None:
    found = sample_covariances(area(), CONTACT.tick, (4, 10, 20, 30, 40), model)
    bias = variance_of_time_mean(CONTACT)
    expected = correlation.autocovariance(CONTACT, found.lag) - bias
    assert np.max(np.abs(found.value - expected) / found.standard_error) <= 4.0
    other = correlation.autocovariance(bare(count=10.0), found.lag)
    assert np.max(np.abs(found.value - other) / found.standard_error) > 5.0


def values_at(lags: tuple[int, ...], row: Doubles) -> Doubles:
    products = LaggedProducts(lags, 200.0)
    products.add(row)
    return products.covariances()


def test_errors_are_the_spread_of_many_runs() -> None:
    run = bare(tick=0.5, distance=1500.0, count=5.0)
    lags = (2, 6, 12, 20)
    seeds = range(seed_of("covariance/spread"), seed_of("covariance/spread") + RUNS)
    rows = [recorded(run, seed)["trace"]["real_contact_area"] for seed in seeds]
    values = np.array([values_at(lags, row) for row in rows])
    errors = covariance_errors(run, run.tick * np.array(lags), 1500.0, run.tick)
    # A spread of 60 runs is known to 9 %, and a little worse for laws with long tails.
    assert values.std(axis=0, ddof=1) == pytest.approx(errors, rel=0.4)
    assert values.std(axis=0, ddof=1) != pytest.approx(0.5 * errors, rel=0.4)


@pytest.mark.parametrize("model", [CONTACT, None], ids=["theory", "batches"])
def test_a_short_record_is_refused_with_its_values(model: Model | None) -> None:
    with pytest.raises(RecordTooShort, match="autocovariance") as refused:
        sample_covariances(area()[:1000], CONTACT.tick, (4, 10), model)
    assert isinstance(refused.value.estimate, Covariances)
    assert refused.value.estimate.value.size == 2

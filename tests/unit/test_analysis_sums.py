"""Estimates of a stream are those of the whole record, in whatever pieces it comes."""

import numpy as np
import pytest

from rubnoise.analysis.covariance import CovarianceSum, LaggedProducts, autocovariance
from rubnoise.analysis.histogram import HistogramSum
from rubnoise.analysis.records import error_of_mean
from tests.unit.records import memory
from tests.verification.seeds import seed_of

VALUES = 200.0 + memory(70_001, seed_of("sums"))
EDGES = np.linspace(198.0, 203.0, 41)
PIECES = (1, 7, 131)


def _shares(parts: np.ndarray) -> np.ndarray:
    return np.stack([np.histogram(part, EDGES)[0] for part in parts]) / parts.shape[1]


@pytest.mark.parametrize("pieces", PIECES)
@pytest.mark.parametrize("reach", [1, 300, 3000])
def test_covariances_are_those_of_lagged_products(pieces: int, reach: int) -> None:
    found, slow = CovarianceSum(reach, 199.0), LaggedProducts(range(reach + 1), 199.0)
    for piece in np.array_split(VALUES, pieces):
        found.add(piece)
    slow.add(VALUES)
    assert found.covariances() == pytest.approx(slow.covariances(), rel=1e-10, abs=1e-10 * VALUES.var())


def test_covariances_are_those_of_the_whole_record_over_their_pairs() -> None:
    found = CovarianceSum(500, 200.0)
    found.add(VALUES)
    pairs = (VALUES.size - np.arange(501)) / VALUES.size
    assert found.covariances() * pairs == pytest.approx(autocovariance(VALUES, 500), abs=1e-10 * VALUES.var())


def test_asking_on_the_way_changes_nothing() -> None:
    asked, silent = CovarianceSum(200, 200.0), CovarianceSum(200, 200.0)
    for piece in np.array_split(VALUES, 50):
        asked.add(piece)
        silent.add(piece)
        asked.covariances()
    assert asked.covariances() == pytest.approx(silent.covariances(), abs=1e-12)


def test_a_lag_beyond_the_record_has_no_covariance() -> None:
    found, slow = CovarianceSum(9, 0.0), LaggedProducts(range(10), 0.0)
    for sums in (found, slow):
        sums.add(VALUES[:6])
    assert np.isnan(found.covariances()).tolist() == [False] * 6 + [True] * 4
    assert found.covariances()[:6] == pytest.approx(slow.covariances()[:6], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("pieces", PIECES)
def test_a_histogram_is_that_of_the_whole_record(pieces: int) -> None:
    found = HistogramSum(EDGES, 1000)
    for piece in np.array_split(VALUES, pieces):
        found.add(piece)
    seen = found.histogram()
    share = np.histogram(VALUES, EDGES)[0] / VALUES.size
    assert seen.density * np.diff(EDGES) == pytest.approx(share, abs=1e-15)
    assert seen.outside == pytest.approx(1.0 - share.sum(), abs=1e-14)
    assert seen.outside > 0.0
    error = error_of_mean(VALUES, 1000, _shares)
    assert seen.standard_error * np.diff(EDGES) == pytest.approx(error, rel=1e-10, abs=1e-12)


def test_values_at_edges_count_above_them_and_the_last_is_outside() -> None:
    found = HistogramSum(np.arange(5.0), 10)
    found.add(np.array([0.0, 1.0, 1.5, 3.0, 4.0, -1e-9, -5.0, 9.0]))
    assert (found.histogram().density * 8.0).tolist() == [1.0, 2.0, 0.0, 1.0]


def test_few_stretches_promise_no_errors() -> None:
    few, enough = HistogramSum(EDGES, 1000), HistogramSum(EDGES, 1000)
    few.add(VALUES[:29_999])
    enough.add(VALUES[:30_000])
    assert np.isinf(few.histogram().standard_error).all()
    assert np.isfinite(enough.histogram().standard_error).all()
    assert few.histogram().density == pytest.approx(enough.histogram().density, abs=1e-3)

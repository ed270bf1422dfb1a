"""Histograms: densities that add up, and errors that know of the correlation."""

import numpy as np
import pytest
from scipy.special import ndtr

from rubnoise.analysis.histogram import Histogram, histogram
from rubnoise.analysis.records import RecordTooShort
from tests.unit.records import memory, white
from tests.verification.seeds import seed_of

EDGES = np.linspace(-3.0, 3.0, 25)


def expected(scale: float = 1.0) -> np.ndarray:
    return np.diff(ndtr(EDGES / scale)) / np.diff(EDGES)


def test_a_histogram_is_the_density_of_its_law_and_of_no_other() -> None:
    found = histogram(memory(400_000, seed_of("histogram")), 1.0, EDGES)
    assert np.max(np.abs(found.density - expected()) / found.standard_error) <= 4.5
    assert np.max(np.abs(found.density - expected(1.1)) / found.standard_error) > 6.0


def test_errors_of_independent_values_are_binomial() -> None:
    found = histogram(white(200_000, seed_of("histogram")) - 3.0, 1.0, EDGES)
    share = expected() * np.diff(EDGES)
    binomial = np.sqrt(share * (1.0 - share) / 200_000) / np.diff(EDGES)
    assert found.standard_error == pytest.approx(binomial, rel=0.3)


def test_errors_of_a_record_with_memory_are_larger() -> None:
    lone = histogram(white(200_000, seed_of("histogram")) - 3.0, 1.0, EDGES)
    kept = histogram(memory(200_000, seed_of("histogram")), 1.0, EDGES)
    assert np.median(kept.standard_error / lone.standard_error) > 1.5


def test_a_histogram_adds_up_and_says_what_lies_outside() -> None:
    values = white(10_000, seed_of("histogram"))
    found = histogram(values, 1.0)
    assert (found.density * np.diff(found.edges)).sum() == pytest.approx(1.0)
    assert found.outside == pytest.approx(0.0, abs=1e-12)
    assert found.middles.size == found.density.size == 60
    half = histogram(values, 1.0, [3.0, 5.0, 10.0])
    assert half.outside == pytest.approx((values < 3.0).mean())


def test_the_last_edge_belongs_to_the_last_bin() -> None:
    values = np.tile([0.0, 1.0, 2.0, 2.0], 1000)
    found = histogram(values, 1.0, [0.0, 1.0, 2.0])
    assert found.density.tolist() == [0.25, 0.75]
    assert found.standard_error == pytest.approx(0.0, abs=0.01)


def test_a_constant_fills_one_bin() -> None:
    found = histogram(np.full(1000, 7.0), 1.0, 4)
    assert found.edges[0] == 7.0
    assert found.density[0] * np.diff(found.edges)[0] == 1.0


@pytest.mark.parametrize("edges", [[1.0], [0.0, 0.0], [1.0, 0.0], [[0.0, 1.0]]])
def test_edges_must_rise(edges: list[float]) -> None:
    with pytest.raises(ValueError, match="must rise"):
        histogram(white(1000, 1), 1.0, edges)


def test_a_short_record_is_refused_with_its_histogram() -> None:
    with pytest.raises(RecordTooShort) as refused:
        histogram(memory(1000, 1), 1.0, EDGES)
    assert isinstance(refused.value.estimate, Histogram)
    assert refused.value.estimate.density.size == 24

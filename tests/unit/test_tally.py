"""Running moments against the plain two-pass formulas."""

from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from rubnoise.record.tally import Moments, Slips, Tally
from tests.models import model

Doubles = NDArray[np.float64]


def _seen(values: Doubles, borders: list[int], powers: int = 4) -> Moments:
    moments = Moments(powers=powers)
    for first, last in pairwise([0, *sorted(borders), values.size]):
        moments.add(values[first:last])
    return moments


def _central(values: Doubles, power: int) -> Fraction:
    """Return a central moment without any rounding."""
    exact = [Fraction(value) for value in values.tolist()]
    mean = sum(exact) / len(exact)
    return sum((value - mean) ** power for value in exact) / len(exact)


@given(st.lists(st.integers(0, 400), max_size=12), st.integers(0, 2**32))
def test_moments_do_not_depend_on_the_panels(borders: list[int], seed: int) -> None:
    values = np.random.default_rng(seed).gamma(3.0, size=400)
    moments = _seen(values, borders)
    variance = float(_central(values, 2))
    assert moments.count == values.size
    assert moments.mean == pytest.approx(float(values.mean()), rel=1e-13)
    assert moments.variance == pytest.approx(variance, rel=1e-12)
    assert moments.std == pytest.approx(variance**0.5, rel=1e-12)
    assert moments.skewness == pytest.approx(float(_central(values, 3)) / variance**1.5, rel=1e-11)
    assert moments.excess_kurtosis == pytest.approx(float(_central(values, 4)) / variance**2 - 3.0, abs=1e-10)


def test_a_large_mean_costs_no_digits_of_the_variance() -> None:
    values = 2.0**30 + np.random.default_rng(7).integers(0, 5, 10_000).astype(np.float64)
    moments = _seen(values, list(range(0, 10_000, 37)))
    assert moments.variance == pytest.approx(float(_central(values, 2)), rel=1e-8)
    naive = float((values * values).mean() - values.mean() ** 2)
    assert naive != pytest.approx(moments.variance, rel=1e-2)


def test_the_merge_of_known_numbers() -> None:
    moments = _seen(np.array([1.0, 2.0, 3.0, 10.0]), [1, 3])
    assert (moments.count, moments.mean, moments.variance) == (4, 4.0, 12.5)
    assert moments.skewness * 12.5**1.5 == pytest.approx((-27.0 - 8.0 - 1.0 + 216.0) / 4.0)
    assert (moments.excess_kurtosis + 3.0) * 12.5**2 == pytest.approx((81.0 + 16.0 + 1.0 + 1296.0) / 4.0)


def test_two_powers_give_the_same_mean_and_variance() -> None:
    values = np.random.default_rng(3).normal(5.0, 2.0, 1000)
    two, four = _seen(values, [100, 700], powers=2), _seen(values, [100, 700])
    assert two.mean == pytest.approx(four.mean, rel=1e-14)
    assert two.variance == pytest.approx(four.variance, rel=1e-12)


@pytest.mark.parametrize("values", [np.empty(0), np.full(5, 3.25)], ids=["none", "all the same"])
def test_values_that_do_not_vary_have_no_shape(values: Doubles) -> None:
    moments = _seen(values, [])
    assert moments.count == values.size
    assert (moments.variance, moments.std, moments.skewness, moments.excess_kurtosis) == (0.0, 0.0, 0.0, 0.0)


def test_a_tally_keeps_what_it_watches_and_nothing_else() -> None:
    tally = Tally()
    tally.write("junctions", 0, {"diameter": np.ones(3)})
    tally.write("trace", 0, {"distance": np.arange(3.0), "real_contact_area": np.array([1.0, 2.0, 3.0])})
    tally.write("trace", 3, {"distance": np.arange(1.0), "real_contact_area": np.array([6.0])})
    tally.write("trace", 0, {"junction_count": np.array([200, 100], dtype=np.uint32)})
    assert set(tally.moments) == {"real_contact_area", "junction_count"}
    assert tally.moments["real_contact_area"].mean == 3.0
    assert tally.moments["real_contact_area"].variance == 3.5
    assert tally.moments["junction_count"].variance == 2500.0


def landmarks(kinds: list[int], places: list[float]) -> dict[str, Any]:
    return {"kind": np.array(kinds, dtype=np.uint8), "distance": np.array(places)}


@pytest.mark.parametrize("cuts", [[], [1], [2, 3], [1, 2, 3, 4, 5, 6]])
def test_slips_are_measured_along_their_path_from_a_breakaway_to_the_next_stick(cuts: list[int]) -> None:
    """Of slips of 3, 0.5, 2 and, with a reversal in it, 0.5 + 1 + 0.75 um two are longer than 2 um."""
    kinds = [0, 1, 0, 1, 0, 1, 0, 1, 2, 3, 0, 1]
    told = landmarks(kinds, [5.0, 5.0, 8.0, 8.0, 8.5, 8.5, 10.5, 10.5, 11.0, 10.0, 10.75, 10.75])
    tally = Tally(slips=Slips(longer_than=2.0))
    edges = [0, *cuts, 12]
    for first, end in pairwise(edges):
        tally.write("landmarks", first, {name: values[first:end] for name, values in told.items()})
    assert tally.slips.count == 2
    assert tally.counts["kind"] == [5, 5, 1, 1]
    assert Tally().slips.count == 0


def test_the_last_row_of_a_balance_is_kept() -> None:
    tally = Tally()
    tally.write("balance", 0, {"time": np.array([2.5]), "velocity": np.array([-3.0])})
    assert tally.last == {"time": 2.5, "velocity": -3.0}
    assert tally.moments == {}


def test_a_tally_for_a_model_has_its_diameter() -> None:
    run = model()
    assert Tally.of(run).slips.longer_than == run.calibrated_diameter

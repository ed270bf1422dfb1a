"""A run summed up while it passes, several runs pooled, and the moments below both."""

import tracemalloc
from fractions import Fraction
from itertools import pairwise
from math import nan, sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from rubnoise.analysis.figures import summarise
from rubnoise.analysis.findings import attributes_of
from rubnoise.analysis.measured import Measured
from rubnoise.analysis.replicates import pooled, ratio, ratio_of_pairs
from rubnoise.analysis.run_summary import CURVES, SummarySink
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.record.moments import Moments
from rubnoise.simulation.run import simulate
from rubnoise.theory.moments import area_cumulants
from tests.laws.scores import seed_of
from tests.models import bare, model

# A run summed up while it passes: what is left of it is what its whole trace would have told.
RUN = bare(distance=3000.0)


def _summary(run: Model, seed: int = 1) -> dict[str, Any]:
    sink = SummarySink(run)
    simulate(run, seed, sink, engine="batch")
    return sink.finish()


@pytest.mark.parametrize("run", [bare(), model()], ids=["contact", "slider"])
def test_the_figures_are_those_of_any_run(run: Model) -> None:
    seen = Measured(run)
    simulate(run, 1, seen, engine="batch")
    figures = {name: value for name, value in _summary(run).items() if name not in CURVES}
    assert figures == attributes_of(summarise(seen))


def _peak(run: Model) -> int:
    _summary(run)
    tracemalloc.start()
    _summary(run)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


@pytest.mark.slow
def test_memory_does_not_grow_with_the_run() -> None:
    # The trace alone of the longer run would be 12 MB more.
    assert _peak(bare(distance=200_000.0)) < _peak(bare(distance=50_000.0)) + 500_000


def _chi(told: Model, simulated: Model, curve: str, runs: int, name: str) -> float:
    """Return the mean square score of the mean curve of some runs; about 1 where theory is right."""
    first = seed_of(f"run_summary/{name}/{curve}")
    values = np.stack([_summary(simulated, first + n)[curve] for n in range(runs)])
    expected, error = (SummarySink(told).theory()[f"{curve}_{part}"] for part in ("expected", "standard_error"))
    used = np.isfinite(error)
    assert used.sum() > 90
    score = (values.mean(axis=0) - expected)[used] / error[used] * runs**0.5
    return float(np.mean(score**2))


@pytest.mark.slow
@pytest.mark.parametrize("curve", ["spectrum", "autocovariance"])
def test_curves_are_where_theory_expects_them_and_not_where_another_does(curve: str) -> None:
    run = bare(distance=3000.0)
    # Neighbouring lags share their noise: far fewer of them are independent than of bands.
    assert _chi(run, run, curve, 30, "right") <= 4.0
    other = bare(
        distance=3000.0, count=23.0, area=area_cumulants(run).mean / area_cumulants(bare(count=23.0)).mean * 200.0
    )
    assert area_cumulants(other).mean == pytest.approx(area_cumulants(run).mean, rel=2e-3)
    assert _chi(other, run, curve, 30, "right") > 9.0


@pytest.mark.slow
def test_histograms_are_where_theory_expects_them() -> None:
    theory = SummarySink(RUN).theory()
    first = seed_of("run_summary/histogram")
    values = np.stack([_summary(RUN, first + n)["histogram"] for n in range(40)])
    well_filled = theory["histogram_expected"] > 1e-3
    assert well_filled.sum() >= 15
    error = values.std(axis=0, ddof=1)[well_filled] / 40**0.5
    assert np.abs((values.mean(axis=0) - theory["histogram_expected"])[well_filled] / error).max() <= 4.5
    wrong = SummarySink(bare(distance=3000.0, count=30.0)).theory()
    shifted = np.interp(theory["histogram_place"], wrong["histogram_place"], wrong["histogram_expected"])
    assert np.abs((values.mean(axis=0) - shifted)[well_filled] / error).max() > 9.0
    assert "histogram_standard_error" not in theory


@pytest.mark.slow("regular")
@pytest.mark.parametrize(
    ("run", "silent"),
    [
        (bare(start="empty", distance=500.0), ("expected", "standard_error")),
        (bare(distance=300.0), ("standard_error",)),
        (bare(distance=1000.0, tick=2.0), ("standard_error",)),
        (bare(distance=1000.0, births="regular"), ("standard_error",)),
    ],
    ids=["empty", "short", "coarse", "regular"],
)
def test_theory_is_silent_where_it_cannot_be_defended(run: Model, silent: tuple[str, ...]) -> None:
    for curve in ("spectrum", "autocovariance"):
        theory = SummarySink(run).theory()
        for name in ("expected", "standard_error"):
            assert bool(np.isfinite(theory[f"{curve}_{name}"]).any()) == (name not in silent)
        assert np.isfinite(theory[f"{curve}_place"]).any()


@pytest.mark.parametrize(
    "run",
    [
        bare(distance=1.0),
        bare(count=0.01, distance=500.0, calibration="exact"),
        bare(births="regular", pulse=TRIANGLE, spread=Spread(absolute=0.0)),
        bare(tick=10.0, distance=100.0),
    ],
    ids=["short", "thin", "constant", "coarse"],
)
def test_runs_of_any_kind_are_summed_up(run: Model) -> None:
    seen = _summary(run)
    for name, size in CURVES.items():
        assert seen[name].shape == (size,)
        assert not np.isinf(seen[name]).any()
    for name, values in SummarySink(run).theory().items():
        assert values.size == CURVES[name.rpartition("_")[0].removesuffix("_standard")]
    width = np.diff(SummarySink(run).theory()["histogram_place"])[0]
    assert float(seen["histogram"].sum() * width) == pytest.approx(1.0, abs=1e-9)


def test_means_are_pooled_as_they_are_and_standard_deviations_as_squares() -> None:
    values = [3.0, nan, 4.0, 5.0]
    mean = pooled("area_mean", values)
    assert (mean.value, mean.runs) == (4.0, 3)
    assert mean.standard_error == pytest.approx(1.0 / sqrt(3.0))
    assert mean.reach == pytest.approx(4.302652729749462 / sqrt(3.0))
    std = pooled("area_std", values)
    assert std.value == pytest.approx(sqrt(50.0 / 3.0))
    assert std.standard_error == pytest.approx(np.std([9.0, 16.0, 25.0], ddof=1) / sqrt(3.0) / 2.0 / std.value)


@pytest.mark.parametrize(("name", "truth"), [("x_mean", 5.0), ("x_std", 2.0)])
def test_intervals_hold_the_truth_as_often_as_they_say(name: str, truth: float) -> None:
    """Of 1000 intervals of 95 % some 950 hold it, give or take 4 sqrt(1000 0.95 0.05) = 28."""
    rng = np.random.Generator(np.random.PCG64(seed_of(f"replicates/{name}")))
    held = missed = 0
    for _ in range(1000):
        runs = rng.normal(5.0, 2.0, (12, 400))
        found = pooled(name, (runs.mean(axis=1) if name == "x_mean" else runs.std(axis=1)).tolist())
        held += abs(found.value - truth) <= found.reach
        missed += abs(found.value - 1.03 * truth) <= found.reach
    assert 922 <= held <= 978
    assert missed < 850


@pytest.mark.parametrize(("name", "truth"), [("x_mean", 0.8), ("x_std", 0.8)])
def test_pairs_tell_a_ratio_as_well_as_they_say(name: str, truth: float) -> None:
    """Of 1000 intervals of 95 % some 950 hold it; what a pair has in common makes them ten times narrower."""
    rng = np.random.Generator(np.random.PCG64(seed_of(f"pairs/{name}")))
    held = missed = 0
    widths = []
    for _ in range(1000):
        common = rng.uniform(3.0, 7.0, 12)
        first, second = (share * common + 0.02 * rng.normal(size=12) for share in (truth, 1.0))
        found = ratio_of_pairs(name, first.tolist(), second.tolist())
        held += abs(found.value - truth) <= found.reach
        missed += abs(found.value - 1.01 * truth) <= found.reach
        widths.append(
            found.standard_error / ratio(pooled(name, first.tolist()), pooled(name, second.tolist())).standard_error
        )
    assert 922 <= held <= 978
    assert missed < 850
    assert np.median(widths) < 0.1


# Running moments against the plain two-pass formulas.
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


@pytest.mark.slow
@given(borders=st.lists(st.integers(0, 400), max_size=12), seed=st.integers(0, 2**32))
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


def landmarks(kinds: list[int], places: list[float]) -> dict[str, Any]:
    return {"kind": np.array(kinds, dtype=np.uint8), "distance": np.array(places)}


@pytest.mark.parametrize("cuts", [[], [1], [2, 3], [1, 2, 3, 4, 5, 6]])
def test_slips_are_measured_along_their_path_from_a_breakaway_to_the_next_stick(cuts: list[int]) -> None:
    """Of slips of 3, 0.5, 2 and, with a reversal in it, 0.5 + 1 + 0.75 um two are longer than 2 um."""
    kinds = [0, 1, 0, 1, 0, 1, 0, 1, 2, 3, 0, 1]
    told = landmarks(kinds, [5.0, 5.0, 8.0, 8.0, 8.5, 8.5, 10.5, 10.5, 11.0, 10.0, 10.75, 10.75])
    seen = Measured(bare(area=4.0 * 0.327 * 20.0))
    seen.first = {}
    edges = [0, *cuts, 12]
    for first, end in pairwise(edges):
        seen.write("landmarks", first, {name: values[first:end] for name, values in told.items()})
    assert seen.slips.count == 2
    assert seen.kinds.tolist() == [5, 5, 1, 1]

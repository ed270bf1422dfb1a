"""A run summed up while it passes: what is left of it is what its whole trace would have told."""

import tracemalloc

import numpy as np
import pytest

from rubnoise.analysis.covariance import LaggedProducts
from rubnoise.analysis.histogram import histogram
from rubnoise.analysis.moments import sample_covariances
from rubnoise.analysis.records import error_of_mean
from rubnoise.analysis.run_summary import BANDS, BINS, CURVES, LAGS, RunLayout, RunSummary, SummarySink, curve_theory
from rubnoise.analysis.spectra import welch
from rubnoise.analysis.summary import summarise
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.simulation.run import simulate
from rubnoise.theory.campbell import area_cumulants
from tests.models import bare, model, recorded
from tests.verification.seeds import seed_of

RUN = bare(distance=3000.0)
LONG = bare(distance=9000.0)


def _summary(run: Model, seed: int = 1) -> RunSummary:
    sink = SummarySink(run)
    simulate(run, seed, sink, engine="batch")
    return sink.finish()


def _area(run: Model, seed: int = 1) -> np.ndarray:
    return recorded(run, seed, engine="batch")["trace"]["real_contact_area"]


def test_the_spectrum_is_welchs_in_bands() -> None:
    layout, seen = RunLayout.of(LONG), _summary(LONG).curves["spectrum"]
    density = welch(_area(LONG), LONG.tick, layout.segment).density
    bands = [density[first : first + width].mean() for first, width in zip(layout.starts, layout.widths, strict=True)]
    assert seen[: len(bands)] == pytest.approx(bands, rel=1e-10)
    assert np.isnan(seen[len(bands) :]).all()
    assert seen.size == BANDS


def test_the_autocovariance_is_that_of_the_trace() -> None:
    lags = RunLayout.of(RUN).lags
    seen = _summary(RUN).curves["autocovariance"]
    whole = sample_covariances(_area(RUN), RUN.tick, lags.tolist(), RUN).value
    assert seen[: lags.size] == pytest.approx(whole, abs=1e-10 * whole[0])
    assert seen.size == LAGS
    assert np.isnan(seen[lags.size :]).all()


def test_the_histogram_is_that_of_the_trace_and_its_errors_those_of_batches() -> None:
    layout, seen, area = RunLayout.of(LONG), _summary(LONG).curves, _area(LONG)
    assert seen["histogram"] == pytest.approx(histogram(area, LONG.tick, layout.edges).density, abs=1e-15)
    assert float(seen["histogram"].sum()) * np.diff(layout.edges)[0] == pytest.approx(1.0, abs=1e-12)

    def shares(parts: np.ndarray) -> np.ndarray:
        return np.stack([np.histogram(part, layout.edges)[0] for part in parts]) / parts.shape[1]

    errors = error_of_mean(area, layout.batch, shares) / np.diff(layout.edges)
    assert seen["histogram_standard_error"] == pytest.approx(errors, rel=1e-9, abs=1e-14)
    assert seen["histogram"].size == BINS


@pytest.mark.parametrize("run", [bare(), model()], ids=["contact", "slider"])
def test_the_figures_are_those_of_any_run(run: Model) -> None:
    tally = Tally()
    simulate(run, 1, tally, engine="batch")
    assert _summary(run).figures == summarise(run, tally)


def test_both_engines_leave_the_same() -> None:
    sink = SummarySink(RUN)
    simulate(RUN, 1, sink, engine="events")
    events, batch = sink.finish().curves, _summary(RUN).curves
    for name in CURVES:
        assert events[name] == pytest.approx(batch[name], rel=1e-12, abs=1e-9, nan_ok=True)


def _peak(run: Model) -> int:
    _summary(run)
    tracemalloc.start()
    _summary(run)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


def test_memory_does_not_grow_with_the_run() -> None:
    # The trace alone of the longer run would be 12 MB more.
    assert _peak(bare(distance=200_000.0)) < _peak(bare(distance=50_000.0)) + 500_000


def test_fine_ticks_cost_no_more_than_they_tell() -> None:
    layout = RunLayout.of(bare(distance=20.0, tick=0.0005))
    assert layout.stride == 21
    assert layout.lags[-1] * layout.step <= 2.0 * RUN.mean_life_distance
    fine = bare(distance=300.0, tick=0.005)
    assert RunLayout.of(fine).stride == 2
    seen = _summary(fine).curves["autocovariance"]
    lags = RunLayout.of(fine).lags
    thinned = LaggedProducts(lags.tolist(), 200.0)
    thinned.add(_area(fine)[::2])
    assert seen[: lags.size] == pytest.approx(thinned.covariances(), abs=1e-10 * seen[0])


def _chi(told: Model, simulated: Model, curve: str, runs: int, name: str) -> float:
    """Return the mean square score of the mean curve of some runs; about 1 where theory is right."""
    first = seed_of(f"run_summary/{name}/{curve}")
    values = np.stack([_summary(simulated, first + n).curves[curve] for n in range(runs)])
    theory = curve_theory(told)[curve]
    used = np.isfinite(theory.standard_error)
    assert used.sum() > 90
    score = (values.mean(axis=0) - theory.expected)[used] / theory.standard_error[used] * runs**0.5
    return float(np.mean(score**2))


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


def test_histograms_are_where_theory_expects_them() -> None:
    theory = curve_theory(RUN)["histogram"]
    first = seed_of("run_summary/histogram")
    values = np.stack([_summary(RUN, first + n).curves["histogram"] for n in range(40)])
    well_filled = theory.expected > 1e-3
    assert well_filled.sum() >= 15
    error = values.std(axis=0, ddof=1)[well_filled] / 40**0.5
    assert np.abs((values.mean(axis=0) - theory.expected)[well_filled] / error).max() <= 4.5
    wrong = curve_theory(bare(distance=3000.0, count=30.0))["histogram"]
    shifted = np.interp(theory.place, wrong.place, wrong.expected)
    assert np.abs((values.mean(axis=0) - shifted)[well_filled] / error).max() > 9.0
    assert np.isnan(theory.standard_error).all()


@pytest.mark.parametrize(
    ("run", "silent"),
    [
        (bare(start="empty", distance=1000.0), ("expected", "standard_error")),
        (bare(distance=300.0), ("standard_error",)),
        (bare(distance=1000.0, tick=2.0), ("standard_error",)),
        (bare(distance=1000.0, births="regular"), ("standard_error",)),
    ],
    ids=["empty", "short", "coarse", "regular"],
)
def test_theory_is_silent_where_it_cannot_be_defended(run: Model, silent: tuple[str, ...]) -> None:
    for curve in ("spectrum", "autocovariance"):
        theory = curve_theory(run)[curve]
        for name in ("expected", "standard_error"):
            assert bool(np.isfinite(getattr(theory, name)).any()) == (name not in silent)
        assert np.isfinite(theory.place).any()


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
        assert seen.curves[name].shape == (size,)
        assert not np.isinf(seen.curves[name]).any()
    for theory in curve_theory(run).values():
        assert theory.place.size == theory.expected.size == theory.standard_error.size
    assert float(seen.curves["histogram"].sum() * np.diff(RunLayout.of(run).edges)[0]) == pytest.approx(1.0, abs=1e-9)

"""Births and sizes of every law in runs: what is drawn, against exact moments and spectra."""

from dataclasses import replace
from functools import lru_cache
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest

from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.distributions import Fixed
from rubnoise.contact.laws import Spread
from rubnoise.model import Model
from rubnoise.scenario import build, loads
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.text import text_of
from rubnoise.simulation import draws
from rubnoise.theory.exact import exact
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.sampling import expected_periodogram, through_window
from rubnoise.theory.second_order import area_noise, autocovariance, spectral_density
from rubnoise.theory.sizes import panels, sizes_of
from rubnoise.theory.unit_pulse import amplitude
from tests.models import bare, contents, recorded
from tests.unit.scenarios import BARE

pytestmark = pytest.mark.slow

# Births that are neither random nor regular: exact figures, and 200 runs of each law beside them.
RUNS, BOUND, LAWS = 200, 4.0, ("gamma", "bunched", "clustered", "jittered")
WAVENUMBERS = np.array([0.01, 0.1, 0.3, 1.0])
FIGURES = {
    "poisson": (22975.81971961742, 22065.51288732153, 15847.06831987238, 211.2679099074118),
    "gamma": (5743.96865307099, 5517.696252031855, 3970.290911927073, 54.08720508129157),
    "bunched": (45951.28814591969, 44097.46572952831, 31485.927091662663, 400.57068279169687),
    "clustered": (91875.71340826772, 85666.44814217556, 49015.44153308794, 222.87643014733712),
}
STDS = {"poisson": 0.27499, "gamma": 0.13771, "bunched": 0.38737, "clustered": 0.48903}


def contact(births: str, **changes: Any) -> Model:
    return bare(**{"births": births, "spread": Spread(law="lognormal", relative=0.5), "distance": 600.0} | changes)


@pytest.mark.parametrize("births", FIGURES)
def test_spectrum_and_spread_have_their_published_figures(births: str) -> None:
    run = contact(births, spread=Spread())
    run = replace(run, sizes=Fixed(value=5.530012635), births=replace(run.births, mean_spacing=5.530012635 / 10.0))
    assert spectral_density(run, WAVENUMBERS) == pytest.approx(FIGURES[births], rel=1e-6)
    area = area_cumulants(run)
    assert area.std / area.mean == pytest.approx(STDS[births], abs=6e-6)


@pytest.mark.parametrize("births", LAWS)
def test_the_spectrum_is_the_transform_of_the_covariance(births: str) -> None:
    run = contact(births)
    reach = 2.0 * run.sizes.support[1] + run.births.memory
    lags, weights = panels(np.linspace(0.0, reach, 400), 10)
    covariance = autocovariance(run, lags)
    if births == "jittered":
        k, power = area_noise(run).lines
        covariance = covariance - 2.0 * np.cos(np.multiply.outer(lags, k)) @ power
    turned = 2.0 * np.cos(np.multiply.outer(WAVENUMBERS, lags)) @ (weights * covariance)
    assert turned == pytest.approx(spectral_density(run, WAVENUMBERS), rel=1e-5, abs=1e-5 * turned[0])


@lru_cache(maxsize=8)
def many(births: str) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Return area and count of 200 runs, a row a run."""
    run = contact(births)
    traces = [recorded(run, seed, engine="batch")["trace"] for seed in range(RUNS)]
    return np.array([each["real_contact_area"] for each in traces]), np.array(
        [each["junction_count"] for each in traces]
    )


def z_of(samples: np.ndarray[Any, Any], expected: float) -> float:
    return float((samples.mean() - expected) / (samples.std(ddof=1) / sqrt(samples.size)))


@pytest.mark.parametrize("births", LAWS)
def test_moments_of_200_runs(births: str) -> None:
    area, count = many(births)
    theory = exact(contact(births))
    centred = area - theory.area.mean
    scores = [
        z_of(area.mean(axis=1), theory.area.mean),
        z_of(np.square(centred).mean(axis=1), theory.area.variance),
        z_of(count.mean(axis=1), theory.count_mean),
        z_of(np.square(count - theory.count_mean).mean(axis=1), theory.count_variance),
    ]
    assert np.isnan(theory.area.values[2:]).all()
    assert np.abs(scores).max() <= BOUND, scores
    at_random = exact(contact("poisson")).area.variance
    assert abs(z_of(np.square(centred).mean(axis=1), at_random)) > BOUND


BINS = np.unique(np.geomspace(2, 400, 12).astype(int))


def _bands(area: np.ndarray[Any, Any], run: Model) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Return the periodogram of each run about the exact mean, and its expected value, in some bins."""
    window = np.square(np.sin(pi * np.arange(area.shape[1]) / area.shape[1]))
    seen = np.square(np.abs(np.fft.rfft(window * (area - area.mean(axis=1, keepdims=True)))))[:, BINS]
    _, expected = expected_periodogram(run, run.tick, window)
    return seen * run.tick / np.square(window).sum(), expected[BINS]


def _centred(run: Model, wavenumber: Any) -> Any:
    """Return |E[A^(k)]|^2 with A^ taken about the middle of each life: the wrong place."""
    sizes = sizes_of(run.sizes)
    transforms = amplitude(run.pulse, np.multiply.outer(wavenumber, sizes.diameter))
    return np.square(transforms @ (sizes.probability * sizes.diameter**3))


def _shown(run: Model, ticks: int) -> np.ndarray[Any, Any]:
    """Return what the window would show of births whose lives are taken about their middle."""

    def density(k: Any) -> Any:
        return area_noise(run).parts(k)[0] + run.birth_rate * run.births.excess(k) * _centred(run, k)

    window = np.square(np.sin(pi * np.arange(ticks) / ticks))
    return through_window(density, run.tick, window, int(BINS[-1]))[BINS]


@pytest.mark.parametrize("births", LAWS)
def test_spectra_of_200_runs(births: str) -> None:
    run = contact(births)
    seen, expected = _bands(many(births)[0], run)
    scores = [z_of(seen[:, n], value) for n, value in enumerate(expected)]
    assert np.abs(scores).max() <= BOUND, scores
    wrong = _shown(run, many(births)[0].shape[1])
    assert np.abs([z_of(seen[:, n], value) for n, value in enumerate(wrong)]).max() > BOUND


@pytest.mark.parametrize("births", ["gamma", "clustered"])
def test_a_start_is_that_of_a_contact_that_always_slid(births: str, monkeypatch: pytest.MonkeyPatch) -> None:
    run = contact(births, distance=5.0)
    theory = exact(run)

    def scores() -> list[float]:
        first = np.array([recorded(run, seed, engine="batch")["trace"]["junction_count"][0] for seed in range(200)])
        away = first - theory.count_mean
        return [z_of(first, theory.count_mean), z_of(np.square(away), theory.count_variance)]

    assert np.abs(scores()).max() <= BOUND
    at_random, past = PoissonBirths(mean_spacing=run.births.mean_spacing), draws.past
    monkeypatch.setattr(draws, "past", lambda run, *where: past(replace(run, births=at_random), *where))
    assert np.abs(scores()).max() > BOUND


@pytest.mark.parametrize("births", LAWS)
def test_engines_give_equal_bits(births: str) -> None:
    run = contact(births)
    assert contents(recorded(run, 3, engine="events")) == contents(recorded(run, 3, engine="batch"))


# Sizes of a mixture and of measured values: exact moments, their areas, and 100 runs beside them.
TWO = 'law = "mixture"\nweights = [0.7, 0.3]\nparts = [{law = "fixed", mean = 4}, {law = "fixed", mean = "9 um"}]\n'
SMOOTH = (
    'law = "mixture"\nweights = [7, 3]\n'
    'parts = [{law = "normal", mean = 4, spread = "20 %"}, {law = "lognormal", mean = 9, spread = "30 %"}]\n'
)
VALUES = 'law = "empirical"\nvalues = [4, 5, 6, 8.5]\n'
ALIVE = f'{VALUES}sampled = "alive"\n'
CASES = {"two": TWO, "smooth": SMOOTH, "values": VALUES, "alive": ALIVE}


def scenario(table: str, **more: Any) -> Scenario:
    text = BARE.replace("[sliding]", f'calibration = "matched"\n[diameter]\n{table}[sliding]')
    return loads(text, overrides=["sliding.distance=600 um", "output.tick=0.2 um", *more.values()])


def test_two_sizes_have_their_published_moments() -> None:
    model = scenario(TWO, how="interface.calibration=exact").model()
    scale = 5.5 / model.calibrated_diameter
    moments = [model.sizes.moment(n) * scale**n for n in range(1, 7)]
    assert moments == pytest.approx([5.5, 35.5, 263.5, 2147.5, 18431.5, 162299.5], rel=1e-14)
    area = exact(model).area
    assert area.std / area.mean * sqrt(20.0) == pytest.approx(1.4859795, abs=5e-8)


@pytest.mark.parametrize("name", CASES)
def test_100_runs_have_the_exact_moments(name: str) -> None:
    made = scenario(CASES[name])
    run, theory = made.model(), exact(made.model())
    assert theory.area.mean == pytest.approx(200.0, rel=1e-12)
    assert build(made.resolved()).model() == run
    assert loads(text_of(made.resolved())).model() == run
    assert contents(recorded(run, 3, engine="events")) == contents(recorded(run, 3, engine="batch"))
    traces = [recorded(run, seed, engine="batch")["trace"] for seed in range(100)]
    area = np.array([each["real_contact_area"] for each in traces])
    first = np.array([each["junction_count"][0] for each in traces])

    def z(samples: np.ndarray[Any, Any], expected: float) -> float:
        return float((samples.mean() - expected) / (samples.std(ddof=1) / sqrt(samples.size)))

    squares = np.square(area - theory.area.mean).mean(axis=1)
    assert abs(z(area.mean(axis=1), theory.area.mean)) <= 4.0
    assert abs(z(squares, theory.area.variance)) <= 4.0
    assert abs(z(first, theory.count_mean)) <= 4.0
    one_size = exact(scenario('law = "fixed"\n').model()).area.variance
    assert abs(z(squares, one_size)) > 4.0


@pytest.mark.parametrize("table", [SMOOTH, TWO])
def test_a_mixture_has_a_distribution(table: str) -> None:
    theory = exact(scenario(table).model())
    law = theory.distribution()
    assert law.cdf(1e9) == 1.0
    places = np.linspace(0.0, float(law.area[-1]), 200_001)
    left = 1.0 - law.cdf(places)
    assert np.trapezoid(left, places) == pytest.approx(theory.area.mean, rel=1e-4)

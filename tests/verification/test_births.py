"""Births and sizes of every law in runs: what is drawn, against exact moments and spectra."""

from dataclasses import replace
from functools import lru_cache
from math import pi, sqrt
from typing import Any

import numpy as np
import pytest

from rubnoise.contact import births as laws
from rubnoise.contact.births import ClusteredBirths, GammaBirths, JitteredBirths, scattered
from rubnoise.contact.deviates import normal_quantile
from rubnoise.contact.laws import Fixed, Spread
from rubnoise.contact.laws.discrete import largest_of
from rubnoise.model import Model
from rubnoise.scenario import build, loads
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.text import text_of
from rubnoise.simulation import draws
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.exact import exact
from rubnoise.theory.periodogram import expected_periodogram, through_window
from rubnoise.theory.second_order import area_noise, autocovariance, spectral_density
from rubnoise.theory.sizes import panels, sizes_of
from rubnoise.theory.unit_pulse import amplitude
from tests.models import bare, contents, recorded
from tests.unit.scenarios import BARE, refusal

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


def test_limits_of_the_laws() -> None:
    k = np.geomspace(1e-7, 1e3, 50)
    assert GammaBirths(mean_spacing=0.5, shape=1.0).excess(k) == pytest.approx(np.zeros(50), abs=1e-9)
    far = GammaBirths(mean_spacing=0.5, shape=4.0)
    assert far.excess(np.array([0.0, 2.1e-5])) == pytest.approx([-0.75, -0.75], abs=1e-9)
    still = exact(contact("regular", calibration="exact", spread=Spread()))
    moved = replace(still.model, births=JitteredBirths(mean_spacing=still.model.births.mean, jitter=1e-4))
    assert area_cumulants(moved).std == pytest.approx(still.area.std, rel=1e-3)
    wide = replace(still.model, births=JitteredBirths(mean_spacing=still.model.births.mean, jitter=50.0))
    assert area_cumulants(wide).std == pytest.approx(
        area_cumulants(contact("poisson", spread=Spread(), calibration="exact")).std, rel=0.05
    )


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
        return area_noise(run).alone(k) + run.birth_rate * run.births.excess(k) * _centred(run, k)

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
    monkeypatch.setattr(draws, "_alive_of_past", draws._alive_at_random)
    assert np.abs(scores()).max() > BOUND


def test_births_come_in_order_and_from_any_stretch(monkeypatch: pytest.MonkeyPatch) -> None:
    law = ClusteredBirths(mean_spacing=0.5, cluster_size=3.0, cluster_width=2.0)
    whole = law.between(7, -500.0, 9000.0)
    assert (np.diff(whole) > 0.0).all()
    begin = float(whole[4000])
    assert law.following(7, begin, 300).tobytes() == whole[4000:4300].tobytes()
    assert law.between(7, begin, 8000.0).tobytes() == whole[4000 : np.searchsorted(whole, 8000.0)].tobytes()
    run = contact("clustered")
    assert (np.diff(recorded(run, 1)["junctions"]["birth_distance"]) >= 0.0).all()
    monkeypatch.setattr(scattered.np, "sort", lambda values: values)
    assert not (np.diff(law.between(7, -500.0, 9000.0)) >= 0.0).all()


def test_large_clusters_are_drawn_where_they_are_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """To the same bits as cells that are drawn whole, and far fewer births."""
    law = ClusteredBirths(mean_spacing=0.5, cluster_size=300.0, cluster_width=40.0)
    assert int(scattered._families(law, 7, 0).before[-1]) > scattered._KEPT
    drawn = []
    monkeypatch.setattr(scattered, "normal_quantile", lambda each: drawn.append(each.size) or normal_quantile(each))
    found = [law.between(7, begin, begin + 2000.0) for begin in (-1000.0, 0.0, 1e6)]
    assert sum(drawn) < 100_000
    monkeypatch.setattr(scattered, "_KEPT", 2**30)
    for each, begin in zip(found, (-1000.0, 0.0, 1e6), strict=True):
        assert each.size > 500
        assert each.tobytes() == law.between(7, begin, begin + 2000.0).tobytes()


def test_the_largest_clusters_are_quick() -> None:
    law = ClusteredBirths(mean_spacing=0.2, cluster_size=1e4, cluster_width=1.0)
    assert law.following(7, 0.0, 30_000).size == 30_000


def test_every_law_is_named_once() -> None:
    assert list(laws.BIRTHS) == ["poisson", "regular", "gamma", "clustered", "jittered"]


@pytest.mark.parametrize("births", LAWS)
def test_engines_give_equal_bits(births: str) -> None:
    run = contact(births)
    assert contents(recorded(run, 3, engine="events")) == contents(recorded(run, 3, engine="batch"))


# Sizes of a mixture and of measured values: exact moments, their areas, and 200 runs beside them.
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
def test_200_runs_have_the_exact_moments(name: str) -> None:
    made = scenario(CASES[name])
    run, theory = made.model(), exact(made.model())
    assert theory.area.mean == pytest.approx(200.0, rel=1e-12)
    assert build(made.resolved()).model() == run
    assert loads(text_of(made.resolved())).model() == run
    assert contents(recorded(run, 3, engine="events")) == contents(recorded(run, 3, engine="batch"))
    traces = [recorded(run, seed, engine="batch")["trace"] for seed in range(200)]
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


def test_a_snapshot_is_freed_of_its_bias() -> None:
    born = scenario(VALUES).model().sizes
    generator, n = np.random.default_rng(3), 200_000
    seen = born.draw_length_biased(generator, n)
    values, counts = np.unique(seen, return_counts=True)
    wanted = values / values.sum()
    assert np.abs(counts - n * wanted).max() <= 4.0 * sqrt(n * 0.25)
    undone = counts / values / (counts / values).sum()
    assert np.abs(undone - 0.25).max() < 0.01 < np.abs(counts / n - 0.25).max()
    alive = scenario(ALIVE).model().sizes
    assert alive.moment(2) / alive.moment(1) ** 2 == pytest.approx(23.5 / 4.0 * (1 / 4 + 1 / 5 + 1 / 6 + 1 / 8.5) / 4.0)


def test_the_largest_size_may_be_of_any_part() -> None:
    parts = '[{law = "fixed", mean = 9}, {law = "fixed", mean = 4}]'
    law = scenario(f'law = "mixture"\nweights = [1, 1]\nparts = {parts}\n').model().sizes
    assert largest_of(law) == law.support[1] > float(law.draw(np.array([1.0 - 2.0**-53]))[0])


@pytest.mark.parametrize("table", [SMOOTH, TWO])
def test_a_mixture_has_a_distribution(table: str) -> None:
    theory = exact(scenario(table).model())
    law = theory.distribution()
    assert law.cdf(1e9) == 1.0
    places = np.linspace(0.0, float(law.area[-1]), 200_001)
    left = 1.0 - law.cdf(places)
    assert np.trapezoid(left, places) == pytest.approx(theory.area.mean, rel=1e-4)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('law = "mixture"\nweights = [1]\n', 'diameter.parts: missing; the law "mixture" needs a parts'),
        (TWO.replace("[0.7, 0.3]", "[1]"), "diameter.weights: 1 weights for 2 parts"),
        (
            TWO.replace("mean = 4", 'mean = 4, spread = "2 %"'),
            'part 1: the law "fixed" takes no spread',
        ),
        (TWO.replace('"fixed", mean = 4', '"normal", mean = 4'), 'part 1: the law "normal" needs a spread'),
        (TWO.replace('"fixed", mean = 4', '"empirical", mean = 4'), 'unknown value "empirical"'),
        (TWO.replace("mean = 4", "mean = -4"), "diameter.parts: must be above 0"),
        ('law = "empirical"\nvalues = []\n', "needs a list of 1 to 2000 diameters"),
        ('law = "empirical"\nvalues = [1, "a"]\n', "diameter.values"),
        ('law = "fixed"\nvalues = [1]\n', 'the law "fixed" takes no values'),
    ],
)
def test_wrong_lists_are_refused(table: str, said: str) -> None:
    assert said in refusal(BARE + "[diameter]\n" + table)

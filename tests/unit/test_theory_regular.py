"""Regular births: exact moments and covariances."""

from dataclasses import replace
from math import isnan, pi

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.distributions import Lognormal
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.model import Model, Slider
from rubnoise.theory.moments import Cumulants, area_cumulants, count_variance, force_cumulants
from rubnoise.theory.motion import FORCE, density_of, response
from rubnoise.theory.second_order import area_noise, autocovariance, count_noise, spectral_density
from rubnoise.theory.sizes import longest_life, panels
from tests.laws.scores import seed_of
from tests.unit.theory_models import FIG5_SLIDER, drawn, regular

Doubles = NDArray[np.float64]

SHAPES = pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)


@pytest.mark.parametrize("count", [2, 4, 10, 20, 50, 500])
def test_rabinowicz_has_a_constant_area(count: int) -> None:
    area = area_cumulants(regular(count, pulse=TRIANGLE))
    assert area.variance == 0.0
    assert np.isnan(area.values[2:]).all()
    assert area.mean == pytest.approx(count * pi / 8.0 * 5.53**2, rel=1e-14)
    assert isnan(area.skewness)
    assert isnan(area.excess_kurtosis)


@pytest.mark.parametrize(
    ("count", "pulse", "ripple"),
    [(2.5, TRIANGLE, 0.052), (2, LENS, 0.074), (10, LENS, 0.0038), (20, LENS, 0.000996)],
    ids=["triangle-2.5", "lens-2", "lens-10", "lens-20"],
)
def test_ripple_of_other_counts_and_of_the_lens(count: float, pulse: Pulse, ripple: float) -> None:
    area = area_cumulants(regular(count, pulse=pulse))
    assert area.std / area.mean == pytest.approx(ripple, rel=0.01)


@SHAPES
@pytest.mark.parametrize("count", [0.5, 2.5, 7.0])
def test_mean_and_variance_of_one_size_are_those_of_a_periodic_function(count: float, pulse: Pulse) -> None:
    model = regular(count, pulse=pulse)
    phase = (np.arange(2_000_000) + 0.5) / 2_000_000 * model.births.mean_spacing
    area = sum(pulse.area(phase + j * model.births.mean_spacing, 5.53) for j in range(8))
    z = area - area.mean()
    found = area_cumulants(model)
    assert found.mean == pytest.approx(area.mean(), rel=1e-12)
    assert found.variance == pytest.approx(np.mean(z**2), rel=1e-8)


def scores(sample: Doubles, exact: Cumulants) -> list[float]:
    """Return z of mean and variance, their errors from the sample's own higher moments."""
    z = sample - exact.mean
    found = [
        (z, 0.0),
        (z**2, exact.variance),
    ]
    return [float((x.mean() - value) / (x.std() / np.sqrt(x.size))) for x, value in found]


@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(0.5, 0.2), (2.5, 0.2), (20.0, 0.2), (3.0, 1.5), (6.0, 6.0)])
def test_cumulants_of_many_sizes(count: float, spread: float, pulse: Pulse) -> None:
    model = replace(regular(count, spread, pulse), strengths=None)
    generator = np.random.default_rng(seed_of(f"regular cumulants {count} {spread} {pulse.shape}"))
    sample = drawn(model, [0.0], 200_000, generator)[0][0]
    assert np.abs(scores(sample, area_cumulants(model))).max() <= 4.0
    poisson = replace(model, births=PoissonBirths(mean_spacing=model.births.mean_spacing))
    assert abs(scores(sample, area_cumulants(poisson))[1]) > 20.0


@pytest.mark.parametrize("spread", [0.0, 0.2, 3.0])
def test_cumulants_of_unequal_strengths(spread: float) -> None:
    """With one strength only the mean strength would count; the lives differ by strength even where sizes do not."""
    psi = Lognormal(mean=250.0, std=75.0)
    model = replace(regular(4.0, spread, TRIANGLE), strengths=psi)
    generator = np.random.default_rng(seed_of(f"regular strengths {spread}"))
    sample = drawn(model, [0.0], 200_000, generator)[0][0]
    assert np.abs(scores(sample, force_cumulants(model))).max() <= 4.0
    scaled = Cumulants(values=tuple(250.0**n * k for n, k in enumerate(area_cumulants(model).values, start=1)))
    assert abs(scores(sample, scaled)[1]) > 20.0


def spread_out(model: Model) -> tuple[Doubles, Doubles]:
    """Return diameters and probabilities by the rule of many small steps."""
    low, high = model.sizes.support
    if low == high:
        return np.array([low]), np.ones(1)
    diameters = low + (high - low) * (np.arange(300) + 0.5) / 300
    shares = model.sizes.density(diameters)
    return diameters, shares / shares.sum()


@pytest.mark.slow("2.5-0.2-lens", "2.5-0.2-triangle", "20.0-1.5-lens", "20.0-1.5-triangle")
@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(0.5, 0.0), (2.5, 0.0), (20.0, 0.0), (2.5, 0.2), (20.0, 1.5)])
def test_lines_hold_what_the_phase_tells(count: float, spread: float, pulse: Pulse) -> None:
    model = regular(count, spread, pulse)
    spacing, (diameters, shares) = model.births.mean_spacing, spread_out(model)
    phases = 4096 if diameters.size == 1 else 2048
    age = np.arange(phases)[:, None] / phases * spacing + spacing * np.arange(int(longest_life(model) / spacing) + 1)
    found = sum(
        share * np.sum(pulse.area(age, d), axis=1) for d, share in zip(diameters.tolist(), shares.tolist(), strict=True)
    )
    told, nothing = float(np.var(found)), 1e-14 * area_cumulants(model).mean ** 2
    assert 2.0 * area_noise(model).lines[1].sum() == pytest.approx(told, rel=1e-4, abs=nothing)


LAGS = [0.0, 0.3, 4.4, 7.0]
CASES = pytest.mark.parametrize(("count", "spread"), [(0.5, 0.2), (2.5, 0.0), (2.5, 0.2), (20.0, 0.2), (6.0, 6.0)])


def score(first: Doubles, second: Doubles, means: float, covariance: float, allowed: float = 1e-9) -> float:
    """Return z of a sample covariance, a share of it allowed where all products are equal, as of 0 and 1 about 1/2."""
    products = (first - means) * (second - means)
    error = products.std() / np.sqrt(products.size) + allowed * abs(covariance)
    return float((products.mean() - covariance) / error)


@pytest.mark.slow
@SHAPES
@CASES
def test_covariances_of_area_and_count(count: float, spread: float, pulse: Pulse) -> None:
    model = replace(regular(count, spread, pulse), strengths=None)
    generator = np.random.default_rng(seed_of(f"regular covariance {count} {spread} {pulse.shape}"))
    area, alive = drawn(model, LAGS, 100_000, generator)
    for row, lag in enumerate(LAGS):
        found = float(autocovariance(model, lag)), float(count_noise(model).covariance(lag))
        assert abs(score(area[0], area[row], area_cumulants(model).mean, found[0])) <= 4.0
        assert abs(score(alive[0], alive[row], model.mean_live_junctions, found[1])) <= 4.0


def test_a_count_of_equal_lives_takes_two_values() -> None:
    assert count_variance(regular(2.5)) == pytest.approx(0.25, rel=1e-12)
    assert count_variance(regular(0.2)) == pytest.approx(0.16, rel=1e-12)
    assert count_variance(regular(20.0)) == 0.0
    np.testing.assert_allclose(count_noise(regular(2.5)).covariance([2.212, 4.424]), [-0.25, 0.25], atol=1e-12)


@pytest.mark.slow
@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(2.5, 0.2), (20.0, 0.2), (6.0, 6.0)])
def test_continuous_spectrum_is_the_transform_of_what_the_phase_does_not_tell(
    count: float, spread: float, pulse: Pulse
) -> None:
    model = regular(count, spread, pulse)
    lags, weights = panels(longest_life(model) * np.linspace(0.0, 1.0, 161) ** 2, 20)
    covariance = 2.0 * weights * area_noise(model).unphased(lags)
    for k in (0.0, 0.1, 0.7, 2.0, 9.0):
        expected = float(spectral_density(model, k))
        found = np.sum(covariance * np.cos(k * lags))
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-8 * np.abs(covariance).sum())
    m = model.sizes.moment
    expected = model.birth_rate * pulse.life_integral(1) ** 2 * (m(6) - m(3) ** 2)
    assert float(spectral_density(model, 0.0)) == pytest.approx(expected, rel=1e-9)


def test_unequal_strengths_add_to_the_continuous_spectrum_and_not_to_the_lines() -> None:
    psi = Lognormal(mean=250.0, std=75.0)
    model = replace(regular(4.0), strengths=psi)
    generator = np.random.default_rng(seed_of("regular force covariance"))
    force, _ = drawn(model, LAGS, 100_000, generator)
    for row, lag in enumerate(LAGS):
        covariance = float(area_noise(model, psi).covariance(lag))
        assert abs(score(force[0], force[row], force_cumulants(model).mean, covariance)) <= 4.0
    lags, weights = panels(np.linspace(0.0, 11.06, 41), 20)
    force = area_noise(model, psi).covariance(lags)
    unphased = 2.0 * weights * (force - 250.0**2 * autocovariance(model, lags))
    found = float(density_of(model, FORCE, np.array(0.4)))
    assert np.sum(unphased * np.cos(0.4 * lags)) == pytest.approx(found, rel=1e-9)


def records(model: Model, draws: int, generator: np.random.Generator) -> tuple[Doubles, Doubles]:
    """Return the means of area and count over the model's ticks for records of independent phase."""
    lags = [model.tick * i for i in range(model.tick_count + 1)]
    area, count = drawn(model, lags, draws, generator)
    return area.mean(axis=0), count.mean(axis=0)


@pytest.mark.slow
@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(0.5, 0.2), (2.5, 0.0), (2.5, 0.2), (6.0, 2.0)])
@pytest.mark.parametrize(("tick", "ticks"), [(1.7, 12), (4.424, 9)])
def test_error_of_a_mean_over_ticks(count: float, spread: float, pulse: Pulse, tick: float, ticks: int) -> None:
    """Ticks of 4.424 um meet births 2.212 um apart in the same phase for ever."""
    model = replace(regular(count, spread, pulse), tick=tick, tick_count=ticks - 1, strengths=None)
    generator = np.random.default_rng(seed_of(f"regular ticks {count} {spread} {pulse.shape} {tick}"))
    area, alive = records(model, 20_000, generator)
    assert abs(score(area, area, area_cumulants(model).mean, area_noise(model).variance_of_mean())) <= 4.0
    assert (
        abs(score(alive, alive, model.mean_live_junctions, count_noise(model).error_of_mean() ** 2, allowed=1e-4))
        <= 4.0
    )


def test_a_long_record_averages_lines_out_as_one_over_its_length() -> None:
    model = regular(2.5)
    errors = [area_noise(model).error_of_mean(length) for length in (1_000.3, 100_000.3)]
    assert errors[0] / errors[1] > 50.0
    assert area_noise(regular(2.5, 0.2)).error_of_mean(1e5) == pytest.approx(
        np.sqrt(float(spectral_density(regular(2.5, 0.2), 0.0)) / 1e5), rel=1e-3
    )


def ridden(slider: Slider, force: Doubles, step: float) -> Doubles:
    """Return the displacement under a periodic force, ticks over one period, by its Fourier series."""
    lines = np.fft.fft(force)
    w = 2.0 * np.pi * np.fft.fftfreq(force.size, step)
    return np.fft.ifft(lines / (slider.stiffness - slider.mass * w**2 + 1j * slider.damping * w)).real


@SHAPES
@pytest.mark.parametrize("count", [0.5, 2.5, 7.0])
@pytest.mark.parametrize("speed", [100.0, 1000.0])
def test_slider_under_a_periodic_force(count: float, pulse: Pulse, speed: float) -> None:
    model = replace(regular(count, pulse=pulse, slider=FIG5_SLIDER), sliding_speed=speed)
    ticks, spacing = 2**15, model.births.mean_spacing
    phase = (np.arange(ticks) + 0.5) / ticks * spacing
    force = 250.0 * sum(pulse.area(phase + j * spacing, 5.53) for j in range(8))
    displacement = ridden(FIG5_SLIDER, force, spacing / speed / ticks)
    assert response(model).displacement_std == pytest.approx(displacement.std(), rel=1e-6)
    assert response(model).mean_displacement == pytest.approx(displacement.mean(), rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("strengths", [None, Lognormal(mean=250.0, std=75.0)], ids=["equal", "unequal"])
def test_slow_slider_under_sizes_and_strengths_that_differ(strengths: Lognormal | None) -> None:
    """Over-damped and slow, Var x = int R_F(tau) exp(-k |tau| / (c V)) dtau / (2 c k V), the lines by themselves."""
    slider = replace(FIG5_SLIDER, mass=1e-9, damping=3.0)
    model = regular(2.5, 0.2, slider=slider)
    model = model if strengths is None else replace(model, strengths=strengths)
    lags, weights = panels(np.linspace(0.0, longest_life(model), 201), 16)
    rate = slider.stiffness / (slider.damping * 1000.0)
    unphased = area_noise(model, model.strengths).unphased(lags)
    expected = weights @ (unphased * np.exp(-rate * lags)) / (3.0 * 300.0 * 1000.0)
    k, power = area_noise(model).lines
    expected += model.strengths.mean**2 * np.sum(2.0 * power / (300.0**2 + (3.0 * 1000.0 * k) ** 2))
    assert response(model).displacement_std ** 2 == pytest.approx(expected, rel=1e-6)

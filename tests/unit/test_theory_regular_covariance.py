from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.laws import Lognormal
from rubnoise.contact.pulses import PULSES, TRIANGLE, Pulse
from rubnoise.model import Model, Slider
from rubnoise.theory import regular_births
from rubnoise.theory.campbell import area_cumulants, force_cumulants
from rubnoise.theory.correlation import autocovariance, force_autocovariance, unphased_covariance
from rubnoise.theory.exact import exact
from rubnoise.theory.lags import lag_edges, longest_life
from rubnoise.theory.motion_errors import mean_displacement_error, mean_force_error
from rubnoise.theory.occupancy import count_covariance, count_variance, mean_count, mean_count_error
from rubnoise.theory.quadrature import panels
from rubnoise.theory.regular_births import line_covariance, spectral_lines
from rubnoise.theory.response import response
from rubnoise.theory.sampling import mean_area_error, variance_of_time_mean
from rubnoise.theory.spectrum import density_at_zero, force_spectral_density, spectral_density
from tests.unit.regular_models import drawn, regular
from tests.unit.theory_models import FIG5_SLIDER
from tests.verification.seeds import seed_of

Doubles = NDArray[np.float64]

LAGS = [0.0, 0.3, 4.4, 7.0]
SHAPES = pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
CASES = pytest.mark.parametrize(("count", "spread"), [(0.5, 0.2), (2.5, 0.0), (2.5, 0.2), (20.0, 0.2), (6.0, 6.0)])


def score(first: Doubles, second: Doubles, means: float, covariance: float, allowed: float = 1e-9) -> float:
    """Return z of a sample covariance, a share of it allowed where all products are equal, as of 0 and 1 about 1/2."""
    products = (first - means) * (second - means)
    error = products.std() / np.sqrt(products.size) + allowed * abs(covariance)
    return float((products.mean() - covariance) / error)


@SHAPES
@CASES
def test_covariances_of_area_and_count(count: float, spread: float, pulse: Pulse) -> None:
    model = replace(regular(count, spread, pulse), strengths=None)
    generator = np.random.default_rng(seed_of(f"regular covariance {count} {spread} {pulse.shape}"))
    area, alive = drawn(model, LAGS, 100_000, generator)
    for row, lag in enumerate(LAGS):
        found = float(autocovariance(model, lag)), float(count_covariance(model, lag))
        assert abs(score(area[0], area[row], area_cumulants(model).mean, found[0])) <= 4.0
        assert abs(score(alive[0], alive[row], mean_count(model), found[1])) <= 4.0


@SHAPES
@CASES
def test_variance_is_the_covariance_at_no_lag(count: float, spread: float, pulse: Pulse) -> None:
    model = regular(count, spread, pulse)
    assert autocovariance(model, 0.0) == pytest.approx(area_cumulants(model).variance, rel=1e-10)
    assert count_variance(model) == float(count_covariance(model, 0.0))
    assert exact(model).count_std == pytest.approx(np.sqrt(count_variance(model)), rel=1e-15)


def test_a_count_of_equal_lives_takes_two_values() -> None:
    assert count_variance(regular(2.5)) == pytest.approx(0.25, rel=1e-12)
    assert count_variance(regular(0.2)) == pytest.approx(0.16, rel=1e-12)
    assert count_variance(regular(20.0)) == 0.0
    np.testing.assert_allclose(count_covariance(regular(2.5), [2.212, 4.424]), [-0.25, 0.25], atol=1e-12)


@pytest.mark.parametrize("spread", [0.2, 2.0])
def test_lives_of_many_spacings_are_summed_as_lines(spread: float, monkeypatch: pytest.MonkeyPatch) -> None:
    model = regular(200.0, spread)
    lags = np.array([0.0, 0.013, 0.05, 1.0, 5.0])
    summed = count_covariance(model, lags)
    monkeypatch.setattr(regular_births, "_MOST_SUMMED", 10)
    np.testing.assert_allclose(count_covariance(model, lags), summed, atol=1e-9)


@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(2.5, 0.2), (20.0, 0.2), (6.0, 6.0)])
def test_continuous_spectrum_is_the_transform_of_what_the_phase_does_not_tell(
    count: float, spread: float, pulse: Pulse
) -> None:
    model = regular(count, spread, pulse)
    edges = np.union1d(lag_edges(model, longest_life(model)), np.linspace(0.0, longest_life(model), 81))
    lags, weights = panels(edges, 20)
    covariance = 2.0 * weights * unphased_covariance(model, lags)
    for k in (0.0, 0.1, 0.7, 2.0, 9.0):
        expected = float(spectral_density(model, k))
        found = np.sum(covariance * np.cos(k * lags))
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-11 * np.abs(covariance).sum())
    m = model.sizes.moment
    expected = model.birth_rate * pulse.life_integral(1) ** 2 * (m(6) - m(3) ** 2)
    assert density_at_zero(model) == pytest.approx(expected, rel=1e-9)


def test_one_size_has_lines_alone() -> None:
    model = regular(2.5)
    np.testing.assert_array_equal(spectral_density(model, [0.0, 1.0, 300.0]), 0.0)
    lags = np.array([0.2, 3.0, 900.0])
    np.testing.assert_array_equal(autocovariance(model, lags), line_covariance(spectral_lines(model), lags))
    np.testing.assert_allclose(autocovariance(model, lags + model.births.mean), autocovariance(model, lags), rtol=1e-9)


def test_unequal_strengths_add_to_the_continuous_spectrum_and_not_to_the_lines() -> None:
    psi = Lognormal(mean=250.0, std=75.0)
    model = replace(regular(4.0), strengths=psi)
    generator = np.random.default_rng(seed_of("regular force covariance"))
    force, _ = drawn(model, LAGS, 100_000, generator)
    for row, lag in enumerate(LAGS):
        covariance = float(force_autocovariance(model, psi, lag))
        assert abs(score(force[0], force[row], force_cumulants(model).mean, covariance)) <= 4.0
    lags, weights = panels(np.linspace(0.0, 11.06, 41), 20)
    unphased = 2.0 * weights * (force_autocovariance(model, psi, lags) - 250.0**2 * autocovariance(model, lags))
    found = float(force_spectral_density(model, psi, 0.4))
    assert np.sum(unphased * np.cos(0.4 * lags)) == pytest.approx(found, rel=1e-9)


def records(model: Model, draws: int, generator: np.random.Generator) -> tuple[Doubles, Doubles]:
    """Return the means of area and count over the model's ticks for records of independent phase."""
    lags = [model.tick * i for i in range(model.tick_count + 1)]
    area, count = drawn(model, lags, draws, generator)
    return area.mean(axis=0), count.mean(axis=0)


@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(0.5, 0.2), (2.5, 0.0), (2.5, 0.2), (6.0, 2.0)])
@pytest.mark.parametrize(("tick", "ticks"), [(1.7, 12), (4.424, 9)])
def test_error_of_a_mean_over_ticks(count: float, spread: float, pulse: Pulse, tick: float, ticks: int) -> None:
    """Ticks of 4.424 um meet births 2.212 um apart in the same phase for ever."""
    model = replace(regular(count, spread, pulse), tick=tick, tick_count=ticks - 1, strengths=None)
    generator = np.random.default_rng(seed_of(f"regular ticks {count} {spread} {pulse.shape} {tick}"))
    area, alive = records(model, 20_000, generator)
    assert abs(score(area, area, area_cumulants(model).mean, variance_of_time_mean(model))) <= 4.0
    assert abs(score(alive, alive, mean_count(model), mean_count_error(model) ** 2, allowed=1e-4)) <= 4.0


def test_a_long_record_averages_lines_out_as_one_over_its_length() -> None:
    model = regular(2.5)
    errors = [mean_area_error(model, length) for length in (1_000.3, 100_000.3)]
    assert errors[0] / errors[1] > 50.0
    assert mean_area_error(regular(2.5, 0.2), 1e5) == pytest.approx(
        np.sqrt(density_at_zero(regular(2.5, 0.2)) / 1e5), rel=1e-3
    )


def test_a_constant_has_no_error() -> None:
    model = regular(4.0, pulse=TRIANGLE, slider=FIG5_SLIDER)
    assert mean_area_error(model) == mean_force_error(model) == mean_count_error(model) == 0.0
    assert mean_displacement_error(model, 4e4) == pytest.approx(0.0, abs=1e-12)


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
    ticks, spacing = 2**15, model.births.mean
    phase = (np.arange(ticks) + 0.5) / ticks * spacing
    force = 250.0 * sum(pulse.area(phase + j * spacing, 5.53) for j in range(8))
    displacement = ridden(FIG5_SLIDER, force, spacing / speed / ticks)
    assert response(model).displacement_std == pytest.approx(displacement.std(), rel=1e-6)
    assert response(model).mean_displacement == pytest.approx(displacement.mean(), rel=1e-7)


@pytest.mark.parametrize("strengths", [None, Lognormal(mean=250.0, std=75.0)], ids=["equal", "unequal"])
def test_slow_slider_under_sizes_and_strengths_that_differ(strengths: Lognormal | None) -> None:
    """Over-damped and slow, Var x = int R_F(tau) exp(-k |tau| / (c V)) dtau / (2 c k V), the lines by themselves."""
    slider = replace(FIG5_SLIDER, mass=1e-9, damping=3.0)
    model = regular(2.5, 0.2, slider=slider)
    model = model if strengths is None else replace(model, strengths=strengths)
    lags, weights = panels(np.linspace(0.0, longest_life(model), 201), 16)
    rate = slider.stiffness / (slider.damping * 1000.0)
    square, squared_mean = model.strengths.moment(2), model.strengths.mean**2
    unphased = unphased_covariance(model, lags, square, squared_mean)
    expected = weights @ (unphased * np.exp(-rate * lags)) / (3.0 * 300.0 * 1000.0)
    k, power = spectral_lines(model)
    expected += squared_mean * np.sum(2.0 * power / (300.0**2 + (3.0 * 1000.0 * k) ** 2))
    assert response(model).displacement_std ** 2 == pytest.approx(expected, rel=1e-6)

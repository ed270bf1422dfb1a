from dataclasses import replace
from math import inf, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.laws import Normal
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.campbell import area_cumulants, force_cumulants
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.drive import drive_of
from rubnoise.theory.response import response
from rubnoise.theory.spectrum import density_at_zero, spectral_density
from tests.unit.theory_models import model_of, one_size, paper_model

Doubles = NDArray[np.float64]

SPEEDS = [10.0, 1e3, 1e5, 1e7]  # 1e-2 mm/s to 10 m/s, in um/s
DAMPING_RATIOS = [1e-6, 1e-3, 0.02, 0.5, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 4.0, 1e3]


def slider_of(damping_ratio: float, stiffness: float = 300.0) -> Slider:
    return Slider(mass=0.005, stiffness=stiffness, damping=2.0 * damping_ratio * sqrt(0.005 * stiffness))


def free_motion(slider: Slider, time: Doubles) -> tuple[Doubles, Doubles]:
    """Return exp(-a t) cosh(r t) and exp(-a t) sinh(r t)/r with r^2 = a^2 - w_0^2, by two exponentials or a series."""
    rate = slider.damping / (2.0 * slider.mass)
    root = np.emath.sqrt(rate**2 - slider.stiffness / slider.mass)
    even = 0.5 * (np.exp((root - rate) * time) + np.exp(-(root + rate) * time))
    small = np.abs(root) * time < 1e-3
    series = time * (1.0 + (root * time) ** 2 / 6.0 * (1.0 + (root * time) ** 2 / 20.0)) * np.exp(-rate * time)
    odd = 0.5 * (np.exp((root - rate) * time) - np.exp(-(root + rate) * time)) / (root or 1.0)
    return even.real, np.where(small, series, odd).real


def stds_in_time(model: Model) -> tuple[float, float]:
    """Return both stds from R(tau) and the autocorrelation of the slider's impulse response, without any spectrum.

    int h(u) h(u + t) du = (even + a odd)/(2 c k), and minus its second derivative is (even - a odd)/(2 c m).
    """
    slider, longest = model.slider, 2.0 * model.sizes.support[1]
    rate = slider.damping / (2.0 * slider.mass)
    turns = longest / model.sliding_speed * slider.natural_angular_frequency * max(1.0, 2.0 * slider.damping_ratio)
    edges = np.union1d(
        np.linspace(0.0, longest, 2 * int(8 + min(turns, 4000.0) / 8)), longest * 2.0 ** -np.arange(40.0)
    )
    x, w = np.polynomial.legendre.leggauss(16)
    half = 0.5 * np.diff(edges)[:, None]
    lags = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * x
    even, odd = free_motion(slider, lags / model.sliding_speed)
    weighted = 2.0 * half * w / model.sliding_speed * autocovariance(model, lags) * model.strengths.moment(2)
    displacement = np.sum(weighted * (even + rate * odd)) / (2.0 * slider.damping * slider.stiffness)
    velocity = np.sum(weighted * (even - rate * odd)) / (2.0 * slider.damping * slider.mass)
    return sqrt(displacement), sqrt(velocity)


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("damping_ratio", DAMPING_RATIOS)
def test_both_stds_against_the_time_domain(damping_ratio: float, speed: float) -> None:
    model = one_size(slider=slider_of(damping_ratio), speed=speed)
    found = response(model)
    assert (found.displacement_std, found.velocity_std) == pytest.approx(stds_in_time(model), rel=2e-8)


@pytest.mark.parametrize("law", [Normal(centre=5.53, std=0.2), Normal(centre=2.0, std=3.0)], ids=["narrow", "wide"])
@pytest.mark.parametrize(("damping_ratio", "speed"), [(0.02, 1e3), (1e-4, 200.0), (3.0, 1e5)])
def test_spread_sizes_against_the_time_domain(law: Normal, damping_ratio: float, speed: float) -> None:
    model = model_of(law, law.centre, slider=slider_of(damping_ratio), speed=speed)
    found = response(model)
    assert (found.displacement_std, found.velocity_std) == pytest.approx(stds_in_time(model), rel=2e-8)


def test_a_coarse_grid_would_miss_the_resonance() -> None:
    model = one_size(slider=slider_of(1e-6))
    drive = drive_of(model)
    k = np.linspace(0.0, 20.0 * drive.resonance, 10_000)
    coarse = np.trapezoid(spectral_density(model, k) * drive.gain(k), k) * drive.strengths.moment(2) / np.pi
    assert abs(sqrt(coarse) / response(model).displacement_std - 1.0) > 0.5


def test_a_sharp_resonance_takes_the_density_where_it_stands() -> None:
    """White noise of density S_F drives a lightly damped oscillator to Var x = S_F / (2 c k)."""
    model = one_size(slider=slider_of(1e-6))
    drive, slider = drive_of(model), model.slider
    force_density = drive.strengths.moment(2) * spectral_density(model, drive.resonance) / drive.speed
    expected = sqrt(force_density / (2.0 * slider.damping * slider.stiffness))
    assert response(model).displacement_std == pytest.approx(expected, rel=1e-5)


def test_a_stiff_slider_follows_the_force() -> None:
    """At k_0 d = 5.5e5 displacement is F/k, velocity its rate: Var x' = (psi V/k)^2 lam (4/3) d^3, from int A'^2 ds."""
    model = one_size(slider=slider_of(0.3, stiffness=5e9), speed=10.0)
    found = response(model)
    assert found.displacement_std == pytest.approx(force_cumulants(model).std / 5e9, rel=1e-9)
    rate = model.birth_rate * 4.0 / 3.0 * 5.53**3
    assert found.velocity_std == pytest.approx(250.0 * 10.0 / 5e9 * sqrt(rate), rel=1e-5)


def test_fast_sliding_is_white_noise() -> None:
    model = paper_model(speed=1e9)
    slider = model.slider
    expected = 250.0 * sqrt(density_at_zero(model) / 1e9 / (2.0 * slider.damping * slider.stiffness))
    assert response(model).displacement_std == pytest.approx(expected, rel=1e-6)


def test_mean_displacement_is_the_static_deflection() -> None:
    model = paper_model()
    assert response(model).mean_displacement == pytest.approx(250.0 * area_cumulants(model).mean / 300.0, rel=1e-15)


def test_no_damping_has_no_stationary_spread() -> None:
    found = response(paper_model(slider=Slider(mass=0.005, stiffness=300.0, damping=0.0)))
    assert (found.displacement_std, found.one_way_validity) == (inf, inf)
    assert found.mean_displacement == pytest.approx(170.561, abs=5e-4)


@pytest.mark.parametrize("missing", ["slider", "strengths", "sliding_speed"])
def test_what_is_missing_is_refused(missing: str) -> None:
    with pytest.raises(Refused, match="needs"):
        response(replace(paper_model(), **{missing: None}))

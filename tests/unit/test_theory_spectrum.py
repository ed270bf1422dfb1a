import mpmath
import numpy as np
import pytest
from scipy.special import struve

from rubnoise.contact.laws import Normal
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.model import Model
from rubnoise.theory.spectrum import density_at_zero, mean_spectral_density, spectral_density
from rubnoise.theory.transform import transform_of
from tests.unit.theory_models import model_of, one_size, paper_model

PHASES = np.concatenate([np.geomspace(1e-8, 1e6, 90), np.linspace(1.0, 60.0, 60), [10.0, 20.0, 32.0, 31.999, 25.57]])
SPREADS = {"narrow": (5.53, 0.2), "wide": (5.53, 4.0), "wider than the mean": (2.0, 3.0)}


def transform_by_series(phase: float) -> float:
    with mpmath.workdps(40):
        return float(mpmath.pi * mpmath.struveh(1, mpmath.mpf(phase)) / mpmath.mpf(phase) ** 2)


def test_transform_of_a_life_over_fourteen_decades() -> None:
    expected = [transform_by_series(z) for z in PHASES.tolist()]
    np.testing.assert_allclose(transform_of(LENS).amplitude(PHASES), expected, rtol=1.5e-13)


def test_transform_at_zero_is_the_life_integral() -> None:
    assert transform_of(LENS).amplitude(0.0) == pytest.approx(2.0 / 3.0, rel=1e-14)


def test_the_library_function_alone_would_not_hold_that_bound() -> None:
    assert abs(float(np.pi * struve(1, 25.57) / 25.57**2) / transform_by_series(25.57) - 1.0) > 1.5e-13


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
@pytest.mark.parametrize("phase", [0.0, 1e-8, 0.3, 6.0, 33.0])
def test_transform_is_the_integral_over_the_life(pulse: Pulse, phase: float) -> None:
    angle, weights = np.polynomial.legendre.leggauss(60)
    angle, weights = 0.25 * np.pi * (angle + 1.0), 0.25 * np.pi * weights
    rising = pulse.area(1.0 - np.cos(angle), 1.0) * np.cos(phase * np.cos(angle)) * np.sin(angle)
    assert transform_of(pulse).amplitude(phase) == pytest.approx(2.0 * (weights @ rising), rel=1e-12)


def by_brute_force(model: Model, wavenumber: float) -> float:
    """Return S(k) with scipy's Struve function on panels narrower than the swing, halved towards d = 0."""
    low, high = model.sizes.support
    count = 20 + int(wavenumber * (high - low) / 8.0)
    edges = np.union1d(np.linspace(low, high, count), low + (high - low) * 2.0 ** -np.arange(20.0))
    x, w = np.polynomial.legendre.leggauss(20)
    half = 0.5 * np.diff(edges)[:, None]
    d = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * x
    pulses = np.pi * d * struve(1, wavenumber * d) / wavenumber**2
    return model.birth_rate * np.sum(half * w * model.sizes.density(d) * np.square(pulses))


@pytest.mark.parametrize("spread", SPREADS)
@pytest.mark.parametrize("wavenumber", [1e-3, 0.5, 3.0, 10.0, 40.0, 47.0, 52.0, 300.0])
def test_density_of_spread_sizes(spread: str, wavenumber: float) -> None:
    mean, std = SPREADS[spread]
    model = model_of(Normal(centre=mean, std=std), mean)
    assert spectral_density(model, wavenumber) == pytest.approx(by_brute_force(model, wavenumber), rel=1e-11)


@pytest.mark.parametrize("std", [1e-7, 1e-9, 1e-14])
@pytest.mark.parametrize("wavenumber", [0.0, 0.7, 40.0])
def test_a_hairline_spread_is_one_size(std: float, wavenumber: float) -> None:
    model = model_of(Normal(centre=5.53, std=std), 5.53)
    assert spectral_density(model, wavenumber) == pytest.approx(
        float(spectral_density(one_size(), wavenumber)), rel=1e-11
    )


def test_density_where_spread_exceeds_the_mean_by_thirty_digit_quadrature() -> None:
    """The law written again from its definition: Normal(2, 3) given d > 0."""
    model = model_of(Normal(centre=2.0, std=3.0), 2.0)
    with mpmath.workdps(30):

        def integrand(d: mpmath.mpf) -> mpmath.mpf:
            pulse = mpmath.pi * d * mpmath.struveh(1, 2 * d) / 4
            return mpmath.npdf((d - 2) / mpmath.mpf(3)) / 3 * pulse**2

        above = 1 - mpmath.ncdf(-mpmath.mpf(2) / 3)
        expected = mpmath.mpf(5) * mpmath.quad(integrand, mpmath.linspace(0, 32, 17), maxdegree=5) / above
    assert spectral_density(model, 2.0) == pytest.approx(float(expected), rel=1e-12)


@pytest.mark.parametrize("spread", ["wide", "wider than the mean"])
def test_tail_falls_with_the_fourth_power(spread: str) -> None:
    mean, std = SPREADS[spread]
    model = model_of(Normal(centre=mean, std=std), mean)
    m = model.sizes.moment
    k = 1e5
    tail = 4.0 * model.birth_rate * m(2) / k**4 * (1.0 + np.pi * m(1) / (4.0 * k * m(2)))
    assert spectral_density(model, k) == pytest.approx(tail, rel=1e-8)


def test_density_at_zero_is_finite_and_even_around() -> None:
    model = paper_model()
    k = np.array([[0.0, 1e-9], [0.3, -0.3]])
    found = spectral_density(model, k)
    assert found.shape == (2, 2)
    np.testing.assert_allclose(found[0], density_at_zero(model), rtol=1e-12)
    assert found[1, 0] == found[1, 1]


def test_many_wavenumbers_at_once_are_as_each_alone() -> None:
    model = paper_model()
    k = np.random.default_rng(7).permutation(np.geomspace(1e-4, 1e3, 5000))
    np.testing.assert_allclose(spectral_density(model, k)[::500], [spectral_density(model, x) for x in k[::500]], 1e-12)


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
def test_averaging_over_the_swing_keeps_the_integral_and_takes_the_swing(pulse: Pulse) -> None:
    z, transform = np.linspace(1e-3, 2000.0, 400_001), transform_of(pulse)
    window = np.exp(-0.5 * np.square((z - 700.0) / 60.0)) * z**4
    assert np.sum(window * transform.mean_square(z)) == pytest.approx(np.sum(window * transform.square(z)), rel=1e-13)
    born = np.sum(window * transform.from_birth(z))
    assert np.sum(window * transform.mean_from_birth(z)) == pytest.approx(born, rel=1e-12)
    far = (z > 300.0) & (z < 400.0)
    assert np.max(np.abs(np.diff(z[far] ** 4 * transform.mean_square(z[far])))) < 1e-5
    assert np.max(np.abs(np.diff(z[far] ** 4 * transform.square(z[far])))) > 1e-3


def test_spectrum_of_triangles_at_zero_and_far_out() -> None:
    model = model_of(Normal(centre=5.53, std=4.0), 5.53, pulse=TRIANGLE)
    m = model.sizes.moment
    assert spectral_density(model, 0.0) == pytest.approx(model.birth_rate * (np.pi / 4.0) ** 2 * m(6), rel=1e-12)
    tail = 6.0 * (np.pi / 4.0) ** 2 * model.birth_rate * m(2) / 1e5**4
    assert spectral_density(model, 1e5) == pytest.approx(tail, rel=1e-9)
    assert density_at_zero(model) == pytest.approx(float(spectral_density(model, 0.0)), rel=1e-12)


def test_mean_density_of_one_size_is_the_density_before_the_tail() -> None:
    k = np.array([0.0, 0.1, 1.0, 5.0])
    np.testing.assert_array_equal(mean_spectral_density(one_size(), k), spectral_density(one_size(), k))

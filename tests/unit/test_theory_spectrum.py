"""Exact spectra, correlations, transients and slopes of the force."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy.special import struve

from rubnoise.contact.distributions import Normal, Weibull
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.model import Model
from rubnoise.theory.coupling import force_slope_std
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.second_order import area_noise, autocovariance, count_noise, spectral_density
from rubnoise.theory.sizes import SETTLED
from rubnoise.theory.unit_pulse import amplitude, energy, from_birth, overlaps
from tests.unit.theory_models import model_of, one_size, paper_model, regular

PHASES = np.concatenate([np.geomspace(1e-8, 1e6, 90), np.linspace(1.0, 60.0, 60), [10.0, 20.0, 32.0, 31.999, 25.57]])
SPREADS = {"narrow": (5.53, 0.2), "wide": (5.53, 4.0), "wider than the mean": (2.0, 3.0)}


def transform_by_series(phase: float) -> float:
    with mpmath.workdps(40):
        return float(mpmath.pi * mpmath.struveh(1, mpmath.mpf(phase)) / mpmath.mpf(phase) ** 2)


def test_transform_of_a_life_over_fourteen_decades() -> None:
    expected = [transform_by_series(z) for z in PHASES.tolist()]
    found = amplitude(LENS, PHASES)
    np.testing.assert_allclose(found, expected, rtol=1e-10)
    np.testing.assert_allclose(energy(LENS, PHASES), np.square(expected), rtol=1e-6)


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
@pytest.mark.parametrize("phase", [0.0, 1e-8, 0.3, 6.0, 33.0])
def test_transform_is_the_integral_over_the_life(pulse: Pulse, phase: float) -> None:
    angle, weights = np.polynomial.legendre.leggauss(60)
    angle, weights = 0.25 * np.pi * (angle + 1.0), 0.25 * np.pi * weights
    rising = pulse.area(1.0 - np.cos(angle), 1.0) * np.cos(phase * np.cos(angle)) * np.sin(angle)
    assert amplitude(pulse, np.array(phase)) == pytest.approx(2.0 * (weights @ rising), rel=1e-10)
    assert energy(pulse, np.array([phase])) == pytest.approx(
        (2.0 * (weights @ rising)) ** 2, rel=1e-8 if phase < 16.0 else 1e-5
    )


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
    assert spectral_density(model, wavenumber) == pytest.approx(
        by_brute_force(model, wavenumber), rel=1e-8 if wavenumber * mean < 16.0 else 1e-5
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
    assert spectral_density(model, 2.0) == pytest.approx(float(expected), rel=1e-8)


@pytest.mark.parametrize("spread", ["wide", "wider than the mean"])
def test_tail_falls_with_the_fourth_power(spread: str) -> None:
    mean, std = SPREADS[spread]
    model = model_of(Normal(centre=mean, std=std), mean)
    m = model.sizes.moment
    k = 1e5
    tail = 4.0 * model.birth_rate * m(2) / k**4 * (1.0 + np.pi * m(1) / (4.0 * k * m(2)))
    assert spectral_density(model, k) == pytest.approx(tail, rel=1e-5)


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
def test_averaging_over_the_swing_keeps_the_integral_and_takes_the_swing(pulse: Pulse) -> None:
    z = np.linspace(1e-3, 2000.0, 400_001)
    window = np.exp(-0.5 * np.square((z - 700.0) / 60.0)) * z**4
    followed, settled = energy(pulse, z), energy(pulse, z, SETTLED)
    assert np.sum(window * settled) == pytest.approx(np.sum(window * followed), rel=1e-9)
    near = np.exp(-0.5 * np.square((z - 90.0) / 12.0)) * z**4
    assert np.sum(near * settled) == pytest.approx(np.sum(near * followed), rel=1e-8)
    born = np.sum(near * from_birth(pulse, z))
    assert np.sum(near * from_birth(pulse, z, SETTLED)) == pytest.approx(born, rel=1e-6)
    far = (z > 300.0) & (z < 400.0)
    assert np.max(np.abs(np.diff(z[far] ** 4 * settled[far]))) < 1e-5
    assert np.max(np.abs(np.diff(z[far] ** 4 * followed[far]))) > 1e-3


def test_spectrum_of_triangles_at_zero_and_far_out() -> None:
    model = model_of(Normal(centre=5.53, std=4.0), 5.53, pulse=TRIANGLE)
    m = model.sizes.moment
    assert spectral_density(model, 0.0) == pytest.approx(model.birth_rate * (np.pi / 4.0) ** 2 * m(6), rel=1e-12)
    tail = 6.0 * (np.pi / 4.0) ** 2 * model.birth_rate * m(2) / 1e5**4
    assert spectral_density(model, 1e5) == pytest.approx(tail, rel=1e-5)


MODELS = {
    "fig5": paper_model(),
    "one size": one_size(),
    "wide": model_of(Normal(centre=2.0, std=3.0), 2.0),
    "triangle": model_of(Normal(centre=5.53, std=0.2), 5.53, pulse=TRIANGLE),
}


def area(shape: str, s: mpmath.mpf) -> mpmath.mpf:
    x = min(abs(1 - s), mpmath.mpf(1))  # rounding may put a cut beyond the end of the life
    if shape == "lens":
        return (mpmath.acos(x) - x * mpmath.sqrt(1 - x * x)) / 2
    return mpmath.pi * (1 - x if shape == "triangle" else 1 - x * x) / 4


@pytest.mark.parametrize("lag", [0.0, 1e-3, 0.02, 0.4, 1.0, 1.3, 1.99])
@pytest.mark.parametrize("powers", [(1, 1), (1, 3), (2, 4)])
@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
def test_overlap_of_two_lives(lag: float, powers: tuple[int, int], pulse: Pulse) -> None:
    i, j = powers
    cuts = sorted({0.0, max(1.0 - lag, 0.0), min(1.0, 2.0 - lag), 2.0 - lag})
    with mpmath.workdps(20):
        expected = mpmath.quad(lambda s: area(pulse.shape, s) ** i * area(pulse.shape, s + lag) ** j, cuts)
    largest, promised = float(overlaps(pulse, *powers)(np.zeros(1))[0]), 1e-9 if powers == (1, 1) else 1e-6
    assert overlaps(pulse, *powers)(np.array([lag]))[0] == pytest.approx(float(expected), abs=promised * largest)


@pytest.mark.parametrize("name", MODELS)
def test_autocovariance_and_density_are_a_fourier_pair(name: str) -> None:
    model = MODELS[name]
    reach = 2.0 * model.sizes.support[1]
    x, w = np.polynomial.legendre.leggauss(12)
    edges = np.linspace(0.0, reach, 101)
    half = 0.5 * np.diff(edges)[:, None]
    lags = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * x
    weighted = 2.0 * half * w * autocovariance(model, lags)
    assert np.sum(weighted) == pytest.approx(float(spectral_density(model, 0.0)), rel=1e-8)
    for k in (0.1, 0.7, 2.0):
        assert np.sum(weighted * np.cos(k * lags)) == pytest.approx(float(spectral_density(model, k)), rel=1e-6)


WIDE = Normal(centre=2.0, std=3.0)
STARTS = {
    "one size": one_size(),
    "fig5": paper_model(),
    "wide": model_of(WIDE, 2.0),
    "triangle": model_of(WIDE, 2.0, pulse=TRIANGLE),
    "one triangle": replace(one_size(), pulse=TRIANGLE),
}


def by_trapezium(model: Model, distance: float) -> float:
    """Return lam E[int_0^s A ds'] from dense sums over age and diameter."""
    low, high = model.sizes.support
    ages = np.linspace(0.0, distance, 2001)
    if low == high:
        return model.birth_rate * float(np.trapezoid(model.pulse.area(ages, high), ages))
    d = np.linspace(low, high, 2002)[1:]
    grown = np.trapezoid(model.pulse.area(ages, d[:, None]), ages, axis=1)
    return model.birth_rate * float(np.trapezoid(grown * model.sizes.density(d), d))


@pytest.mark.parametrize("name", STARTS)
@pytest.mark.parametrize("distance", [0.5, 4.0, 9.0])
def test_area_grows_from_empty_as_the_lives_do(name: str, distance: float) -> None:
    model = STARTS[name]
    assert area_noise(model).from_empty(distance) == pytest.approx(by_trapezium(model, distance), rel=2e-5)


@pytest.mark.parametrize("name", STARTS)
def test_an_empty_start_lowers_the_means_by_a_lifes_worth(name: str) -> None:
    """A junction waits d on average for its area and its count: lam c_1 m_4 / T and lam 2 m_2 / T are missing."""
    model = replace(STARTS[name], start="empty")
    m = model.sizes.moment
    area = area_cumulants(model).mean - model.birth_rate * model.pulse.life_integral(1) * m(4) / 500.0
    count = count_noise(model).mean - model.birth_rate * 2.0 * m(2) / 500.0
    assert area_noise(model).expected_mean(500.0) == pytest.approx(area, rel=1e-8)
    assert count_noise(model).expected_mean(500.0) == pytest.approx(count, rel=1e-6)


# The slope of the friction force against differences of its autocovariance, which knows nothing of slopes.
UNEQUAL = Normal(centre=250.0, std=100.0)
WIDER = Normal(centre=5.53, std=2.0)
SLOPES = {
    "one size": one_size(),
    "figure 5": paper_model(),
    "wide": model_of(WIDER, 5.53),
    "wide triangles": model_of(WIDER, 5.53, pulse=TRIANGLE),
    "unequal strengths": replace(paper_model(), strengths=UNEQUAL),
    "regular": regular(20.0),
    "regular of many sizes": regular(20.0, 0.5),
    "regular triangles": regular(3.0, pulse=TRIANGLE),
    "regular triangles of many sizes": regular(2.5, 0.8, pulse=TRIANGLE),
    "regular exponential": regular(20.0, sizes=Weibull(mean=5.53, std=5.53)),
    "regular of unequal strengths": replace(regular(20.0, 0.5), strengths=UNEQUAL),
}


def _curvature(model: Model) -> float:
    """Return the limit of 2 (R(0) - R(h))/h^2, whose first correction is of the order of h."""
    step = 4e-3
    psi = model.strengths
    found = area_noise(model, psi).covariance([0.0, step, 0.5 * step])
    coarse, fine = 2.0 * (found[0] - found[1]) / step**2, 8.0 * (found[0] - found[2]) / step**2
    return float(2.0 * fine - coarse)


@pytest.mark.slow("regular of many sizes", "regular exponential", "regular of unequal strengths")
@pytest.mark.parametrize("name", SLOPES)
def test_the_variance_of_the_slope_is_the_curvature_of_the_autocovariance(name: str) -> None:
    assert force_slope_std(SLOPES[name]) ** 2 == pytest.approx(_curvature(SLOPES[name]), rel=5e-4)

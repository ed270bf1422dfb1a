import mpmath
import numpy as np
import pytest

from rubnoise.contact.laws import Normal
from rubnoise.contact.pulses import PULSES, TRIANGLE, Pulse
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.correlation import Powers, autocovariance, joint_cumulants, life_overlaps
from rubnoise.theory.spectrum import density_at_zero, spectral_density
from tests.unit.theory_models import model_of, one_size, paper_model

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
@pytest.mark.parametrize("powers", [(1, 1), (1, 3), (4, 2)])
@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
def test_overlap_of_two_lives(lag: float, powers: Powers, pulse: Pulse) -> None:
    i, j = powers
    cuts = sorted({0.0, max(1.0 - lag, 0.0), min(1.0, 2.0 - lag), 2.0 - lag})
    with mpmath.workdps(20):
        expected = mpmath.quad(lambda s: area(pulse.shape, s) ** i * area(pulse.shape, s + lag) ** j, cuts)
    assert life_overlaps(pulse, np.array(lag), (powers,))[powers] == pytest.approx(float(expected), rel=1e-11)


@pytest.mark.parametrize("name", MODELS)
def test_variance_at_no_lag_and_nothing_beyond_the_longest_life(name: str) -> None:
    model = MODELS[name]
    assert autocovariance(model, 0.0) == pytest.approx(area_cumulants(model).variance, rel=1e-12)
    assert autocovariance(model, 2.0 * model.sizes.support[1]) == pytest.approx(0.0, abs=1e-12)
    assert autocovariance(model, [-3.0, 3.0])[0] == pytest.approx(float(autocovariance(model, 3.0)), rel=1e-14)


@pytest.mark.parametrize("name", MODELS)
def test_autocovariance_and_density_are_a_fourier_pair(name: str) -> None:
    model = MODELS[name]
    reach = 2.0 * model.sizes.support[1]
    x, w = np.polynomial.legendre.leggauss(12)
    edges = np.linspace(0.0, reach, 101)
    half = 0.5 * np.diff(edges)[:, None]
    lags = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * x
    weighted = 2.0 * half * w * autocovariance(model, lags)
    assert np.sum(weighted) == pytest.approx(density_at_zero(model), rel=1e-10)
    for k in (0.1, 0.7, 2.0):
        assert np.sum(weighted * np.cos(k * lags)) == pytest.approx(float(spectral_density(model, k)), rel=1e-8)


def test_joint_cumulants_at_no_lag_are_the_cumulants() -> None:
    model = MODELS["fig5"]
    values = area_cumulants(model).values
    joint = joint_cumulants(model, 0.0, ((1, 1), (1, 2), (2, 2), (3, 3)))
    for (i, j), found in joint.items():
        assert found == pytest.approx(values[i + j - 1], rel=1e-12)

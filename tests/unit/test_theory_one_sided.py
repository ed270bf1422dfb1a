from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Normal
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.errors import Refused
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.quadrature import panels
from rubnoise.theory.spectrum import (
    density_at_zero,
    half_power_wavenumber,
    one_sided_density,
    one_sided_density_per_cycle,
    spectral_density,
    tail,
)
from tests.unit.theory_models import model_of, one_size, paper_model

PULSES = pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)


@PULSES
def test_both_densities_integrate_to_the_variance(pulse: Pulse) -> None:
    """Panels follow the swing up to k = 200; the tail beyond holds 1e-7 of the variance."""
    model = replace(paper_model(), pulse=pulse)
    k, weights = panels(np.linspace(0.0, 200.0, 801), 16)
    variance = area_cumulants(model).variance
    beyond = float(tail(model, 200.0)) * 200.0 / 3.0 / np.pi
    assert weights @ one_sided_density(model, k) + beyond == pytest.approx(variance, rel=1e-8)
    cycles = k / (2.0 * np.pi)
    assert weights / (2.0 * np.pi) @ one_sided_density_per_cycle(model, cycles) + beyond == pytest.approx(
        variance, rel=1e-8
    )


@PULSES
@pytest.mark.parametrize("std", [0.2, 2.0, 6.0])
def test_spread_leaves_the_tail_alone(pulse: Pulse, std: float) -> None:
    """What is left over is of the order 1/(k d)."""
    model = replace(model_of(Normal(centre=5.53, std=std), 5.53), pulse=pulse)
    k = np.array([1e3, 1e4])
    np.testing.assert_allclose(spectral_density(model, k), tail(model, k), rtol=4e-4)


@pytest.mark.parametrize(
    ("pulse", "swing"), [(LENS, 2.5 / np.sqrt(5530.0)), (TRIANGLE, 5.0 / 3.0)], ids=["lens", "triangle"]
)
def test_one_size_swings_about_the_tail(pulse: Pulse, swing: float) -> None:
    model = replace(one_size(5.53), pulse=pulse)
    k = 1000.0 + 20.0 * np.pi / 5.53 * np.arange(20_000) / 20_000
    ratio = spectral_density(model, k) / tail(model, k)
    assert ratio.mean() == pytest.approx(1.0, abs=1e-3)
    assert np.max(ratio) - 1.0 == pytest.approx(swing, rel=0.02)


def test_corner_of_one_size() -> None:
    corner = half_power_wavenumber(one_size(5.53))
    assert 2.0 * 5.53 * corner == pytest.approx(4.50, abs=0.01)
    assert spectral_density(one_size(5.53), corner) == pytest.approx(0.5 * density_at_zero(one_size(5.53)), rel=1e-12)


def test_corner_of_triangles_is_that_of_a_squared_sinc() -> None:
    """(sin y / y)^4 = 1/2 at y = k d / 2."""
    corner = half_power_wavenumber(replace(one_size(5.53), pulse=TRIANGLE))
    y = 0.5 * corner * 5.53
    assert (np.sin(y) / y) ** 4 == pytest.approx(0.5, rel=1e-12)


def test_large_junctions_in_a_wide_law_lower_the_corner() -> None:
    wide = model_of(Normal(centre=5.53, std=4.0), 5.53)
    assert half_power_wavenumber(wide) < 0.6 * half_power_wavenumber(one_size(5.53))


def test_regular_births_have_neither() -> None:
    model = replace(one_size(), births=RegularBirths(mean_spacing=0.5))
    with pytest.raises(Refused, match="tail of the spectrum is known for Poisson births alone"):
        tail(model, 1.0)
    with pytest.raises(Refused, match="corner of the spectrum is known for Poisson births alone"):
        half_power_wavenumber(model)

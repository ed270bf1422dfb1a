from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Lognormal
from rubnoise.errors import Refused
from rubnoise.model import Slider
from rubnoise.theory.drive import drive_of
from rubnoise.theory.quadrature import panels
from rubnoise.theory.regular_births import spectral_lines
from rubnoise.theory.response import (
    displacement_spectrum,
    displacement_spectrum_per_hertz,
    response,
    velocity_spectrum,
)
from rubnoise.theory.spectrum import density_at_zero
from tests.unit.theory_models import FIG5_SLIDER, one_size, paper_model


def test_both_spectra_integrate_to_the_spreads_of_figure_5() -> None:
    """Panels of a fifth of the half-width over the resonance, 5 rad/s wide, and wider ones on either side."""
    model, natural = paper_model(), FIG5_SLIDER.natural_angular_frequency
    edges = np.unique(np.concatenate([np.linspace(0.0, 2.0 * natural, 501), np.geomspace(2.0 * natural, 1e6, 1501)]))
    w, weights = panels(edges, 12)
    stds = [np.sqrt(weights @ spectrum(model, w) / np.pi) for spectrum in (displacement_spectrum, velocity_spectrum)]
    assert stds == pytest.approx([195.3059, 47241.1], rel=3e-6)
    motion = response(model)
    assert stds == pytest.approx([motion.displacement_std, motion.velocity_std], rel=1e-7)
    hertz = np.sqrt(weights / (2.0 * np.pi) @ displacement_spectrum_per_hertz(model, w / (2.0 * np.pi)))
    assert hertz == pytest.approx(stds[0], rel=1e-12)


def test_slow_swings_are_static_and_those_at_resonance_magnified() -> None:
    """S_x(0) = (psi/k)^2 S(0)/V, and 1/(2 zeta)^2 of the static value at the natural frequency."""
    model = paper_model()
    static = (250.0 / 300.0) ** 2 * density_at_zero(model) / 1000.0
    assert displacement_spectrum(model, 0.0) == pytest.approx(static, rel=1e-12)
    natural = FIG5_SLIDER.natural_angular_frequency
    fast = replace(model, sliding_speed=1e9)
    magnified = displacement_spectrum(fast, natural) / displacement_spectrum(fast, 0.0)
    assert magnified == pytest.approx(1.0 / (2.0 * FIG5_SLIDER.damping_ratio) ** 2, rel=1e-6)


def test_even_and_of_any_shape() -> None:
    w = np.array([[0.0, 100.0], [-100.0, 245.0]])
    found = displacement_spectrum(paper_model(), w)
    assert found.shape == (2, 2)
    assert found[0, 1] == found[1, 0]
    np.testing.assert_allclose(velocity_spectrum(paper_model(), w), w**2 * found)


def test_no_spectrum_without_damping_or_slider() -> None:
    undamped = one_size(slider=Slider(mass=0.005, stiffness=300.0, damping=0.0))
    with pytest.raises(Refused, match="without damping"):
        displacement_spectrum(undamped, 10.0)
    with pytest.raises(Refused, match="needs \\[slider\\]"):
        velocity_spectrum(one_size(), 10.0)


def test_unequal_strengths_count_by_their_mean_square() -> None:
    unequal = replace(paper_model(), strengths=Lognormal(mean=250.0, std=75.0))
    w = np.array([0.0, 100.0, 245.0])
    ratio = displacement_spectrum(unequal, w) / displacement_spectrum(paper_model(), w)
    np.testing.assert_allclose(ratio, unequal.strengths.moment(2) / 250.0**2, rtol=1e-12)


@pytest.mark.parametrize("strengths", [None, Lognormal(mean=250.0, std=75.0)], ids=["equal", "unequal"])
def test_integral_and_lines_of_regular_births_are_the_variance(strengths: Lognormal | None) -> None:
    slider = replace(FIG5_SLIDER, damping=1.0)
    model = replace(paper_model(slider=slider), births=RegularBirths(mean_spacing=0.5))
    model = model if strengths is None else replace(model, strengths=strengths)
    w, weights = panels(np.concatenate([np.linspace(0.0, 600.0, 61), np.geomspace(700.0, 1e5, 80)]), 20)
    k, power = spectral_lines(model)
    lines = 2.0 * model.strengths.mean**2 * np.sum(power * drive_of(model).gain(k))
    found = weights @ displacement_spectrum(model, w) / np.pi + lines
    assert found == pytest.approx(response(model).displacement_std ** 2, rel=1e-7)

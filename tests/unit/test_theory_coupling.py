"""The strength of coupling, and upward passages."""

from dataclasses import replace
from math import isnan, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.model import Model, Slider
from rubnoise.theory.coupling import coupling, weak_coupling_change
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import spectral_density
from tests.laws.scores import seed_of
from tests.models import model as scenario_model
from tests.models import recorded
from tests.unit.theory_models import FIG5_SLIDER, paper_model, regular

# The strength of coupling and its law against measured motions, a simulation of the law's own picture, and limits.
MEASURED = [
    (paper_model(speed=1e5), 1.0097, 0.0027),
    (paper_model(speed=5e4), 1.038, 0.005),
    (paper_model(speed=5e4, slider=replace(FIG5_SLIDER, damping=0.2)), 1.0086, 0.0022),
    (paper_model(speed=5e4, mean_count=80.0), 1.0058, 0.0019),
]
"""The displacement's std, two-way over one-way on the same junctions, as a prototype of two-way runs measured it."""


def test_figure_5_is_strongly_coupled() -> None:
    found = coupling(paper_model())
    assert found.strength == pytest.approx(2929.741, abs=5e-4)
    assert found.stick_number == pytest.approx(16.8602754, abs=5e-8)
    assert isnan(found.expected_change)
    assert "too strong" in found.unknown


def test_the_strength_is_that_of_the_sixth_moment() -> None:
    """Pi = psi^2 S(0)/(2 m c V^3), here from lam c_1^2 E[d^6]; not the fourth power of V, nor without the damping."""
    model = paper_model(speed=3e4)
    expected = 250.0**2 * float(spectral_density(model, 0.0)) / (2.0 * 0.005 * 0.05 * 3e4**3)
    assert coupling(model).strength == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("damping", [0.005, 0.05, 5.0], ids=["light", "figure 5", "over-damped"])
def test_the_strength_is_the_square_of_validity_for_a_force_white_to_the_slider(damping: float) -> None:
    """From below: no wavenumber has more than S(0)."""
    shares = []
    for speed in (1e3, 1e6, 1e9):
        model = paper_model(speed=speed, slider=replace(FIG5_SLIDER, damping=damping))
        shares.append(response(model).one_way_validity ** 2 / coupling(model).strength)
    assert shares[0] < shares[1] < shares[2] < 1.0
    assert shares[0] < 0.95
    assert shares[2] == pytest.approx(1.0, abs=1e-4)


def test_the_printed_figures_of_weak_coupling() -> None:
    """50 mm/s, where a junction's kick is left out: 1.035 to first order, 1.042 by the next."""
    strength = coupling(paper_model(speed=5e4)).strength
    assert 1.0 + 1.5 * strength == pytest.approx(1.035, abs=5e-4)
    assert weak_coupling_change(strength, 0.0) == pytest.approx(1.042, abs=5e-4)
    u = strength * weak_coupling_change(strength, 0.0) ** 2
    assert u == pytest.approx(strength * (1.0 + 3.0 * u + 15.0 * u**2), rel=1e-14)


def test_measured_changes_are_those_of_the_law() -> None:
    expected = [coupling(model).expected_change for model, _, _ in MEASURED]
    assert expected == pytest.approx([1.0048, 1.0437, 1.0104, 1.0049], abs=1e-4)
    scores = [(seen - told) / error for (_, seen, error), told in zip(MEASURED, expected, strict=True)]
    assert np.abs(scores).max() < 4.0
    assert np.square(scores).sum() < 18.5  # one in a thousand, of four degrees of freedom
    unchanged = [(seen - 1.0) / error for _, seen, error in MEASURED]
    assert np.square(unchanged).sum() > 90.0


def _variance_of_velocity(strength: float, kick: float, *, acts_back: bool) -> tuple[float, float]:
    """Return Var x'/V^2 over Pi and its relative error, of oscillators hit by junctions that have no width.

    w_0 = m = V = 1. A junction takes 2 q from w^2, or all of it. The times of those that could come are a Poisson
    process, so that what is seen just before them averages over time. The energy of an oscillator is exponential and
    forgets as exp(-c t), which makes the relative error of its mean over a time T sqrt(2/(c T)).
    """
    generator = np.random.default_rng(20)
    damping, fastest, oscillators, steps, left_out = 0.2, 2.0, 4000, 890, 178
    births = 2.0 * damping * strength / kick**2
    rate, turn = births * fastest, sqrt(1.0 - 0.25 * damping**2)
    mean = births * kick
    x = mean + sqrt(strength) * generator.standard_normal(oscillators)
    v = sqrt(strength) * generator.standard_normal(oscillators)
    total = 0.0
    for step in range(steps):
        time = generator.standard_exponential(oscillators) / rate
        decay, even, odd = np.exp(-0.5 * damping * time), np.cos(turn * time), np.sin(turn * time) / turn
        x, v = (
            decay * (even * x + odd * (v + 0.5 * damping * x)),
            decay * (even * v - odd * (x + 0.5 * damping * v)),
        )
        total += float(v @ v) if step >= left_out else 0.0
        w = 1.0 - v
        hit = generator.random(oscillators) * fastest < (w if acts_back else 1.0)
        v = np.where(hit, 1.0 - np.sqrt(np.maximum(np.square(w) - 2.0 * kick, 0.0)) if acts_back else v + kick, v)
    seen = oscillators * (steps - left_out)
    return total / seen / strength, sqrt(2.0 * rate / (damping * seen))


def test_the_law_is_that_of_oscillators_hit_by_junctions_without_width() -> None:
    strength, kick = 0.008, 0.03
    ratio, error = _variance_of_velocity(strength, kick, acts_back=True)
    assert error < 0.006
    assert abs(ratio / weak_coupling_change(strength, kick) ** 2 - 1.0) < 4.0 * error
    assert abs(ratio / weak_coupling_change(strength, 0.0) ** 2 - 1.0) > 4.0 * error
    assert abs(ratio - 1.0) > 4.0 * error


@pytest.mark.parametrize(
    ("model", "why"),
    [
        (paper_model(speed=3e4), "too strong"),
        (paper_model(slider=replace(FIG5_SLIDER, damping=20.0), speed=3e4), "white"),
        (replace(regular(20.0, 0.2, slider=FIG5_SLIDER), sliding_speed=1e5), "random"),
        (paper_model(slider=replace(FIG5_SLIDER, damping=0.0), speed=1e5), "damping"),
    ],
    ids=["strong", "slow", "regular", "undamped"],
)
def test_a_change_that_is_not_known_says_why(model: Model, why: str) -> None:
    found = coupling(model)
    assert isnan(found.expected_change)
    assert why in found.unknown
    assert found.stick_number > 0.0


# Passages of the mean against counts of a simulated slider.
Doubles = NDArray[np.float64]

SEGMENTS = 40
TICKS_A_SEGMENT = 20_000


@pytest.fixture(scope="module")
def slid() -> tuple[Model, Doubles]:
    """Return a model of skewness 0.02 and its displacement after the first second, a row for each 10 s of sliding."""
    tick, speed = 0.5, 1000.0
    spare = int(speed / tick)
    distance = tick * (spare + SEGMENTS * TICKS_A_SEGMENT)
    slider = Slider(mass=0.005, stiffness=300.0, damping=2.0 * 0.05 * sqrt(1.5))
    model = scenario_model(distance=distance, tick=tick, speed=speed, slider=slider)
    record = recorded(model, seed_of("passages of a simulated slider"))
    displacement = record.groups["slider"]["displacement"][spare : spare + SEGMENTS * TICKS_A_SEGMENT]
    return model, displacement.reshape(SEGMENTS, TICKS_A_SEGMENT)


def passage_score(rows: Doubles, tick_duration: float, at: float, expected: float) -> float:
    """Return z of the passages counted upwards, the error of their mean from segments that are independent."""
    rates = np.sum((rows[:, :-1] < at) & (rows[:, 1:] >= at), axis=1) / ((rows.shape[1] - 1) * tick_duration)
    return float((rates.mean() - expected) / (rates.std(ddof=1) / np.sqrt(rows.shape[0])))


@pytest.mark.slow
def test_passages_of_a_simulated_slider(slid: tuple[Model, Doubles]) -> None:
    model, rows = slid
    motion = response(model)
    assert abs(passage_score(rows, model.tick_duration, motion.mean_displacement, motion.upcrossing_rate)) <= 4.0
    assert passage_score(rows, model.tick_duration, motion.mean_displacement, 0.9 * motion.upcrossing_rate) > 5.0
    above = motion.mean_displacement + motion.displacement_std
    assert passage_score(rows, model.tick_duration, above, motion.upcrossing_rate) < -5.0


def test_a_light_slider_passes_its_mean_at_its_natural_frequency() -> None:
    model = paper_model()
    assert response(model).upcrossing_rate == pytest.approx(38.4968, abs=1e-4)
    light = paper_model(speed=1e7, slider=replace(FIG5_SLIDER, damping=1e-4))
    assert response(light).upcrossing_rate == pytest.approx(FIG5_SLIDER.natural_frequency, rel=1e-4)

"""The linear motion under a load that weighs: against a first-order reference, other integrals, and its limits."""

from dataclasses import replace
from itertools import pairwise
from math import cos, erfc, exp, inf, log, pi, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad

from rubnoise.contact.distributions import Lognormal
from rubnoise.model import Model
from rubnoise.theory.coupling import level, load_motion, overlap_scale, third_octaves
from rubnoise.theory.exact import exact
from rubnoise.theory.moments import force_cumulants
from rubnoise.theory.motion import motion_spectrum, response
from rubnoise.theory.sampling import load_errors
from tests.models import loaded

FIRST_ORDER = [
    # damping ratio, v, then std of z', z and P in units of s_0 omega_c, s_0 and W; 20 live junctions
    (0.05, 0.15, 0.078152, 0.32901, 0.062918),
    (0.05, 0.5, 0.45557, 0.56945, 0.43681),
    (0.05, 0.8, 0.7353, 0.80205, 0.73352),
    (0.05, 2.0, 0.76779, 0.78806, 0.81115),
    (0.05, 4.0, 0.59096, 0.59843, 0.66359),
    (0.05, 16.0, 0.30522, 0.30617, 0.438835),
    (0.3, 0.15, 0.051541, 0.32203, 0.040002),
    (0.3, 0.5, 0.18954, 0.36739, 0.19202),
    (0.3, 0.8, 0.26454, 0.38772, 0.29939),
    (0.3, 2.0, 0.28261, 0.32636, 0.39143),
    (0.3, 4.0, 0.22767, 0.24479, 0.37913),
]
FIG5 = [
    # s_0 (um), contact resonance (Hz), std F over mean, std x (um), std z (um)
    (0.1, 3183.098861837907, 0.0018254407758496812, 0.2702886106573798, 0.03162671387027823),
    (0.5, 1423.5250868343542, 0.006005791025842868, 0.6225883321842796, 0.1582813075565505),
]


def scaled(model: Model) -> tuple[float, float, float]:
    motion, held = load_motion(model), model.separation
    assert held is not None
    omega = held.oscillator.natural_angular_frequency
    height = held.height_scale
    return motion.velocity_std / height / omega, motion.separation_std / height, motion.load_std / held.load


@pytest.mark.parametrize(("ratio", "v", "velocity", "separation", "load"), FIRST_ORDER)
def test_spreads_are_those_of_the_reference(
    ratio: float, v: float, velocity: float, separation: float, load: float
) -> None:
    assert scaled(loaded(ratio=ratio, relative_speed=v)) == pytest.approx((velocity, separation, load), rel=1e-4)


@pytest.mark.parametrize(("height", "resonance", "force", "displacement", "separation"), FIG5)
def test_figure_5_goes_quiet(
    height: float, resonance: float, force: float, displacement: float, separation: float
) -> None:
    model = loaded(height=height)
    motion, found = load_motion(model), exact(model)
    assert found.force is not None
    assert found.slider is not None
    assert motion.contact_resonance == pytest.approx(resonance, rel=1e-12)
    assert found.force.std / found.force.mean == pytest.approx(force, rel=1e-4)
    assert found.slider.displacement_std == pytest.approx(displacement, rel=1e-4)
    assert motion.separation_std == pytest.approx(separation, rel=1e-3)
    assert motion.regime == "constant load"
    still = response(replace(model, separation=None)).displacement_std
    assert still == pytest.approx(223.70860511235702, rel=1e-5)
    assert motion.suppression == pytest.approx(still / displacement, rel=1e-4)


@pytest.mark.parametrize("height", [0.1, 0.5])
def test_unequal_strengths_are_then_all_there_is(height: float) -> None:
    """Their part is that of sum (psi_i - psi) A_i, which no load constrains: independent of the part of equal ones."""
    model = loaded(height=height)
    unequal = replace(model, strengths=Lognormal(mean=250.0, std=50.0))
    alone = sqrt(response(unequal).displacement_std ** 2 - response(model).displacement_std ** 2)
    assert alone == pytest.approx(44.74172102247141, rel=1e-5)


def correlation(t: float) -> float:
    """The relative area's, of Rayleigh paraboloids and 20 live junctions, at a lag of t times c."""
    return ((2.0 - t * t) * erfc(t / 2.0) + 2.0 * t * exp(-t * t / 4.0) / sqrt(pi)) / 20.0


@pytest.mark.parametrize("v", [0.1, 1.0, 10.0])
def test_variances_are_integrals_over_lags(v: float) -> None:
    """Var z = 2 int_0^inf R(tau) (h * h)(tau) dtau, in the units of the reference; the spectrum is not asked."""
    ratio = 0.05
    damped = sqrt(1.0 - ratio**2)

    def impulse_correlation(tau: float) -> float:
        return exp(-ratio * tau) * (cos(damped * tau) + ratio / damped * sin(damped * tau)) / (4.0 * ratio)

    def curvature(tau: float) -> float:
        return exp(-ratio * tau) * (cos(damped * tau) - ratio / damped * sin(damped * tau)) / (4.0 * ratio)

    ends = np.linspace(0.0, min(12.0 / v, 700.0), 200)
    place, speed = (
        2.0 * sum(quad(lambda t, f=f: correlation(v * t) * f(t), a, b)[0] for a, b in pairwise(ends))
        for f in (impulse_correlation, curvature)
    )
    velocity, separation, _ = scaled(loaded(ratio=ratio, relative_speed=v))
    assert separation == pytest.approx(sqrt(place), rel=1e-6)
    assert velocity == pytest.approx(sqrt(speed), rel=1e-6)


@pytest.mark.slow
def test_limits_are_constant_load_and_constant_gap() -> None:
    """The second one where the contact resonance is slow beside junctions and slider alike."""
    slow, fast = loaded(relative_speed=1e-3, ratio=0.3), loaded(relative_speed=1e4, ratio=0.3, mass=5e6)
    _, separation, load = scaled(slow)
    assert separation == pytest.approx(sqrt(2.0 / 20.0), rel=1e-5)
    assert load < 1e-3
    _, separation, load = scaled(fast)
    assert load == pytest.approx(sqrt(2.0 / 20.0), rel=1e-3)
    assert separation < 0.01
    assert (load_motion(slow).regime, load_motion(fast).regime) == ("constant load", "constant gap")
    still = replace(fast, separation=None)
    assert response(fast).displacement_std == pytest.approx(response(still).displacement_std, rel=1e-3)
    assert [load_motion(loaded(relative_speed=v)).regime for v in (0.5, 1.0)] == ["resonance", "resonance"]
    bounces = load_motion(loaded(relative_speed=1.0, count=5.0))
    assert (bounces.regime, bounces.error) == ("bouncing", inf)


def test_covariances_hold_together() -> None:
    """A stationary motion and its velocity have none; P - W = m z'' + c z' has what the balance of forces gives."""
    model = loaded(relative_speed=0.7)
    unequal = replace(model, strengths=Lognormal(mean=250.0, std=50.0))
    held, motion = model.separation, load_motion(unequal)
    assert held is not None
    found = motion.covariances
    std = {one: sqrt(value) for (one, other), value in found.items() if one == other}
    assert abs(found["separation", "normal_velocity"]) < 1e-12 * std["separation"] * std["normal_velocity"]
    assert abs(found["displacement", "velocity"]) < 1e-9 * std["displacement"] * std["velocity"]
    # E[z (m z'' + c z')] = -m E[z'^2], and E[z' (m z'' + c z')] = c E[z'^2].
    kinetic = std["normal_velocity"] ** 2
    assert found["separation", "load"] == pytest.approx(-held.mass * kinetic, rel=1e-9)
    assert found["normal_velocity", "load"] == pytest.approx(held.damping * kinetic, rel=1e-9)
    still = replace(unequal, separation=None)
    deviations = 50.0**2 * force_cumulants(still).variance / (250.0**2 + 50.0**2)
    assert std["friction_force"] ** 2 == pytest.approx(deviations + 0.25**2 * found["load", "load"], rel=1e-7)
    assert force_cumulants(unequal).std == std["friction_force"]
    assert response(unequal).displacement_std == std["displacement"]
    friction = 0.25 * found["load", "load"]
    assert found["load", "friction_force"] == pytest.approx(friction, rel=1e-12)


@pytest.mark.slow
def test_spectra_and_bands_add_up() -> None:
    model = loaded(relative_speed=0.5)
    motion = load_motion(model)
    omega = np.geomspace(1e-1, 1e7, 8_001)
    for name, std in (
        ("separation", motion.separation_std),
        ("normal_velocity", motion.velocity_std),
        ("load", motion.load_std),
    ):
        assert sqrt(np.trapezoid(motion_spectrum(name, model, omega), omega) / pi) == pytest.approx(std, rel=1e-3)
    bands = third_octaves(model)
    assert sqrt(np.sum(bands["velocity"] ** 2)) == pytest.approx(motion.velocity_std, rel=1e-5)
    assert np.allclose(np.diff(np.log10(bands["frequency"])), 0.1)
    assert level(0.05) == 0.0
    assert motion.velocity_level == pytest.approx(10.0 * np.log10(np.sum(10.0 ** (0.1 * bands["level"]))), abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("v", [0.05, 0.3, 1.0, 5.0])
@pytest.mark.parametrize("ratio", [0.05, 0.3])
def test_exponents_of_height_and_speed_belong_together(v: float, ratio: float) -> None:
    """m = (1 + n)/2, at fixed c, N, W, mass and damping ratio: v_rms = (V s_0/c) f(V^2 s_0 m/(c^2 W))."""
    step = 1e-3
    speed = loaded(relative_speed=v).sliding_speed or 0.0

    def velocity(**changes: float) -> float:
        return load_motion(loaded(**{"speed": speed, "ratio": ratio} | changes)).velocity_std

    n = log(velocity(speed=speed * exp(step)) / velocity(speed=speed * exp(-step))) / (2.0 * step)
    m = log(velocity(height=0.5 * exp(step)) / velocity(height=0.5 * exp(-step))) / (2.0 * step)
    assert m == pytest.approx((1.0 + n) / 2.0, abs=1e-5)
    if v == 0.05 and ratio == 0.3:
        assert n == pytest.approx(1.0, abs=0.05)
    if v == 5.0 and ratio == 0.05:
        assert n == pytest.approx(-0.5, abs=0.05)


@pytest.mark.parametrize(("count", "apart"), [(2000.0, 4e-4), (20.0, 4e-2)])
def test_the_error_of_the_loads_spread_is_that_of_a_gaussian_process_and_of_lives(count: float, apart: float) -> None:
    """Var of a mean square over T is 2/(pi T) int S^2 domega; what lives add to it goes as 1/N_jm."""
    model, distance, omega = loaded(count=count, relative_speed=0.5, ratio=0.3), 1e5, np.geomspace(1e-1, 1e7, 2_001)
    density = motion_spectrum("load", model, omega)
    square = np.trapezoid(density**2, omega) * 2.0 / pi * (model.sliding_speed or 0.0) / distance
    gaussian = sqrt(square) / (2.0 * load_motion(model).load_std)
    found = load_errors(model, distance)["load_std"]
    assert found / gaussian - 1.0 == pytest.approx(apart, rel=0.1)


def test_the_mean_square_diameter_sets_the_scale() -> None:
    assert overlap_scale(loaded()) == pytest.approx(sqrt(loaded().sizes.moment(2)), rel=1e-12)

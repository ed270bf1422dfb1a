"""The tail and the corner of the spectrum, and exponents."""

from dataclasses import replace
from itertools import cycle
from math import log
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.contact.laws import LAWS
from rubnoise.contact.pulses import PULSES, TRIANGLE, Pulse
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.second_order import half_power_wavenumber, spectral_density, tail
from rubnoise.theory.sizes import panels
from tests.unit.theory_models import one_size, paper_model

SIDES = pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)


@pytest.mark.slow
@SIDES
def test_the_density_integrates_to_the_variance(pulse: Pulse) -> None:
    """Panels follow the swing up to k = 200; the tail beyond holds 1e-7 of the variance."""
    model = replace(paper_model(), pulse=pulse)
    k, weights = panels(np.linspace(0.0, 200.0, 801), 16)
    variance = area_cumulants(model).variance
    beyond = float(tail(model, 200.0)) * 200.0 / 3.0 / np.pi
    assert weights @ spectral_density(model, k) / np.pi + beyond == pytest.approx(variance, rel=1e-8)


def test_corner_of_one_size() -> None:
    corner = half_power_wavenumber(one_size(5.53))
    assert 2.0 * 5.53 * corner == pytest.approx(4.50, abs=0.01)
    ratio = spectral_density(one_size(5.53), corner) / spectral_density(one_size(5.53), 0.0)
    assert ratio == pytest.approx(0.5, rel=1e-12)


def test_corner_of_triangles_is_that_of_a_squared_sinc() -> None:
    """(sin y / y)^4 = 1/2 at y = k d / 2."""
    corner = half_power_wavenumber(replace(one_size(5.53), pulse=TRIANGLE))
    y = 0.5 * corner * 5.53
    assert (np.sin(y) / y) ** 4 == pytest.approx(0.5, rel=1e-12)


# Exponents of junction diameter and of speed add up to 1: docs/field.md proves it, and exact theory obeys it.
MORE: dict[str, dict[str, Any]] = {
    "power": {"exponent": 3.0, "smallest": 0.25, "largest": 4.0},
    "mixture": {"weights": [0.7, 0.3], "parts": [{"law": "fixed", "mean": 4}, {"law": "fixed", "mean": 9}]},
    "empirical": {"values": [3.0, 4.5, 7.0]},
}
OF_LAWS: dict[str, dict[str, Any]] = {
    name: {
        "law": name,
        **({"spread": "30 %"} if entry.takes_spread else {}),
        **MORE.get(name, {}),
    }
    for name, entry in LAWS.items()
}
DAMPING_RATIOS = (1e-4, 0.02, 1.0, 30.0)
PAIRS = [(shape, name) for shape in PULSES for name in OF_LAWS]
CASES = [(*pair, ratio) for pair, ratio in zip(PAIRS, cycle(DAMPING_RATIOS), strict=False)]
STRENGTH = {"law": "constant", "mean": "250 MPa"}


def amplitudes(
    times: float, speed: float, *, count: float = 20.0, damping_ratio: float = 0.02, **tables: Any
) -> tuple[float, float]:
    """Return spreads of displacement and velocity on the area of Figure 5, with diameters ``times`` as large."""
    values: dict[str, Any] = {
        "format": 1,
        "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": count / times**2, "calibration": "exact"},
        "strength": STRENGTH,
        "sliding": {"speed": speed, "distance": 1e5},
        "slider": {"mass": 0.005, "stiffness": 300.0, "damping_ratio": damping_ratio},
        "output": {"tick": 1.0},
    }
    motion = rubnoise.exact(rubnoise.build(values | tables)).slider
    assert motion is not None
    return motion.displacement_std, motion.velocity_std


def sums(factor: float = 2.0, speed: float = 1000.0, **case: Any) -> list[float]:
    """Return the sum of both exponents for displacement and velocity, from two points that share V/d."""
    near, far = amplitudes(1.0, speed, **case), amplitudes(factor, factor * speed, **case)
    return [log(large / small) / log(factor) for small, large in zip(near, far, strict=True)]


@pytest.mark.slow("lens-normal-0.02", "lens-gamma-0.0001", "lens-power-1.0", "triangle-power-30.0")
@pytest.mark.parametrize(("shape", "law", "damping_ratio"), CASES)
def test_exponents_add_up_to_1_for_every_law_of_sizes_pulse_and_damping(
    shape: str, law: str, damping_ratio: float
) -> None:
    found = sums(pulse={"shape": shape}, diameter=OF_LAWS[law], damping_ratio=damping_ratio)
    assert found == pytest.approx([1.0, 1.0], abs=1e-6)


@pytest.mark.parametrize("law", ["fixed", "lognormal"])
def test_they_do_off_the_centre_line(law: str) -> None:
    found = sums(pulse={"offset": "uniform"}, diameter=OF_LAWS[law])
    assert found == pytest.approx([1.0, 1.0], abs=1e-6)


@pytest.mark.parametrize("speed", [20.0, 450.0, 1e5])
def test_they_do_at_every_speed_by_exponents_of_one_variable(speed: float) -> None:
    step = 1.001
    slower, faster = amplitudes(1.0, speed / step), amplitudes(1.0, speed * step)
    smaller, larger = amplitudes(1.0 / step, speed), amplitudes(step, speed)
    for quantity in range(2):
        of_speed = log(faster[quantity] / slower[quantity]) / log(step) / 2.0
        of_size = log(larger[quantity] / smaller[quantity]) / log(step) / 2.0
        assert of_speed + of_size == pytest.approx(1.0, abs=1e-6)
        assert abs(of_size - 1.0) > 1e-3


def test_no_other_scaling_has_the_identity() -> None:
    absolute = {"law": "normal", "spread": "1 um"}
    assert abs(sums(diameter=absolute)[0] - 1.0) > 1e-3
    # The spacing of regular births is no fixed part of the diameter, so their spectral lines move.
    assert abs(sums(birth={"law": "regular"}, count=4.0)[0] - 1.0) > 0.1
    near, far = amplitudes(1.0, 1e4), amplitudes(2.0, 1e4)
    assert log(far[0] / near[0]) / log(2.0) == pytest.approx(1.5, abs=0.01)


def exponent_of_speed(speed: float, quantity: int) -> float:
    slower, faster = (amplitudes(1.0, speed * factor, **FIGURE_5)[quantity] for factor in (0.995, 1.005))
    return log(faster / slower) / log(1.005 / 0.995)


FIGURE_5 = {
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20.0, "calibration": "paper"},
    "diameter": {"law": "normal", "spread": "0.2 um"},
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("quantity", "windows"), [(0, [(200.0, 210.0), (400.0, 470.0)]), (1, [(410.0, 490.0)])], ids=["std x", "std x'"]
)
def test_figure_5_rises_with_speed_as_published_only_where_the_page_says(
    quantity: int, windows: list[tuple[float, float]]
) -> None:
    for low, high in windows:
        assert 0.6 <= exponent_of_speed(0.5 * (low + high), quantity) <= 1.1
        assert not 0.6 <= exponent_of_speed(low - 10.0, quantity) <= 1.1
        assert not 0.6 <= exponent_of_speed(high + 10.0, quantity) <= 1.1
    for speed in (250.0, 300.0, 350.0, 520.0, 600.0, 700.0, 1e3, 1e4, 7e5):
        assert not 0.6 <= exponent_of_speed(speed, quantity) <= 1.1

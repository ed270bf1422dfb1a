"""Older models beside this one: published figures of each, limits, and what is refused."""

import json
from dataclasses import replace
from math import pi

import numpy as np
import pytest

import rubnoise
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.ancestors import (
    height_integral,
    velocity_weakening,
    white_noise,
)
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.motion import response
from tests.models import model
from tests.shell.terminal import call


def one_size(**slider: object) -> Model:
    run = model(spread=Spread())
    return replace(run, slider=replace(run.slider, **slider))  # type: ignore[type-var]


def test_white_noise_has_its_published_figures() -> None:
    found, own = white_noise(one_size()), response(one_size())
    assert found["force_density"] == pytest.approx(1436574.38, rel=1e-8)
    assert (found["displacement_std"], found["velocity_std"]) == pytest.approx((218.828, 53602.0), rel=1e-5)
    assert found["life_phase"] == pytest.approx(4.50, abs=5e-3)
    assert found["displacement_std"] / own.displacement_std == pytest.approx(1.129, abs=5e-4)
    assert found["velocity_std"] / own.velocity_std == pytest.approx(1.143, abs=5e-4)
    assert white_noise(replace(model(births="gamma"), pulse=one_size().pulse))["wavenumber"] is None


LISTS: list[dict[str, object]] = [
    {"law": "empirical", "values": [4.0, 5.0, 8.5]},
    {"law": "mixture", "weights": [1.0, 2.0], "parts": [{"law": "fixed", "mean": 4}, {"law": "fixed", "mean": 9}]},
]


@pytest.mark.parametrize("sizes", LISTS)
def test_lists_of_sizes_are_the_same_when_read_again(sizes: dict[str, object]) -> None:
    """An unfinished run goes on if its stored scenario equals the one that is asked for."""
    asked = {"interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20.0}, "diameter": sizes}
    resolved = rubnoise.build({"format": 1, "sliding": {"distance": 1000.0}} | asked).resolved()
    assert json.loads(json.dumps(resolved)) == resolved


BIRTHS: dict[str, tuple[dict[str, object], list[float], float]] = {
    "poisson": ({}, [22975.8, 22065.5, 15847.1, 211.268], 0.27499),
    "gamma 4": ({"law": "gamma", "shape": 4.0}, [5743.97, 5517.70, 3970.29, 54.0872], 0.13771),
    "gamma 0.5": ({"law": "gamma", "shape": 0.5}, [45951.3, 44097.5, 31485.9, 400.571], 0.38737),
    "clustered": (
        {"law": "clustered", "cluster_size": 3.0, "cluster_width": "2 um"},
        [91875.7, 85666.4, 49015.4, 222.876],
        0.48902,
    ),
}
"""Tables of births, spectral densities at k = 0.01, 0.1, 0.3 and 1 rad/um, and std over mean of the area."""


@pytest.mark.parametrize("name", BIRTHS)
def test_births_have_their_spectra_to_every_digit(name: str) -> None:
    """By a second program, for lenses of 5.530012635 um of which 20 are alive on average."""
    table, densities, spread = BIRTHS[name]
    asked = {"interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20.0, "calibration": "paper"}}
    theory = rubnoise.exact(rubnoise.build({"format": 1, "sliding": {"distance": 1000.0}, "birth": table} | asked))
    assert theory.mean_diameter == pytest.approx(5.530012635, rel=1e-9)
    assert theory.spectral_density(np.array([0.01, 0.1, 0.3, 1.0])) == pytest.approx(densities, rel=5e-6)
    assert theory.area.std / theory.area.mean == pytest.approx(spread, rel=2e-3), "kept to what its brute sums resolve"


@pytest.mark.parametrize(("count", "times"), [(20.0, 1.0), (0.2, 0.1)])
def test_a_base_of_asperities_has_its_published_figures(count: float, times: float) -> None:
    run = model(spread=Spread(), area=10.0 * count, count=count)
    height = 0.1 / run.calibrated_diameter
    lifted = replace(run, pulse=TRIANGLE, slider=replace(run.slider, excitation="base", asperity_height=height))  # type: ignore[type-var]
    found = response(lifted)
    assert found.mean_displacement == pytest.approx(count / 20.0, rel=1e-12)
    assert lifted.base_per_area * area_cumulants(lifted).std == pytest.approx(0.2581989 * times, rel=1e-7)
    assert (found.displacement_std, found.velocity_std) == pytest.approx(
        (1.1066318 * times, 267.2051 * times), rel=2e-6
    )
    with pytest.raises(Refused, match="driven"):
        response(replace(run, slider=replace(run.slider, excitation="base")))  # type: ignore[type-var]


BORDER = [(0.0, True), (0.05, True), (0.0500001, False), (0.1, False), (0.5, False)]


@pytest.mark.parametrize(("slope", "steady"), BORDER)
def test_the_border_is_the_damping(slope: float, steady: bool) -> None:  # noqa: FBT001  (a case)
    run = one_size(excitation="velocity-weakening", slope=slope)
    found = velocity_weakening(run)
    assert (found["steady"], found["border"]) == (steady, 0.05)
    assert (found["amplitude"] > 0.0) == (not steady)


def test_a_force_that_falls_with_speed_has_no_noise() -> None:
    """Of the contact only the mean force is left: no spread, spectrum or distribution, and no picture of them."""
    asked = ("theory", "paper/fig5", "--set", "slider.excitation=velocity-weakening", "--set", "slider.slope=0.1 N*s/m")
    found = call(*asked, "--json").values()
    assert set(found) == {"title", "passed", "failing", "notes", "velocity_weakening"}
    assert found["velocity_weakening"]["mean_force"] == pytest.approx(51168.4, rel=1e-6)
    text = call(*asked).out
    assert "mean force" in text
    assert not any(word in text for word in ("std", "spectral", "autocovariance", "distribution", "junction"))
    for curve in (("--at-lag", "1"), ("--plot",), ("--white",)):
        refused = call(*asked, *curve)
        assert (refused.code, refused.out) == (2, "")
        assert "has no noise" in refused.err


def test_a_cycle_obeys_its_closed_solution() -> None:
    """In the slip y is a growing oscillation about 0, which begins at the spring's largest pull with the speed V."""
    run, slope = one_size(excitation="velocity-weakening", slope=0.3), 0.3
    found, slider = velocity_weakening(run), run.slider
    assert slider is not None
    rate = 0.5 * (slope - slider.damping) / slider.mass
    turn = np.sqrt(slider.stiffness / slider.mass - rate**2)
    start, speed = 2.0 * rate * slider.mass * 1000.0 / slider.stiffness, 1000.0
    slipped = found["period"] * (1.0 - found["stick_fraction"])
    t = np.linspace(0.0, slipped, 20001)
    ahead = (speed - rate * start) / turn
    y = np.exp(rate * t) * (start * np.cos(turn * t) + ahead * np.sin(turn * t))
    velocity = np.gradient(y, t)
    assert velocity[-1] == pytest.approx(speed, rel=2e-3)
    assert velocity.min() == pytest.approx(found["slowest"], rel=1e-4)
    assert 0.5 * np.ptp(y) == pytest.approx(found["amplitude"], rel=1e-4)
    assert (start - y[-1]) / speed == pytest.approx(found["period"] * found["stick_fraction"], rel=1e-3)


@pytest.mark.parametrize(
    ("h", "first", "more"),
    [
        (0.0, 0.3989422804, 0.4300199937),
        (1.0, 0.0833154706, 0.0756681774),
        (2.0, 0.0084907026, 0.0066481776),
        (3.0, 0.000382154317, 0.000263967554),
    ],
)
def test_height_integrals_have_their_published_figures(h: float, first: float, more: float) -> None:
    assert height_integral("gaussian", 1.0, h) == pytest.approx(first, rel=2e-8)
    assert height_integral("gaussian", 1.5, h) == pytest.approx(more, rel=2e-8)
    assert height_integral("gaussian", 1.0, -8.0) == pytest.approx(8.0, rel=1e-12)


def test_a_rough_contact_has_its_published_figures() -> None:
    surface = {"radius": 50.0, "height": 0.5, "density": "20 1/mm^2", "modulus": 1e5, "hardness": "2 GPa"}
    found = rubnoise.greenwood_williamson(**surface, separation=0.0, heights="exponential")
    assert found.load == pytest.approx(8.862269e6, rel=1e-7)
    assert (found.real_contact_area, found.junction_count) == pytest.approx((1570.796, 20.0), rel=1e-6)
    assert (found.mean_pressure, found.plasticity_index) == pytest.approx((5641.896, 5.0), rel=1e-7)
    for load in ("1 mN", "1 N"):  # the area of a contact is pi R s, whatever the load
        light = rubnoise.greenwood_williamson(**surface, load=load, heights="exponential")
        assert light.real_contact_area / light.junction_count == pytest.approx(pi * 25.0, rel=1e-12)
    plastic = rubnoise.greenwood_williamson(**surface, load="1 N", regime="plastic")
    assert plastic.mean_pressure == pytest.approx(2000.0, rel=1e-12)
    text = f'format = 1\n{plastic.interface()}[sliding]\ndistance = "1 mm"\n'
    assert rubnoise.scenario.loads(text).model().mean_real_contact_area == pytest.approx(500.0, rel=1e-8)

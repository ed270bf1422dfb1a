"""What the page predicts is what the package predicts, to six digits, wherever a knob may stand."""

from typing import Any

import numpy as np
import pytest

import rubnoise
from tests.lesson.node import answer
from tests.lesson.worlds import WORLDS, scenario_of, world_with

TOLERANCE = 1e-6
NUMBERS = """
const e = rub.theory.exact(world);
const names = ['diameter', 'diameterMean', 'lengthBiasedMean', 'countMean', 'countStd', 'areaMean', 'areaStd',
  'skewness', 'forceMean', 'forceStd', 'displacementMean', 'displacementStd', 'velocityStd', 'oneWay', 'spacing',
  'lifeMean', 'naturalFrequency', 'dampingRatio'];
return Object.fromEntries(names.map((name) => [name, e[name]]));
"""


def expected(world: dict[str, Any]) -> dict[str, float]:
    theory = rubnoise.exact(scenario_of(world))
    model, slider = theory.model, theory.slider
    assert slider is not None
    assert theory.force is not None
    assert model.slider is not None
    return {
        "diameter": model.calibrated_diameter,
        "diameterMean": theory.mean_diameter,
        "lengthBiasedMean": theory.length_biased_mean_diameter,
        "countMean": theory.count_mean,
        "countStd": theory.count_std,
        "areaMean": theory.area.mean,
        "areaStd": theory.area.std,
        "skewness": theory.area.skewness,
        "forceMean": theory.force.mean,
        "forceStd": theory.force.std,
        "displacementMean": slider.mean_displacement,
        "displacementStd": slider.displacement_std,
        "velocityStd": slider.velocity_std,
        "oneWay": slider.one_way_validity,
        "spacing": model.mean_birth_spacing,
        "lifeMean": theory.model.pulse.mean_life * theory.mean_diameter,
        "naturalFrequency": model.slider.natural_frequency,
        "dampingRatio": model.slider.damping_ratio,
    }


def told_apart(world: dict[str, Any]) -> str:
    return "-".join(str(world[key]) for key in ("births", "pulse", "offset", "meanCount", "spread", "speed", "damping"))


@pytest.mark.parametrize("world", WORLDS, ids=told_apart)
def test_numbers_are_those_of_the_package(world: dict[str, Any]) -> None:
    found, wanted = answer(NUMBERS, world=world), expected(world)
    assert found.keys() == wanted.keys()
    for name, value in wanted.items():
        assert found[name] == pytest.approx(value, rel=TOLERANCE, abs=1e-9), name


@pytest.mark.parametrize("world", WORLDS, ids=told_apart)
def test_spectrum_and_autocovariance_are_those_of_the_package(world: dict[str, Any]) -> None:
    theory = rubnoise.exact(scenario_of(world))
    d = theory.model.calibrated_diameter
    wavenumbers = np.array([0.0, 0.5, 3.0, 9.9, 10.1, 19.9, 20.1, 31.9, 32.1, 100.0, 1000.0]) / d
    lags = np.array([0.0, 0.01, 0.5, 0.99, 1.0, 1.5, 1.9, 1.99, 2.5]) * d
    body = "const e = rub.theory.exact(world); return [wavenumbers.map(e.spectrum), lags.map(e.autocovariance)];"
    density, value = answer(body, world=world, wavenumbers=wavenumbers.tolist(), lags=lags.tolist())
    np.testing.assert_allclose(density, theory.spectral_density(wavenumbers), rtol=TOLERANCE, atol=1e-12)
    scale = 1e-9 * theory.area.mean**2
    np.testing.assert_allclose(value, theory.autocovariance(lags), rtol=TOLERANCE, atol=scale)


FEW = [
    world_with(meanCount=count, spread=spread, pulse=pulse, calibration="exact")
    for count, spread, pulse in (
        (0.5, 0.0, "lens"),
        (0.5, 0.0, "triangle"),
        (0.5, 3.0, "lens"),
        (1.0, 0.2, "lens"),
        (2.0, 0.0, "lens"),
        (2.0, 5.0, "lens"),
        (400.0, 0.0, "lens"),
    )
]


def densities(world: dict[str, Any]) -> tuple[Any, Any, float, float]:
    """Return the density of the area on the page and in the package, and the two atoms.

    At the same areas, but neither at 0 nor within a cell of the page's lattice of the jump that equal sizes make.
    """
    theory = rubnoise.exact(scenario_of(world))
    top = theory.area.mean + 4.5 * theory.area.std
    body = """const contact = rub.model.contact(world);
    return [Array.from(rub.theory.areaDensity(contact, top)), rub.theory.areaAtom(contact)];"""
    found, atom = answer(body, world=world, top=top)
    law = theory.distribution()
    areas = np.linspace(0.0, top, len(found))
    jump = 0.25 * np.pi * theory.model.calibrated_diameter**2 if world["spread"] == 0.0 else np.inf
    rows = (areas > 0.0) & (np.abs(areas - jump) > top / 7680)
    return np.array(found)[rows], law.density(areas[rows]), atom, law.atom_at_zero


OFF_CENTRE = [
    world_with(offset="uniform", calibration="exact", meanCount=count, spread=spread)
    for count, spread in ((0.5, 0.0), (2.0, 3.0), (20.0, 0.2))
]


@pytest.mark.parametrize(
    "world", [WORLDS[0], WORLDS[1], WORLDS[3], WORLDS[4], WORLDS[6], *FEW, *OFF_CENTRE], ids=told_apart
)
def test_the_distribution_is_that_of_the_package(world: dict[str, Any]) -> None:
    found, expected, atom, wanted = densities(world)
    assert atom == pytest.approx(wanted, rel=1e-9)
    # The peak beside the unbounded density near 0, where junctions are being born.
    np.testing.assert_allclose(found, expected, rtol=0.01, atol=0.01 * expected[11:].max())


def test_a_normal_curve_would_be_noticed() -> None:
    theory = rubnoise.exact(scenario_of(FEW[4]))
    _, expected, _, _ = densities(FEW[4])
    areas = np.linspace(0.0, theory.area.mean + 4.5 * theory.area.std, expected.size + 1)[1:]
    normal = np.exp(-0.5 * ((areas - theory.area.mean) / theory.area.std) ** 2) / (
        theory.area.std * np.sqrt(2.0 * np.pi)
    )
    assert np.abs(expected - normal).max() > 0.1 * expected[11:].max()


def test_triangles_of_one_size_at_regular_spacing_are_constant() -> None:
    world = world_with(births="regular", pulse="triangle", calibration="exact", spread=0.0)
    found = answer(NUMBERS, world=world)
    assert (found["areaStd"], found["skewness"]) == (0.0, None)
    assert answer(NUMBERS, world=world | {"meanCount": 3.0})["areaStd"] == pytest.approx(200.0 / (3**0.5 * 9), rel=1e-9)


def test_a_spread_that_no_diameter_matches_is_known() -> None:
    world = world_with(calibration="matched", spread=4.0)
    least = 1.609247 * 20.0 * 16.0
    ask = "return rub.model.calibratedDiameter(world);"
    assert answer(ask, world=world | {"meanArea": 0.999 * least}) is None
    assert answer(ask, world=world | {"meanArea": 1.001 * least}) > 0.887 * 4.0


def test_a_wrong_prediction_would_be_noticed() -> None:
    wanted = expected(world_with())
    found = answer(NUMBERS, world=world_with(spread=0.201))
    assert found["areaStd"] != pytest.approx(wanted["areaStd"], rel=TOLERANCE)

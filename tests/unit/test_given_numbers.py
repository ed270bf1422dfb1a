"""Numbers that Python gives to theory and to one junction: units of pint, nan, inf, and what is no number."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pint
import pytest
from numpy.testing import assert_array_equal

import rubnoise

UNIT: Any = pint.UnitRegistry()
BASE = rubnoise.example("paper/fig5").replace(distance="2 mm")
THEORY = rubnoise.exact(BASE)
LAW = THEORY.distribution()
REGULAR = rubnoise.exact(BASE.replace({"birth.law": "regular"}))
MEAN = THEORY.area.mean
CASES: dict[str, tuple[Callable[[Any], Any], Any, tuple[float, float]]] = {
    "spectrum": (THEORY.spectral_density, 1e3 / UNIT.mm, (0.0, 0.0)),
    "spectrum of regular births": (REGULAR.spectral_density, 1e3 / UNIT.mm, (0.0, 0.0)),
    "autocovariance": (THEORY.autocovariance, 1e-3 * UNIT.mm, (0.0, 0.0)),
    "area from empty": (THEORY.area_from_empty, 1e-3 * UNIT.mm, (0.0, MEAN)),
    "count from empty": (THEORY.count_from_empty, 1e-3 * UNIT.mm, (0.0, 20.0)),
    "crossings": (THEORY.crossing_rate, 1e-3 * UNIT.mm, (0.0, 0.0)),
    "Gaussian crossings": (THEORY.gaussian_crossing_rate, 1e-3 * UNIT.mm, (0.0, 0.0)),
    "cdf": (LAW.cdf, 1e-6 * UNIT.mm**2, (0.0, 1.0)),
    "density": (LAW.density, 1e-6 * UNIT.mm**2, (0.0, 0.0)),
    "junction": (
        rubnoise.simulate(BASE.replace(distance="20 um"), seed=1).junction(3).area,
        1e-3 * UNIT.mm,
        (0.0, 0.0),
    ),
}
"""Functions of one place, a quantity that is 1 in its unit, and the limits at -inf and inf."""


@pytest.mark.parametrize("name", CASES)
def test_a_function_of_a_place_answers_every_number_and_refuses_the_rest(name: str) -> None:
    function, one, (low, high) = CASES[name]
    assert function(one) == function([one])[0] == pytest.approx(function(1.0), rel=1e-12)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_array_equal(function([[np.nan, 1.0], [-np.inf, np.inf]]), [[np.nan, function(1.0)], [low, high]])
        assert np.isnan(function(np.nan))
        assert function([]).shape == (0,)
    assert np.shape(function(np.nan)) == np.shape(function(np.inf)) == ()
    for wrong in (None, "1", [1.0, None], 1j, 2.0 * UNIT.kg, [2.0 * UNIT.kg]):
        with pytest.raises(rubnoise.Refused, match=r"^(wavenumber|lag|distance|level|area): "):
            function(wrong)


def test_both_units_are_named() -> None:
    with pytest.raises(rubnoise.Refused, match="lag: 2 second: a quantity in um is needed"):
        THEORY.autocovariance(2 * UNIT.s)


@pytest.mark.parametrize("births", [{"law": "regular"}, {"law": "jittered", "jitter": "20 %"}])
def test_an_autocovariance_that_swings_for_ever_has_no_limit(births: dict[str, Any]) -> None:
    theory = rubnoise.exact(BASE.replace({f"birth.{key}": value for key, value in births.items()}))
    assert np.isnan(theory.autocovariance(np.nan))
    assert theory.autocovariance([]).shape == (0,)
    with pytest.raises(rubnoise.Refused, match="lag: inf: there is no limit"):
        theory.autocovariance([1.0, np.inf])


def test_a_level_is_refused_whatever_it_is_if_its_rate_is_not_known() -> None:
    for level in (np.nan, np.inf, []):
        with pytest.raises(rubnoise.Refused, match="Pois"):
            REGULAR.crossing_rate(level)


def test_one_number_is_asked_for() -> None:
    for wrong in ("5", [1.0, 2.0], None):
        with pytest.raises(rubnoise.Refused, match=r"^lowest: "):
            THEORY.estimated_spectrum(256).band(wrong, 2.0)  # type: ignore[arg-type]
    with pytest.raises(rubnoise.Refused, match=r"^distance: "):
        THEORY.expected_mean_area("5")  # type: ignore[arg-type]
    seen = THEORY.estimated_spectrum(256)
    assert seen.band(500 / UNIT.mm, 2000 / UNIT.mm) == pytest.approx(seen.band(0.5, 2.0), rel=1e-12)


@pytest.mark.parametrize("ticks", ["256", 3.0, True, 100 * UNIT.um])
def test_a_segment_has_a_whole_number_of_ticks(ticks: Any) -> None:
    with pytest.raises(rubnoise.Refused, match=r"ticks: .* whole number"):
        THEORY.estimated_spectrum(ticks)
    assert THEORY.estimated_spectrum(np.int64(256)).ticks == 256  # type: ignore[arg-type]


def test_a_static_contact_takes_quantities_of_pint() -> None:
    texts = {"radius": "50 um", "height": "0.5 um", "density": "300 1/mm^2", "modulus": "100 GPa", "load": "1 N"}
    found = rubnoise.greenwood_williamson(**{name: UNIT(text) for name, text in texts.items()})
    assert found.load == pytest.approx(1e6, rel=1e-12)
    assert found.real_contact_area == pytest.approx(rubnoise.greenwood_williamson(**texts).real_contact_area, rel=1e-12)
    for wrong in (10 * UNIT.s, [1.0, 2.0], None, float("nan"), True):
        with pytest.raises(rubnoise.Refused, match=r"^radius: "):
            rubnoise.greenwood_williamson(**texts | {"radius": wrong})


FORCES = np.array([1.0, 2.0, 1.5])
TIMES = np.array([0.0, 0.1, 0.2])


@pytest.mark.parametrize(
    ("columns", "expected"),
    [
        ({"time": TIMES * UNIT.s, "force": FORCES * UNIT.N}, (1e6, "uN")),
        ({"time (ms)": TIMES * UNIT.s, "force (mN)": FORCES * UNIT.N}, (1e6, "uN")),
        ({"time (s)": TIMES, "force": [1.0 * UNIT.mN, 2000.0 * UNIT.uN, 1.5 * UNIT.mN]}, (1e3, "uN")),
        ({"time (s)": TIMES, "signal": FORCES * UNIT.mV}, (1.0, "mV")),
        ({"time (s)": TIMES, "ratio": FORCES * UNIT.dimensionless}, (1.0, "1")),
    ],
)
def test_columns_of_a_trace_keep_the_units_that_they_carry(
    columns: dict[str, Any], expected: tuple[float, str]
) -> None:
    trace = rubnoise.Trace(columns)
    name = list(trace)[1]
    assert (trace.step, trace.units["time"], trace.units[name]) == (pytest.approx(0.1), "s", expected[1])
    assert trace[name] == pytest.approx(expected[0] * FORCES, rel=1e-12)


def test_an_array_with_a_unit_is_converted_or_defines_it() -> None:
    for unit in ("mN", "N", None):
        trace = rubnoise.Trace(FORCES * UNIT.N, rate="10 Hz", unit=unit)
        assert trace["trace"] == pytest.approx(1e6 * FORCES, rel=1e-12)
    with pytest.raises(rubnoise.Refused, match="newton: a quantity in mm is needed"):
        rubnoise.Trace(FORCES * UNIT.N, rate="10 Hz", unit="mm")
    with pytest.raises(rubnoise.Refused, match=r"force \(mm\): .* newton: a quantity in mm is needed"):
        rubnoise.Trace({"time (s)": TIMES, "force (mm)": FORCES * UNIT.N})


def test_heights_with_a_unit_are_converted_or_define_it() -> None:
    heights = np.random.default_rng(1).standard_normal((16, 16))
    plain = rubnoise.Surface.of(heights, spacing="1 um", unit="nm").heights
    for unit in ("nm", "um", None):
        made = rubnoise.Surface.of(heights * UNIT.nm, spacing=1.0 * UNIT.um, unit=unit).heights
        np.testing.assert_allclose(made, plain, rtol=1e-9, atol=1e-15)
    with pytest.raises(rubnoise.Refused, match="values in second: a quantity in um is needed"):
        rubnoise.Surface.of(heights * UNIT.s, spacing="1 um", unit="um")
    with pytest.raises(rubnoise.Refused, match="no unit of length"):
        rubnoise.Surface.of(heights * UNIT.s, spacing="1 um")

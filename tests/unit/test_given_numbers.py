"""Numbers that Python gives: units of pint, nan, inf, what is no number; and tables of other libraries."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
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
        with pytest.raises(rubnoise.Refused, match=r"^(wavenumber|lag|distance|area): "):
            function(wrong)


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
    for unit in ("mN", "N", UNIT.mN, None):
        trace = rubnoise.Trace(FORCES * UNIT.N, rate="10 Hz", unit=unit)
        assert trace["trace"] == pytest.approx(1e6 * FORCES, rel=1e-12)


def test_heights_with_a_unit_are_converted_or_define_it() -> None:
    heights = np.random.default_rng(1).standard_normal((16, 16))
    plain = rubnoise.Surface.of(heights, spacing="1 um", unit="nm").heights
    for unit in ("nm", "um", UNIT.um, None):
        made = rubnoise.Surface.of(heights * UNIT.nm, spacing=1.0 * UNIT.um, unit=unit).heights
        np.testing.assert_allclose(made, plain, rtol=1e-9, atol=1e-15)


RECORD = rubnoise.simulate(BASE, seed=7)
SECONDS = RECORD.slider["time"][:]
FORCE = RECORD.slider["friction_force"][:]
STEP = float(SECONDS[1])
TABLES: dict[str, Any] = {
    "series": pd.Series(FORCE / 1e3, index=pd.Index(SECONDS, name="time (s)"), name="force (mN)"),
    "durations": pd.Series(FORCE / 1e3, index=pd.to_timedelta(SECONDS, unit="s"), name="force (mN)"),
    "dates": pd.Series(FORCE / 1e3, index=pd.to_datetime(SECONDS, unit="s"), name="force (mN)"),
    "frame of dates": pd.DataFrame({"force (mN)": FORCE / 1e3}, index=pd.to_datetime(SECONDS, unit="s")),
    "our frame": RECORD.slider.to_pandas(["friction_force"]),
    "our array": RECORD.slider.to_xarray()["friction_force"],
    "our dataset": RECORD.slider.to_xarray()[["friction_force"]],
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_says_how_its_samples_lie(name: str) -> None:
    trace = rubnoise.Trace(TABLES[name])
    assert (trace.place, trace.units["time"], list(trace.units.values())[1]) == ("time", "s", "uN")
    assert trace.step == pytest.approx(STEP, rel=1e-4)
    assert trace[list(trace)[1]] == pytest.approx(FORCE, rel=1e-12)
    found = rubnoise.infer(TABLES[name], speed="1 mm/s", zero="known", law="fixed")
    plain = rubnoise.infer(FORCE, rate=f"{1.0 / STEP} Hz", unit="uN", speed="1 mm/s", zero="known", law="fixed")
    assert found.estimates["diameter"].value == pytest.approx(plain.estimates["diameter"].value, rel=1e-4)
    faster = rubnoise.infer(TABLES[name], rate="50 kHz", speed="1 mm/s", zero="known", law="fixed")
    expected = plain.estimates["diameter"].value * 2e-5 / STEP  # a rate that is said outranks the table's times
    assert faster.estimates["diameter"].value == pytest.approx(expected, rel=1e-4)
    assert rubnoise.Trace(TABLES[name], rate="50 kHz").step == pytest.approx(2e-5, rel=1e-9)


@pytest.mark.parametrize(
    ("unit", "named"),
    [
        (UNIT.uN, "uN"),
        (1 * UNIT.uN, "uN"),
        (1.0 * UNIT.mN, "mN"),
        ("1 mN", "mN"),
        (0.5 * UNIT.mN, "0.5 mN"),
        ("10 mN", "10 mN"),
        ("V", "V"),
    ],
)
def test_a_unit_is_named_without_a_factor_of_one(unit: Any, named: str) -> None:
    found = rubnoise.infer(FORCE, rate=f"{1 / STEP} Hz", speed="1 mm/s", unit=unit, law="fixed")
    assert found.estimates["noise"].unit == found.signal.unit == named
    assert found.to_dict()["noise"]["unit"] == named
    assert all(len(repr(each)) <= 1500 and "np." not in repr(each) for each in (found, found.fit, found.signal))


def test_a_run_is_a_trace_over_its_distance(tmp_path: Any) -> None:
    trace = rubnoise.Trace(RECORD)
    assert (trace.place, trace.units["friction_force"]) == ("distance", "uN")
    assert list(rubnoise.Trace(RECORD.trace)) == list(trace)
    whole, part = (rubnoise.infer(each, column="friction_force", zero="known", law="fixed") for each in (RECORD, trace))
    assert whole.estimates == part.estimates
    assert rubnoise.infer(RECORD, zero="known", law="fixed").estimates == part.estimates
    RECORD.save(tmp_path / "run.h5").close()
    with pytest.raises(rubnoise.Refused, match=r"of a result, Trace\(rubnoise.open"):
        rubnoise.Trace(tmp_path / "run.h5")


def test_a_column_of_a_run_has_its_place_and_its_unit() -> None:
    over_distance, over_time = RECORD.trace["friction_force"], RECORD.slider["friction_force"]
    found = rubnoise.infer(over_distance, zero="known", law="fixed")
    assert found.estimates == rubnoise.infer(RECORD, zero="known", law="fixed").estimates
    over = rubnoise.infer(over_time, speed="1 mm/s", zero="known", law="fixed", unit="uN")
    assert over.estimates["diameter"].value == pytest.approx(found.estimates["diameter"].value, rel=1e-9)
    trace = rubnoise.Trace(over_time)
    assert (trace.place, trace.step, trace.units["friction_force"]) == ("time", pytest.approx(STEP), "uN")
    assert_array_equal(trace["friction_force"], FORCE)
    assert rubnoise.infer(RECORD.trace["real_contact_area"], law="fixed").signal.is_area
    for wrong in (RECORD.trace["distance"], RECORD.junctions["diameter"]):
        with pytest.raises(rubnoise.Refused, match="the trace has no time and no distance"):
            rubnoise.infer(wrong)
    with pytest.raises(rubnoise.Refused, match=r"sample \d+: distance grows"):
        rubnoise.infer(RECORD.trace.where("real_contact_area > 100")["friction_force"])
    with pytest.raises(rubnoise.Refused, match="speed= is needed: the trace is over time"):  # with a rate it is samples
        rubnoise.infer(over_distance, rate="10 kHz")

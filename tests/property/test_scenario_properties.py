"""Whatever a file holds, it is a scenario or a report of what is wrong, and soon."""

import math
import re
import tomllib
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import Scenario, build, loads
from rubnoise.scenario.source import locate
from rubnoise.units import LENGTH, NUMBER, QuantityError, read_quantity
from tests.unit.scenarios import BARE, WHOLE

TOML_PIECES = st.sampled_from(
    ["[slider]", "[[a]]", "[", "]", "{", "}", "=", ".", ",", "\n", '"', "'", '"""', "'''", "#", "\\", "\\u0000", " ",
     "a", "1", "1,5 mm", '"1 mm"', "mass", "run.seed", "nan", "-inf", "true", "1979-05-27", "\r", "\x00", "\ud800"]
)  # fmt: skip
NUMBERS = st.one_of(
    st.integers(-(10**30), 10**30).map(str),
    st.floats(allow_nan=True).map(repr),
    st.decimals(allow_nan=False, allow_infinity=False, places=6).map(str),
    st.from_regex(NUMBER, fullmatch=True),
    st.text(alphabet="0123456789.,eE+-*/_ \u2212", max_size=12),
)
UNITS = st.one_of(
    st.sampled_from(
        ["um", "mm", "um^2", "um2", "mPa", "MPa", "N*s/m", "%", "m^9", "degC", "dB", "inch", "", "s", "N/m"]
    ),
    st.text(alphabet="umMPasNkg%^*/ .-0129\u00b5", max_size=14),
    st.text(max_size=6),
)
KEYS = st.sampled_from(
    ["interface.mean_real_contact_area", "interface.mean_junction_count", "interface.calibration", "diameter.law",
     "diameter.spread", "strength.mean", "sliding.speed", "sliding.distance", "slider.mass", "slider.damping",
     "slider.stiffness", "output.tick", "run.seed", "title", "format", "run", "sweep.replicates", "x"]
)  # fmt: skip


def outcome(text: str, *overrides: str) -> Scenario | str:
    """Return the scenario or the report; anything else is an error of the test."""
    try:
        return loads(text, "a.toml", overrides)
    except ScenarioRefused as refused:
        report = str(refused)
        assert report.replace("\n", "").isprintable()
        assert "error: " in report
        return report


@given(st.one_of(st.text(max_size=200), st.lists(TOML_PIECES, max_size=40).map("".join)))
def test_any_text_is_a_scenario_or_a_report(text: str) -> None:
    assert isinstance(outcome(text), str)


@given(st.lists(TOML_PIECES, max_size=12).map("".join), st.integers(0, len(WHOLE)), st.integers(0, 30))
def test_a_damaged_scenario_is_a_scenario_or_a_report(piece: str, at: int, cut: int) -> None:
    outcome(WHOLE[:at] + piece + WHOLE[at + cut :])


@given(KEYS, NUMBERS, UNITS, st.sampled_from(['"', ""]))
def test_any_number_and_unit_is_a_scenario_or_a_report(key: str, number: str, unit: str, quote: str) -> None:
    result = outcome(WHOLE, f"{key}={quote}{number} {unit}{quote}")
    if isinstance(result, Scenario):
        model = result.model()
        assert math.isfinite(model.stationary_mean_area)
        assert model.tick_count >= 1


def powers(low: float, high: float) -> st.SearchStrategy[float]:
    """Return numbers from 10^low to 10^high, evenly on a logarithmic axis."""
    return st.floats(low, high).map(lambda power: float(10.0**power))


@settings(max_examples=200)
@given(
    powers(-12, 18), powers(-6, 9), st.one_of(st.just(0.0), powers(-12, 12)),
    st.sampled_from(["paper", "exact", "matched"]), st.sampled_from(["um", "%"]),
)  # fmt: skip
def test_the_bounds_of_numbers_keep_the_model_finite(
    area: float, count: float, spread: float, calibration: str, unit: str
) -> None:
    values: dict[str, Any] = {
        "interface": {"mean_real_contact_area": area, "mean_junction_count": count, "calibration": calibration},
        "diameter": {"law": "normal", "spread": f"{spread!r} {unit}"},
        "sliding": {"distance": math.sqrt(area / count)},
    }
    try:
        model = build(values).model()
    except ScenarioRefused as refused:
        assert re.search("too (long|small|large)|no solution|alive at once", str(refused))  # noqa: PT017  (either way is right)
        return
    assert 0.0 < model.calibrated_diameter < math.inf
    assert math.isfinite(model.stationary_mean_area)
    if calibration == "matched":
        assert model.stationary_mean_area == pytest.approx(area, rel=1e-12)


DECIMALS = st.tuples(st.integers(1, 9999), st.integers(0, 4)).map(lambda p: f"{p[0] / 10 ** p[1]:.{p[1]}f}")


@given(DECIMALS, DECIMALS, st.sampled_from(["um", "mm", "nm"]))
def test_ticks_are_counted_as_written(distance: str, tick: str, unit: str) -> None:
    scenario = outcome(WHOLE, f"sliding.distance={distance} {unit}", f"output.tick={tick} um")
    if isinstance(scenario, str):
        return
    scale = {"um": Fraction(1), "mm": Fraction(1000), "nm": Fraction(1, 1000)}[unit]
    count = scenario.model().tick_count
    assert count * Fraction(tick) <= Fraction(distance) * scale < (count + 1) * Fraction(tick)


@given(
    st.integers(1, 400), st.floats(0.5, 60.0), st.sampled_from(["0.2 um", "20 %", "0 um", "1e-2 inch"]),
    st.sampled_from(["paper", "exact", "matched"]), st.one_of(st.none(), st.floats(1e-3, 1.0)),
    st.integers(0, 2**53 - 1),
)  # fmt: skip
def test_resolved_scenarios_are_the_same_scenario(
    area: int, count: float, spread: str, calibration: str, tick: float | None, seed: int
) -> None:
    overrides = [
        f"interface.mean_real_contact_area={area} um^2", f"interface.mean_junction_count={count}",
        f"interface.calibration={calibration}", "diameter.law=normal", f"diameter.spread={spread}", f"run.seed={seed}",
        *([] if tick is None else [f"output.tick={tick:.5f} um"]),
    ]  # fmt: skip
    scenario = outcome(BARE, *overrides)
    if isinstance(scenario, Scenario):
        again = build(scenario.resolved())
        assert again.model() == scenario.model()
        assert again.resolved() == scenario.resolved()


PLAIN_KEYS = st.text(alphabet="abc-_1", min_size=1, max_size=3)
LEAVES = st.one_of(
    st.integers(0, 99).map(str), st.sampled_from(['"a # b"', "'c]'", "true", "1.5", '"""x\ny"""', "1979-05-27"])
)
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: f"[ {', '.join(items)} ]"),
        st.dictionaries(PLAIN_KEYS, inner, max_size=2).map(
            lambda table: "{ " + ", ".join(f"{key} = {value}" for key, value in table.items()) + " }"
        ),
    ),
    max_leaves=6,
)


def leaves(data: Any, path: tuple[str | int, ...] = ()) -> dict[tuple[str | int, ...], Any]:
    """Return path and value of everything below a table."""
    found: dict[tuple[str | int, ...], Any] = {}
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        found[*path, key] = value
        if isinstance(value, (dict, list)):
            found |= leaves(value, (*path, key))
    return found


@given(st.dictionaries(PLAIN_KEYS, VALUES, max_size=4), st.dictionaries(PLAIN_KEYS, VALUES, max_size=4))
def test_the_locator_finds_every_value_that_tomllib_reads(top: dict[str, str], below: dict[str, str]) -> None:
    lines = [f"{key} = {value} # note" for key, value in top.items()]
    lines += ["[table.'sub']", *(f'"{key}" . x = {value}' for key, value in below.items())]
    text = "\n".join(lines)
    data = tomllib.loads(text) if "table" not in top else {}
    spans = locate(text)
    for path, value in leaves(data).items():
        if isinstance(value, dict) and path not in spans.values:
            assert path in spans.keys  # a table by its header or a dotted key
            continue
        span = spans.values[path]
        assert tomllib.loads(f"v = {text[span.start : span.end]}")["v"] == value


@given(NUMBERS, UNITS)
def test_a_length_is_read_exactly_or_refused(number: str, unit: str) -> None:
    try:
        quantity = read_quantity(f"{number} {unit}", LENGTH)
    except QuantityError:
        return
    assert quantity.exact == Fraction(number.strip(" ")) * read_quantity(f"1 {unit.strip(' ')}", LENGTH).exact
    assert float(quantity) == float(quantity.exact)

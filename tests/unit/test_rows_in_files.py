"""Rows of a result that others are derived from: junctions with their pulse, areas by stretches, the slider."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.errors import RunFileRefused
from rubnoise.record.rows import MemoryRecord
from rubnoise.scenario.reading import stored
from rubnoise.storage.life_curve import JUNCTION_AREA_FORMULAS, life_curve

# Junctions of a result have the pulse of the run, from the scenario in the file alone.
SCENARIO = """format = 1
[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 8
[diameter]
law = "normal"
spread = "30 %"
[birth]
law = "regular"
[pulse]
shape = "triangle"
[strength]
law = "lognormal"
mean = "250 MPa"
spread = "40 %"
[sliding]
distance = "150 um"
[output]
tick = "0.1 um"
"""


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> rubnoise.Scenario:
    path = tmp_path_factory.mktemp("pulse") / "triangles.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    return rubnoise.load(path)


@pytest.fixture(scope="module")
def path(scenario: rubnoise.Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pulse") / "triangles.h5"
    rubnoise.run(scenario, path).close()
    return path


@pytest.fixture
def run(path: Path) -> Iterator[rubnoise.Run]:
    with rubnoise.open(path) as opened:
        yield opened


def test_the_file_has_the_formula_and_the_curve_of_its_pulse(run: rubnoise.Run) -> None:
    assert run.attributes["junction_area_formula"] == JUNCTION_AREA_FORMULAS["triangle"]
    curve = run.groups()["life_curve"]
    u = np.linspace(0.0, 2.0, 1_777)
    found = np.interp(u, curve["u"][:], curve["area_fraction"][:])
    assert np.abs(found - TRIANGLE.area(u, 1.0)).max() < 1e-15
    assert np.abs(found - LENS.area(u, 1.0)).max() > 0.05


@pytest.mark.parametrize("pulse", PULSES.values(), ids=lambda pulse: pulse.shape)
def test_the_formula_in_words_gives_the_area(pulse: Pulse) -> None:
    formula = JUNCTION_AREA_FORMULAS[pulse.shape].removeprefix("A(s) = ").partition(" with")[0]
    expression = formula.replace("^", "**").replace("d**2/2 acos", "d**2/2 * acos").replace("/2 sqrt", "/2 * sqrt")
    expression = expression.replace("pi/4 d (", "pi/4 * d * (").replace("pi/4 (", "pi/4 * (")
    names = {"acos": np.arccos, "sqrt": np.sqrt, "pi": np.pi, "d": 3.0}
    for s in (0.5, 3.0, 4.2):
        area = eval(expression, names | {"x": abs(3.0 - s)})  # noqa: S307  (our own formula, to see that it is one)
        assert area == pytest.approx(float(pulse.area(s, 3.0)), rel=1e-14)


@pytest.mark.parametrize("pulse", PULSES.values(), ids=lambda pulse: pulse.shape)
def test_a_curve_is_that_of_its_pulse_at_every_point(pulse: Pulse) -> None:
    curve = life_curve(pulse.shape)
    assert np.abs(curve["area_fraction"] - pulse.area(curve["u"], 1.0)).max() < 1e-15


def test_the_trace_is_the_sum_of_the_junctions(run: rubnoise.Run) -> None:
    s = run.trace["distance"][:]
    junctions = [run.junction(n) for n in range(len(run.junctions))]
    area = sum(junction.area(s) for junction in junctions)
    np.testing.assert_allclose(area, run.trace["real_contact_area"][:], rtol=0.0, atol=1e-9)
    force = sum((junction.shear_strength or 0.0) * junction.area(s) for junction in junctions)
    np.testing.assert_allclose(force, run.trace["friction_force"][:], rtol=0.0, atol=1e-6)


@pytest.mark.parametrize(
    "text",
    ['{"pulse": {"shape": "square"}}', '{"pulse": {"shape": ["lens"]}}', '{"pulse": 3}', "[]", "no JSON", "[" * 9999],
)
def test_a_pulse_that_nobody_knows_is_refused(text: str) -> None:
    with pytest.raises(RunFileRefused, match="the scenario in the file"):
        stored(text)


def test_a_record_in_memory_grows() -> None:
    record, values = MemoryRecord({"slider": None}), np.arange(1000.0)
    for first, last in ((0, 3), (3, 10), (10, 11), (11, 1000)):
        record.write("slider", first, {"time": values[first:last], "velocity": -values[first:last]})
    assert record["slider"]["time"].tobytes() == values.tobytes()
    assert record["slider"]["velocity"].tobytes() == (-values).tobytes()

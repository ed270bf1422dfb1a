"""The scenarios for teaching show what their comments promise."""

import pytest

import rubnoise
from rubnoise.scenario import Scenario
from rubnoise.scenario.shipped import shipped
from rubnoise.theory.exact import Exact
from tests.architecture.sources import ROOT

READ = ("read_exponential", "read_lognormal", "read_normal")
NAMES = ("few_large", "many_small", "one_at_a_time", "poisson", *READ, "regular")
WORTH_A_WARNING = 0.1


def _load(name: str) -> Scenario:
    return rubnoise.load(shipped(f"lessons/{name}.toml"))


def _exact(name: str) -> Exact:
    return rubnoise.exact(_load(name))


def test_these_are_all() -> None:
    assert tuple(sorted(path.stem for path in (ROOT / "scenarios" / "lessons").iterdir())) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_each_is_sound_and_lets_the_slider_move_little(name: str) -> None:
    scenario, motion = _load(name), _exact(name).slider
    slider = scenario.model().slider
    assert scenario.warnings == ()
    assert motion is not None
    assert slider is not None
    assert 0.0 < motion.one_way_validity < WORTH_A_WARNING
    assert slider.natural_frequency == pytest.approx(39.0, abs=0.05)


def test_many_small_junctions_share_the_area_and_a_quarter_of_its_spread() -> None:
    few, many = _exact("few_large"), _exact("many_small")
    assert many.area.mean == pytest.approx(few.area.mean, rel=1e-9)
    assert many.area.std == pytest.approx(0.25 * few.area.std, rel=1e-9)
    assert many.count_mean == pytest.approx(16.0 * few.count_mean, rel=1e-9)
    assert many.slider.velocity_std < 0.25 * few.slider.velocity_std


def test_sizes_to_read_halve_from_one_trace_to_the_next_and_the_swing_does_not() -> None:
    contacts = [_exact(name) for name in ("read_normal", "read_lognormal", "read_exponential")]
    assert [each.mean_diameter for each in contacts] == pytest.approx([8.0, 4.0, 2.0], rel=1e-6)
    swings = [each.area.std / each.area.mean for each in contacts]
    assert max(swings) < 1.25 * min(swings)


def test_births_by_the_clock_are_all_that_differs() -> None:
    poisson, regular = _exact("poisson"), _exact("regular")
    assert _load("poisson").model().sizes == _load("regular").model().sizes
    assert regular.area.mean == pytest.approx(poisson.area.mean, rel=1e-9)
    assert poisson.count_std == pytest.approx(20.0**0.5, rel=1e-9)
    assert regular.count_std == pytest.approx(0.0, abs=1e-6)
    assert regular.area.std < 0.01 * poisson.area.std


def test_there_is_one_junction_at_a_time() -> None:
    scenario = rubnoise.load(shipped("lessons/one_at_a_time.toml"), ["sliding.distance=200 um"])
    count = rubnoise.simulate(scenario).trace["junction_count"]
    assert (count.min(), count.max()) == (1, 1)
    assert scenario.model().calibrated_diameter == pytest.approx(_load("few_large").model().calibrated_diameter)

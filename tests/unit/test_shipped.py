"""The scenarios that come along: all run, and studies and lessons show what their comments say."""

from math import sqrt
from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.figures import expected_figure
from rubnoise.analysis.replicates import PooledEstimate, pooled, ratio
from rubnoise.cli.theory_answer import theory_answer
from rubnoise.scenario import Scenario
from rubnoise.scenario.layers import shipped
from rubnoise.scenario.sweep import Sweep, load_sweep, points_of
from rubnoise.theory.exact import Exact
from tests.architecture.sources import ROOT
from tests.unit.scenarios import std_of

# The studies that come along ask what their comments say, and theory answers it.
STUDIES = ROOT / "scenarios" / "studies"
COUNT, RATIO, SPEED = "interface.mean_junction_count", "slider.damping_ratio", "sliding.speed"
FORCE = "friction_force_std"


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted((ROOT / "scenarios").rglob("*.toml")), ids=lambda path: path.stem)
def test_theory_has_an_answer_for_it(path: Path) -> None:
    swept = "\n[sweep" in path.read_text(encoding="utf-8")
    scenarios = [case.scenario for case in load_sweep(path).cases] if swept else [rubnoise.load(path)]
    for model in {scenario.model() for scenario in (scenarios[0], scenarios[-1])}:
        assert theory_answer(path.stem, model, {}, brief=True).to_text()


def _study(name: str, *changes: str) -> Sweep:
    return load_sweep(STUDIES / f"{name}.toml", changes)


def _exact(sweep: Sweep, quantity: str, key: str = "", value: object = None) -> list[float]:
    """Return the exact quantity at the points where a key, if one is named, has a value."""
    chosen = [case for case in sweep.cases if not key or case.values[key] == value]
    return [expected_figure(case.scenario.model(), quantity) for case in chosen]


def test_passes_off_the_centre_line_make_the_area_vary_by_a_tenth_more() -> None:
    """1.3559/1.2298 for equal sizes, of the same mean area and number; displacement and velocity with it."""
    key = "pulse.offset"
    for quantity, low, high in (
        ("real_contact_area_std", 1.10, 1.105), ("displacement_std", 1.14, 1.18), ("real_contact_area_mean", 1.0, 1.0),
    ):  # fmt: skip
        centred, aside = (_exact(_study("off_centre"), quantity, key, value)[0] for value in ("none", "uniform"))
        assert low - 1e-9 <= aside / centred <= high + 1e-9


@pytest.mark.slow
def test_vibration_rises_and_falls_with_the_speed() -> None:
    stds = _exact(_study("speed"), "displacement_std")
    highest = int(np.argmax(stds))
    assert 0 < highest < len(stds) - 1
    assert stds == sorted(stds[: highest + 1]) + sorted(stds[highest + 1 :], reverse=True)
    assert stds[-1] < 0.5 * stds[0] < 0.25 * stds[highest]
    # Beyond the corner of the spectrum the power on the resonance goes with S(0)/V.
    assert stds[-1] / stds[-2] == pytest.approx(1.0 / sqrt(2.0), rel=1e-3)
    assert _exact(_study("speed"), "one_way_validity")[-1] < 0.1


@pytest.mark.parametrize("speed", ["10 mm/s", "50 mm/s"])
def test_vibration_falls_as_the_root_of_the_damping(speed: str) -> None:
    study = _study("damping")
    stds = _exact(study, "displacement_std", SPEED, speed)
    damping = sorted({case.values[RATIO] for case in study.cases})
    products = [std * sqrt(damped) for std, damped in zip(stds, damping, strict=True)]
    assert products == pytest.approx([products[0]] * len(products), rel=2e-3)


def test_a_texture_has_the_same_area_and_less_vibration() -> None:
    study = _study("texture")
    areas = _exact(study, "real_contact_area_mean")
    assert areas == pytest.approx([200.0] * len(areas), rel=1e-12)
    forces = [_exact(study, FORCE, COUNT, count)[0] for count in (20, 100)]
    assert forces[0] / forces[1] == pytest.approx(sqrt(5.0), rel=1e-9)
    plain, textured = (_exact(study, "displacement_std", COUNT, count) for count in (20, 100))
    reductions = [before / after for before, after in zip(plain, textured, strict=True)]
    assert reductions == sorted(reductions)
    assert 3.0 < reductions[0] < 3.1
    # Where S is flat over the resonance, its S(0) goes with N d^5 and so with N^(-3/2).
    assert reductions[-1] == pytest.approx(5.0**0.75, rel=1e-3)


def _pooled(study: Sweep, count: int) -> PooledEstimate:
    [case] = [case for case in study.cases if case.values[COUNT] == count]
    return pooled(FORCE, [std_of(point, "friction_force") for point in points_of([case], 12)])


def test_the_reduction_is_found_by_simulation_with_an_interval_that_holds_it() -> None:
    study = _study("texture", 'sweep.zip.sliding.speed=["10 mm/s"]', 'sweep.zip.sliding.distance=["4 mm"]')
    found = ratio(_pooled(study, 20), _pooled(study, 100))
    assert abs(found.value - sqrt(5.0)) <= 4.0 * found.standard_error
    assert found.standard_error < 0.03 * found.value
    # No reduction, and one as that of the number itself, are both ruled out.
    assert all(abs(found.value - wrong) > 4.0 * found.standard_error for wrong in (1.0, 5.0))


def _load(name: str) -> Scenario:
    return rubnoise.load(shipped(f"lessons/{name}.toml"))


def _exact_lesson(name: str) -> Exact:
    return rubnoise.exact(_load(name))


def test_many_small_junctions_share_the_area_and_a_quarter_of_its_spread() -> None:
    few, many = _exact_lesson("few_large"), _exact_lesson("many_small")
    assert many.area.mean == pytest.approx(few.area.mean, rel=1e-9)
    assert many.area.std == pytest.approx(0.25 * few.area.std, rel=1e-9)
    assert many.count_mean == pytest.approx(16.0 * few.count_mean, rel=1e-9)
    assert many.slider.velocity_std < 0.25 * few.slider.velocity_std


def test_sizes_to_read_halve_from_one_trace_to_the_next_and_the_swing_does_not() -> None:
    contacts = [_exact_lesson(name) for name in ("read_normal", "read_lognormal", "read_exponential")]
    assert [each.mean_diameter for each in contacts] == pytest.approx([8.0, 4.0, 2.0], rel=1e-6)
    swings = [each.area.std / each.area.mean for each in contacts]
    assert max(swings) < 1.25 * min(swings)


def test_births_by_the_clock_are_all_that_differs() -> None:
    poisson, regular = _exact_lesson("poisson"), _exact_lesson("regular")
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

"""Knobs, keys and clicks: each does what it says, and nothing else."""

from collections.abc import Iterator
from typing import Any

import pytest

from tests.lesson.walk import CALM, UNFOLD, opened, until

pytestmark = pytest.mark.slow

PREDICTIONS = """(() => {
  const e = rub.exact();
  const names = ['diameter', 'lengthBiasedMean', 'countMean', 'countStd', 'areaMean', 'areaStd', 'forceMean',
    'displacementMean', 'displacementStd', 'oneWay', 'naturalFrequency', 'dampingRatio'];
  return Object.fromEntries(names.map((name) => [name, e[name]]));
})()"""
CONTACT = {"areaStd", "displacementStd", "oneWay"}
FORCES = {"forceMean", "displacementMean", "displacementStd", "oneWay"}
CHANGES = {
    "meanArea": CONTACT | FORCES | {"diameter", "lengthBiasedMean", "areaMean"},
    "meanCount": CONTACT | FORCES | {"diameter", "lengthBiasedMean", "countMean", "countStd", "areaMean"},
    "spread": CONTACT | FORCES | {"lengthBiasedMean", "areaMean"},
    "speed": {"displacementStd", "oneWay"},
    "strength": FORCES,
    "mass": {"displacementStd", "oneWay", "naturalFrequency", "dampingRatio"},
    "stiffness": {"displacementMean", "displacementStd", "oneWay", "naturalFrequency", "dampingRatio"},
    "damping": {"displacementStd", "oneWay", "dampingRatio"},
}
SAMPLES = """(() => {
  const { samples, ...told } = rub.sound.samples(48000);
  let [sum, most, least] = [0, -Infinity, Infinity];
  for (const each of samples) [sum, most, least] = [sum + each, Math.max(most, each), Math.min(least, each)];
  return { ...told, sum, most, least, count: samples.length, some: [10, 5000, 100000].map((i) => samples[i]) };
})()"""
ROWS = "JSON.stringify(rub.run.rows.slice(0, 30))"


@pytest.fixture
def page(browser: Any, lesson_file: str) -> Iterator[Any]:
    """Return the page of Figure 5, standing still."""
    with opened(browser, lesson_file, **CALM) as found:
        found.evaluate(UNFOLD)
        yield found


def test_a_knob_changes_what_it_should(page: Any) -> None:
    before, rows = page.evaluate(PREDICTIONS), page.evaluate(ROWS)
    page.locator("#reveal").click()
    for knob, changes in CHANGES.items():
        page.locator(f"#knob-{knob}").focus()
        page.keyboard.press("PageUp")
        after = page.evaluate(PREDICTIONS)
        assert {name for name in before if after[name] != pytest.approx(before[name], rel=1e-9)} == changes, knob
        assert (page.evaluate(ROWS) != rows) == (knob in {"meanArea", "meanCount", "spread", "strength"}), knob
        force = page.evaluate("rub.run.goTo(50), rub.run.trace.force[100] / rub.run.trace.area[100]")
        assert force == pytest.approx(page.evaluate("rub.world.strength"), rel=1e-9), knob
        shown = page.locator("#number-displacement-std td").first.inner_text().replace("\u2212", "-")
        assert float(shown) == pytest.approx(after["displacementStd"], rel=1e-5), knob
        page.locator("#reset").click()
        assert page.evaluate(PREDICTIONS) == before, knob


def test_a_number_is_taken_in_its_unit_and_a_wrong_one_is_refused(page: Any) -> None:
    number = page.locator("#exact-speed")
    number.fill("2.5")
    number.press("Enter")
    assert page.evaluate("rub.world.speed") == 2500
    number.fill("-1")
    number.press("Enter")
    assert page.evaluate("rub.world.speed") == 2500
    assert number.input_value() == "2.5"
    assert page.locator("#status").inner_text() == "speed: a number from 1 to 10000000"
    assert page.evaluate("rub.set({ spread: NaN })") is False
    assert page.evaluate("rub.set({ pulse: 'cone' })") is False
    assert page.evaluate("rub.set({ calibration: 'matched', spread: 4 })") is False
    assert page.evaluate("rub.world.spread") == 0.2


def test_settings_are_shared_in_the_address_and_reset(page: Any, browser: Any) -> None:
    page.evaluate("rub.set({ meanCount: 40, pulse: 'triangle' })")
    until(page, "location.hash.length > 1")
    assert page.url.endswith("#meanCount=40&pulse=triangle")
    with opened(browser, page.url, **CALM) as other:
        assert other.evaluate("[rub.world.meanCount, rub.world.pulse]") == [40, "triangle"]
        assert other.evaluate(ROWS) == page.evaluate(ROWS)
        assert other.locator("#exact-meanCount").input_value() == "40"
    page.locator("#reset").click()
    until(page, "location.hash === ''")
    assert page.evaluate("rub.world.meanCount") == 20


def test_a_click_shows_the_row_of_the_junction(page: Any) -> None:
    page.evaluate("rub.run.goTo(57.3)")
    for index in (0, 5, 11):
        row = page.evaluate(f"rub.run.living[{index}]")
        x, y = page.evaluate(f"rub.stage.pointOf(rub.run.living[{index}])")
        page.locator("#stage").click(position={"x": x, "y": y})
        shown = dict(zip(*[iter(page.locator("#card dl > *").all_inner_texts())] * 2, strict=True))
        assert shown["row"] == str(row["id"])
        for label, value in {"born at": row["birth"], "diameter": row["diameter"], "dies at": row["death"]}.items():
            number, unit = shown[label].replace("\u2212", "-").split()
            assert float(number) == pytest.approx(value, rel=1e-5)
            assert unit == "µm"
        accent = page.evaluate("rub.run.selected")
        assert accent == row["id"]
    page.locator("#stage").click(position={"x": 1, "y": 1})
    assert page.locator("#card").is_hidden()


def test_everything_by_keyboard_alone(page: Any) -> None:
    page.locator("#stage").focus()
    page.keyboard.press("Space")
    until(page, "rub.run.playing && rub.run.distance > 0")
    page.keyboard.press("k")
    assert page.evaluate("rub.run.playing") is False
    page.keyboard.press("ArrowRight")
    first = page.evaluate("rub.run.selected")
    page.keyboard.press("n")
    assert page.evaluate("rub.run.selected") != first
    born, now, dies = page.evaluate(
        "((run, row) => [row.birth, run.distance, row.death])(rub.run, rub.run.rows[rub.run.selected])"
    )
    assert born <= now < dies, "it is alive"
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("rub.run.selected") == first
    assert page.locator("#status").inner_text().startswith(f"junction {first}: diameter")
    page.keyboard.press("Escape")
    assert page.evaluate("rub.run.selected") == -1
    page.keyboard.press("e")
    assert page.locator("#status").inner_text().split()[0] in {"birth", "death"}
    pace = page.evaluate("rub.run.pace")
    page.keyboard.press("+")
    assert page.evaluate("rub.run.pace") == 1.5 * pace
    page.keyboard.press("0")
    assert page.evaluate("rub.run.distance") == 0
    reached = set()
    for _ in range(80):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("document.activeElement.id"))
    assert {
        "stage",
        "play",
        "step",
        "pace",
        "scrubber",
        "knob-meanArea",
        "knob-births",
        "reset",
        "sound-play",
    } <= reached


@pytest.mark.parametrize("what", ["velocity", "force"])
def test_the_ear_hears_the_trace(page: Any, what: str) -> None:
    page.locator("#sound-what").select_option(what)
    made = page.evaluate(SAMPLES)
    assert made["factor"] == 8  # 39 Hz times 8 is the first above 200 Hz
    assert max(made["most"], -made["least"]) == pytest.approx(0.8, rel=1e-6)
    assert made["sum"] / made["count"] == pytest.approx(0.0, abs=1e-6)
    assert made["length"] == pytest.approx(20000.0, rel=1e-3)
    assert made["count"] == pytest.approx(20.0 / 8.0 * 48000.0, rel=1e-3)
    ticks_a_sample = 8 * 1000.0 / (48000.0 * page.evaluate("rub.run.trace.tick"))
    for i, sample in zip((10, 5000, 100000), made["some"], strict=True):
        at = i * ticks_a_sample
        low, high = page.evaluate(f"[...rub.run.trace.{what}.slice({int(at)}, {int(at) + 2})]")
        value = low + (at % 1) * (high - low)
        assert sample == pytest.approx(0.8 * (value - made["mean"]) / made["peak"], abs=1e-6)
    page.locator("#sound-speed").select_option("1")
    assert page.evaluate("rub.sound.samples(48000).factor") == 1

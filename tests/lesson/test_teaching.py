"""What a teacher has: the page as one file, numbers and answers, a projector and a worksheet."""

import re
from functools import cache
from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.lesson.page import LAWS, half_lag, page, script_parts
from rubnoise.lesson.settings import LESSON_SLIDER, settings_of
from rubnoise.scenario import build
from rubnoise.scenario import load as load_scenario
from rubnoise.scenario.reading import load
from tests.architecture.sources import ROOT
from tests.lesson.node import PARTS, lessons, minutes, other_numbers, scenario_of, world_with
from tests.lesson.test_beside import IN_SIGHT, LEAST
from tests.lesson.test_lessons import VERDICTS
from tests.lesson.walk import CALM, UNHURRIED, Walk, opened, until

# Every number in bold in docs/teaching.md is the one of the theory, to the digits that are printed.
UNEQUAL = ("diameter.law=normal", "diameter.spread=2 um", "interface.calibration=matched")
FASTER = 66.4


@cache
def exact(name, *overrides):
    return rubnoise.exact(load(ROOT / "scenarios" / f"{name}.toml", overrides))


def contact(count):
    return exact("lessons/poisson", f"interface.mean_junction_count={count}")


def swing(result):
    return result.area.std / result.area.mean


def fig5(*overrides):
    return exact("paper/fig5", *overrides).slider


def one_life():
    life = exact("lessons/one_at_a_time")
    return [life.model.calibrated_diameter, life.area.mean]


def births():
    random, regular = exact("lessons/poisson"), exact("lessons/regular")
    spacing = random.model.mean_birth_spacing
    return [random.model.calibrated_diameter, spacing, 100 * swing(random), 100 * swing(regular)]


def count():
    found = exact("lessons/poisson")
    return [found.count_mean, found.count_variance, found.count_std, 2 * found.mean_diameter]


def alive():
    found = exact("lessons/poisson", *UNEQUAL)
    return [found.mean_diameter, found.length_biased_mean_diameter, found.count_mean]


def area_sum():
    each = [contact(count) for count in (2, 20, 100)]
    law = swing(contact(20)) * sqrt(20)
    answers = [100 * swing(found) / 2 for found in each[1:]]
    skewness = [found.area.skewness for found in each]
    return [*[100 * swing(found) for found in each], *skewness, law, swing(each[0]) / swing(each[2]), *answers]


def memory():
    found = exact("lessons/poisson")
    life = 2 * found.mean_diameter
    shares = found.autocovariance([life * part for part in (0.25, 0.5, 0.75, 1)]) / found.area.variance
    return [*shares, life]


def slider():
    printed, damped = fig5(), fig5("slider.damping=0.5 N*s/m")
    fast = fig5("sliding.speed=100 mm/s")
    motion = [printed.displacement_std, damped.displacement_std]
    ratios = [each.one_way_validity for each in (printed, damped, fast, printed)]
    frequency = exact("paper/fig5").model.slider.natural_frequency
    return [frequency, *motion, *ratios, FASTER]


def bet():
    few, many = exact("lessons/few_large"), exact("lessons/many_small")
    stds = [each.slider.displacement_std for each in (few, many)]
    ratios = [each.slider.one_way_validity for each in (few, many)]
    return [100 * swing(few), 100 * swing(many), swing(few) / swing(many), *stds, stds[0] / stds[1], *ratios]


def sizes():
    traces = [exact(f"lessons/read_{law}") for law in LAWS]
    equal = exact("lessons/few_large")
    diameters, lags = [each.mean_diameter for each in traces], [half_lag(each) for each in traces]
    of_equal = half_lag(equal) / equal.mean_diameter
    return [*diameters, of_equal, *lags, *[lag / of_equal / d for lag, d in zip(lags, diameters, strict=True)]]


def rise():
    held = exact("load/fig5_load")
    load, gap = held.load, 100 * sqrt(2 / held.model.mean_junction_count)
    force = 100 * sqrt(load.covariances.of("friction_force")) / (250 * 200)
    rest = [load.contact_resonance, load.separation_std, 0.5 * sqrt(2 / 50)]
    return [gap, force, held.slider.displacement_std, *rest]


def hop():
    held = exact("load/fig5_load", "interface.mean_junction_count=0.5", "sliding.speed=80 mm/s")
    width = sqrt(4 * 200 / (pi * 0.5))
    low = width * 2 * pi * held.load.contact_resonance / 1000
    return [width, low, low / 2, 80 / low, 40 / low, 80 / low, 160 / low]


EXPECTED = [one_life, births, count, alive, area_sum, memory, slider, bet, sizes, rise, hop]


def is_shown_as(value, text):
    return round(value, len(text.partition(".")[2])) == float(text)


@pytest.mark.parametrize(
    ("lesson", "expected"), list(zip(lessons(), EXPECTED, strict=True)), ids=[each.title for each in lessons()]
)
def test_numbers_are_those_of_the_theory(lesson, expected):
    values = expected()
    wrong = [(text, value) for text, value in zip(lesson.numbers, values, strict=True) if not is_shown_as(value, text)]
    assert wrong == []


def test_numbers_outside_of_the_lessons():
    lens = swing(contact(20)) * sqrt(20)
    triangle = swing(exact("lessons/poisson", "pulse.shape=triangle")) * sqrt(20)
    parabola = swing(exact("lessons/poisson", "pulse.shape=parabola")) * sqrt(20)
    off_centre = swing(exact("lessons/poisson", "pulse.offset=uniform")) * sqrt(20)
    written = [text for text in other_numbers() if "." in text]
    values = (lens, triangle, parabola, off_centre)
    assert [is_shown_as(value, text) for value, text in zip(values, written, strict=True)] == [True] * 4


def test_constant_speed_is_fair_from_the_speed_that_is_named():
    """To the digit that is printed: just above it, and no more just below."""
    assert fig5(f"sliding.speed={FASTER + 0.05} mm/s").one_way_validity < 0.1
    assert fig5(f"sliding.speed={FASTER - 0.05} mm/s").one_way_validity > 0.1


def test_a_wrong_digit_is_noticed():
    assert is_shown_as(4.4721, "4.472")
    assert not is_shown_as(4.4721, "4.473")
    assert not is_shown_as(0.0499, "0.04")


def test_the_plan_fills_a_lesson():
    assert sum(minutes()) == 45


def test_the_regular_contact_that_is_silent():
    silent = exact("lessons/regular", "pulse.shape=triangle")
    assert silent.area.std < 1e-12 * silent.area.mean


# The teacher's kit: larger for a projector, and a worksheet without answers where the page is printed.
LESSONS = lessons()
SIZES = """(() => {
  const size = (selector) => parseFloat(getComputedStyle(document.querySelector(selector)).fontSize);
  const { ctx, scale } = rub.traces.pens.area;
  rub.traces.draw(rub.run.moments());
  return [size('.lesson-question'), size('#play'), parseFloat(ctx.font) * scale, ctx.lineWidth * scale];
})()"""
ANSWERS = """rub.lessons.list.map((lesson) => {
  const world = { ...rub.world, ...lesson.experiment.runs[0].set };
  const exact = rub.theory.exact(world);
  const laws = lesson.experiment.table.map((row) => row.exact(exact, world));
  const asked = lesson.checks.filter((check) => check.expected).flatMap((check) => check.expected(exact, world));
  const texts = (values) => values.map(rub.lessons.words.say).filter((text) => text.length > 3);
  return [texts([...laws, ...asked]), texts(asked)];
})"""
"""What a lesson's table and questions ask for, and what its questions alone do."""


@pytest.mark.parametrize(("width", "height"), [(1024, 768), (1920, 1080)])
def test_a_projector_shows_larger_type_and_lines(browser: Any, lesson_file: str, width: int, height: int) -> None:
    screen = {"width": width, "height": height}
    with opened(browser, lesson_file, init=UNHURRIED, viewport=screen, **CALM) as page:
        walk = Walk(page)
        walk.open("5. The sum")
        walk.predict()
        walk.run()
        page.evaluate("rub.run.pause(), rub.show('area'), rub.fitAll()")
        before = page.evaluate(SIZES)
        page.keyboard.press("b")
        assert page.locator("#projector").get_attribute("aria-pressed") == "true"
        assert all(after > 1.15 * size for size, after in zip(before, page.evaluate(SIZES), strict=True))
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        walk.run(2)
        assert page.evaluate(IN_SIGHT) >= LEAST
        page.evaluate("rub.run.pause(), scrollTo(0, 0)")
        row = page.evaluate("rub.run.living[3]")
        x, y = page.evaluate("rub.stage.pointOf(rub.run.living[3])")
        page.locator("#stage").click(position={"x": x, "y": y})
        assert page.evaluate("rub.run.selected") == row["id"]
        page.evaluate("rub.run.goTo(0), rub.set(rub.lessons.list[4].experiment.runs[0].set), rub.show('area')")
        page.locator("#projector").click()
        page.evaluate("rub.fitAll()")
        assert page.evaluate(SIZES) == before


def test_a_print_is_a_worksheet_without_answers(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        assert page.locator("#sheet").count() == 0
        page.emulate_media(media="print")
        until(page, "document.getElementById('sheet') !== null")
        sheet = page.locator("#sheet")
        text = sheet.inner_text()
        assert page.inner_text("body").strip() == text.strip(), "nothing else is printed"
        for lesson in LESSONS:
            assert text.count(lesson.title) == 2, "once to play, once afterwards"
        blanks = page.locator("#sheet .sheet-blank").count()
        boxes = page.locator("#sheet .sheet-boxes li").count()
        questions = sum(len(lesson.rows) for lesson in LESSONS)
        assert (blanks > 3 * len(LESSONS), boxes > 4 * len(LESSONS)) == (True, True)
        assert page.locator("#sheet > section").count() == 2 * len(LESSONS)
        assert page.locator("#sheet h1.sheet-after ~ section > p").count() >= questions
        assert page.locator("#sheet input, #sheet button").count() == 0
        assert page.locator("#sheet td").all_inner_texts() == [""] * page.locator("#sheet td").count()
        assert [each for each in (*VERDICTS, "Show the law") if each in text] == []
        for lesson, answers in zip(LESSONS, page.evaluate(ANSWERS), strict=True):
            parts = page.locator("#sheet > section", has_text=lesson.title).all_inner_texts()
            for part, forbidden in zip(parts, answers, strict=True):
                assert [answer for answer in forbidden if answer in part] == [], lesson.title
        assert page.pdf(format="A4")[:5] == b"%PDF-"
        page.emulate_media(media="screen")
        until(page, "document.getElementById('sheet') === null")
        assert page.locator("#lessons").is_visible()


# The page as a file: one, small, and without requests.
FIG5 = ROOT / "scenarios" / "paper" / "fig5.toml"
BARE = {
    "format": 1,
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
    "sliding": {"distance": "300 um"},
}


def text_of(title: str = "a title") -> str:
    return page(title, settings_of(load_scenario(FIG5)))


def test_it_is_small_and_whole() -> None:
    text = text_of()
    assert len(text.encode()) < 420_000
    assert "http:" not in text
    assert "https:" not in text
    assert re.findall(r"(?:src|href)=\"([^\"]*)\"", text) == ["data:,"]
    assert re.findall(r"url\(|@import|\bimport\b\s*[({'\"]", text) == []
    assert "default-src 'none'" in text


def test_a_title_is_text_wherever_it_stands() -> None:
    text = text_of('</script><b>@data@ & "more"</b>')
    assert "<b>" not in text
    assert "&lt;b&gt;@data@ &amp; &quot;more&quot;" in text
    assert text.count("</script>") == 2


def test_every_part_runs_once_and_the_last_one_last() -> None:
    parts = script_parts()
    assert sorted(parts) == sorted(path.name for path in PARTS.glob("*.js"))
    assert parts[-1] == "main.js"


@pytest.mark.parametrize("path", sorted(PARTS.iterdir()), ids=lambda path: path.name)
def test_a_part_stays_readable(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 300
    if path.suffix == ".js":
        assert path.name.startswith("lessons_text") or max(map(len, text.splitlines())) <= 120
        assert text.startswith("'use strict';\n/* ")


def test_knobs_stand_as_the_scenario_says() -> None:
    world = world_with(births="regular", spread=0.25, calibration="matched", pulse="triangle", damping=0.07, seed=9)
    settings = settings_of(scenario_of(world, distance=300.0))
    assert settings.world == world
    assert (settings.distance, settings.slider_start, settings.borrowed) == (300.0, "equilibrium", ())


def test_passes_off_the_centre_line_stand_as_the_scenario_says() -> None:
    world = world_with(offset="uniform", calibration="matched")
    assert settings_of(scenario_of(world)).world == world
    assert '"offset": "uniform"' in page("off", settings_of(scenario_of(world)))


def test_what_a_scenario_lacks_is_borrowed_and_said() -> None:
    settings = settings_of(build(BARE))
    assert settings.borrowed == ("strength", "sliding.speed", "slider")
    assert LESSON_SLIDER.items() <= settings.world.items()
    assert (settings.world["spread"], settings.world["strength"], settings.world["speed"]) == (0.0, 250.0, 1000.0)
    assert "The scenario has no strength and no sliding.speed and no slider: that of the paper&#x27;s Figure 5" in page(
        "bare", settings
    )


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"diameter": {"law": "gamma", "spread": "1 um"}}, "diameter.law"),
        ({"strength": {"law": "normal", "mean": "250 MPa", "spread": "20 %"}}, "strength.law"),
        ({"pulse": {"shape": "parabola", "offset": "uniform"}}, "pulse.offset"),
        ({"birth": {"law": "gamma", "shape": 4.0}}, "birth.law"),
    ],
)
def test_what_the_page_cannot_draw_is_refused(table: dict[str, object], said: str) -> None:
    with pytest.raises(Refused, match=said):
        settings_of(build(BARE | table))

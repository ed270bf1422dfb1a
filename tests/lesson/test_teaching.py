"""What a teacher has: the page as one file, numbers and answers, a projector and a worksheet."""

import re
from functools import cache
from math import pi, sqrt

import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.lesson.page import LAWS, LESSON_SLIDER, half_lag, page, settings_of
from rubnoise.scenario import build
from rubnoise.scenario import load as load_scenario
from rubnoise.scenario.reading import load
from tests.architecture.sources import ROOT
from tests.lesson.node import lessons, scenario_of, world_with
from tests.lesson.walk import Walk

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
    force = 100 * sqrt(load.covariances["friction_force", "friction_force"]) / (250 * 200)
    rest = [load.contact_resonance, load.separation_std, 0.5 * sqrt(2 / 50)]
    return [gap, force, held.slider.displacement_std, *rest]


def hop():
    held = exact("load/fig5_load", "interface.mean_junction_count=0.5", "sliding.speed=80 mm/s")
    width = sqrt(4 * 200 / (pi * 0.5))
    low = width * 2 * pi * held.load.contact_resonance / 1000
    return [width, low, low / 2, 80 / low, 40 / low, 80 / low, 160 / low]


def back():
    result = exact("paper/fig5")
    return [result.slider.displacement_std, result.force.std / result.model.slider.stiffness]


EXPECTED = [one_life, births, count, alive, area_sum, memory, slider, bet, sizes, rise, hop, back]


def is_shown_as(value, text):
    return round(value, len(text.partition(".")[2])) == float(text)


@pytest.mark.parametrize(
    ("lesson", "expected"), list(zip(lessons(), EXPECTED, strict=True)), ids=[each.title for each in lessons()]
)
def test_numbers_are_those_of_the_theory(lesson, expected):
    values = expected()
    wrong = [(text, value) for text, value in zip(lesson.numbers, values, strict=True) if not is_shown_as(value, text)]
    assert wrong == []


def test_a_wrong_digit_is_noticed():
    assert is_shown_as(4.4721, "4.472")
    assert not is_shown_as(4.4721, "4.473")
    assert not is_shown_as(0.0499, "0.04")


def test_the_regular_contact_that_is_silent():
    silent = exact("lessons/regular", "pulse.shape=triangle")
    assert silent.area.std < 1e-12 * silent.area.mean


def test_the_guide_tells_after_how_many_lives_a_lesson_asks(walk):
    lives = walk.page.evaluate("rub.lessons.list.filter((each) => !each.experiment.reading).map(rub.lessons.lives)")
    least, *_, most, memory = sorted(lives)
    said = f"after {least} to {most} lives (lesson 6: {memory})"
    assert lives[5] == memory
    assert said in (ROOT / "docs" / "teaching.md").read_text(encoding="utf-8")


def test_the_worksheet_is_of_the_open_lesson(walk):
    walk.open("5. The sum")
    walk.page.evaluate("dispatchEvent(new Event('beforeprint'))")
    sheet = walk.page.locator("#sheet")
    assert sheet.locator("h1").all_text_contents() == ["5. The sum", "Afterwards"]
    columns = sheet.locator("table th[scope=col]").all_text_contents()
    assert columns == ["quantity", "2 junctions", "20 junctions", "100 junctions", "the law"]
    assert "Two equal discs" not in sheet.text_content()


def test_on_a_low_screen_question_and_answers_are_in_sight_and_no_table_is_empty(browser, lesson_file):
    page = browser.new_page(viewport={"width": 1366, "height": 768})
    page.goto(lesson_file)
    walk = Walk(page)
    for number, lesson in enumerate(lessons()):
        if number:
            walk.open(lesson.title)
        assert page.locator(".lesson-question").bounding_box()["y"] >= 0, lesson.title
        box = walk.article.locator("#lesson-predict .lesson-buttons").bounding_box()
        assert box["y"] + box["height"] <= 768, lesson.title
        assert page.locator("table:visible").count() == 0, lesson.title
        walk.predict()
        assert walk.article.locator("table").count() == 0, lesson.title
    page.close()


@pytest.mark.parametrize("title", ["5. The sum", "7. The slider", "11. Let it hop"])
def test_a_phone_shows_the_pictures_of_a_lesson_whole(browser, lesson_file, title):
    page = browser.new_page(viewport={"width": 390, "height": 844}, is_mobile=True, has_touch=True)
    page.goto(lesson_file)
    walk = Walk(page)
    walk.open(title)
    assert page.locator(".lesson-question").bounding_box()["y"] < 0.6 * 844
    walk.predict()
    for index in range(walk.article.locator("[data-run]").count()):
        walk.run(index)
        pictures = page.evaluate("(({ scrollHeight, clientHeight }) => [scrollHeight, clientHeight])(pictures)")
        assert pictures[0] <= pictures[1], index
    page.close()


# The page as a file: one, small, and without requests.
FIG5 = ROOT / "scenarios" / "paper" / "fig5.toml"
BARE = {
    "format": 1,
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
    "sliding": {"distance": "300 um"},
}


def text_of(title: str = "a title") -> str:
    return page(title, load_scenario(FIG5))


@pytest.mark.slow
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


def test_knobs_stand_as_the_scenario_says() -> None:
    world = world_with(births="regular", spread=0.25, calibration="matched", pulse="triangle", damping=0.07, seed=9)
    settings, borrowed = settings_of(scenario_of(world, distance=300.0))
    assert settings["world"] == world | {"coupling": "one-way"}
    assert (settings["distance"], settings["sliderStart"], borrowed) == (300.0, "equilibrium", ())


def test_passes_off_the_centre_line_stand_as_the_scenario_says() -> None:
    world = world_with(offset="uniform", calibration="matched")
    assert settings_of(scenario_of(world))[0]["world"] == world | {"coupling": "one-way"}
    assert '"offset": "uniform"' in page("off", scenario_of(world))


def test_what_a_scenario_lacks_is_borrowed_and_said() -> None:
    settings, borrowed = settings_of(build(BARE))
    assert borrowed == ("strength", "sliding.speed", "slider")
    assert LESSON_SLIDER.items() <= (world := settings["world"]).items()
    assert (world["spread"], world["strength"], world["speed"]) == (0.0, 250.0, 1000.0)
    assert "The scenario has no strength and no sliding.speed and no slider: that of the paper&#x27;s Figure 5" in page(
        "bare", build(BARE)
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

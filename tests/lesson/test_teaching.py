"""Every number in bold in docs/teaching.md is the one of the theory, to the digits that are printed."""

from functools import cache
from math import sqrt

import pytest

import rubnoise
from rubnoise.lesson.readings import LAWS, half_lag
from rubnoise.scenario.reading import load
from tests.architecture.sources import ROOT
from tests.lesson.teaching import lessons, minutes, other_numbers

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


EXPECTED = [one_life, births, count, alive, area_sum, memory, slider, bet, sizes]


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
    off_centre = swing(exact("lessons/poisson", "pulse.offset=uniform")) * sqrt(20)
    written = [text for text in other_numbers() if "." in text]
    values = (lens, triangle, off_centre)
    assert [is_shown_as(value, text) for value, text in zip(values, written, strict=True)] == [True] * 3


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

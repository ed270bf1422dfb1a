"""Every figure that a lesson shows: the law's are those of the Python package, the run's follow from its rows."""

from math import exp, sqrt

import numpy as np
import pytest

import rubnoise
from tests.laws.scores import seed_of
from tests.lesson.node import FIGURE_5, scenario_of
from tests.lesson.walk import UNFOLD

pytestmark = pytest.mark.slow

MEASURED = "(settings) => rub.lessons.measured({ ...rub.world, ...settings })"


def swing(exact):
    return exact.area.std / exact.area.mean


TABLE = """(names) => Object.fromEntries(names.map((name) => [name,
  document.querySelector(`#number-${name} td`).textContent.replace('\u2212', '-')]))"""


def table(exact):
    """Return what the page's table of numbers has to say of a contact and its slider, in the units of the table."""
    forces = exact.model.strengths.mean
    return {
        "count": exact.count_mean,
        "count-std": exact.count_std,
        "area": exact.area.mean,
        "area-std": exact.area.std,
        "relative": swing(exact),
        "swing": swing(exact) * sqrt(exact.count_mean),
        "tail": -exact.model.pulse.tail[1],
        "little": exact.count_mean,
        "skewness": exact.area.skewness,
        "diameter": exact.mean_diameter,
        "live-diameter": exact.length_biased_mean_diameter,
        "life": exact.model.pulse.mean_life * exact.mean_diameter,
        "spacing": exact.model.mean_birth_spacing,
        "force": 1e-3 * forces * exact.area.mean,
        "force-std": 1e-3 * forces * exact.area.std,
        "displacement": exact.slider.mean_displacement,
        "displacement-std": exact.slider.displacement_std,
        "velocity-std": 1e-3 * exact.slider.velocity_std,
        "frequency": exact.model.slider.natural_frequency,
        "one-way": exact.slider.one_way_validity,
    }


@pytest.mark.parametrize(("lesson", "offset"), [(4, "none"), (7, "none"), (8, "none"), (5, "uniform")])
def test_the_numbers_on_the_page_are_those_of_theory(walk, lesson, offset):
    """Twenty numbers, as they can be read, of three lessons and of passes off the centre line."""
    walk.page.evaluate(f"rub.set(rub.lessons.list[{lesson - 1}].experiment.runs[0].set)")
    walk.page.evaluate(UNFOLD)
    walk.page.locator("#knob-offset").select_option(offset)
    walk.page.locator("#reveal").click()
    world = walk.page.evaluate("rub.world")
    expected = table(rubnoise.exact(scenario_of(world)))
    shown = walk.page.evaluate(TABLE, list(expected))
    for name, value in expected.items():
        assert float(shown[name]) == pytest.approx(value, rel=5e-6), name
    other = table(rubnoise.exact(scenario_of({**world, "meanCount": 1.001 * world["meanCount"]})))
    assert float(shown["area-std"]) != pytest.approx(other["area-std"], rel=5e-6)


def squared_error(settings):
    """Return a bound on the variance of log(std/mean) over a run: those of log std and log mean, as if independent.

    Var of a variance from a stretch S is (2 int R^2 + int C4) / S, C4 the joint fourth cumulant of A, A, A', A', whose
    integral is lam E[(int A^2)^2]; Var of a mean is S(0) / S. Std and mean rise together, so that the sum is a bound.
    """
    exact = rubnoise.exact(scenario_of(settings))
    model, length = exact.model, 400 * 2 * exact.mean_diameter
    lags = np.linspace(0, 2 * exact.mean_diameter, 2001)
    squares = 2 * 2 * np.trapezoid(exact.autocovariance(lags) ** 2, lags)
    fourth = model.birth_rate * (model.pulse.life_integral(2) * model.calibrated_diameter**5) ** 2
    of_variance = (squares + fourth) / length / exact.area.variance**2
    of_mean = float(exact.spectral_density(0.0)) / length / exact.area.mean**2
    return of_variance / 4 + of_mean


def test_the_bet_is_settled_by_runs_that_obey_the_law(walk):
    seed = seed_of("lesson bet") % 2**48
    sides = [
        {**FIGURE_5, "meanCount": count, "spread": 0.0, "calibration": "matched", "seed": seed} for count in (5.0, 80.0)
    ]
    told = [walk.page.evaluate(MEASURED, settings) for settings in sides]
    few, many = (each["areaStd"] / each["areaMean"] for each in told)
    error = sqrt(sum(squared_error(settings) for settings in sides))
    assert abs(np.log(few / many) - np.log(4)) <= 4 * error
    assert abs(np.log(few / many) - np.log(2)) > 4 * error
    assert abs(np.log(few / many) - np.log(16)) > 4 * error


SPELLINGS = {
    "": {
        "0.33": 0.33, "0,33": 0.33, ".5": 0.5, "1/3": 1 / 3, "⅓": 1 / 3, "33 %": 0.33, "3.3e-1": 0.33,
        "\u22122": -2, "2^-1": 0.5, "√20": sqrt(20), "sqrt(20)": sqrt(20), "1/e": exp(-1), "e^-1": exp(-1),
        "pi/8": np.pi / 8, "2·10^2": 200, "1 000": 1000, "(1+2)*3": 9, "-3^2": -9, "6:3": 2,
    },
    "um": {"11,06 µm": 11.06, "11.06 um": 11.06, "0.01106 mm": 11.06, "8": 8},
    "um^2": {"160 µm²": 160, "160 um^2": 160, "0.00016 mm^2": 160},
    "Hz": {"19.5 Hz": 19.5, "19.5": 19.5, "122.5 rad/s": 122.5 / 2 / np.pi},
}  # fmt: skip


def test_numbers_are_read_as_they_are_written(walk):
    for unit, spellings in SPELLINGS.items():
        read = walk.page.evaluate(
            "([texts, unit]) => texts.map((t) => rub.answers.read(t, unit))", [[*spellings], unit]
        )
        assert [each.get("value") for each in read] == pytest.approx([*spellings.values()]), unit


UNREAD = [
    "",
    "  ",
    "about a third",
    "1.234,5",
    "1,2,3",
    "(1/2",
    "1/0",
    "3 kg",
    "7 Hz m",
    "alert(1)",
    "<b>1</b>",
    "((((",
    "1 1/2",
]


def test_what_is_no_number_is_refused_with_a_reason(walk):
    for text in UNREAD:
        told = walk.page.evaluate("(text) => rub.answers.read(text, 'um')", text)
        assert "value" not in told, text
        assert len(told["problem"]) > 10, text
        assert "<" not in told["problem"], text

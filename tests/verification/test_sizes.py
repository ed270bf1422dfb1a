"""Sizes of a mixture and of measured values: exact moments, their areas, and 200 runs beside them."""

from math import sqrt
from typing import Any

import numpy as np
import pytest

from rubnoise.contact.laws.discrete import largest_of
from rubnoise.errors import Refused
from rubnoise.scenario import build, loads
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.writing import text_of
from rubnoise.theory.exact import exact
from tests.models import contents, recorded
from tests.unit.scenarios import BARE, refusal

TWO = 'law = "mixture"\nweights = [0.7, 0.3]\nparts = [{law = "fixed", mean = 4}, {law = "fixed", mean = "9 um"}]\n'
SMOOTH = (
    'law = "mixture"\nweights = [7, 3]\n'
    'parts = [{law = "normal", mean = 4, spread = "20 %"}, {law = "lognormal", mean = 9, spread = "30 %"}]\n'
)
VALUES = 'law = "empirical"\nvalues = [4, 5, 6, 8.5]\n'
ALIVE = f'{VALUES}sampled = "alive"\n'
CASES = {"two": TWO, "smooth": SMOOTH, "values": VALUES, "alive": ALIVE}


def scenario(table: str, **more: Any) -> Scenario:
    text = BARE.replace("[sliding]", f'calibration = "matched"\n[diameter]\n{table}[sliding]')
    return loads(text, overrides=["sliding.distance=600 um", "output.tick=0.2 um", *more.values()])


def test_two_sizes_have_their_published_moments() -> None:
    model = scenario(TWO, how="interface.calibration=exact").model()
    scale = 5.5 / model.calibrated_diameter
    moments = [model.sizes.moment(n) * scale**n for n in range(1, 7)]
    assert moments == pytest.approx([5.5, 35.5, 263.5, 2147.5, 18431.5, 162299.5], rel=1e-14)
    area = exact(model).area
    assert area.std / area.mean * sqrt(20.0) == pytest.approx(1.4859795, abs=5e-8)


@pytest.mark.parametrize("name", CASES)
def test_200_runs_have_the_exact_moments(name: str) -> None:
    made = scenario(CASES[name])
    run, theory = made.model(), exact(made.model())
    assert theory.area.mean == pytest.approx(200.0, rel=1e-12)
    assert build(made.resolved()).model() == run
    assert loads(text_of(made.resolved())).model() == run
    assert contents(recorded(run, 3, engine="events")) == contents(recorded(run, 3, engine="batch"))
    traces = [recorded(run, seed, engine="batch")["trace"] for seed in range(200)]
    area = np.array([each["real_contact_area"] for each in traces])
    first = np.array([each["junction_count"][0] for each in traces])

    def z(samples: np.ndarray[Any, Any], expected: float) -> float:
        return float((samples.mean() - expected) / (samples.std(ddof=1) / sqrt(samples.size)))

    squares = np.square(area - theory.area.mean).mean(axis=1)
    assert abs(z(area.mean(axis=1), theory.area.mean)) <= 4.0
    assert abs(z(squares, theory.area.variance)) <= 4.0
    assert abs(z(first, theory.count_mean)) <= 4.0
    one_size = exact(scenario('law = "fixed"\n').model()).area.variance
    assert abs(z(squares, one_size)) > 4.0


def test_a_snapshot_is_freed_of_its_bias() -> None:
    born = scenario(VALUES).model().sizes
    generator, n = np.random.default_rng(3), 200_000
    seen = born.draw_length_biased(generator, n)
    values, counts = np.unique(seen, return_counts=True)
    wanted = values / values.sum()
    assert np.abs(counts - n * wanted).max() <= 4.0 * sqrt(n * 0.25)
    undone = counts / values / (counts / values).sum()
    assert np.abs(undone - 0.25).max() < 0.01 < np.abs(counts / n - 0.25).max()
    alive = scenario(ALIVE).model().sizes
    assert alive.moment(2) / alive.moment(1) ** 2 == pytest.approx(23.5 / 4.0 * (1 / 4 + 1 / 5 + 1 / 6 + 1 / 8.5) / 4.0)


def test_the_largest_size_may_be_of_any_part() -> None:
    parts = '[{law = "fixed", mean = 9}, {law = "fixed", mean = 4}]'
    law = scenario(f'law = "mixture"\nweights = [1, 1]\nparts = {parts}\n').model().sizes
    assert largest_of(law) == law.support[1] > float(law.draw(np.array([1.0 - 2.0**-53]))[0])


def test_what_needs_a_density_is_refused() -> None:
    assert exact(scenario(SMOOTH).model()).distribution().cdf(1e9) == 1.0
    with pytest.raises(Refused, match="several single diameters"):
        exact(scenario(TWO).model()).distribution()


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('law = "mixture"\nweights = [1]\n', 'diameter.parts: missing; the law "mixture" needs a parts'),
        (TWO.replace("[0.7, 0.3]", "[1]"), "diameter.weights: 1 weights for 2 parts"),
        (
            TWO.replace("mean = 4", 'mean = 4, spread = "2 %"'),
            'part 1: the law "fixed" takes no spread',
        ),
        (TWO.replace('"fixed", mean = 4', '"normal", mean = 4'), 'part 1: the law "normal" needs a spread'),
        (TWO.replace('"fixed", mean = 4', '"empirical", mean = 4'), 'unknown value "empirical"'),
        (TWO.replace("mean = 4", "mean = -4"), "diameter.parts: must be above 0"),
        ('law = "empirical"\nvalues = []\n', "needs a list of 1 to 2000 diameters"),
        ('law = "empirical"\nvalues = [1, "a"]\n', "diameter.values"),
        ('law = "fixed"\nvalues = [1]\n', 'the law "fixed" takes no values'),
    ],
)
def test_wrong_lists_are_refused(table: str, said: str) -> None:
    assert said in refusal(BARE + "[diameter]\n" + table)

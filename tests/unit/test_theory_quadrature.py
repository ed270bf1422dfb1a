import numpy as np
import pytest

from rubnoise.contact import laws
from rubnoise.contact.laws import Exponential, Fixed, Law, Lognormal, Normal, Power, Weibull
from rubnoise.theory.quadrature import cut_size_rule, size_edges, size_range, size_rule
from tests.unit.size_laws import Gamma, LogNormal

LAWS: dict[str, Law] = {
    "normal 1e-8": Normal(centre=2.0, std=2e-8),
    "normal 4 %": Normal(centre=2.0, std=0.08),
    "normal 15 %": Normal(centre=2.0, std=0.3),
    "normal 300 %": Normal(centre=2.0, std=6.0),
    "lognormal 5 %": LogNormal(2.0, 0.05),
    "lognormal 40 %": LogNormal(2.0, 0.4),
    "lognormal 300 %": LogNormal(2.0, 3.0),
    "gamma 20 %": Gamma(2.0, 0.2),
    "exponential": Gamma(2.0, 1.0),
    "gamma 300 %, singular at 0": Gamma(2.0, 3.0),
    "lognormal as drawn": Lognormal(mean=2.0, std=3.0),
    "gamma as drawn": laws.Gamma(mean=2.0, std=0.5),
    "gamma as drawn, singular at 0": laws.Gamma(mean=2.0, std=5.0),
    "exponential as drawn": Exponential(mean=2.0),
    "weibull as drawn, singular at 0": Weibull(mean=2.0, std=4.0),
    "power over a decade": Power(exponent=2.5, smallest=1.0, largest=10.0),
    "power, narrow": Power(exponent=1.0, smallest=1.9, largest=2.1),
    "power over six decades": Power(exponent=3.5, smallest=1e-4, largest=1e2),
    "power, rising": Power(exponent=-8.0, smallest=0.01, largest=4.0),
}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("power", [1, 2, 3, 5, 9, 13])
def test_moments_of_any_law_to_rounding(name: str, power: int) -> None:
    diameters, probabilities = size_rule(LAWS[name], 64)
    # 2e-13, not rounding itself: the laws of the tests take their moments from lgamma.
    assert probabilities @ diameters**power == pytest.approx(LAWS[name].moment(power), rel=2e-13)
    assert diameters.size < 300


def test_a_support_alone_would_lose_the_high_moments_of_a_heavy_tail() -> None:
    law = LAWS["lognormal 300 %"]
    assert size_range(law)[1] > 1e6 * law.support[1]


def test_edges_of_a_law_are_found_once() -> None:
    assert size_edges(Gamma(2.0, 1.0))[0] is size_edges(Gamma(2.0, 1.0))[0]


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("kink", [1e-6, 1.9, 2.3, 40.0])
def test_averages_of_what_has_a_kink(name: str, kink: float) -> None:
    """E[(d - a)+] + E[min(d, a)] is E[d], wherever the cut lies, and each part against finer panels."""
    law = LAWS[name]

    def parts(count: int) -> tuple[float, float]:
        d, p = cut_size_rule(law, np.array([kink]), count)
        return float(p @ np.maximum(d - kink, 0.0)), float(p @ np.minimum(d, kink))

    assert sum(parts(16)) == pytest.approx(law.moment(1), rel=1e-14)
    np.testing.assert_allclose(parts(16), parts(48), rtol=1e-11, atol=1e-15)


def test_a_rule_without_the_cut_would_show() -> None:
    law = LAWS["normal 15 %"]
    d, p = size_rule(law, 64)
    cut, probabilities = cut_size_rule(law, np.array([2.1]), 16)
    assert abs(p @ np.maximum(d - 2.1, 0.0) / (probabilities @ np.maximum(cut - 2.1, 0.0)) - 1.0) > 1e-4


def test_one_size_has_one_diameter_in_every_rule() -> None:
    d, p = cut_size_rule(Fixed(value=3.0), np.array([[1.0], [5.0]]), 16)
    assert d.tolist() == [[3.0], [3.0]]
    assert p.tolist() == [[1.0], [1.0]]
    assert size_range(Normal(centre=3.0, std=1e-12)) == (3.0, 3.0)

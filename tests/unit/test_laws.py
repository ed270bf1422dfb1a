"""Every law of sizes and strengths against its textbook: moments, density, samples and extremes."""

from collections.abc import Callable
from dataclasses import dataclass
from math import log, sqrt
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.special import gammainc, ndtr

from rubnoise.contact.distributions import Fixed, Gamma, Lognormal, Normal, Power, Weibull
from rubnoise.contact.laws import LAWS, Spread, law_for
from tests.frozen import frozen
from tests.laws.scores import seed_of

# The laws again, from their textbook densities and distribution functions.
# A `Textbook` shares no code with the law that it stands beside: `textbook(law)` reads nothing but its parameters.
Doubles = NDArray[np.float64]
Distribution = Callable[[Doubles], Doubles]

KS_BOUND = 2.28
"""D sqrt(n) of Kolmogorov and Smirnov is larger with the probability of 4 standard deviations."""


def ks(values: Doubles, distribution: Distribution) -> float:
    """Return D sqrt(n) of a sample against a continuous distribution function."""
    n = values.size
    heights = distribution(np.sort(values))
    steps = np.arange(n + 1) / n
    return float(max(np.max(steps[1:] - heights), np.max(heights - steps[:-1])) * np.sqrt(n))


@dataclass(frozen=True)
class Textbook:
    """A law as books have it.

    density and tails take mpmath numbers: f(x), and P(X < x) with P(X > y). distribution is that of f(x),
    for arrays. weight(n) are places in ln x between which all of x^n f(x) lies.
    """

    density: Callable[[Any], Any]
    tails: Callable[[Any, Any], tuple[Any, Any]]
    distribution: Distribution
    weight: Callable[[int], tuple[Any, Any]]

    def moment(self, power: int) -> Any:
        """Return E[x^n] as the integral of x^n f(x), in ln x."""
        steps = mpmath.linspace(*self.weight(power), 12)
        return mpmath.quad(lambda t: mpmath.exp((power + 1) * t) * self.density(mpmath.exp(t)), steps)


def textbook(law: Any) -> Textbook:
    """Return the textbook's form of a law that has a density."""
    return _BOOKS[type(law)](law)


def _normal(law: Normal) -> Textbook:
    centre, std = law.centre, law.std
    start, mass = -centre / std, float(ndtr(centre / std))
    exact = mpmath.mpf(centre), mpmath.mpf(std), mpmath.ncdf(mpmath.mpf(centre) / std)

    return Textbook(
        density=lambda x: mpmath.npdf((x - exact[0]) / exact[1]) / exact[1] / exact[2],
        tails=lambda x, y: (
            (mpmath.ncdf((x - exact[0]) / exact[1]) - mpmath.ncdf(-exact[0] / exact[1])) / exact[2],
            mpmath.ncdf((exact[0] - y) / exact[1]) / exact[2],
        ),
        distribution=lambda x: (ndtr((x - centre) / std) - ndtr(start)) / mass,
        weight=lambda n: (
            mpmath.log(max(centre - 14 * std, std * mpmath.mpf(10) ** (-40 / (n + 1)))),
            mpmath.log(centre + 16 * std),
        ),
    )


def _lognormal(law: Lognormal) -> Textbook:
    variance = log(1.0 + (law.std / law.mean) ** 2)
    centre = log(law.mean) - 0.5 * variance
    exact = mpmath.log(1 + (mpmath.mpf(law.std) / law.mean) ** 2)
    middle, width = mpmath.log(law.mean) - exact / 2, mpmath.sqrt(exact)
    return Textbook(
        density=lambda x: mpmath.npdf((mpmath.log(x) - middle) / width) / (x * width),
        tails=lambda x, y: (
            mpmath.ncdf((mpmath.log(x) - middle) / width),
            mpmath.ncdf((middle - mpmath.log(y)) / width),
        ),
        distribution=lambda x: ndtr((np.log(x) - centre) / sqrt(variance)),
        weight=lambda n: (middle + n * exact - 14 * width, middle + n * exact + 14 * width),
    )


def _gamma(law: Gamma) -> Textbook:
    order = (law.mean / law.std) ** 2
    shape = (mpmath.mpf(law.mean) / law.std) ** 2
    scale = mpmath.mpf(law.mean) / shape
    return Textbook(
        density=lambda x: (x / scale) ** (shape - 1) * mpmath.exp(-x / scale) / (mpmath.gamma(shape) * scale),
        tails=lambda x, y: (
            mpmath.gammainc(shape, 0, x / scale, regularized=True),
            mpmath.gammainc(shape, y / scale, mpmath.inf, regularized=True),
        ),
        distribution=lambda x: gammainc(order, order * x / law.mean),
        weight=lambda n: (
            mpmath.log(law.mean) - 40 / (shape + n) - 1,
            mpmath.log(law.mean) + mpmath.log((100 + shape + 10 * mpmath.sqrt(shape)) / shape),
        ),
    )


def _weibull(law: Weibull) -> Textbook:
    variation = (mpmath.mpf(law.std) / law.mean) ** 2
    shape = mpmath.findroot(
        lambda k: mpmath.gamma(1 + 2 / k) / mpmath.gamma(1 + 1 / k) ** 2 - 1 - variation,
        (0.2, 500.0),
        solver="bisect",
        maxsteps=200,
    )
    scale = law.mean / mpmath.gamma(1 + 1 / shape)
    k, size = float(shape), float(scale)
    return Textbook(
        density=lambda x: shape / scale * (x / scale) ** (shape - 1) * mpmath.exp(-((x / scale) ** shape)),
        tails=lambda x, y: (-mpmath.expm1(-((x / scale) ** shape)), mpmath.exp(-((y / scale) ** shape))),
        distribution=lambda x: -np.expm1(-((x / size) ** k)),
        weight=lambda n: (
            mpmath.log(scale) - 60 / (shape + n),
            mpmath.log(scale) + mpmath.log(100 + 4 * (1 + n / shape)) / shape,
        ),
    )


def _power(law: Power) -> Textbook:
    low, high = law.smallest, law.largest

    def partial(x: Any, power: float, logarithm: Callable[[Any], Any] = np.log) -> Any:
        """Return the integral of x^(power - exponent) from the smallest value to x, but for a factor."""
        rate = 1.0 + power - law.exponent
        return logarithm(x / low) if rate == 0.0 else ((x / low) ** rate - 1.0) / rate

    whole = partial(mpmath.mpf(high), 0.0, mpmath.log)
    return Textbook(
        density=lambda x: (x / low) ** (-mpmath.mpf(law.exponent)) / (low * whole),
        tails=lambda _x, _y: (mpmath.mpf(0), mpmath.mpf(0)),
        distribution=lambda x: partial(x, 0.0) / partial(high, 0.0),
        weight=lambda _n: (mpmath.log(low), mpmath.log(high)),
    )


_BOOKS: dict[type, Callable[[Any], Textbook]] = {
    Normal: _normal,
    Lognormal: _lognormal,
    Gamma: _gamma,
    Weibull: _weibull,
    Power: _power,
}


# Each law against its textbook.
COUNT = 100_000
CASES = [
    *(Normal(centre=c, std=s) for c, s in [(5.53, 0.2), (1.0, 1.0), (0.4, 2.0), (250.0, 1000.0)]),
    *(Lognormal(mean=5.53, std=5.53 * cv) for cv in (0.05, 0.3, 1.0, 3.0)),
    Gamma(mean=5.53, std=5.53),
    *(Gamma(mean=5.53, std=5.53 * cv) for cv in (0.05, 0.3, 1.0, 3.0)),
    *(Weibull(mean=250.0, std=250.0 * cv) for cv in (0.1, 0.2, 1.0, 2.0, 3.0)),
    *(Power(exponent=a, smallest=2.0, largest=20.0) for a in (-1.5, 1.0, 2.0, 2.5, 9.0)),
    Power(exponent=1.0 + 1e-9, smallest=1.0, largest=1e4),
]
"""At least one of each law that has a density; a new law needs its cases here and its textbook."""

ENDS = np.array([2.0**-53, 0.25, 0.5, 0.75, 1.0 - 3.0 * 2.0**-53, 1.0 - 2.0**-53])
"""The least and the largest uniform, and some between."""
every_law = pytest.mark.parametrize("law", CASES, ids=str)


def uniforms(law, what="draws"):
    return np.random.default_rng(seed_of(f"laws/{what}/{law}")).random(COUNT)


def std_of(law):
    return sqrt(law.moment(2) - law.moment(1) ** 2)


WITHOUT_LISTS = [name for name, entry in LAWS.items() if not entry.own_keys]


def test_every_law_of_the_registry_has_its_cases():
    own = {name: tuple((each.name, each.sample) for each in LAWS[name].parameters) for name in WITHOUT_LISTS}
    made = {type(law_for(5.0, Spread(relative=0.2, law=name, parameters=own[name]))) for name in own}
    assert made == {Fixed, *map(type, CASES)}


@frozen
def textbook_moment(law, power):
    with mpmath.workdps(25):
        return float(textbook(law).moment(power))


@every_law
@pytest.mark.parametrize("power", [0, 1, 6, 13])
def test_moments_are_those_of_the_density(law, power):
    assert law.moment(power) == pytest.approx(textbook_moment(law, power), rel=1e-12)


@pytest.mark.slow("Gamma(mean=5.53", "Weibull(mean=250.0")
@every_law
def test_the_density_is_the_textbooks(law):
    values = law.quantile(np.linspace(0.001, 0.999, 41))
    with mpmath.workdps(25):
        expected = [float(textbook(law).density(mpmath.mpf(x))) for x in values.tolist()]
    assert law.density(values) == pytest.approx(expected, rel=1e-12)
    assert law.density(np.array([-1.0, 0.0])).tolist() == [0.0, 0.0]


@every_law
def test_less_than_1e_16_of_a_law_lies_outside_its_support(law):
    low, high = law.support
    assert 0.0 <= low < law.mean < high
    with mpmath.workdps(25):
        outside = float(sum(textbook(law).tails(mpmath.mpf(low), mpmath.mpf(high))))
    assert outside <= 1.1e-16 or low == law.mean * 2.0**-100  # below that no junction is ever made


@every_law
def test_samples_follow_the_law(law):
    drawn = law.quantile(uniforms(law))
    assert ks(drawn, textbook(law).distribution) < KS_BOUND
    assert ks(np.minimum(drawn * (1.0 + 0.1 * std_of(law) / law.mean), law.support[1]), textbook(law).distribution) > (
        KS_BOUND
    )


@pytest.mark.parametrize("law", [law for law in CASES if std_of(law) < 2.0 * law.mean], ids=str)
@pytest.mark.parametrize("power", [1, 2, 3])
def test_samples_have_the_exact_moments(law, power):
    error = sqrt((law.moment(2 * power) - law.moment(power) ** 2) / COUNT)
    assert abs(np.mean(law.quantile(uniforms(law)) ** power) - law.moment(power)) <= 4 * error


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name, entry in LAWS.items() if entry.takes_spread])
@settings(max_examples=3, deadline=None)
@given(spread=st.floats(1e-6, 3.0), exponent=st.integers(-6, 6))
def test_extremes_give_finite_positive_values(name, spread, exponent):
    centre, spread = 10.0**exponent, min(spread, LAWS[name].widest)
    _hold_extremes(law_for(centre, Spread(absolute=spread * centre, law=name)))


@settings(max_examples=20, deadline=None)
@given(
    fall=st.one_of(st.floats(-10.0, 10.0), st.floats(1.0 - 1e-6, 1.0 + 1e-6)),
    low=st.floats(1e-3, 1e3),
    ratio=st.floats(1.0 + 1e-6, 1e6),
)
def test_any_range_of_a_power_law_gives_values_in_it(fall, low, ratio):
    law = Power(exponent=fall, smallest=low, largest=low * ratio)
    _hold_extremes(law)
    values = law.quantile(ENDS)
    assert np.all(np.diff(values) >= 0.0)
    assert law.smallest <= values[0] <= values[-1] <= law.largest


def _hold_extremes(law):
    drawn = law.quantile(ENDS)
    assert np.all((drawn > 0.0) & np.isfinite(drawn))
    assert np.all(drawn**2 > 0.0)
    assert all(np.isfinite(law.moment(n)) for n in range(14))


def test_redrawing_is_not_reflecting():
    """|d| in place of drawing again has another mean, and would be seen; so the mean exceeds the centre."""
    law = Normal(centre=0.4, std=2.0)
    reflected = np.abs(np.random.default_rng(3).normal(0.4, 2.0, COUNT))
    assert abs(reflected.mean() - law.moment(1)) > 4 * std_of(law) / sqrt(COUNT)
    assert Normal(centre=250.0, std=250.0).mean == pytest.approx(250.0 * 1.2876, rel=1e-4)

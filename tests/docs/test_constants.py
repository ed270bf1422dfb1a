"""The constants that docs/theory.md derives, computed again by quadrature, by sums and by the program."""

import re
from collections.abc import Callable
from functools import cache
from math import pi, sqrt
from typing import Any

import mpmath
import numpy as np
import pytest

import rubnoise
from rubnoise.theory.exact import Exact
from tests.architecture.sources import ROOT
from tests.frozen import frozen

TEXT = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
SECTION = TEXT.partition("## Where the constants come from")[2].partition("\n## ")[0]
BOLD = set(re.findall(r"\*\*([^*]+)\*\*", " ".join(SECTION.split())))


@frozen
def lens_integral(n: int) -> float:
    """Return c_n from the area as it is written in docs/theory.md."""
    return float(mpmath.quad(lambda x: 2 * (mpmath.acos(x) / 2 - x / 2 * mpmath.sqrt(1 - x * x)) ** n, [0, 1]))


def lens(z: float) -> float:
    """Return A^(k)/A^(0) at z = k d, from the slope of the area."""
    edges = np.linspace(0.0, 1.0, 2 + int(z / 3.0)).tolist()
    return float(3 / mpmath.mpf(z) * mpmath.quad(lambda x: mpmath.sqrt(1 - x * x) * mpmath.sin(z * x), edges))


def triangle(z: float) -> float:
    return float(np.sinc(0.5 * z / pi) ** 2)


def ripple(pulse: Callable[[float], float], count: float, terms: int) -> float:
    """Return std over mean of equal junctions born at regular spacing, by its Fourier series."""
    return sqrt(2.0 * sum(pulse(pi * n * count) ** 2 for n in range(1, terms + 1)))


@frozen
def lens_ripple(count: float, terms: int) -> float:
    return ripple(lens, count, terms)


@frozen
def half_power() -> float:
    return 2.0 * float(mpmath.findroot(lambda z: lens(float(z)) ** 2 - 0.5, (2.0, 2.5), solver="secant", tol=1e-9))


def third_over_mean(r: Any) -> Any:
    """Return E[d^3]/d_m of the conditioned normal law for unit spread."""
    mass, third = (mpmath.quad(lambda d, n=n: d**n * mpmath.npdf(d, r, 1), [0, r, r + 12]) for n in (0, 3))
    return third / mass / r


@frozen
def least_matched() -> float:
    return float(mpmath.findroot(lambda r: mpmath.diff(third_over_mean, r), 0.9))


@frozen
def matched_at_least() -> float:
    return float(third_over_mean(least_matched()))


@cache
def contact(count: int, spread: str = "0.2 um", area: float = 200.0) -> Exact:
    interface = {"mean_real_contact_area": area, "mean_junction_count": count, "calibration": "paper"}
    diameter = {"law": "normal", "spread": spread}
    values = {"format": 1, "interface": interface, "diameter": diameter, "sliding": {"distance": "1 mm"}}
    return rubnoise.exact(rubnoise.build(values))


def swing() -> float:
    """Return the largest distance of S from its mean tail in units of the tail over sqrt(k d), far out."""
    z = np.linspace(2000.0, 2100.0, 20_001)
    exact = contact(20, "0 um")
    diameter = exact.model.calibrated_diameter
    k = z / diameter
    tail = 4.0 * exact.model.birth_rate * diameter**2 / k**4 * (1.0 + pi / (4.0 * z))
    return float(np.max(np.abs(exact.spectral_density(k) / tail - 1.0) * np.sqrt(z)))


def at_zero_of_one_size(count: int) -> float:
    return float(contact(count, "0 um").spectral_density(0.0))


def tail_level() -> float:
    """Return S k^4 / (lam m_2) far out, where spread has averaged the swing away."""
    exact, k = contact(20, "2 um"), 4000.0
    return float(exact.spectral_density(k)) * k**4 / (exact.model.birth_rate * exact.model.sizes.moment(2))


@pytest.mark.parametrize(
    ("printed", "expected", "value"),
    [
        ("1/3", 1.0 / 3.0, lambda: lens_integral(1) / 2.0),
        (r"$\pi/3 - 32/45$", pi / 3.0 - 32.0 / 45.0, lambda: lens_integral(2)),
        (r"$\pi/8$", pi / 8.0, lambda: float(mpmath.quad(lambda u: pi / 4 * u, [0, 1]))),
        (r"$1/(\sqrt{3} N_{jm}^2)$", 1.0 / sqrt(3.0), lambda: ripple(triangle, 7.0, 4000) * 49.0),
        (r"$N_{jm}^{-1.5}$", -1.5, lambda: np.log(at_zero_of_one_size(40) / at_zero_of_one_size(10)) / np.log(4.0)),
        (r"$4 \lambda m_2/k^4$", 4.0, tail_level),
    ],
)
def test_a_formula_holds(printed: str, expected: float, value: Callable[[], float]) -> None:
    assert printed in BOLD
    assert value() == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("printed", "value"),
    [
        ("1.2298", lambda: sqrt(2.0 * lens_integral(2)) / lens_integral(1)),
        ("1.1547", lambda: sqrt(2.0 * 2.0 / 3.0 * (pi / 4.0) ** 2) / (pi / 4.0)),
        ("0.887855", least_matched),
        ("1.609247", lambda: matched_at_least() / 3.0),
        ("0.967", lambda: lens(0.5) ** 2),
        ("0.251", lambda: lens(pi) ** 2),
        ("4.50", half_power),
        ("0.717", lambda: half_power() / (2.0 * pi)),
        ("2.5", swing),
        ("5.2 %", lambda: 100.0 * ripple(triangle, 2.5, 4000)),
        ("7.4 %", lambda: 100.0 * lens_ripple(2.0, 30)),
        ("0.38 %", lambda: 100.0 * lens_ripple(10.0, 20)),
        ("0.0996 %", lambda: 100.0 * lens_ripple(20.0, 20)),
    ],
)
def test_a_number_is_right_to_its_last_digit(printed: str, value: Callable[[], float]) -> None:
    assert printed in BOLD
    digits = re.match(r"[\d.]+", printed)
    assert digits
    places = len(digits[0].partition(".")[2])
    assert f"{value():.{places}f}" == digits[0]


def test_nothing_else_stands_out_that_is_a_number() -> None:
    tested = {mark.args[1][i][0] for test in (test_a_formula_holds, test_a_number_is_right_to_its_last_digit)
              for mark in test.pytestmark for i in range(len(mark.args[1]))}  # fmt: skip
    headings = {text for text in BOLD if text.endswith(".")}
    # The origin of the paper's 0.327 is unknown.
    assert BOLD - headings - {"0.327"} == tested

"""The parabola's exact figures beside those of a second program (tests/reference/family.json), and two errors of it."""

import json
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from rubnoise.contact.calibration import calibrated_diameter
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, PARABOLA
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.correlation import life_overlaps
from rubnoise.theory.spectrum import spectral_density
from rubnoise.theory.transform import transform_of
from tests.models import model

REFERENCE = json.loads((Path(__file__).parents[1] / "reference" / "family.json").read_text(encoding="utf-8"))[
    "parabola"
]
RAYLEIGH = Spread(relative=sqrt(4.0 / pi - 1.0), law="weibull")


def test_its_integrals_are_those_of_the_reference() -> None:
    assert [PARABOLA.life_integral(n) for n in range(1, 7)] == pytest.approx(list(REFERENCE["c_n"].values()), rel=1e-15)
    assert float(PARABOLA.life_mean()) == pytest.approx(REFERENCE["life_mean_over_d2"], rel=1e-15)


@pytest.mark.parametrize(("spread", "key"), [(Spread(), "cv_sqrtN_fixed"), (RAYLEIGH, "cv_sqrtN_rayleigh")], ids=str)
def test_variations_are_those_of_the_reference(spread: Spread, key: str) -> None:
    found = area_cumulants(model(spread=spread, calibration="matched", pulse=PARABOLA))
    assert found.mean == pytest.approx(200.0, rel=1e-13)
    assert sqrt(20.0) * found.std / found.mean == pytest.approx(REFERENCE[key], rel=1e-12)
    lens = area_cumulants(model(spread=spread, calibration="matched", pulse=LENS))
    assert sqrt(20.0) * lens.std / lens.mean != pytest.approx(REFERENCE[key], rel=0.01)


def test_rayleigh_sizes_need_the_matched_calibration() -> None:
    assert calibrated_diameter("matched", 200.0, 20.0, RAYLEIGH, PARABOLA) == pytest.approx(sqrt(10.0), rel=1e-15)
    too_large = area_cumulants(model(spread=RAYLEIGH, calibration="exact", pulse=PARABOLA)).mean
    assert too_large == pytest.approx(200.0 * 6.0 / pi, rel=1e-12)


def test_two_places_of_a_life_are_correlated_as_the_reference_has_it() -> None:
    """At a lag of 0.7 d: (pi/4)^2 (2 - t)^3 (t^2 + 6t + 4)/30."""
    found = life_overlaps(PARABOLA, np.array(0.7), ((1, 1),))[1, 1] / (0.25 * pi) ** 2
    assert REFERENCE["acf_check"] == pytest.approx([float(found)] * 2, rel=1e-7)


def test_its_transform_is_the_integral_of_its_life() -> None:
    z = np.array([0.0, 1e-3, 0.5, 0.999, 1.0, 1.001, 4.0, 20.0, 60.0])
    x, w = np.polynomial.legendre.leggauss(80)
    expected = (0.25 * pi * (1.0 - x * x) * np.cos(np.multiply.outer(z, x))) @ w
    assert transform_of(PARABOLA).amplitude(z) == pytest.approx(expected, abs=3e-15)


def test_its_spectrum_falls_off_about_the_tail() -> None:
    """Over a whole swing the mean is pi^2/2 lam d^2/k^4; the lens has 4 and would be seen."""
    contact = model(spread=Spread(), pulse=PARABOLA)
    d = contact.calibrated_diameter
    k = (3000.0 + np.linspace(0.0, pi, 400, endpoint=False)) / d
    level = float(np.mean(spectral_density(contact, k) * k**4)) / (contact.birth_rate * d * d)
    assert level == pytest.approx(0.5 * pi**2, rel=2e-3)
    assert abs(level - 4.0) > 0.5

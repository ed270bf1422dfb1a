from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.model import Model
from rubnoise.theory.spectrum import visible_lines
from tests.unit.theory_models import one_size


def _regular(count: int, pulse: Pulse) -> Model:
    model = one_size()
    return replace(model, pulse=pulse, births=RegularBirths(mean_spacing=2.0 * model.calibrated_diameter / count))


def test_births_at_random_have_none() -> None:
    assert [values.size for values in visible_lines(one_size())] == [0, 0]


def test_an_even_number_of_triangles_has_none() -> None:
    assert visible_lines(_regular(4, TRIANGLE))[0].size == 0


def test_of_an_odd_number_every_second_is_left() -> None:
    model = _regular(3, TRIANGLE)
    wavenumber, power = visible_lines(model)
    order = wavenumber / (2.0 * np.pi * model.birth_rate)
    np.testing.assert_allclose(order[:50], np.arange(1, 100, 2), rtol=1e-12)
    # A triangular ripple: a variance of the squared mean over 3 N^4, and powers as 1/n^4.
    mean = model.birth_rate * 0.25 * np.pi * model.calibrated_diameter**3
    assert 2.0 * power.sum() == pytest.approx(mean**2 / (3.0 * 3**4), rel=1e-6)
    np.testing.assert_allclose(power[:20] / power[0], np.arange(1.0, 40.0, 2.0) ** -4, rtol=1e-9)


def test_lenses_have_all() -> None:
    model = _regular(4, LENS)
    wavenumber, power = visible_lines(model)
    np.testing.assert_allclose(wavenumber[:20], 2.0 * np.pi * model.birth_rate * np.arange(1, 21), rtol=1e-12)
    assert np.all(power > 0.0)

"""Functions kept as polynomials in the logarithm of their place."""

import numpy as np
import pytest

from rubnoise.contact.laws import Normal
from rubnoise.contact.pulses import PULSES, Pulse
from rubnoise.theory.log_table import log_table
from rubnoise.theory.mean_life import age_table
from rubnoise.theory.quadrature import panels


def test_edges_that_differ_by_rounding_make_no_panel() -> None:
    table = log_table(
        lambda x: np.stack([x, x**2]), np.array([1.0, 2.0, np.nextafter(2.0, 3.0), 8.0]), np.full(2, 1e-13)
    )
    places = np.array([1.0, 1.5, 2.0, 2.5, 3.5, 7.9])
    np.testing.assert_allclose(table(places), [places, places**2], rtol=1e-12)


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
def test_mean_area_of_every_age_is_right_where_sizes_reach_down_to_nothing(pulse: Pulse) -> None:
    # Of these sizes an edge, doubled, falls beside another one. The check has no care for how lenses are born.
    law = Normal(centre=9.752392710241176, std=1.5)
    for age in np.linspace(0.5, 40.0, 80).tolist():
        sizes, weights = panels(np.unique(np.clip([0.5 * age, age, 6.0, 10.0, 14.0, 22.2], 0.5 * age, 22.2)), 60)
        exact = np.sum(weights * pulse.area(age, sizes) * law.density(sizes))
        assert age_table(law, pulse)(np.array([age]))[0, 0] == pytest.approx(exact, rel=1e-6, abs=1e-6), age

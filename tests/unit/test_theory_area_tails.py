from math import log

import numpy as np
import pytest

from rubnoise.contact.laws import Fixed, Law, Lognormal, Normal
from rubnoise.contact.pulses import LENS
from rubnoise.theory.distribution import distribution
from rubnoise.theory.inversion import area_tails
from rubnoise.theory.live_area import live_area
from tests.unit.theory_models import model_of

LAWS = [Fixed(value=2.0), Normal(centre=2.0, std=0.4), Lognormal(mean=2.0, std=1.0)]


@pytest.mark.parametrize("law", LAWS, ids=["one size", "normal", "lognormal"])
@pytest.mark.parametrize("count", [0.3, 20.0, 800.0])
@pytest.mark.parametrize("nats", [2.0, 8.0, 15.0])
def test_bounds_hold_and_are_near(law: Law, count: float, nats: float) -> None:
    """Near, that is, but for the lognormal, whose tail is heavier than any exponential."""
    model = model_of(law, law.moment(1), count)
    tails, found = area_tails(live_area(law, LENS), count), distribution(model)
    above = -log(1.0 - float(found.cdf(tails.upper(nats))))
    assert nats < above < nats + (100.0 if isinstance(law, Lognormal) else 6.0)
    assert tails.nats_above(tails.upper(nats)) == pytest.approx(nats, abs=0.05)
    lower = tails.lower(nats)
    if count < nats:
        assert lower == 0.0
    elif lower > 0.0:
        assert nats < -log(float(found.cdf(lower))) < nats + 6.0


def test_furthest_area_is_all_but_out_of_reach() -> None:
    live = live_area(Lognormal(mean=2.0, std=1.0), LENS)
    few, many = area_tails(live, 1.0).furthest, area_tails(live, 1e6).furthest
    assert 0.0 < few < many < live.largest
    assert float(live.cdf(few)) == pytest.approx(1.0, abs=1e-15)


def test_nothing_is_beyond_the_largest_area_of_a_lone_junction() -> None:
    tails = area_tails(live_area(Fixed(value=2.0), LENS), 1e-3)
    assert np.pi < tails.upper(log(1e4)) < 2.0 * np.pi

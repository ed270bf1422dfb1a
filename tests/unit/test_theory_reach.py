from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.laws import Normal
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.lags import covariance_reach
from tests.unit.theory_models import paper_model


def test_sizes_that_are_alike_reach_as_far_as_their_lives() -> None:
    model = paper_model(spread=0.0)
    assert covariance_reach(model, 1e-9) == pytest.approx(2.0 * model.calibrated_diameter, rel=1e-9)


@pytest.mark.parametrize("part", [0.1, 0.01, 1e-9])
def test_less_than_the_part_is_left_beyond_it(part: float) -> None:
    model = replace(paper_model(), sizes=Normal(centre=1.0, std=8.0))
    reach = covariance_reach(model, part)
    level = part * autocovariance(model, 0.0)
    assert np.all(autocovariance(model, np.linspace(reach, 100.0, 50)) < level)
    assert np.any(autocovariance(model, np.linspace(0.5 * reach, reach, 50)) >= level)


def test_a_larger_part_is_reached_sooner() -> None:
    model = replace(paper_model(), sizes=Normal(centre=1.0, std=8.0))
    assert covariance_reach(model, 0.5) < covariance_reach(model, 1e-9)

"""The slope of the friction force against differences of its autocovariance, which knows nothing of slopes."""

from dataclasses import replace

import pytest

from rubnoise.contact.laws import Exponential, Normal
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.correlation import force_autocovariance
from rubnoise.theory.coupling import force_slope_std
from tests.unit.regular_models import regular
from tests.unit.theory_models import model_of, one_size, paper_model

UNEQUAL = Normal(centre=250.0, std=100.0)
WIDE = Normal(centre=5.53, std=2.0)
MODELS = {
    "one size": one_size(),
    "figure 5": paper_model(),
    "wide": model_of(WIDE, 5.53),
    "wide triangles": model_of(WIDE, 5.53, pulse=TRIANGLE),
    "unequal strengths": replace(paper_model(), strengths=UNEQUAL),
    "regular": regular(20.0),
    "regular of many sizes": regular(20.0, 0.5),
    "regular triangles": regular(3.0, pulse=TRIANGLE),
    "regular triangles of many sizes": regular(2.5, 0.8, pulse=TRIANGLE),
    "regular exponential": regular(20.0, sizes=Exponential(mean=5.53)),
    "regular of unequal strengths": replace(regular(20.0, 0.5), strengths=UNEQUAL),
}


def _curvature(model: Model) -> float:
    """Return the limit of 2 (R(0) - R(h))/h^2, whose first correction is of the order of h."""
    step = 4e-3
    found = force_autocovariance(model, model.strengths, [0.0, step, 0.5 * step])
    coarse, fine = 2.0 * (found[0] - found[1]) / step**2, 8.0 * (found[0] - found[2]) / step**2
    return float(2.0 * fine - coarse)


@pytest.mark.parametrize("name", MODELS)
def test_the_variance_of_the_slope_is_the_curvature_of_the_autocovariance(name: str) -> None:
    assert force_slope_std(MODELS[name]) ** 2 == pytest.approx(_curvature(MODELS[name]), rel=5e-4)


def test_where_junctions_are_born_counts() -> None:
    """Regular births bring half-lives together that random ones do not."""
    at_random = force_slope_std(one_size())
    assert abs(force_slope_std(MODELS["regular"]) / at_random - 1.0) > 0.5


def test_regular_triangles_of_an_even_count_are_constant() -> None:
    assert force_slope_std(regular(4.0, pulse=TRIANGLE)) == 0.0
    assert force_slope_std(regular(3.0, pulse=TRIANGLE)) > 100.0


def test_a_strength_is_needed() -> None:
    with pytest.raises(Refused, match="shear strength"):
        force_slope_std(replace(paper_model(), strengths=None))

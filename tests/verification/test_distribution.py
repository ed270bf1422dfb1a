"""How often each real contact area is found in long runs, against its exact distribution.

Ticks further apart than the longest life have no junction in common, so their areas are independent and the bound of
Kolmogorov and Smirnov holds as it stands (an atom only makes it safer). KS_BOUND has the probability of 4 standard
deviations; each control is a law that ought to be found out.
"""

from collections.abc import Callable
from functools import cache
from math import ceil, sqrt
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr, pdtr

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.distribution import distribution
from rubnoise.theory.occupancy import mean_count
from tests.models import bare, recorded
from tests.verification.seeds import seed_of

Doubles = NDArray[np.float64]
Law = Callable[[Doubles], Doubles]

KS_BOUND = 2.28
CASES: dict[str, tuple[int, dict[str, Any]]] = {
    "fig5": (1_000_000, {}),
    "half a junction": (1_000_000, {"count": 0.5, "spread": Spread(), "calibration": "exact"}),
    "hardly a junction": (100_000, {"count": 0.05, "spread": Spread(relative=0.2), "calibration": "exact"}),
    "five, widely spread": (500_000, {"count": 5.0, "spread": Spread(relative=1.5), "calibration": "exact"}),
    "fifty": (1_000_000, {"count": 50.0, "spread": Spread(relative=0.2), "calibration": "exact"}),
    "three triangles": (300_000, {"count": 3.0, "spread": Spread(absolute=0.2), "pulse": TRIANGLE}),
}


def spaced(junctions: int, contact: dict[str, Any]) -> Model:
    """Return a contact run for so many junctions, its ticks further apart than its longest life."""
    sizes = bare(**contact).sizes
    tick = ceil(2.02 * sizes.support[1])
    ticks = ceil(junctions / (bare(**contact).birth_rate * tick))
    return bare(distance=float(tick * ticks), tick=float(tick), **contact)


@cache
def run(name: str) -> tuple[Model, Doubles]:
    """Return a case's model, and its areas at the ticks in order of size."""
    model = spaced(*CASES[name])
    trace = recorded(model, seed_of(f"distribution/{name}"))["trace"]
    return model, np.sort(np.asarray(trace["real_contact_area"]))


def distance(areas: Doubles, law: Law) -> float:
    """Return D sqrt(n) of sorted areas from a law that is continuous but for an atom at 0."""
    at_zero = int(np.searchsorted(areas, 0.0, side="right"))
    heights, steps = law(areas[at_zero:]), np.arange(at_zero, areas.size + 1) / areas.size
    apart = [abs(steps[0] - float(law(np.zeros(1))[0])), np.max(steps[1:] - heights), np.max(heights - steps[:-1])]
    return float(max(apart) * sqrt(areas.size))


@pytest.mark.parametrize("name", CASES)
def test_areas_of_a_long_run_have_the_exact_distribution(name: str) -> None:
    model, areas = run(name)
    law = distribution(model)
    assert areas.size > 7_000
    assert distance(areas, law.cdf) < KS_BOUND


def normal_of(model: Model) -> Law:
    """Return the normal law of the same mean and variance."""
    exact = area_cumulants(model)
    return lambda area: ndtr((area - exact.mean) / exact.std)


def squares_of(model: Model) -> Law:
    """Return the law of pulses that are as long, and have their mean area all the time."""
    count = mean_count(model)
    height = area_cumulants(model).mean / count
    return lambda area: pdtr(np.floor(area / height), count)


def without_atom(model: Model) -> Law:
    """Return the law of the area where there is any."""
    law = distribution(model)
    return lambda area: (law.cdf(area) - law.atom_at_zero) / (1.0 - law.atom_at_zero)


def as_the_paper_has_it(model: Model) -> Law:
    """Return the law scaled to a mean of A_rm, as 0.327 in place of 1/3 would have it."""
    law = distribution(model)
    ratio = area_cumulants(model).mean / model.mean_real_contact_area
    return lambda area: law.cdf(area * ratio)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("fig5", normal_of),
        ("fig5", squares_of),
        ("fig5", as_the_paper_has_it),
        ("half a junction", normal_of),
        ("half a junction", squares_of),
        ("half a junction", without_atom),
        ("hardly a junction", without_atom),
        ("five, widely spread", normal_of),
        ("three triangles", squares_of),
        ("fifty", as_the_paper_has_it),
    ],
)
def test_a_wrong_law_is_found_out(name: str, wrong: Callable[[Model], Law]) -> None:
    model, areas = run(name)
    assert distance(areas, wrong(model)) > 1.5 * KS_BOUND


def test_lenses_are_no_triangles() -> None:
    """Of the same mean and count, a run of lenses is told from triangles, which vary less."""
    model, areas = run("half a junction")
    triangles = spaced(1000, {"count": 0.5, "spread": Spread(), "pulse": TRIANGLE})
    law = distribution(triangles)
    assert area_cumulants(triangles).mean == pytest.approx(area_cumulants(model).mean, rel=1e-12)
    assert distance(areas, law.cdf) > 1.5 * KS_BOUND

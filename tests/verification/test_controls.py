"""Records that are wrong in one way each are rejected at five standard errors, by the figures that a comparison has.

A comparison is only worth something if it says no. Every record here is made outside of the simulation, and the one
with nothing changed is accepted.
"""

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.analysis.comparing.findings import Comparison
from rubnoise.analysis.comparison import compare
from rubnoise.contact.laws import Spread
from rubnoise.contact.overlap import junction_area
from rubnoise.model import Model
from tests.models import bare
from tests.verification.fabricated import Made, made
from tests.verification.scores import REJECTED
from tests.verification.seeds import seed_of

Doubles = NDArray[np.float64]

ONE_SIZE = Spread(absolute=0.0)
ORDINARY = bare(spread=ONE_SIZE, calibration="exact", distance=60_000.0, tick=0.5)
LONG = bare(spread=ONE_SIZE, calibration="exact", distance=450_000.0, tick=1.25)
"""Long enough that one per cent of the births is nine standard errors."""


SPARSE = bare(count=0.1, spread=ONE_SIZE, calibration="exact", distance=4_000_000.0, tick=10.0)
"""Nine tenths of the ticks are without contact."""


def square(age: Doubles, diameter: Doubles) -> Doubles:
    """Return the mean area of a life, as long as it lasts."""
    return np.broadcast_to(np.square(diameter) / 3.0, age.shape)


def smooth(age: Doubles, diameter: Doubles) -> Doubles:
    """Return (pi/4) d^2 sin^3(pi s / 2d): the life, peak and mean of the lens, and no kink at mid-life."""
    return 0.25 * np.pi * np.square(diameter) * np.sin(0.5 * np.pi * age / diameter) ** 3


def of_0327(age: Doubles, diameter: Doubles) -> Doubles:
    """Return the lens scaled to the paper's life mean of 0.327 d^2."""
    return 3.0 * 0.327 * junction_area(age, diameter)


def hasty(age: Doubles, diameter: Doubles) -> Doubles:
    """Return the lens run through in 1.98 d."""
    return junction_area(age * (2.0 / 1.98), diameter)


@cache
def compared(name: str, run: Model, how: Made | None = None) -> Comparison:
    return compare(run, made(run, seed_of(f"controls/{name}"), how))


def score(found: Comparison, name: str) -> float:
    figure = next(figure for figure in found.figures if figure.name == name)
    assert figure.z is not None
    return figure.z


def broken(found: Comparison) -> set[str]:
    return {identity.name for identity in found.identities if not identity.holds}


@pytest.mark.parametrize("run", [ORDINARY, LONG, SPARSE], ids=["ordinary", "long", "sparse"])
def test_a_right_record_is_accepted(run: Model) -> None:
    found = compared("right", run)
    assert found.outside == ()
    assert len(found.figures) > 20
    assert max(abs(figure.z or 0.0) for figure in found.figures) <= found.bound


def test_the_smooth_pulse_is_what_it_says() -> None:
    age = np.linspace(0.0, 2.0, 200_001)
    assert smooth(age, np.ones(1)).mean() == pytest.approx(1.0 / 3.0, rel=1e-5)
    assert smooth(age, np.ones(1)).max() == pytest.approx(0.25 * np.pi)


def test_a_life_mean_of_0327_is_rejected() -> None:
    found = compared("0.327", LONG, Made(area=of_0327))
    assert score(found, "life_mean_area") < -1000.0
    assert score(found, "real_contact_area_mean") < -REJECTED
    assert "area_from_rows" in broken(found)


def test_one_per_cent_more_births_are_rejected() -> None:
    found = compared("births", LONG, Made(births=1.01))
    assert score(found, "birth_count") > REJECTED
    assert score(found, "junction_count_mean") > REJECTED


def test_deaths_at_198_diameters_are_rejected() -> None:
    """Of rows that tell the truth and of rows that do not."""
    honest = compared("1.98", LONG, Made(area=hasty, lives=1.98, told=1.98))
    assert broken(honest) >= {"life"}
    assert score(honest, "junction_count_mean") < -REJECTED
    covered = compared("1.98", LONG, Made(area=hasty, lives=1.98))
    assert score(covered, "life_over_diameter") < -100.0
    assert "count_from_rows" in broken(covered)


def test_a_square_pulse_of_the_same_mean_is_rejected() -> None:
    found = compared("square", ORDINARY, Made(area=square))
    bands = [score(found, figure.name) for figure in found.figures if figure.name.startswith("spectrum")]
    assert score(found, "real_contact_area_std") < -REJECTED
    assert bands[-1] > 100.0
    assert score(found, "real_contact_area_kolmogorov") > REJECTED


def test_a_missing_kink_is_rejected_by_high_wavenumbers() -> None:
    """Peak, mean and life are right, and so are count and births: the spectrum knows."""
    found = compared("kink", ORDINARY, Made(area=smooth))
    bands = [score(found, figure.name) for figure in found.figures if figure.name.startswith("spectrum")]
    assert bands[-2] < -REJECTED
    assert abs(score(found, "life_over_diameter")) <= found.bound
    assert abs(score(found, "real_contact_area_mean")) <= found.bound


def test_an_empty_start_is_not_taken_for_a_stationary_one() -> None:
    found = compared("empty", ORDINARY, Made(empty=True))
    assert score(found, "start_count") < -REJECTED


def test_a_count_that_never_changes_is_rejected() -> None:
    found = compared("fixed", ORDINARY, Made(always=20))
    assert score(found, "junction_count_variance") < -REJECTED
    assert score(found, "birth_place_kolmogorov") < -2.0


def test_sparse_contact_of_another_pulse_is_rejected_by_the_areas_in_contact() -> None:
    """As many ticks are without contact, and the mean is right."""
    found = compared("sparse/square", SPARSE, Made(area=square))
    assert score(found, "real_contact_area_kolmogorov") > REJECTED
    assert abs(score(found, "junction_count_zero_share")) <= found.bound
    assert abs(score(found, "real_contact_area_mean")) <= found.bound


def test_sparse_contact_of_another_rate_is_rejected_by_the_share_without_it() -> None:
    """Where few junctions meet, one area says next to nothing of how often there is one."""
    found = compared("sparse/births", SPARSE, Made(births=1.2))
    assert score(found, "junction_count_zero_share") < -REJECTED
    assert score(found, "birth_count") > REJECTED
    assert abs(score(found, "real_contact_area_kolmogorov")) <= found.bound


def test_sparse_contact_of_twins_is_rejected_by_the_share_without_it() -> None:
    """Births two by two: as many junctions, as many births, as large a mean, and half as often contact."""
    found = compared("sparse/twins", SPARSE, Made(together=2))
    assert score(found, "junction_count_zero_share") > REJECTED
    assert score(found, "real_contact_area_kolmogorov") > REJECTED
    assert abs(score(found, "real_contact_area_mean")) <= REJECTED


def test_sparse_contact_of_another_size_law_is_rejected_by_the_areas_in_contact() -> None:
    """Junctions of one size, said to spread by a third: the areas alone know, without a look at a diameter."""
    spread = Spread(relative=1.0 / 3.0)
    said = bare(count=0.1, spread=spread, calibration="exact", distance=SPARSE.distance, tick=10.0)
    assert said.mean_birth_spacing == SPARSE.mean_birth_spacing
    found = compare(said, made(SPARSE, seed_of("controls/sparse/sizes")))
    assert score(found, "real_contact_area_kolmogorov") > REJECTED
    assert abs(score(found, "birth_count")) <= found.bound


def test_sparse_contact_that_is_cut_off_early_is_rejected_by_the_share_without_it() -> None:
    found = compared("sparse/1.7", SPARSE, Made(area=lambda s, d: junction_area(s / 0.85, d), lives=1.7, told=1.7))
    assert score(found, "junction_count_zero_share") > REJECTED
    assert abs(score(found, "birth_count")) <= found.bound

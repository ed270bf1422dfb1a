"""Right runs are called outside as rarely as is promised, wrong ones always; areas against their distribution."""

import sys
from collections.abc import Callable
from functools import cache
from math import ceil, sqrt
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr, pdtr

from rubnoise.analysis.comparison import compare
from rubnoise.analysis.findings import Comparison
from rubnoise.contact.laws import Spread
from rubnoise.contact.overlap import junction_area
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.theory.moments import area_cumulants, distribution
from tests.models import bare, recorded
from tests.verification.scores import REJECTED, Made, made, seed_of
from tools import right_runs

# Records that are wrong in one way each are rejected at five standard errors, by the figures that a comparison has.
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


def test_a_life_mean_of_0327_is_rejected() -> None:
    found = compared("0.327", LONG, Made(area=of_0327))
    assert score(found, "real_contact_area_mean") < -REJECTED
    assert "area_from_rows" in broken(found)


def test_one_per_cent_more_births_are_rejected() -> None:
    found = compared("births", LONG, Made(births=1.01))
    assert score(found, "birth_count") > REJECTED
    assert score(found, "junction_count_mean") > REJECTED


@pytest.mark.slow
def test_deaths_at_198_diameters_are_rejected() -> None:
    """Of rows that tell the truth and of rows that do not."""
    honest = compared("1.98", LONG, Made(area=hasty, lives=1.98, told=1.98))
    assert score(honest, "junction_count_mean") < -REJECTED
    covered = compared("1.98", LONG, Made(area=hasty, lives=1.98))
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


def test_sparse_contact_of_twins_is_rejected_by_the_share_without_it() -> None:
    """Births two by two: as many junctions, as many births, as large a mean, and half as often contact."""
    found = compared("sparse/twins", SPARSE, Made(together=2))
    assert score(found, "junction_count_zero_share") > REJECTED
    assert score(found, "real_contact_area_kolmogorov") > REJECTED
    assert abs(score(found, "real_contact_area_mean")) <= REJECTED


@pytest.mark.slow
def test_sparse_contact_of_another_size_law_is_rejected_by_the_areas_in_contact() -> None:
    """Junctions of one size, said to spread by a third: the areas alone know, without a look at a diameter."""
    spread = Spread(relative=1.0 / 3.0)
    said = bare(count=0.1, spread=spread, calibration="exact", distance=SPARSE.distance, tick=10.0)
    assert said.mean_birth_spacing == SPARSE.mean_birth_spacing
    found = compare(said, made(SPARSE, seed_of("controls/sparse/sizes")))
    assert score(found, "real_contact_area_kolmogorov") > REJECTED
    assert abs(score(found, "birth_count")) <= found.bound


# Right runs are called outside as rarely as is promised; `python tools/right_runs.py` makes some thousands of them.
FEW_AT_ONCE = right_runs.KINDS["sparse"]


def test_a_wrong_run_is_an_alarm(monkeypatch: pytest.MonkeyPatch) -> None:
    spoil(monkeypatch, lambda model: right_runs.model_of([*FEW_AT_ONCE["1 over 100 mm"], OTHER]))
    count = right_runs.counted(FEW_AT_ONCE["1 over 100 mm"], [1, 2])
    assert set(count.alarms) == {1, 2}
    assert "birth_count" in count.alarms[1]
    assert count.far["birth_count"] == 2


OTHER = "interface.mean_junction_count=1.2"


def spoil(monkeypatch: pytest.MonkeyPatch, wrong: Callable[[Model], Model]) -> None:
    from rubnoise.analysis import comparison

    def compare(model: Model, rows: object) -> Comparison:
        return comparison.compare(wrong(model), rows)  # type: ignore[arg-type]

    monkeypatch.setattr(right_runs, "compare", compare)


def test_what_is_promised_is_a_thousandth() -> None:
    assert right_runs.chance_of(0, 2000) == 1.0
    assert right_runs.chance_of(1, 1) == pytest.approx(1e-3)
    assert right_runs.chance_of(2, 2000) == pytest.approx(0.594, abs=1e-3)
    assert right_runs.chance_of(8, 2000) > right_runs.CHANCE > right_runs.chance_of(9, 2000)


@pytest.mark.parametrize(("wrong", "code"), [(False, 0), (True, 1)])
def test_too_many_alarms_are_an_exit_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *, wrong: bool, code: int
) -> None:
    short = FEW_AT_ONCE["1 over 100 mm"]
    monkeypatch.setattr(right_runs, "KINDS", {"sparse": {"one": short}, "dense": {"other": ()}})
    monkeypatch.setattr(sys, "argv", ["right_runs.py", "--runs", "2", "--kind", "sparse"])
    if wrong:
        spoil(monkeypatch, lambda model: right_runs.model_of([*short, OTHER]))
    assert right_runs.main() == code
    told = capsys.readouterr().out
    assert f"{2 * wrong} alarms in 2 right runs" in told
    assert "other" not in told


# How often each real contact area is found in long runs, against its exact distribution.
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


@pytest.mark.slow
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
    count = model.mean_live_junctions
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_lenses_are_no_triangles() -> None:
    """Of the same mean and count, a run of lenses is told from triangles, which vary less."""
    model, areas = run("half a junction")
    triangles = spaced(1000, {"count": 0.5, "spread": Spread(), "pulse": TRIANGLE})
    law = distribution(triangles)
    assert area_cumulants(triangles).mean == pytest.approx(area_cumulants(model).mean, rel=1e-12)
    assert distance(areas, law.cdf) > 1.5 * KS_BOUND

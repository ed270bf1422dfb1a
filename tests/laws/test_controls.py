"""Right runs are called outside as rarely as is promised, wrong ones always."""

import sys
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.analysis.comparison import compare
from rubnoise.analysis.findings import Comparison
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS
from rubnoise.model import Model
from tests.laws.scores import REJECTED, Made, made, seed_of
from tests.models import bare
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
    return 3.0 * 0.327 * LENS.area(age, diameter)


def hasty(age: Doubles, diameter: Doubles) -> Doubles:
    """Return the lens run through in 1.98 d."""
    return LENS.area(age * (2.0 / 1.98), diameter)


@cache
def compared(name: str, run: Model, how: Made | None = None) -> Comparison:
    return compare(run, made(run, seed_of(f"controls/{name}"), how))


def score(found: Comparison, name: str) -> float:
    figure = next(figure for figure in found.figures if figure.name == name)
    assert figure.z is not None
    return figure.z


def broken(found: Comparison) -> set[str]:
    return {identity.name for identity in found.identities if identity.fails}


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


RIGHT = [(kind, name) for kind, cases in right_runs.KINDS.items() for name in cases if "exponential" not in name]
"""Exponential sizes have to run for long."""


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "name"), RIGHT[::2])
def test_a_right_run_of_every_kind_is_accepted(kind: str, name: str) -> None:
    """Births, sizes, ages at the start, areas, spectra and motion of the engine, each against its law."""
    count = right_runs.counted(right_runs.KINDS[kind][name], [seed_of(f"right/{name}")])
    assert count.alarms == {}
    assert count.scores >= 5


def test_a_wrong_run_is_an_alarm(monkeypatch: pytest.MonkeyPatch) -> None:
    spoil(monkeypatch, lambda model: right_runs.model_of([*FEW_AT_ONCE["1 over 100 mm"], OTHER]))
    count = right_runs.counted(FEW_AT_ONCE["1 over 100 mm"], [1, 2])
    assert set(count.alarms) == {1, 2}
    assert "birth_count" in count.alarms[1]
    assert count.far >= 2


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

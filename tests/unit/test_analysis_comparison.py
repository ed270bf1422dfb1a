"""A run beside its theory: what is compared of which run, what is left out and why; right runs are accepted."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.analysis import comparison, measured, moments
from rubnoise.analysis.comparison import compare
from rubnoise.analysis.findings import Comparison
from rubnoise.contact.births import RegularBirths
from rubnoise.contact.distributions import Lognormal
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.moments import Cumulants
from tests.laws.scores import Held, seed_of
from tests.models import bare, model, recorded

QUICK = Slider(mass=0.005, stiffness=300.0, damping=0.5)
RIGHT = {
    "figure 5": model(distance=20_000.0, tick=0.2),
    "empty": model(start="empty", slider=None, distance=3000.0, tick=0.2),
    "wide": bare(spread=Spread(relative=1.0), distance=6000.0, tick=0.2),
    "few": bare(count=0.5, distance=160_000.0, tick=4.0),
    "triangle": replace(bare(distance=6000.0, tick=0.2), pulse=TRIANGLE),
    "one size": bare(spread=Spread(absolute=0.0), distance=4000.0, tick=0.2),
    "unequal strengths": replace(
        model(slider=None, distance=20_000.0, tick=0.2), strengths=Lognormal(mean=250.0, std=100.0)
    ),
    "at rest": model(distance=10_000.0, tick=0.5, slider=replace(QUICK, start="rest"), speed=100.0),
    "regular": bare(distance=3000.0, tick=0.2, births="regular"),
}


@cache
def run(name: str) -> Held:
    return recorded(RIGHT[name], seed_of(f"comparison/{name}"))


@cache
def compared(name: str) -> Comparison:
    return compare(RIGHT[name], run(name))


def names(found: Comparison) -> set[str]:
    return {figure.name.rstrip("0123456789.") for figure in found.figures}


def reason(found: Comparison, name: str) -> str:
    return found.left_out[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", RIGHT)
def test_right_runs_are_accepted(name: str) -> None:
    found = compared(name)
    assert found.outside == ()
    assert all(figure.z is not None for figure in found.figures)
    assert found.bound == pytest.approx(3.9, abs=0.4)


def test_an_ordinary_run_is_held_against_everything() -> None:
    found = compared("figure 5")
    assert list(dict.fromkeys(row.part for row in found.figures)) == ["births", "junctions", "contact", "slider"]
    assert names(found) >= {
        "birth_count",
        "birth_gap_variation",
        "birth_gap_kolmogorov",
        "birth_place_kolmogorov",
        "start_count",
        "diameter_mean",
        "diameter_std",
        "diameter_kolmogorov",
        "real_contact_area_mean",
        "real_contact_area_std",
        "real_contact_area_skewness",
        "real_contact_area_excess_kurtosis",
        "real_contact_area_kolmogorov",
        "junction_count_mean",
        "junction_count_variance",
        "real_contact_area_autocovariance_",
        "displacement_mean",
    }
    assert sum(figure.name.startswith("spectrum") for figure in found.figures) >= 7
    held_to = {identity.name for identity in found.identities}
    assert held_to == {
        "shear_strength", "area_from_rows", "count_from_rows", "friction_force",
    }  # fmt: skip


def test_an_empty_start_is_compared_from_where_it_is_forgotten() -> None:
    found = compared("empty")
    assert not any(figure.name.startswith("start") for figure in found.figures)
    assert {"real_contact_area_mean", "birth_count"} <= names(found)
    settled = moments.forgetting(RIGHT["empty"])["trace"]
    assert measured.measured_run(RIGHT["empty"], run("empty")).ticks() == RIGHT["empty"].tick_count + 1 - settled
    # The first life taken in, the run would not pass as stationary.
    taken = compare(replace(RIGHT["empty"], start="stationary"), run("empty"))
    assert "start_count" in taken.outside


def test_regular_births_are_told_from_random_ones() -> None:
    found = compared("regular")
    assert {"birth_gap", "birth_count", "area_from_rows", "count_from_rows"} <= {each.name for each in found.identities}
    assert {"diameter_mean", "diameter_std", "diameter_kolmogorov"} <= names(found)
    assert "known for Poisson births alone" in reason(found, "spectrum")
    random = replace(RIGHT["regular"], births=bare().births)
    assert {"birth_gap_kolmogorov", "birth_place_kolmogorov"} <= set(compare(random, run("regular")).outside)


def test_an_area_that_regular_births_keep_constant_is_an_identity(monkeypatch: pytest.MonkeyPatch) -> None:
    """Triangles of one size at an even mean count: Rabinowicz's contact."""
    contact = bare(spread=Spread(absolute=0.0), distance=1000.0, tick=0.13)
    constant = replace(contact, births=RegularBirths(mean_spacing=contact.mean_birth_spacing), pulse=TRIANGLE)
    mean = constant.stationary_mean_area
    monkeypatch.setattr(comparison, "area_cumulants", lambda model: Cumulants(values=(mean, *(0.0,) * 5)))
    record = recorded(constant, seed_of("comparison/constant"))
    found = {identity.name: identity for identity in compare(constant, record).identities}
    assert not found["real_contact_area"].fails
    assert {figure.name for figure in compare(constant, record).figures} == {"junction_count_mean"}
    ripple = replace(constant, pulse=bare().pulse)
    assert "real_contact_area" in compare(ripple, recorded(ripple, 1)).outside


def test_what_is_too_short_for_a_figure_says_how_long_it_should_be() -> None:
    found = compare(bare(distance=700.0, tick=0.2), recorded(bare(distance=700.0, tick=0.2), 1))
    assert "it needs about 1.76e+04 um" in reason(found, "real_contact_area_excess_kurtosis")
    assert "real_contact_area_mean" in names(found)
    slider = compare(model(distance=1000.0), recorded(model(distance=1000.0), 1))
    assert reason(slider, "displacement").startswith("the run is too short; it needs about 3.")


@pytest.mark.parametrize(
    ("short", "needed"), [(bare(distance=300.0), 553.0), (bare(distance=560.0, start="empty"), 567.5)]
)
def test_a_run_too_short_for_its_mean_is_refused(short: Model, needed: float) -> None:
    with pytest.raises(Refused, match=rf"a comparison with the theory: .* too short .* about {needed:.3g} um"):
        compare(short, recorded(short, 1))


def test_an_undamped_slider_is_left_out() -> None:
    undamped = model(distance=1000.0, slider=replace(QUICK, damping=0.0))
    found = compare(undamped, recorded(undamped, 1))
    assert reason(found, "displacement") == "a slider without damping never forgets its start"


def changed(groups: Any, group: str, name: str, change: Any) -> Held:
    columns: dict[str, NDArray[Any]] = dict(groups[group])
    columns[name] = columns[name].copy()
    change(columns[name])
    return Held(dict(groups) | {group: columns})


@pytest.mark.parametrize(
    ("group", "name", "identity"),
    [
        ("junctions", "shear_strength", "shear_strength"),
        ("trace", "friction_force", "friction_force"),
    ],
)
def test_a_single_wrong_row_breaks_an_identity(group: str, name: str, identity: str) -> None:
    def change(values: NDArray[Any]) -> None:
        values[100] *= 1.0 + 1e-9

    found = compare(RIGHT["figure 5"], changed(run("figure 5").groups, group, name, change))
    assert identity in found.outside


def test_a_wrong_sum_at_a_sampled_tick_breaks_an_identity() -> None:
    apart = measured.MeasuredRun(RIGHT["figure 5"]).apart

    def change(values: NDArray[Any]) -> None:
        values[3 * apart] += 1

    for name, identity in (("real_contact_area", "area_from_rows"), ("junction_count", "count_from_rows")):
        found = compare(RIGHT["figure 5"], changed(run("figure 5").groups, "trace", name, change))
        assert identity in found.outside


@pytest.mark.slow
def test_right_runs_of_sparse_contact_are_accepted() -> None:
    """Most ticks are without contact: the distribution has an atom, whose share is not judged by a distance."""
    sparse = bare(count=0.05, distance=6_000_000.0, tick=10.0)
    for seed in range(seed_of("comparison/sparse"), seed_of("comparison/sparse") + 4):
        found = compare(sparse, recorded(sparse, seed, engine="batch"))
        assert found.outside == ()
        shares = {figure.name: figure for figure in found.figures}
        assert shares["junction_count_zero_share"].exact == pytest.approx(np.exp(-0.05), rel=1e-4)
        assert abs(shares["real_contact_area_kolmogorov"].z or 0.0) <= 4.0


@pytest.mark.slow
def test_a_share_without_contact_that_a_run_is_too_short_for_is_left_out() -> None:
    rare = bare(count=4.0, distance=8000.0, tick=0.5)
    found = compare(rare, recorded(rare, seed_of("comparison/rare")))
    needed = float(reason(found, "junction_count_zero_share").split("about ")[1].removesuffix(" um"))
    longer = bare(count=4.0, distance=1.05 * needed, tick=1.0)
    assert "junction_count_zero_share" in names(compare(longer, recorded(longer, engine="batch")))
    assert "real_contact_area_kolmogorov" in names(found)
    # Of a denser contact nothing is said: the share is below a thousandth.
    assert "junction_count_zero_share" not in compared("figure 5").left_out


@pytest.mark.slow
def test_scores_of_many_right_runs_are_unit_normals() -> None:
    short = bare(distance=1500.0, tick=0.2)
    seeds = range(seed_of("comparison/many"), seed_of("comparison/many") + 50)
    scores: dict[str, list[float]] = {}
    for seed in seeds:
        for figure in compare(short, recorded(short, seed)).figures:
            scores.setdefault(figure.name, []).append(figure.z or 0.0)
    whole = {name: np.array(z) for name, z in scores.items() if not name.startswith(("start", "real_contact_area_kol"))}
    assert len(whole) > 15
    assert {name: z.mean() for name, z in whole.items() if abs(z.mean()) > 4.0 / 50**0.5} == {}
    # Spreads of 50 scores are known to a tenth.
    assert {name: z.std() for name, z in whole.items() if not 0.6 <= z.std() <= 1.4} == {}

"""Sums that their largest junctions rule: how skewed they are, and right runs that hold such a junction."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.comparing.findings import (
    LARGEST_TAIL_SKEWNESS,
    NORMAL,
    LeftOut,
    Tail,
    judged_mean,
    tail_of,
    tail_of_squares,
)
from rubnoise.analysis.comparison import compare
from rubnoise.contact.laws import Exponential, Fixed, Gamma, Lognormal
from rubnoise.model import Model
from rubnoise.theory.sampling import mean_area_error
from tests.models import bare, recorded
from tests.unit.theory_models import model_of
from tests.verification.fabricated import held
from tests.verification.seeds import seed_of

LENGTH = 5000.0


def births(model: Model) -> float:
    return model.birth_rate * LENGTH


def test_equal_junctions_are_as_skewed_as_their_number() -> None:
    model = model_of(Fixed(value=5.0), 5.0)
    for power in (1, 5, 9):
        found = tail_of(model, LENGTH, power)
        assert (found.skewness, found.needed) == (pytest.approx(births(model) ** -0.5), 0.0)
    few = tail_of(model, 1.0, 3)
    assert few.skewness > LARGEST_TAIL_SKEWNESS
    assert few.needed == pytest.approx(8.0 / 2.0, rel=0.3), "eight births, two a um"


def test_exponential_sizes_have_the_skewness_of_their_moments() -> None:
    """E[d^n] = n!; what is too rare for the record to hold is 1e-5 of a junction, and takes little from the third."""
    model = model_of(Exponential(mean=5.0), 5.0)
    assert tail_of(model, LENGTH, 1).skewness == pytest.approx(6.0 / 2.0**1.5 / births(model) ** 0.5, rel=0.01)


def test_strengths_multiply_what_sizes_bring() -> None:
    plain = model_of(Fixed(value=5.0), 5.0)
    unequal = replace(plain, strengths=Lognormal(mean=250.0, std=100.0))
    factor = 1.16 ** (3 - 1.5)  # E[psi^3] / E[psi^2]^1.5
    assert tail_of(unequal, LENGTH, 3, 1).skewness == pytest.approx(factor * births(plain) ** -0.5, rel=0.01)
    assert tail_of(unequal, LENGTH, 3).skewness == pytest.approx(births(plain) ** -0.5)


def test_sums_that_are_drawn_are_as_skewed() -> None:
    law = Gamma(mean=1.0, std=0.4)
    generator = np.random.default_rng(seed_of("tails/gamma"))
    numbers = generator.poisson(200.0, 10_000)
    cubes = law.draw(generator.random(int(numbers.sum()))) ** 3
    sums = np.add.reduceat(cubes, np.concatenate([[0], np.cumsum(numbers)[:-1]]))
    z = (sums - sums.mean()) / sums.std()
    seen, error = float(np.mean(z**3)), float(np.std(z**3) / z.size**0.5)
    tail = tail_of(model_of(law, 1.0, mean_count=2.0), 200.0, 3)
    assert abs(seen - tail.skewness) <= 4.0 * error
    assert abs(seen - NORMAL.skewness) > 5.0 * error


def test_squares_of_a_wide_law_need_more_draws_than_those_of_a_narrow_one() -> None:
    wide = tail_of_squares(Lognormal(mean=5.0, std=5.0), 5.0, 1000.0, 500.0)
    narrow = tail_of_squares(Lognormal(mean=5.0, std=0.5), 5.0, 1000.0, 500.0)
    assert narrow.needed == 0.0
    assert wide.needed > 500.0
    assert wide.skewness > narrow.skewness


def test_a_tail_that_is_too_heavy_leaves_a_mean_without_a_score() -> None:
    found = judged_mean("x", 9.0, 1.0, 1.0, length=10.0, tail=Tail(skewness=2.0, needed=300.0))
    assert found == LeftOut(name="x", reason="the run is too short; it needs about 300 um")


def test_a_skewed_mean_is_scored_on_its_own_scale() -> None:
    high, low = (
        judged_mean("x", value, 0.0, 1.0, length=10.0, tail=Tail(skewness=0.3, needed=0.0)) for value in (5.0, -5.0)
    )
    assert isinstance(high, Agreement)
    assert isinstance(low, Agreement)
    assert high.z == pytest.approx(10.0 * np.log1p(0.5))
    assert low.z == -5.0


def test_a_right_run_that_holds_one_huge_junction_is_accepted() -> None:
    """Of some hundred such runs one has a mean that a normal law would call impossible."""
    run = replace(bare(distance=LENGTH, tick=2.0), sizes=Lognormal(mean=5.4772, std=3.834))
    record = recorded(run, 1010)
    found = compare(run, held(record))
    assert found.outside == []
    assert "real_contact_area_mean" in {each.name for each in found.left_out}
    mean = float(record["trace"]["real_contact_area"].mean())
    assert mean - run.stationary_mean_area > 8.0 * mean_area_error(run)

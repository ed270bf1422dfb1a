"""How verdicts follow from numbers."""

from dataclasses import replace
from math import inf, log, nan

import numpy as np
import pytest

from rubnoise.analysis.replicates import Estimate, difference, estimate, ratio
from rubnoise.claims.claim import Quantity, Verdict, verdict_if_agreed
from rubnoise.claims.field import FieldClaim, FieldVerdict, Known, Source, exponent, exponent_of
from rubnoise.claims.field_page import agreement, as_range


# How a verdict follows from numbers.
def test_an_estimate_is_the_mean_of_the_runs_with_student_s_interval() -> None:
    found = estimate([1.0, 2.0, 3.0, 6.0])
    assert found.value == 3.0
    assert found.standard_error == pytest.approx(np.std([1, 2, 3, 6], ddof=1) / 2.0)
    assert found.interval[1] - 3.0 == pytest.approx(3.182446 * found.standard_error, rel=1e-6)


def test_one_run_has_no_interval_and_agrees_with_anything() -> None:
    found = estimate([1.0])
    assert found.interval == (-inf, inf)
    assert found.agrees_with(2.0)


def test_agreement_is_as_strict_as_four_standard_deviations_of_a_normal_number() -> None:
    many = Estimate(value=0.0, standard_error=1.0, runs=100_000)
    assert many.agrees_with(3.99)
    assert not many.agrees_with(4.01)
    few = Estimate(value=0.0, standard_error=1.0, runs=4)
    assert few.agrees_with(4.5), "few runs know their own error badly"


def test_rounding_is_forgiven_where_runs_do_not_scatter() -> None:
    still = estimate([1e-15, 1e-15])
    assert still.agrees_with(0.0, rounding=1e-12)
    assert not still.agrees_with(0.0)


def test_errors_of_differences_and_ratios_add_up() -> None:
    one, other = Estimate(value=8.0, standard_error=0.3, runs=5), Estimate(value=2.0, standard_error=0.4, runs=7)
    assert difference(one, other) == Estimate(value=6.0, standard_error=0.5, runs=5)
    found = ratio(one, other)
    assert (found.value, found.runs) == (4.0, 5)
    assert found.standard_error == pytest.approx(4.0 * np.hypot(0.3 / 8.0, 0.4 / 2.0))


@pytest.mark.parametrize(("exact", "verdict"), [(1.0, Verdict.HOLDS), (2.0, Verdict.UNSETTLED)])
def test_a_verdict_needs_simulation_and_theory_to_agree(exact: float, verdict: Verdict) -> None:
    simulated = Estimate(value=1.0, standard_error=0.01, runs=50)
    quantity = Quantity(name="mean", unit="um", printed=1.0, simulated=simulated, exact=exact)
    assert verdict_if_agreed(quantities=(quantity,), verdict=Verdict.HOLDS) is verdict


# How a verdict on a published statement follows from numbers and from how well the statement is known.
NEAR_2 = Quantity(
    name="exponent", unit="", printed=None, simulated=Estimate(value=2.1, standard_error=0.1, runs=8), exact=2.0
)


def claim(known: Known = Known.ORIGINAL, **changes: object) -> FieldClaim:
    row = FieldClaim(
        id="row",
        source=Source(name="Someone 1956", doi=None, known=known),
        statement="It is 2.",
        conditions="dry",
        because="It is.",
        quantity=NEAR_2,
        published=(1.9, 2.2),
    )
    return replace(row, **changes)


def test_an_original_that_was_read_is_reproduced_or_contradicted_by_both_numbers() -> None:
    assert claim().verdict is FieldVerdict.REPRODUCES
    assert claim(published=(2.05, 2.2)).verdict is FieldVerdict.CONTRADICTS, "the exact number is outside"
    scattered = replace(NEAR_2, simulated=Estimate(value=9.0, standard_error=0.1, runs=8))
    assert claim(quantity=scattered).verdict is FieldVerdict.CONTRADICTS, "the runs are outside"
    without_theory = replace(NEAR_2, exact=nan)
    assert claim(quantity=without_theory).verdict is FieldVerdict.REPRODUCES
    assert claim(published=(-inf, 0.0)).verdict is FieldVerdict.CONTRADICTS


@pytest.mark.parametrize("known", [Known.ABSTRACT, Known.SECOND_HAND, Known.MEMORY])
@pytest.mark.parametrize("published", [(1.9, 2.2), (5.0, 6.0)])
def test_what_was_not_read_has_no_verdict_and_says_what_is_missing(
    known: Known, published: tuple[float, float]
) -> None:
    row = claim(known, published=published)
    assert row.verdict is FieldVerdict.NOT_YET
    assert row.missing is not None
    assert "a look at the original" in row.missing
    assert agreement(row) == ("agree" if published[0] < 2.0 else "disagree")


def test_what_the_model_lacks_is_out_of_scope_once_an_abstract_shows_it() -> None:
    assert claim(Known.ABSTRACT, lacks="impacts", quantity=None).verdict is FieldVerdict.OUT_OF_SCOPE
    assert claim(Known.MEMORY, lacks="impacts", quantity=None).verdict is FieldVerdict.NOT_YET


def test_without_a_published_number_there_is_nothing_to_compare() -> None:
    row = claim(published=None)
    assert (row.numbers_agree, row.verdict) == (None, FieldVerdict.NOT_YET)
    assert row.missing == "a published number to compare with"
    assert (agreement(row), as_range(None)) == ("", "")


def test_numbers_that_agree_by_assumption_carry_no_verdict() -> None:
    row = claim(cannot_fail=True)
    assert (row.numbers_agree, row.verdict, agreement(row)) == (None, FieldVerdict.NOT_YET, "no test")
    assert row.missing == "a number that could disagree"


def test_an_exponent_has_the_error_of_both_its_points() -> None:
    near = Estimate(value=3.0, standard_error=0.3, runs=8)
    far = Estimate(value=12.0, standard_error=0.6, runs=4)
    found = exponent(near, far, 4.0)
    assert (found.value, found.runs) == (pytest.approx(1.0), 4)
    assert found.standard_error == pytest.approx((0.1**2 + 0.05**2) ** 0.5 / log(4.0))
    half = exponent_of("half", (near, 3.0), (far, 48.0), 4.0, times=0.5)
    assert (half.exact, half.simulated.value) == (pytest.approx(1.0), pytest.approx(0.5))
    assert exponent(far, near, 0.25).standard_error > 0.0


def test_ranges_are_written_as_they_are() -> None:
    written = [as_range(each) for each in ((1.0, 2.0), (-inf, 0.0), (0.0, inf), (1.5, 1.5))]
    assert written == ["1 to 2", "below 0", "above 0", "1.5"]

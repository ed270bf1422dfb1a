"""How a verdict on a published statement follows from numbers and from how well the statement is known."""

from dataclasses import replace
from math import inf, log, nan

import pytest

from rubnoise.claims.claim import Estimate, Quantity
from rubnoise.claims.exponents import exponent, exponent_of
from rubnoise.claims.field import FieldClaim, FieldVerdict, Known, Source
from rubnoise.claims.field_page import agreement, as_range

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

"""Measured beside exact: scores, and the way into a file and back."""

import pytest

from rubnoise.analysis.agreement import (
    Agreement,
    as_json,
    family_wise_bound,
    from_attributes,
    normal_deviate,
    outside,
)

FULL = Agreement(name="real_contact_area_mean", observed=206.0, expected=204.0, standard_error=0.5)
UNSURE = Agreement(name="real_contact_area_std", observed=57.0, expected=56.5, standard_error=None)
ALONE = Agreement(name="events", observed=73084.0, expected=None, standard_error=None)


def test_a_score_counts_standard_errors() -> None:
    assert FULL.z == 4.0


@pytest.mark.parametrize("figure", [UNSURE, ALONE, Agreement(name="x", observed=1.0, expected=1.5, standard_error=0.0)])
def test_there_is_no_score_without_a_standard_error(figure: Agreement) -> None:
    assert figure.z is None


def test_attributes_are_the_figure_and_what_is_known_beside_it() -> None:
    assert FULL.as_attributes() == {
        "real_contact_area_mean": 206.0,
        "real_contact_area_mean_exact": 204.0,
        "real_contact_area_mean_standard_error": 0.5,
    }
    assert UNSURE.as_attributes() == {"real_contact_area_std": 57.0, "real_contact_area_std_exact": 56.5}
    assert ALONE.as_attributes() == {"events": 73084.0}


def test_figures_come_back_from_a_file_in_their_order() -> None:
    figures = [UNSURE, ALONE, FULL]
    attributes: dict[str, object] = {"comment": "a text is no figure"}
    for figure in figures:
        attributes |= figure.as_attributes()
    assert from_attributes(attributes) == figures


def test_whole_numbers_are_figures_too() -> None:
    assert from_attributes({"events": 12}) == [
        Agreement(name="events", observed=12.0, expected=None, standard_error=None)
    ]


def test_json_has_the_score() -> None:
    assert as_json([FULL, ALONE]) == {
        "real_contact_area_mean": {"observed": 206.0, "expected": 204.0, "standard_error": 0.5, "z": 4.0},
        "events": {"observed": 73084.0, "expected": None, "standard_error": None, "z": None},
    }


def test_a_deviate_stands_for_the_score_of_a_law_that_is_not_normal() -> None:
    figure = Agreement(name="count", observed=0.0, expected=20.0, standard_error=20.0**0.5, deviate=-5.9)
    assert figure.z == -5.9
    assert as_json([figure])["count"]["z"] == -5.9


@pytest.mark.parametrize(
    ("below", "above", "z"),
    [(1.0, 0.0013499, 3.0), (0.0013499, 1.0, -3.0), (0.7, 0.6, 0.0), (0.0, 1.0, -37.05), (1.0, 0.0, 37.05)],
)
def test_a_deviate_has_the_tail_of_the_figure(below: float, above: float, z: float) -> None:
    assert normal_deviate(below, above) == pytest.approx(z, abs=0.01)


def test_the_bound_of_a_family_is_bonferronis() -> None:
    from scipy.special import ndtr

    for count in (1, 40, 1000):
        assert 2.0 * count * ndtr(-family_wise_bound(count)) == pytest.approx(1e-3)
    assert family_wise_bound(10, 0.05) == pytest.approx(2.807, abs=1e-3)
    assert family_wise_bound(0) == family_wise_bound(1)


def test_what_lies_outside_is_what_exceeds_the_bound() -> None:
    broken = Agreement(name="broken", observed=float("nan"), expected=1.0, standard_error=0.5)
    assert outside([FULL, UNSURE, ALONE, broken], 4.0) == [broken]
    assert outside([FULL, UNSURE, ALONE], 3.9) == [FULL]

"""Measured beside exact: scores, and the way into a file and back."""

import pytest

from rubnoise.analysis.agreement import Agreement, as_json, from_attributes

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

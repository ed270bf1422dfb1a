"""Resampling keeps what both rates can hold and folds nothing."""

from fractions import Fraction

import numpy as np
import pytest

from rubnoise.analysis.resampling import (
    CROSSINGS,
    MOST,
    PASSED,
    RIPPLE,
    input_count,
    output_count,
    rate_ratio,
    resampled,
)

RATIOS = [Fraction(24, 5), Fraction(6, 25), Fraction(1), Fraction(379, 1061), Fraction(147, 160), Fraction(1, 400)]


def _tone(places: np.ndarray, cycles: float) -> np.ndarray:
    return np.sin(2.0 * np.pi * cycles * places + 0.3)


def _all(panels: list[np.ndarray], ratio: Fraction) -> np.ndarray:
    return np.concatenate(list(resampled(panels, ratio)))


def _middle(values: np.ndarray, ratio: Fraction) -> np.ndarray:
    """Leave out where the filter reaches beyond the record."""
    edge = int(CROSSINGS * max(1, ratio)) + 1
    assert values.size > 3 * edge
    return values[edge:-edge]


@pytest.mark.parametrize("ratio", RATIOS, ids=str)
@pytest.mark.parametrize("share", [0.01, 0.5, PASSED])
def test_a_tone_below_both_halves_comes_out_as_it_is(ratio: Fraction, share: float) -> None:
    inputs = int(max(3000, 600 / ratio))
    cycles = 0.5 * share * float(min(1, ratio))
    found = _all([_tone(np.arange(inputs), cycles)], ratio)
    wanted = _tone(np.arange(found.size) / float(ratio), cycles)
    assert np.abs(_middle(found - wanted, ratio)).max() < RIPPLE


@pytest.mark.parametrize("ratio", [each for each in RATIOS if each < 1], ids=str)
def test_a_tone_that_would_fold_is_gone(ratio: Fraction) -> None:
    inputs = int(max(3000, 600 / ratio))
    for share in (1.0, 1.3):
        cycles = 0.5 * share * float(ratio)
        if cycles < 0.5:
            tone = _tone(np.arange(inputs), cycles)
            assert np.abs(_middle(_all([tone], ratio), ratio)).max() < RIPPLE
            picked = tone[np.rint(np.arange(output_count(inputs, ratio)) / float(ratio)).astype(int)]
            assert np.abs(picked).max() > 0.1  # what happens to it without a filter


@pytest.mark.parametrize("ratio", RATIOS, ids=str)
def test_panels_do_not_matter(ratio: Fraction) -> None:
    values = np.random.default_rng(4).normal(size=int(max(5000, 900 / ratio)))
    whole = _all([values], ratio)
    for cuts in ([1], [2500], [10, 11, 400, 401, 402, 4500]):
        found = _all(np.split(values, cuts), ratio)
        assert found.size == whole.size == output_count(values.size, ratio)
        np.testing.assert_allclose(found, whole, atol=1e-12)


def test_beyond_its_ends_a_record_stays_as_it_is_there() -> None:
    found = _all([np.full(500, 7.0)], Fraction(24, 5))
    np.testing.assert_allclose(found, 7.0, rtol=RIPPLE)


def test_few_values_are_resampled_too() -> None:
    assert _all([np.array([2.0])], Fraction(24, 5)) == pytest.approx([2.0], rel=RIPPLE)
    assert _all([np.array([2.0, 2.0])], Fraction(24, 5)).size == 5
    assert list(resampled([], Fraction(2))) == []


@pytest.mark.parametrize("ratio", RATIOS, ids=str)
def test_counts_of_inputs_and_outputs_belong_together(ratio: Fraction) -> None:
    for outputs in (1, 2, 3, 100, 12_345):
        inputs = input_count(outputs, ratio)
        assert output_count(inputs, ratio) >= outputs
        assert inputs == 1 or output_count(inputs - 1, ratio) < outputs
    assert (output_count(0, ratio), input_count(0, ratio)) == (0, 0)


@pytest.mark.parametrize(
    ("source", "target", "ratio"),
    [
        (10_000.0, 48_000.0, Fraction(24, 5)),
        (200_000.0, 48_000.0, Fraction(6, 25)),
        (44_100.0, 48_000.0, Fraction(160, 147)),
        (10_000.0 / 3.0, 48_000.0, Fraction(72, 5)),
        (10.0, 48_000.0, Fraction(0)),
        (48_000.0 * 5000.0, 48_000.0, Fraction(0)),
    ],
)
def test_ratios_are_met_exactly_where_they_can_be(source: float, target: float, ratio: Fraction) -> None:
    assert rate_ratio(source, target) == ratio


def test_every_ratio_is_met_to_a_part_in_4096() -> None:
    for source in np.geomspace(12.0, 1.9e8, 2001).tolist():
        ratio = rate_ratio(source, 48_000.0)
        assert max(ratio.numerator, ratio.denominator) <= MOST
        assert abs(float(ratio) * source / 48_000.0 - 1.0) <= 1.0 / 4096.0

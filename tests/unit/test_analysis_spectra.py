"""Welch's spectrum: scipy's numbers in the house's convention, however the record comes in, and its errors."""

from math import pi

import numpy as np
import pytest

from rubnoise.analysis.records import RecordTooShort
from rubnoise.analysis.spectra import Spectrum, WelchSum, hann, shared_variance, welch
from tests.unit.records import memory, white
from tests.verification.seeds import seed_of

VALUES = memory(65_536, seed_of("spectra"))


@pytest.mark.parametrize("ticks", [512, 511])
def test_it_is_what_scipy_finds(ticks: int) -> None:
    from scipy.signal import welch as of_scipy

    found = welch(VALUES, 0.05, ticks)
    options = {"nperseg": ticks, "noverlap": ticks - ticks // 2, "return_onesided": False}
    frequency, density = of_scipy(VALUES, fs=20.0, **options)
    half = ticks // 2 + 1
    assert found.density == pytest.approx(density[:half], rel=1e-10)
    assert found.wavenumber == pytest.approx(np.abs(2.0 * pi * frequency[:half]), rel=1e-12)


def test_its_integral_is_the_variance() -> None:
    found = welch(VALUES, 0.05)
    whole = 2.0 * found.density.sum() - found.density[0] - found.density[-1]
    assert whole * found.wavenumber[1] / (2.0 * pi) == pytest.approx(VALUES.var(), rel=0.02)


def test_it_is_flat_for_white_noise_and_falls_for_one_with_memory() -> None:
    flat = welch(white(65_536, seed_of("spectra/white")), 0.05)
    score = (flat.density - 0.05) / flat.standard_error
    assert np.abs(score[2:-2]).max() <= 5.5
    assert np.abs(score[2:-2]).mean() == pytest.approx((2.0 / pi) ** 0.5, rel=0.15)
    falling = welch(VALUES, 0.05)
    assert falling.density[-5:].mean() < 0.01 * falling.density[2:7].mean()


@pytest.mark.parametrize("pieces", [1, 7, 131])
def test_a_record_may_come_in_pieces(pieces: int) -> None:
    total = WelchSum(256, 0.05)
    for piece in np.array_split(VALUES, pieces):
        total.add(piece)
    found, whole = total.spectrum(), welch(VALUES, 0.05, 256)
    assert found.segments == whole.segments == 2 * (VALUES.size // 256) - 1
    assert found.density == pytest.approx(whole.density, rel=1e-10)
    assert found.standard_error == pytest.approx(whole.standard_error, rel=1e-6)


def test_a_short_record_is_refused_with_its_spectrum() -> None:
    with pytest.raises(RecordTooShort, match="spectrum: 50 um of sliding are too short for it; it needs") as refused:
        welch(VALUES[:1000], 0.05, 512)
    assert isinstance(refused.value.estimate, Spectrum)
    assert refused.value.estimate.segments == 2
    assert refused.value.needed == pytest.approx(0.5 * 31 * 512 * 0.05)


def test_less_than_a_segment_has_no_spectrum_to_speak_of() -> None:
    with pytest.raises(RecordTooShort) as refused:
        welch(VALUES[:100], 0.05, 512)
    assert isinstance(refused.value.estimate, Spectrum)
    assert refused.value.estimate.segments == 0
    assert np.isinf(refused.value.estimate.standard_error).all()


def test_overlap_and_neighbours_cost_what_welch_says() -> None:
    assert shared_variance(512, 1)[:4] == pytest.approx([1.0, 4.0 / 9.0, 1.0 / 36.0, 0.0], abs=1e-12)
    # Half-overlapping Hann windows: correlation 1/6, its square 1/36 on either side.
    assert shared_variance(512, 10**9)[0] == pytest.approx(1.0 + 2.0 / 36.0, rel=1e-6)


def test_the_window_is_scipys() -> None:
    from scipy.signal import get_window

    assert hann(64) == pytest.approx(get_window("hann", 64), abs=1e-15)

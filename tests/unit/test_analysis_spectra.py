"""Spectra of records, whole or in pieces; sounds, resampled and as files that others read."""

import struct
import wave
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import pi
from pathlib import Path

import numpy as np
import pytest

from rubnoise.analysis.records import CovarianceSum, HistogramSum
from rubnoise.analysis.sound import (
    CROSSINGS,
    PASSED,
    RIPPLE,
    output_count,
    resampled,
)
from rubnoise.analysis.spectra import Band, band_powers, welch
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.inference.signal import autocovariance
from rubnoise.model import Model
from rubnoise.storage.sound import STEPS, write_wave
from rubnoise.theory.sampling import expected_periodogram, hann
from tests.laws.scores import seed_of
from tests.models import bare, recorded
from tests.unit.theory_models import memory, white

# Spectra of records, whole or in pieces: Welch, bands and sums of streams.
# Welch's spectrum: scipy's numbers in the house's convention, however the record comes in, and its errors.
VALUES = memory(65_536, seed_of("spectra"))


@pytest.mark.parametrize("ticks", [512, 511])
def test_it_is_what_scipy_finds(ticks: int) -> None:
    from scipy.signal import welch as of_scipy

    found = welch([VALUES], ticks, 0.05)
    options = {"nperseg": ticks, "noverlap": ticks - ticks // 2, "return_onesided": False}
    frequency, density = of_scipy(VALUES, fs=20.0, **options)
    half = ticks // 2 + 1
    assert found.density == pytest.approx(density[:half], rel=1e-10)
    assert found.wavenumber == pytest.approx(np.abs(2.0 * pi * frequency[:half]), rel=1e-12)


def test_it_is_flat_for_white_noise_and_falls_for_one_with_memory() -> None:
    flat = welch([white(65_536, seed_of("spectra/white"))], 2016, 0.05)
    score = (flat.density - 0.05) / flat.standard_error
    assert np.abs(score[2:-2]).max() <= 5.5
    assert np.abs(score[2:-2]).mean() == pytest.approx((2.0 / pi) ** 0.5, rel=0.15)
    falling = welch([VALUES], 2016, 0.05)
    assert falling.density[-5:].mean() < 0.01 * falling.density[2:7].mean()


# Powers of bands: what they add up to, and that their errors are the spread of many runs.
TICKS = 256
RUNS = 50
LENS = bare(tick=0.4, distance=2000.0)
TRIANGULAR = replace(LENS, pulse=TRIANGLE)


@cache
def bands(run: Model, name: str, runs: int = RUNS) -> list[list[Band]]:
    seeds = range(seed_of(f"bands/{name}"), seed_of(f"bands/{name}") + runs)
    _, expected = expected_periodogram(run, run.tick, hann(TICKS))
    return [_of(run, seed, expected, 6) for seed in seeds]


def _of(run: Model, seed: int, expected: np.ndarray, count: int) -> list[Band]:
    seen = welch([recorded(run, seed)["trace"]["real_contact_area"]], TICKS, run.tick)
    return band_powers(run, seen, expected, run.distance, count)


@pytest.mark.slow
@pytest.mark.parametrize(("run", "name"), [(TRIANGULAR, "triangle"), (LENS, "lens")], ids=["triangle", "lens"])
def test_errors_are_the_spread_of_many_runs(run: Model, name: str) -> None:
    rows = bands(run, name)
    scores = np.array([[(band.observed - band.expected) / band.standard_error for band in row] for row in rows])
    assert np.abs(scores.mean(axis=0)).max() <= 4.0 / RUNS**0.5
    # A spread of 50 runs is known to a tenth, a little worse for laws with a longer tail.
    assert np.abs(scores.std(axis=0) - 1.0).max() <= 4.0 * 1.2 / (2.0 * RUNS) ** 0.5


# Estimates of a stream are those of the whole record, in whatever pieces it comes.
OFFSET_VALUES = 200.0 + memory(70_001, seed_of("sums"))
EDGES = np.linspace(198.0, 203.0, 41)
PIECES = (1, 7, 131)


@pytest.mark.parametrize("pieces", PIECES)
@pytest.mark.parametrize("reach", [1, 300, 3000])
def test_covariances_are_those_of_lagged_products(pieces: int, reach: int) -> None:
    lags, count = np.unique(np.geomspace(1, reach + 1, 40).astype(int)) - 1, OFFSET_VALUES.size
    found, away = CovarianceSum(lags, 199.0), OFFSET_VALUES - OFFSET_VALUES.mean()
    slow = [float(away[: count - lag] @ away[lag:]) / (count - lag) for lag in lags.tolist()]
    for piece in np.array_split(OFFSET_VALUES, pieces):
        found.add(piece)
    assert found.covariances() == pytest.approx(np.array(slow), rel=1e-10, abs=1e-10 * OFFSET_VALUES.var())


def test_covariances_are_those_of_the_whole_record_over_their_pairs() -> None:
    found = CovarianceSum(np.arange(501), 200.0)
    found.add(OFFSET_VALUES)
    pairs = (OFFSET_VALUES.size - np.arange(501)) / OFFSET_VALUES.size
    whole = autocovariance(OFFSET_VALUES, 500)
    assert found.covariances() * pairs == pytest.approx(whole, abs=1e-10 * OFFSET_VALUES.var())


@pytest.mark.parametrize("pieces", PIECES)
def test_a_histogram_is_that_of_the_whole_record(pieces: int) -> None:
    found = HistogramSum(EDGES, 1000)
    for piece in np.array_split(OFFSET_VALUES, pieces):
        found.add(piece)
    seen = found.histogram()
    share = np.histogram(OFFSET_VALUES, EDGES)[0] / OFFSET_VALUES.size
    assert seen.density * np.diff(EDGES) == pytest.approx(share, abs=1e-15)
    assert seen.outside == pytest.approx(1.0 - share.sum(), abs=1e-14)
    assert seen.outside > 0.0
    parts = OFFSET_VALUES[: OFFSET_VALUES.size // 1000 * 1000].reshape(-1, 1000)
    shares = np.stack([np.histogram(part, EDGES)[0] for part in parts]) / 1000.0
    error = shares.std(axis=0, ddof=1) / len(parts) ** 0.5
    assert seen.standard_error * np.diff(EDGES) == pytest.approx(error, rel=1e-10, abs=1e-12)


# Sound: resampling, and files of sound as others read them.
# Resampling keeps what both rates can hold and folds nothing.
RATIOS = [Fraction(24, 5), Fraction(6, 25), Fraction(1), Fraction(379, 1061), Fraction(147, 160), Fraction(1, 400)]


def _tone(places: np.ndarray, cycles: float) -> np.ndarray:
    return np.sin(2.0 * np.pi * cycles * places + 0.3)


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
    found = resampled(_tone(np.arange(inputs), cycles), ratio)
    wanted = _tone(np.arange(found.size) / float(ratio), cycles)
    assert np.abs(_middle(found - wanted, ratio)).max() < RIPPLE


@pytest.mark.parametrize("ratio", [each for each in RATIOS if each < 1], ids=str)
def test_a_tone_that_would_fold_is_gone(ratio: Fraction) -> None:
    inputs = int(max(3000, 600 / ratio))
    for share in (1.0, 1.3):
        cycles = 0.5 * share * float(ratio)
        if cycles < 0.5:
            tone = _tone(np.arange(inputs), cycles)
            assert np.abs(_middle(resampled(tone, ratio), ratio)).max() < RIPPLE
            picked = tone[np.rint(np.arange(output_count(inputs, ratio)) / float(ratio)).astype(int)]
            assert np.abs(picked).max() > 0.1  # what happens to it without a filter


# WAV files as others read them.
TEXTS = {"INAM": "noise of 5 um", "ICMT": "unit=um/s; full_scale=2.5"}


def _write(path: Path, values: np.ndarray, panels: int = 3, **options: int) -> None:
    with path.open("w+b") as stream:
        write_wave(stream, np.array_split(values, panels), samples=values.size, rate=48_000, texts=TEXTS, **options)


def _read(path: Path) -> np.ndarray:
    with wave.open(str(path)) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 3, 48_000)
        frames = np.frombuffer(file.readframes(file.getnframes()), np.uint8).reshape(-1, 3)
    low, middle, high = frames.astype(np.int32).T
    return (((high ^ 0x80) - 0x80) << 16) | (middle << 8) | low


def _chunks(data: bytes) -> dict[bytes, bytes]:
    """Return the chunks of a RIFF file, or of a list, by name, and see that they fill it."""
    found, place = {}, 0
    while place < len(data):
        name, size = data[place : place + 4], struct.unpack("<I", data[place + 4 : place + 8])[0]
        found[name] = data[place + 8 : place + 8 + size]
        place += 8 + size + size % 2
    assert place == len(data)
    return found


@pytest.mark.parametrize("count", [1, 2, 1001, 200_000])
def test_samples_are_read_back_to_half_a_step(tmp_path: Path, count: int) -> None:
    values = np.random.default_rng(1).uniform(-0.999, 0.999, count)
    _write(tmp_path / "x.wav", values)
    found = _read(tmp_path / "x.wav")
    assert found.size == count
    assert np.abs(found - STEPS * values).max() <= 0.5 + 1e-6


def test_what_is_beyond_full_scale_is_cut_and_not_turned_over(tmp_path: Path) -> None:
    _write(tmp_path / "x.wav", np.array([1.0, 1.5, -1.0, -1.5, 0.0]))
    assert _read(tmp_path / "x.wav").tolist() == [STEPS - 1, STEPS - 1, -STEPS, -STEPS, 0]


@pytest.mark.parametrize("count", [4, 5])
def test_every_length_in_it_is_right(tmp_path: Path, count: int) -> None:
    _write(tmp_path / "x.wav", np.zeros(count))
    whole = (tmp_path / "x.wav").read_bytes()
    assert len(whole) % 2 == 0
    file = _chunks(whole)[b"RIFF"]
    assert file[:4] == b"WAVE"
    chunks = _chunks(file[4:])
    assert list(chunks) == [b"fmt ", b"data", b"LIST"]
    # PCM, one channel, samples and bytes a second, bytes and bits a sample.
    assert struct.unpack("<HHIIHH", chunks[b"fmt "]) == (1, 1, 48_000, 144_000, 3, 24)
    assert len(chunks[b"data"]) == 3 * count
    texts = _chunks(chunks[b"LIST"][4:])
    assert {name.decode(): text.rstrip(b"\0").decode() for name, text in texts.items()} == TEXTS

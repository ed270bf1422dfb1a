"""Sound: resampling, and files of sound as others read them."""

import struct
import wave
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from rubnoise.analysis.sound import (
    CROSSINGS,
    MOST,
    PASSED,
    RIPPLE,
    input_count,
    output_count,
    rate_ratio,
    resampled,
)
from rubnoise.errors import Refused
from rubnoise.storage.wave_file import MOST as MOST_SAMPLES
from rubnoise.storage.wave_file import STEPS, check_length, write_wave

# Resampling keeps what both rates can hold and folds nothing.
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


# WAV files as others read them.
TEXTS = {"INAM": "noise of 5 um", "ICMT": "unit=um/s; full_scale=2.5"}


def _write(path: Path, values: np.ndarray, panels: int = 3, **options: int) -> None:
    write_wave(path, np.array_split(values, panels), samples=values.size, rate=48_000, texts=TEXTS, **options)


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
    assert list(chunks) == [b"fmt ", b"LIST", b"data"]
    # PCM, one channel, samples and bytes a second, bytes and bits a sample.
    assert struct.unpack("<HHIIHH", chunks[b"fmt "]) == (1, 1, 48_000, 144_000, 3, 24)
    assert len(chunks[b"data"]) == 3 * count
    texts = _chunks(chunks[b"LIST"][4:])
    assert {name.decode(): text.rstrip(b"\0").decode() for name, text in texts.items()} == TEXTS


def test_samples_beyond_the_number_are_left_out_and_missing_ones_noticed(tmp_path: Path) -> None:
    write_wave(tmp_path / "x.wav", [np.zeros(3), np.zeros(3)], samples=4, rate=48_000, texts=TEXTS)
    assert _read(tmp_path / "x.wav").size == 4
    with pytest.raises(AssertionError, match="6 samples came of 7"):
        write_wave(tmp_path / "x.wav", [np.zeros(3), np.zeros(3)], samples=7, rate=48_000, texts=TEXTS)


def test_more_samples_than_a_file_can_tell_are_refused() -> None:
    check_length(MOST_SAMPLES)
    with pytest.raises(Refused, match="that a WAV file holds; --seconds takes some"):
        check_length(MOST_SAMPLES + 1)
    assert 3 * MOST_SAMPLES + 65_536 <= 1 << 32

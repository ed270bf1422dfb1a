"""WAV files as others read them."""

import struct
import wave
from pathlib import Path

import numpy as np
import pytest

from rubnoise.errors import Refused
from rubnoise.storage.wave_file import MOST, STEPS, check_length, write_wave

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
    assert len(chunks[b"data"]) == 3 * count
    texts = _chunks(chunks[b"LIST"][4:])
    assert {name.decode(): text.rstrip(b"\0").decode() for name, text in texts.items()} == TEXTS


def test_samples_beyond_the_number_are_left_out_and_missing_ones_noticed(tmp_path: Path) -> None:
    write_wave(tmp_path / "x.wav", [np.zeros(3), np.zeros(3)], samples=4, rate=48_000, texts=TEXTS)
    assert _read(tmp_path / "x.wav").size == 4
    with pytest.raises(AssertionError, match="6 samples came of 7"):
        write_wave(tmp_path / "x.wav", [np.zeros(3), np.zeros(3)], samples=7, rate=48_000, texts=TEXTS)


def test_more_samples_than_a_file_can_tell_are_refused() -> None:
    check_length(MOST)
    with pytest.raises(Refused, match="that a WAV file holds; --seconds takes some"):
        check_length(MOST + 1)
    assert 3 * MOST + 65_536 <= 1 << 32

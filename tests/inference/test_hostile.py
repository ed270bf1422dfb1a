"""Files that were damaged or made to do harm, and values that are no trace: a sentence each, and exit code 2."""

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat, wavfile

from rubnoise.errors import Refused
from rubnoise.storage.measured import Asked
from tests.inference.traces import read_measured

VALUES = 50.0 + np.sin(np.arange(400.0))


def wave(
    *,
    code: int = 1,
    channels: int = 1,
    rate: int = 8000,
    bits: int = 16,
    block: int | None = None,
    byte_rate: int | None = None,
) -> bytes:
    """Return a WAV file with this header, right or wrong."""
    data = np.rint(100.0 * VALUES).astype("<i2").tobytes()
    size = channels * bits // 8 if block is None else block
    form = struct.pack("<HHIIHH", code, channels, rate, rate * size if byte_rate is None else byte_rate, size, bits)
    return (
        b"RIFF"
        + struct.pack("<I", 36 + len(data))
        + b"WAVEfmt "
        + struct.pack("<I", 16)
        + form
        + b"data"
        + struct.pack("<I", len(data))
        + data
    )


WAVES = {
    "rate": wave(rate=0),
    "channels": wave(channels=0, block=2),
    "block": wave(block=0),
    "byte rate": wave(byte_rate=16000 // 3),
    "cut header": wave()[:30],
    "cut before data": wave()[:40],
    "cut data": wave()[:-100],
    "empty data": wave()[:40] + bytes(4),
    "empty": b"",
    "other": b"RIFFxxxxAVI " + bytes(50),
    "compressed": wave(code=2),
    "many chunks": wave()[:12] + b"junk\0\0\0\0" * 50_000,
}


@pytest.mark.parametrize("name", WAVES)
def test_a_wave_file_that_is_cut_or_damaged_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / "a.wav"
    path.write_bytes(WAVES[name])
    with pytest.raises(Refused, match=r"a\.wav: is no WAV file|a\.wav: has 0 samples|at 0 Hz"):
        read_measured(path)


@pytest.mark.parametrize("kind", ["u1", "<i2", "<i4", "<f4", "<f8"])
def test_sound_of_every_kind_is_read_as_scipy_reads_it(tmp_path: Path, kind: str) -> None:
    full = {"u1": 255, "<i2": 2**15 - 1, "<i4": 2**31 - 1}.get(kind, 1.0)
    both = np.stack([np.linspace(0, 1, 99), np.linspace(0, 0.5, 99)], axis=-1) * full
    wavfile.write(tmp_path / "a.wav", 8000, both.astype(kind))
    offset, scale = {"u1": (128.0, 128.0), "<i2": (0.0, 2.0**15), "<i4": (0.0, 2.0**31)}.get(kind, (0.0, 1.0))
    assert (
        read_measured(tmp_path / "a.wav", Asked(column="2")).values.tolist()
        == ((both.astype(kind)[:, 1] - offset) / scale).tolist()
    )


def bomb(path: Path, *, rows: int, told: int) -> None:
    """Write a MATLAB file whose one vector unpacks to so many rows, whatever its header tells."""
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49)
    begun = (
        struct.pack("<IIII", 6, 8, 6, 0) + struct.pack("<IIii", 5, 8, told, 1) + struct.pack("<HH4s", 1, 1, b"f\0\0\0")
    )
    array = begun + struct.pack("<II", 9, 8 * rows % 2**32)
    packer = zlib.compressobj(9)
    parts = [packer.compress(struct.pack("<II", 14, (len(array) + 8 * rows) % 2**32) + array)]
    zeros = bytes(1 << 20)
    parts += [packer.compress(zeros) for _ in range(8 * rows >> 20)]
    packed = b"".join([*parts, packer.flush()])
    path.write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)


@pytest.mark.slow
@pytest.mark.parametrize(("rows", "told"), [(1 << 25, 1 << 25), (1 << 25, 100), (1 << 20, 1 << 27)])
def test_a_matlab_file_that_unpacks_to_gigabytes_is_refused(tmp_path: Path, rows: int, told: int) -> None:
    path = tmp_path / "a.mat"
    bomb(path, rows=rows, told=told)
    assert path.stat().st_size < 400_000
    with pytest.raises(Refused, match=r"a\.mat: .*(values; up to|damaged|no MATLAB|no vector)"):
        read_measured(path)


@pytest.mark.slow
def test_what_is_no_vector_of_a_matlab_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.mat"
    for content, problem in (
        ({"a": np.zeros((3, 3))}, "has no vector of real numbers; it has a 3x3"),
        ({"a": 1j * VALUES}, "no vector of real numbers"),
        ({"a": np.zeros((0, 1))}, "has no vector"),
        ({"a": "text"}, "has no vector"),
        ({"a": np.full(9, np.nan)}, "every sample needs a number"),
        ({"a": 1e300 * VALUES}, "up to 1e"),
    ):
        savemat(path, content, do_compression=True)
        with pytest.raises(Refused, match=rf"a\.mat: .*{problem}"):
            read_measured(path)
    savemat(path, {"a": VALUES})
    for end in (10, 128, 140, 300, 1000):
        path.write_bytes(path.read_bytes()[:end])
        with pytest.raises(Refused, match=r"a\.mat: "):
            read_measured(path)
        savemat(path, {"a": VALUES})
    assert read_measured(path, Asked(rate=1.0)).values.tolist() == VALUES.tolist()

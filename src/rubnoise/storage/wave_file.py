"""Write sound to a WAV file: one channel of 24 bits, with its physical scale in words."""

import struct
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused

BITS: Final = 24
STEPS: Final = 1 << (BITS - 1)
"""Steps from silence to full scale."""

_BYTES: Final = BITS // 8
MOST: Final = ((1 << 32) - (1 << 16)) // _BYTES
"""Samples in a file of 4 GB, with room for texts."""

_PCM: Final = 1


def check_length(samples: int) -> None:
    """Raise Refused for more samples than the 32-bit length in a WAV file can count."""
    if samples > MOST:
        raise Refused(f"{samples:,} samples are more than the {MOST:,} that a WAV file holds; --seconds takes some")


def write_wave(path: Path, pieces: Iterable[Doubles], *, samples: int, rate: int, texts: Mapping[str, str]) -> None:
    """Write samples from -1 to 1 as whole numbers of 24 bits, rounded; full scale is 2^23.

    There are ``samples`` of them, in pieces; ``texts`` are those of the chunk LIST INFO by their names of four letters
    (INAM the title, ICMT a comment, ISFT the software). Raises Refused for more than fit, OSError if the disk
    fails. Source: Multimedia Programming Interface and Data Specifications 1.0 (IBM and Microsoft, 1991).
    """
    check_length(samples)
    with path.open("wb") as stream:
        stream.write(_head(samples, rate, texts))
        written = 0
        for part in _cut(pieces, samples):
            stream.write(_packed(part))
            written += part.size
        stream.write(bytes(samples * _BYTES % 2))
    if written != samples:
        raise AssertionError(f"{written} samples came of {samples}")


def _cut(pieces: Iterable[Doubles], samples: int) -> Iterator[Doubles]:
    """Yield pieces up to a number of samples in all."""
    rest = samples
    for piece in pieces:
        yield piece[:rest]
        rest -= min(rest, piece.size)


def _packed(values: Doubles) -> bytes:
    """Return the three lower bytes, lowest first, of each value as a whole number of steps."""
    steps = np.clip(np.rint(values * STEPS), -STEPS, STEPS - 1).astype("<i4")
    return steps.view(np.uint8).reshape(-1, 4)[:, :_BYTES].tobytes()


def _head(samples: int, rate: int, texts: Mapping[str, str]) -> bytes:
    """Return everything before the first sample."""
    size = samples * _BYTES
    form = struct.pack("<HHIIHH", _PCM, 1, rate, rate * _BYTES, _BYTES, BITS)
    information = b"INFO" + b"".join(_chunk(name, text.encode() + b"\0") for name, text in texts.items())
    before = _chunk("fmt ", form) + _chunk("LIST", information) + b"data" + struct.pack("<I", size)
    return b"RIFF" + struct.pack("<I", 4 + len(before) + size + size % 2) + b"WAVE" + before


def _chunk(name: str, content: bytes) -> bytes:
    """Return a chunk: its name, its length, its content, and a zero if that is odd."""
    return name.encode("ascii") + struct.pack("<I", len(content)) + content + bytes(len(content) % 2)

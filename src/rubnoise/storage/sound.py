"""Write sound to a WAV file: one channel of 24 bits, with its physical scale in words."""

import os
import struct
import wave
from collections.abc import Iterable, Mapping
from typing import IO, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused

BITS: Final = 24
STEPS: Final = 1 << (BITS - 1)  # steps from silence to full scale
_BYTES: Final = BITS // 8
MOST: Final = ((1 << 32) - (1 << 16)) // _BYTES  # samples in a file of 4 GB, with room for texts


def check_length(samples: int) -> None:
    """Raise Refused for more samples than the 32-bit length in a WAV file can count."""
    if samples > MOST:
        raise Refused(f"{samples:,} samples are more than the {MOST:,} that a WAV file holds; --seconds takes some")


def write_wave(
    stream: IO[bytes], pieces: Iterable[Doubles], *, samples: int, rate: int, texts: Mapping[str, str]
) -> None:
    """Write samples from -1 to 1 as whole numbers of 24 bits, rounded, into a new file; full scale is 2^23.

    There are ``samples`` of them, in pieces; ``texts`` are those of the chunk LIST INFO by their names of four letters
    (INAM the title, ICMT a comment, ISFT the software). Raises Refused for more than fit, OSError if the disk
    fails. Source: Multimedia Programming Interface and Data Specifications 1.0 (IBM and Microsoft, 1991).
    """
    check_length(samples)
    written, information = 0, b"".join(_chunk(name, text.encode() + b"\0") for name, text in texts.items())
    with wave.open(stream, "wb") as sound:
        sound.setparams((1, _BYTES, rate, samples, "NONE", "not compressed"))
        for piece in pieces:
            steps = np.clip(np.rint(piece[: samples - written] * STEPS), -STEPS, STEPS - 1).astype("<i4")
            sound.writeframesraw(steps.view(np.uint8).reshape(-1, 4)[:, :_BYTES].tobytes())
            written += steps.size
    end = stream.seek(0, os.SEEK_END)
    stream.write(bytes(end % 2) + _chunk("LIST", b"INFO" + information))  # which the module does not write
    end = stream.tell()
    stream.seek(4)
    stream.write(struct.pack("<I", end - 8))
    if written != samples:
        raise AssertionError(f"{written} samples came of {samples}")


def _chunk(name: str, content: bytes) -> bytes:
    """Return a chunk: its name, its length, its content, and a zero if that is odd."""
    return name.encode("ascii") + struct.pack("<I", len(content)) + content + bytes(len(content) % 2)

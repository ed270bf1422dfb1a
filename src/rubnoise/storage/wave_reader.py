"""Read one channel of a WAV file of another program; its header is used only if it is consistent."""

import os
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np

from rubnoise.arrays import Doubles, slices
from rubnoise.errors import Refused
from rubnoise.regular_file import open_stream
from rubnoise.storage.samples import chosen_column

_PCM: Final = 1
_FLOAT: Final = 3
_EXTENSIBLE: Final = 0xFFFE
_FORM_BYTES: Final = 16
_MOST_CHUNKS: Final = 10_000
_FRAMES_AT_ONCE: Final = 1 << 20
_KINDS: Final = {
    (_PCM, 1): "u1",
    (_PCM, 2): "<i2",
    (_PCM, 3): "",
    (_PCM, 4): "<i4",
    (_FLOAT, 4): "<f4",
    (_FLOAT, 8): "<f8",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Form:
    """The content of a header: the code and size in bytes of its samples, its channels, and samples per second."""

    code: int
    width: int
    channels: int
    rate: int


def read_wave(path: Path, wanted: str | None) -> tuple[str, Doubles, int]:
    """Return the name of the wanted channel, its samples (whole numbers as parts of full scale) and its rate in Hz.

    Raises Refused if the header is cut or inconsistent, and for a file without samples.
    """
    with open_stream(path) as stream:
        form, size = _head(stream, path)
        frame = form.width * form.channels
        there = os.fstat(stream.fileno()).st_size - stream.tell()
        if size > there:
            raise Refused(f"{path}: is cut: its header names {size:,} bytes of samples, and {there:,} are there")
        if size < frame:
            raise Refused(f"{path}: has no samples")
        names = [str(channel + 1) for channel in range(form.channels)]
        chosen = chosen_column(path, names, wanted, None)
        found = np.empty(size // frame)
        for part in slices(0, found.size, _FRAMES_AT_ONCE):
            found[part] = _channel(stream.read((part.stop - part.start) * frame), form, chosen)
    return names[chosen], found, form.rate


def _head(stream: BinaryIO, path: Path) -> tuple[_Form, int]:
    """Return the form of the samples and their size in bytes; the stream is then at the first sample."""
    riff, _, wave = struct.unpack("<4sI4s", stream.read(12).ljust(12, b"\0"))
    if (riff, wave) != (b"RIFF", b"WAVE"):
        raise Refused(f"{path}: is no WAV file: it does not begin as one")
    form: _Form | None = None
    for _ in range(_MOST_CHUNKS):
        head = stream.read(8)
        if len(head) < 8:
            break
        name, size = struct.unpack("<4sI", head)
        if name == b"data":
            if form is None:
                break
            return form, size
        if name == b"fmt ":
            form = _form(stream.read(min(size, 64)), path)
            size = max(size - 64, 0)
        stream.seek(size + size % 2, os.SEEK_CUR)
    raise Refused(
        f"{path}: is no WAV file that can be read: its header is cut, it has no {'samples' if form else 'form'}"
    )


def _form(content: bytes, path: Path) -> _Form:
    if len(content) < _FORM_BYTES:
        raise Refused(f"{path}: is no WAV file that can be read: its header is cut")
    code, channels, rate, byte_rate, block, bits = struct.unpack("<HHIIHH", content[:_FORM_BYTES])
    if code == _EXTENSIBLE and len(content) >= 26:
        (code,) = struct.unpack("<H", content[24:26])
    width = block // channels if channels else 0
    said = f"{channels} channels of {bits} bits in blocks of {block} bytes, at {rate} Hz and {byte_rate} bytes a second"
    if not (channels and rate) or width * channels != block or bits != 8 * width or byte_rate != rate * block:
        raise Refused(f"{path}: its header does not agree with itself: {said}; write the file again")
    if (code, width) not in _KINDS:
        raise Refused(f"{path}: samples of {bits} bits (code {code}) are not read; save it as PCM of 16 or 24 bits")
    return _Form(code=code, width=width, channels=channels, rate=rate)


def _channel(content: bytes, form: _Form, channel: int) -> Doubles:
    kind = _KINDS[form.code, form.width]
    raw: Any
    if kind:
        raw = np.frombuffer(content, dtype=kind).reshape(-1, form.channels)[:, channel].astype(np.float64)
    else:
        three = np.frombuffer(content, dtype=np.uint8).reshape(-1, form.channels, 3)[:, channel].astype(np.int32)
        raw = (three[:, 0] | three[:, 1] << 8 | three[:, 2] << 16).astype(np.float64)
        raw -= np.where(three[:, 2] > 127, 2.0**24, 0.0)
    if form.code == _FLOAT:
        return np.asarray(raw)
    full = 2.0 ** (8 * form.width - 1)
    return np.asarray(raw / full - (1.0 if form.width == 1 else 0.0))

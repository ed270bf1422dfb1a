"""Lines of a text file with their numbers, read in pieces, so that no file can fill the memory."""

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Final

from rubnoise.errors import Refused
from rubnoise.regular_file import open_stream

Line = tuple[int, str]
"""The number of a line, from 1 on, and its text."""

LONGEST_LINE: Final = 1 << 20
"""Bytes of a line at most: ten thousand cells have a tenth of it."""

_PIECE_BYTES: Final = 4 * 1024**2
_BOM: Final = b"\xef\xbb\xbf"


def lines_of(path: Path) -> Iterator[list[Line]]:
    """Yield the lines of a text in UTF-8, a piece at a time, without comments (#) and empty lines.

    Lines end in LF, CR LF or CR. Raises Refused, with the line, if the file is not a text.
    """
    number = 0
    with open_stream(path) as stream:
        for piece in _pieces(stream, path):
            texts = (
                _decoded(piece, path, number).replace("\r\n", "\n").replace("\r", "\n").removesuffix("\n").split("\n")
            )
            if len(piece) > LONGEST_LINE and max(map(len, texts)) > LONGEST_LINE:
                line = next(at for at, text in enumerate(texts, number + 1) if len(text) > LONGEST_LINE)
                raise Refused(f"{path}: line {line}: {_TOO_LONG}")
            kept = [
                (at, text)
                for at, text in enumerate(texts, number + 1)
                if text[:1] != "#" and not text.isspace() and text
            ]
            number += len(texts)
            if kept:
                yield kept


_TOO_LONG: Final = f"has more than {LONGEST_LINE:,} characters; a table has a row for each sample"


def _pieces(stream: BinaryIO, path: Path) -> Iterator[bytes]:
    """Yield the content in pieces that end where a line ends."""
    rest, done = b"", 0
    while True:
        new = stream.read(_PIECE_BYTES)
        whole = rest + new if rest or done else new.removeprefix(_BOM)
        if not new:
            if whole:
                yield whole
            return
        end = whole.rfind(b"\n") + 1
        if not end:
            end = whole.rfind(b"\r", 0, len(whole) - 1) + 1  # the last one may be half of a CR LF
        if end:
            yield whole[:end]
            done += whole.count(b"\n", 0, end) or whole.count(b"\r", 0, end)
        elif len(whole) > LONGEST_LINE:
            _decoded(whole[:LONGEST_LINE], path, done, cut=True)
            raise Refused(f"{path}: line {done + 1}: {_TOO_LONG}")
        rest = whole[end:]


def _decoded(piece: bytes, path: Path, before: int, *, cut: bool = False) -> str:
    """Return a piece as text; raises Refused with the line of the first byte that is not UTF-8."""
    if (zero := piece.find(b"\0")) >= 0:
        line = before + 1 + piece.count(b"\n", 0, zero)
        raise Refused(f"{path}: line {line}: holds a zero byte, so it is no text in UTF-8; save it as CSV in UTF-8")
    try:
        return piece.decode("utf-8", "ignore" if cut else "strict")
    except UnicodeDecodeError as problem:
        line = before + 1 + piece.count(b"\n", 0, problem.start)
        byte = f"0x{piece[problem.start]:02x}"
        raise Refused(f"{path}: line {line}: the byte {byte} is no text in UTF-8; save it as CSV in UTF-8") from None

"""The journal of a sweep: what became of each run, a line each, appended as it happens.

It is read back after any crash: a torn last line is no entry.
"""

import json
import os
import re
import time
from base64 import b64decode, b64encode
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Literal, Self, get_args

import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.errors import OutputRefused
from rubnoise.regular_file import open_stream
from rubnoise.storage import disk


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRow:
    """One run that is done, as the index of its sweep has it.

    ``file`` lies relative to the folder of the sweep, and is empty if no file is kept; ``figures`` are named as in
    /summary of a run; ``arrays`` have one shape for each name in all runs of a sweep. ``of_point`` are such arrays that
    are the same for all replicates of a point; they come with the first one.
    """

    run_id: str
    file: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    of_point: Mapping[str, NDArray[Any]] = field(default_factory=dict)


SYNC_EVERY: Final = 1.0
"""Seconds of lines that a power cut may take, whose runs are found again by their files, and seconds of such files."""

Stamp = tuple[int, int]
"""Size of a file in bytes, and the time of its last change in ns."""

State = Literal["begun", "done", "failed"]

Fault = Literal["cut short", "damaged"]
"""What is wrong with a line that is no entry."""

LINE_BYTES: Final = 1 << 24
"""No line is longer: the curves of a run's summary take some hundred kB."""

_DIGITS: Final = 16

TAKEN: Final = frozenset(("run", "run_id", "point", "replicate", "seed", "file", "state", "reason"))
"""Names of columns of /runs, which no figure has."""

_WHOLE: Final = 1 << 62
"""Whole numbers of a figure lie below it."""

_ID: Final = re.compile(r"[0-9a-z]{1,64}")
_FILE: Final = re.compile(r"(runs/[0-9a-z]{1,64}\.h5)?")
_NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,99}")


@dataclass(frozen=True, slots=True, kw_only=True)
class JournalEntry:
    """What happened to one run: it is done, with what is left of it, or failed, with the reason; or is to be made.

    One that was ``begun`` had no file in its place: what is found there, torn, is its own. ``stamp`` is that of the
    file of one that is done, by which it is known again (see SweepFolder.stamp); None if none was taken.
    """

    run_id: str
    state: State
    row: RunRow | None = None
    reason: str = ""
    stamp: Stamp | None = None


class SweepJournal:
    """Lines appended to a file, each behind its checksum; a line that was cut short is as if it had never been."""

    def __init__(self, path: Path) -> None:
        """Open a journal to go on at its end."""
        if path.exists() and not path.is_file():
            raise OutputRefused(f"{path}: exists and is not a regular file")
        self._path = path
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o666)
        self._synced = time.monotonic()
        size = os.fstat(self._descriptor).st_size
        if size and disk.read(self._descriptor, 1, size - 1) != b"\n":
            self._write(b"\n")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.fsync(self._descriptor)
        os.close(self._descriptor)

    def add(self, *entries: JournalEntry) -> None:
        """Append entries; raises OSError if the disk fails."""
        self._write(b"".join(map(_line, entries)))
        if time.monotonic() - self._synced >= SYNC_EVERY:
            self.sync()

    def sync(self) -> None:
        """See all of it onto the disk."""
        os.fsync(self._descriptor)
        self._synced = time.monotonic()

    def _write(self, line: bytes) -> None:
        try:
            disk.append_all(self._descriptor, memoryview(line))
        except OSError as problem:
            raise OSError(problem.errno, problem.strerror, str(self._path)) from problem


def entries(path: Path) -> Iterator[JournalEntry]:
    """Yield every sound entry of a journal, the oldest first; nothing if there is none."""
    return (entry for _, entry in numbered(path) if isinstance(entry, JournalEntry))


def numbered(path: Path) -> Iterator[tuple[int, JournalEntry | Fault]]:
    """Yield the entries of a journal with the numbers of their lines, and what is wrong with a line in place of one."""
    try:
        with open_stream(path) as lines:
            for number, line in enumerate(iter(partial(lines.readline, LINE_BYTES), b""), 1):
                digest, _, text = line.rstrip(b"\n").partition(b" ")
                if _is_sound(digest, text):
                    yield number, _entry(text) or "damaged"
                else:
                    yield number, "cut short" if _is_cut_short(digest, text) else "damaged"
    except FileNotFoundError:
        return


def _is_sound(digest: bytes, text: bytes) -> bool:
    return len(digest) == _DIGITS and digest == xxhash.xxh3_64_hexdigest(text).encode()


def _is_cut_short(digest: bytes, text: bytes) -> bool:
    """Whether a line is the beginning of one, as a kill or a power cut leaves it, and not a whole one that was changed.

    A whole one ends with the brace that closes it, or did before its last byte was changed.
    """
    text = text.rstrip(b"\0")
    if not text:
        return len(digest.rstrip(b"\0")) <= _DIGITS  # a longer one has lost the space behind its checksum
    if not text.endswith(b"}"):
        return not _is_sound(digest, text[:-1] + b"}")
    try:
        json.loads(text + b"}")  # cut behind the brace of an inner table
    except ValueError:
        return False
    return True


def _line(entry: JournalEntry) -> bytes:
    text = json.dumps(_packed(entry), separators=(",", ":")).encode()
    return xxhash.xxh3_64_hexdigest(text).encode() + b" " + text + b"\n"


def _packed(entry: JournalEntry) -> dict[str, Any]:
    fields: dict[str, Any] = {"run": entry.run_id, "state": entry.state}
    if entry.reason:
        fields["reason"] = entry.reason
    if entry.row is not None:
        fields |= {"file": entry.row.file, "figures": dict(entry.row.figures)}
        for kind, arrays in (("arrays", entry.row.arrays), ("of_point", entry.row.of_point)):
            if arrays:
                fields[kind] = {name: _as_text(values) for name, values in arrays.items()}
    if entry.stamp is not None:
        fields["stamp"] = entry.stamp
    return fields


def _entry(text: bytes) -> JournalEntry | None:
    """Return the entry that a line holds; None for one that this program has not written, whatever its checksum."""
    try:
        fields: Any = json.loads(text)
        return _unpacked(fields) if _is_right(fields) else None
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError, OverflowError):
        return None


def _is_right(fields: Any) -> bool:
    """Whether the fields of an entry are of their kinds, and its names lead nowhere else."""
    figures, arrays = fields.get("figures", {}), fields.get("arrays", {}) | fields.get("of_point", {})
    return (
        _ID.fullmatch(fields["run"]) is not None
        and fields["state"] in get_args(State)
        and isinstance(fields.get("reason", ""), str)
        and [type(number) for number in fields.get("stamp", (0, 0))] == [int, int]
        and _FILE.fullmatch(fields.get("file", "")) is not None
        and all(_NAME.fullmatch(name) and name not in TAKEN for name in (*figures, *arrays))
        and all(type(value) is float or abs(int(value)) < _WHOLE for value in figures.values())
        and all(np.dtype(kind).kind in "iuf" for kind, _, _ in arrays.values())
    )


def _unpacked(fields: Mapping[str, Any]) -> JournalEntry:
    row = None
    if fields["state"] == "done":
        arrays, of_point = (
            {name: _as_array(*packed) for name, packed in fields.get(kind, {}).items()}
            for kind in ("arrays", "of_point")
        )
        row = RunRow(
            run_id=fields["run"], file=fields["file"], figures=fields["figures"], arrays=arrays, of_point=of_point
        )
    stamp = tuple(fields["stamp"]) if "stamp" in fields else None
    return JournalEntry(
        run_id=fields["run"], state=fields["state"], row=row, reason=fields.get("reason", ""), stamp=stamp
    )


def _as_text(values: NDArray[Any]) -> tuple[str, list[int], str]:
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    return little.dtype.str, list(values.shape), b64encode(little.tobytes()).decode()


def _as_array(kind: str, shape: list[int], text: str) -> NDArray[Any]:
    return np.frombuffer(b64decode(text), dtype=np.dtype(kind)).reshape(shape)

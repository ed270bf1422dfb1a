"""The journal of a sweep: a line for the outcome of each run, appended as it happens.

It is read back after any crash: a last line that is cut short is not an entry.
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
    """A run that is done, with its values in the index of the sweep.

    ``file`` is relative to the folder of the sweep, empty if no file is kept; ``figures`` are named as in /summary of a
    run; ``arrays`` of one name have one shape in all runs of a sweep. ``of_point`` are arrays that are equal for all
    replicates of a point; the first one has them.
    """

    run_id: str
    file: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    of_point: Mapping[str, NDArray[Any]] = field(default_factory=dict)


SYNC_EVERY: Final = 1.0
"""Seconds between two flushes, of lines and of results; a power cut may take the lines, and their files are found."""

Stamp = tuple[int, int]
"""Size of a file in bytes, and the time of its last change in ns."""

State = Literal["begun", "done", "failed"]

Fault = Literal["cut short", "damaged"]
"""The reason why a line is not an entry."""

LINE_BYTES: Final = 1 << 24
"""No line is longer: the curves of a run's summary take some hundred kB."""

_DIGITS: Final = 16

TAKEN: Final = frozenset(("run", "run_id", "point", "replicate", "seed", "file", "state", "reason"))
"""Names of columns of /runs, which no figure may have."""

_WHOLE: Final = 1 << 62
"""Upper limit of the whole numbers in figures."""

_ID: Final = re.compile(r"[0-9a-z]{1,64}")
_FILE: Final = re.compile(r"(runs/[0-9a-z]{1,64}\.h5)?")
_NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,99}")


@dataclass(frozen=True, slots=True, kw_only=True)
class JournalEntry:
    """The state of one run: done, with its row; failed, with the reason; or begun.

    A run that was ``begun`` had no file: a truncated file at its path is its own. ``stamp`` recognises the file of a
    run that is done (see SweepFolder.stamp); None if none was taken.
    """

    run_id: str
    state: State
    row: RunRow | None = None
    reason: str = ""
    stamp: Stamp | None = None


class SweepJournal:
    """Lines appended to a file, each after its checksum; a line that was cut short does not count."""

    def __init__(self, path: Path) -> None:
        """Open a journal for appending."""
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
        """Flush the journal to disk."""
        os.fsync(self._descriptor)
        self._synced = time.monotonic()

    def _write(self, line: bytes) -> None:
        try:
            disk.append_all(self._descriptor, memoryview(line))
        except OSError as problem:
            raise OSError(problem.errno, problem.strerror, str(self._path)) from problem


def entries(path: Path) -> Iterator[JournalEntry]:
    """Yield every valid entry of a journal, the oldest first; nothing if there is no journal."""
    return (entry for _, entry in numbered(path) if isinstance(entry, JournalEntry))


def numbered(path: Path) -> Iterator[tuple[int, JournalEntry | Fault]]:
    """Yield the entries of a journal with their line numbers; for an invalid line, the reason in place of an entry."""
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
    """Whether a line is the beginning of an entry, as after a kill or a power cut, and not a complete, changed one.

    A complete one ends with a closing brace, or did before its last byte was changed.
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
    """Return the entry in a line; None if this program cannot have written it, whatever its checksum."""
    try:
        fields: Any = json.loads(text)
        return _unpacked(fields) if _is_right(fields) else None
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError, OverflowError):
        return None


def _is_right(fields: Any) -> bool:
    """Whether the fields of an entry have their types, and its names cannot lead out of the folder."""
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

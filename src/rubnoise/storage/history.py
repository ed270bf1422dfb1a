"""What the journal of a run tells: which run it is of, how far it was at each commit, and how it was to be ended."""

import json
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import time
from typing import Final, Self

import xxhash

from rubnoise.errors import RunFileRefused
from rubnoise.regular_file import open_stream
from rubnoise.simulation.state import State
from rubnoise.storage.columns import Mark
from rubnoise.storage.ending import Ending
from rubnoise.storage.journal import Frame, frames
from rubnoise.storage.layout import Name, RunDescription

VERSION: Final = 2
MOST_COMMITS: Final = 4096
"""Commits that are remembered at most: of those long ago every other one is forgotten, again and again."""

LATEST: Final = 253_402_300_800.0
"""Seconds from 1970 to the end of the year 9999: of no later moment there is a date."""

_HEAD: Final = struct.Struct("<dI")
_MARK: Final = struct.Struct("<Q16s")


@dataclass(frozen=True, slots=True, kw_only=True)
class Commit:
    """How far a run was: ``moment`` (s since 1970), a mark for every column, and where its record lies.

    ``state``: place and length of the packed state in the journal; ``end``: where the record ends.
    """

    moment: float
    marks: Mapping[Name, Mark]
    state: tuple[int, int]
    end: int


@dataclass(slots=True, kw_only=True)
class History:
    """All that a journal tells. ``run`` is None where there is no journal, or none that tells of a run."""

    run: str | None = None
    columns: tuple[Name, ...] = ()
    commits: list[Commit] = field(default_factory=list)
    ending: Ending | None = None
    begun: int = 0

    @classmethod
    def read(cls, path: Path) -> Self:
        """Return what a journal tells, as far as it is whole.

        ``begun`` is where its first record ends. Raises RunFileRefused for one of another version, OSError where the
        disk fails.
        """
        history = cls()
        for frame in frames(path):
            if history.run is None and frame.kind != "run":
                break
            with _refusing(path):
                history._take(frame, path)
        return history

    def _take(self, frame: Frame, path: Path) -> None:
        if frame.kind == "run":
            told = json.loads(frame.content)
            if told["version"] != VERSION:
                raise RunFileRefused(f"{path}: has version {told['version']}; this rubnoise resumes version {VERSION}")
            self.run, self.columns, self.begun = told["run"], tuple(map(tuple, told["columns"])), frame.end
        elif frame.kind == "rows":
            self.commits.append(_unpacked(frame, self.columns))
            if len(self.commits) > MOST_COMMITS:
                del self.commits[: MOST_COMMITS // 2 : 2]
        else:
            self.ending = Ending.unpacked(frame.content)


def state_at(path: Path, commit: Commit) -> State:
    """Return the state of a run at a commit; raises RunFileRefused where it is none."""
    place, length = commit.state
    with open_stream(path) as stream, _refusing(path):
        stream.seek(place)
        return State.unpack(stream.read(length))


def identity(description: RunDescription) -> str:
    """Return what tells a run from any other: its scenario, seed and streams, its rows, and when it was started."""
    origin, extent = description.provenance, description.extent
    rows = (extent.junctions, extent.ticks, extent.blocks)
    told = [description.scenario_resolved, origin.seed, origin.stream_version, origin.started, rows]
    return xxhash.xxh3_128_hexdigest(json.dumps(told, sort_keys=True).encode())


def packed_run(description: RunDescription, columns: Sequence[Name]) -> bytes:
    """Return the content of a journal's first record."""
    told = {"version": VERSION, "run": identity(description), "columns": columns}
    return json.dumps(told).encode()


def packed_commit(marks: Sequence[Mark], state: State) -> bytes:
    """Return the content of a commit's record; the marks stand in the order of the columns in the first one."""
    told = b"".join(_MARK.pack(mark.rows, mark.digest) for mark in marks)
    return _HEAD.pack(time(), len(marks)) + told + state.pack()


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    """Say of a record that is whole and yet makes no sense, so that somebody else made it, where it is."""
    try:
        yield
    except (ValueError, KeyError, TypeError, struct.error) as problem:
        raise RunFileRefused(f"{path}: is no journal of rubnoise") from problem


def _unpacked(frame: Frame, columns: Sequence[Name]) -> Commit:
    moment, count = _HEAD.unpack_from(frame.content)
    if not 0.0 <= moment < LATEST:
        raise ValueError(f"a commit at {moment} s since 1970")
    told = _HEAD.size + count * _MARK.size
    marks = [Mark(rows=rows, digest=digest) for rows, digest in _MARK.iter_unpack(frame.content[_HEAD.size : told])]
    length = len(frame.content) - told
    return Commit(
        moment=moment,
        marks=dict(zip(columns, marks, strict=True)),
        state=(frame.end - length, length),
        end=frame.end,
    )

"""A disk that fails at each call in turn, or writes less than requested; and a small disk that fills up.

A failure gives one line, without a crash and without half a file; a short write changes nothing.
"""

import errno
import os
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any
from unittest.mock import patch

from rubnoise.storage import disk
from survival.child import MEMORY_BYTES, Child, Ending, command, isolated
from survival.moments import Stage, stages_of
from survival.recording import CHANGING, NAMING, OPENING
from survival.stories import (
    NAME,
    SCENARIO,
    SMALL,
    Outcome,
    Story,
    afterwards,
    chance,
    committing,
    contents,
    differences,
    judged,
    words,
)

READING = ("read_into",)
CALLS = (*OPENING, *CHANGING, *NAMING, *READING)
SHORT = ("preadv", "pwrite", "write")
"""Calls of the system that may do less than they are asked for; POSIX allows it, and network disks do it."""

FAILURES = (errno.ENOSPC, errno.EIO)
OLDER = b"a result of before"
TMPFS_BYTES = 20 * 1024**2
FILLING = (
    Story(name="filled", distance="40 mm", tick="0.5 um"),
    Story(name="filled, compressed", distance="20 mm", tick="0.5 um", compression="gzip"),
    Story(name="filled, two-way", kind="two-way", distance="40 mm", tick="0.5 um"),
)
"""Of 9 MB, of 5 MB beside which the compressed copy has to find its place, and one whose rows grow while it runs."""


class Counter:
    """Counts calls, and changes what one of them is given, or all from one on: by default the calls of the disk.

    A change takes the name of the call and what it is given, and returns what is given instead, or raises.
    """

    def __init__(self, change: Callable[..., Any], at: int | None = None, *, for_ever: bool = False) -> None:
        """Begin at no call; ``at``: the first call that is changed."""
        self.calls = 0
        self._change, self._at, self._for_ever = change, at, for_ever

    @contextmanager
    def counting(self, owner: ModuleType = disk, names: Sequence[str] = CALLS) -> Iterator[None]:
        """Count and change the calls of a module by these names in runs that commit often."""
        with committing(0.0), ExitStack() as patches:
            for name in names:
                patches.enter_context(patch.object(owner, name, self._counted(name, getattr(owner, name))))
            yield

    def _counted(self, name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def called(*given: Any) -> Any:
            call, self.calls = self.calls, self.calls + 1
            if self._at is not None and (call == self._at or (self._for_ever and call > self._at)):
                given = self._change(name, *given)
            return real(*given)

        return called


def _fail(number: int) -> Callable[..., Any]:
    def change(*_: Any) -> Any:
        raise OSError(number, os.strerror(number))

    return change


def _halve(name: str, descriptor: int, given: Any, *more: Any) -> tuple[Any, ...]:
    view = memoryview(given[0] if name == "preadv" else given).cast("B")
    half = view[: max(len(view) // 2, 1)]
    return descriptor, [half] if name == "preadv" else half, *more


def full(
    count: int,
    seed: int,
    stories: Sequence[Story] = SMALL,
    every: int = 1,
    calls: Sequence[int] | None = None,
    first: int = 0,
) -> Outcome:
    """Let each call fail in each way and be short, or each of some, and fill a disk so many times.

    ``first`` and ``every``: which calls, so that several processes can share them.
    """
    outcome = Outcome()
    for story in stories:
        begin = Stage(name="run", story=story, files={})
        for call in calls or range(first, calls_of(begin), every):
            for way in range(4):
                _failing(outcome, begin, call, FAILURES[way % 2], for_ever=way > 1)
        for stage in (begin, *stages_of(story)):
            for call in calls or range(first, calls_of(stage, os, SHORT), every):
                for for_ever in (False, True) if call % 8 == 0 else (False,):
                    _short(outcome, stage, call, for_ever=for_ever)
    try:
        with small_disk() as folder:
            for turn in range(count):
                _filling(outcome, folder, chance(seed, turn))
    except PermissionError:
        outcome.count("small disks: left out, only root may mount one")
    return outcome


@contextmanager
def small_disk() -> Iterator[Path]:
    """Yield a folder on a disk of 20 MB; raises PermissionError for who may not make one."""
    with TemporaryDirectory(prefix="rubnoise-") as name:
        made = ["mount", "-t", "tmpfs", "-o", f"size={TMPFS_BYTES}", "rubnoise", name]
        if os.geteuid() or subprocess.run(made, check=False, capture_output=True).returncode:
            raise PermissionError(name)
        try:
            yield Path(name)
        finally:
            subprocess.run(["umount", name], check=True)


def calls_of(stage: Stage, owner: ModuleType = disk, names: Sequence[str] = CALLS) -> int:
    """Return how many calls there are from a stage to the end."""
    counter = Counter(_halve)
    with stage.folder() as folder, counter.counting(owner, names):
        command(stage.words(), folder)
    return counter.calls


def _failing(outcome: Outcome, stage: Stage, call: int, number: int, *, for_ever: bool) -> None:
    """Let a call of a run fail, and those after it where it is ``for_ever``; half of the runs replace a result."""
    older, story = bool((call + for_ever) % 2), stage.story
    where = f"{story.name}, {errno.errorcode[number]} {'from' if for_ever else 'at'} call {call}"

    def task() -> int:
        with Counter(_fail(number), call, for_ever=for_ever).counting():
            return command([*stage.words(), *["--force"] * older], folder)

    with stage.folder({NAME: OLDER} if older else {}) as folder:
        ending = isolated(task)
        outcome.count(f"{errno.errorcode[number]}: exit code {ending.code}")
        outcome.find(where, _wrong(folder, story, ending, older=older))


def _short(outcome: Outcome, stage: Stage, call: int, *, for_ever: bool) -> None:
    """Let a call do half of what it is asked for: nothing may come of it."""

    def task() -> int:
        with Counter(_halve, call, for_ever=for_ever).counting(os, SHORT):
            return command(stage.words(), folder)

    with stage.folder() as folder:
        ending = isolated(task)
        outcome.count(f"short, {stage.name}: exit code {ending.code}")
        wrong = [f"{fault}: {ending.err}"] if (fault := ending.fault(0)) else []
        where = f"{stage.story.name}, {stage.name}, short {'from' if for_ever else 'at'} call {call}"
        outcome.find(where, wrong + judged(folder, stage.story))


def _wrong(folder: Path, story: Story, ending: Ending, *, older: bool = False) -> Iterator[str]:
    """Yield what is wrong about how a run ended that could not be written, and what becomes of it afterwards."""
    if fault := ending.fault(0, 1, 2):
        yield f"{fault}: {ending.err}"
    elif ending.code and (ending.err.count("\n") != 1 or ending.out):
        yield f"said {ending.out!r} and {ending.err!r}"
    path = folder / NAME
    if not path.exists():
        if older or ending.code == 0:
            yield "the result is gone"
    elif older and path.read_bytes() == OLDER:
        path.unlink()
    else:
        yield from differences(contents(path), story.expected)
    yield from afterwards(folder, story, again=False)


def _filling(outcome: Outcome, folder: Path, random: Random) -> None:
    """Let another program take all the space that is left, at some moment of a run."""
    story = random.choice(FILLING)
    for each in folder.iterdir():
        each.unlink()
    (folder / SCENARIO).write_text(story.text, encoding="utf-8")
    child = Child.begin(lambda _: command(words(story), folder), memory=MEMORY_BYTES)
    time.sleep(random.uniform(0.0, 1.5))
    _fill(folder / "other")
    ending = child.end()
    (folder / "other").unlink()
    outcome.count(f"filled up: exit code {ending.code}")
    outcome.find(f"filled up, {story.name}", _wrong(folder, story, ending))


def _fill(path: Path) -> None:
    with path.open("wb", buffering=0) as stream:
        for size in (1 << 20, 1 << 12):
            try:
                while True:
                    stream.write(bytes(size))
            except OSError:
                continue

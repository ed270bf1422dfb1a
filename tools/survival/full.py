"""A disk that fails at each call in turn, and a small disk that fills up: one sentence, and nothing is left."""

import errno
import os
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

from survival.child import MEMORY_BYTES, Child, Ending, command, isolated
from survival.stories import PART, SLIDER, SMALL, TWO_WAY, Outcome, Story, chance, interrupted

CALLS = ("open", "pwrite", "preadv", "ftruncate", "posix_fallocate", "fsync", "replace", "link", "unlink")
"""Every call of the system by which a result comes to the disk."""

FAILURES = (errno.ENOSPC, errno.EIO)
TMPFS_BYTES = 20 * 1024**2
FILLING = (
    Story(name="filled", sections=SLIDER, distance="25 mm", tick="0.5 um"),
    Story(name="filled, compressed", sections=SLIDER, distance="20 mm", tick="0.5 um", compression="gzip"),
    Story(name="filled, two-way", sections=TWO_WAY, distance="30 mm", tick="0.5 um"),
)
"""Runs of some megabytes; the rows of the last one grow, and those of the second wait beside their compressed copy."""


class Counter:
    """Counts the calls of the disk, and lets one of them fail, or all from one on."""

    def __init__(self, number: int = 0, at: int | None = None, *, for_ever: bool = False) -> None:
        """``at``: the first call that fails, with this number of an error."""
        self.names: list[str] = []
        self._number, self._at, self._for_ever = number, at, for_ever

    @contextmanager
    def counting(self) -> Iterator[None]:
        """Count the calls."""
        with ExitStack() as patches:
            for name in CALLS:
                patches.enter_context(patch.object(os, name, self._counted(name, getattr(os, name))))
            yield

    def _counted(self, name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def called(*given: Any, **named: Any) -> Any:
            if name == "open" and not (given[1] & os.O_RDWR and "rubnoise-" in str(given[0])):
                return real(*given, **named)  # of a file elsewhere, or to be read
            call = len(self.names)
            self.names.append(name)
            if self._at is not None and (call == self._at or (self._for_ever and call > self._at)):
                raise OSError(self._number, os.strerror(self._number))
            return real(*given, **named)

        return called


def calls_of(story: Story, *, older: bool) -> list[str]:
    """Return the names of the calls of a run, in their order."""
    counter = Counter()
    with TemporaryDirectory(prefix="rubnoise-") as folder:
        story.write(Path(folder), older=older)
        with counter.counting():
            command(story.words(*["--force"] * older), Path(folder))
    return counter.names


def failing(stories: Sequence[Story] = SMALL, every: int = 1, first: int = 0) -> Outcome:
    """Let each call of runs fail, once or from there on; half of the runs replace a result.

    ``first`` and ``every``: which calls, so that several processes can share them.
    """
    outcome = Outcome()
    for story in stories:
        for older in (False, True):
            names = calls_of(story, older=older)
            for call in range(first, len(names), every):
                number, for_ever = FAILURES[call % 2], bool((call // 2 + older) % 2)
                when = f"{'from' if for_ever else 'at'} {names[call]} {call}"
                where = f"{story.name}, {errno.errorcode[number]} {when}"
                with outcome.trial(where) as folder:
                    _fail(outcome, where, folder, story, Counter(number, call, for_ever=for_ever), older=older)
    return outcome


def _fail(outcome: Outcome, where: str, folder: Path, story: Story, counter: Counter, *, older: bool) -> None:
    story.write(folder, older=older)

    def task() -> int:
        with counter.counting():
            return command(story.words(*["--force"] * older), folder)

    ending = isolated(task)
    outcome.count(f"exit code {ending.code}")
    # A part stays where the disk does not let it be removed; the next run overwrites it.
    left = frozenset((PART,)) if " from " in where or " unlink " in where else frozenset[str]()
    outcome.find(where, [*_said(ending), *interrupted(folder, story, older=older, left=left)])


def _said(ending: Ending) -> Iterator[str]:
    """Yield what is wrong with what a run that could not be written said."""
    if fault := ending.fault(0, 1, 2):
        yield f"{fault}: {ending.err}"
    elif ending.code and (ending.err.count("\n") != 1 or ending.out):
        yield f"said {ending.out!r} and {ending.err!r}"


def filling(count: int, seed: int, stories: Sequence[Story] = FILLING) -> Outcome:
    """Fill a small disk so many times at some moment of a run; nothing is done for who may not mount one."""
    outcome = Outcome()
    try:
        with small_disk() as folder:
            for turn in range(count):
                _filled(outcome, folder, stories[turn % len(stories)], turn, seed)
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


def _filled(outcome: Outcome, folder: Path, story: Story, turn: int, seed: int) -> None:
    """Let another program take all the space that is left, at some moment of a run."""
    older, random = bool(turn // 3 % 2), chance(seed, turn)
    _ = story.expected
    for each in folder.iterdir():
        each.unlink()
    story.write(folder, older=older)
    child = Child.begin(lambda: command(story.words("--force"), folder), memory=MEMORY_BYTES)
    time.sleep(random.uniform(0.0, 0.6))
    _fill(folder / "other")
    ending = child.end()
    (folder / "other").unlink()
    outcome.count(f"filled up: exit code {ending.code}")
    outcome.find(f"{turn}: {story.name}", [*_said(ending), *interrupted(folder, story, older=older)])


def _fill(path: Path) -> None:
    with path.open("wb", buffering=0) as stream:
        for size in (1 << 20, 1 << 12):
            try:
                while True:
                    stream.write(bytes(size))
            except OSError:
                continue

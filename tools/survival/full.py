"""A disk that fails at each call in turn, or writes less than requested; and a small disk that fills up.

A failure gives one line, without a crash and without half a file; a short write changes nothing.
"""

import errno
import json
import os
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any
from unittest.mock import patch

from fuzz.isolated import Outcome as Ending
from fuzz.isolated import command, isolated

from rubnoise.storage import disk
from survival.child import Child, Tell, committing
from survival.moments import stages_of
from survival.recording import CHANGING, NAMING, OPENING
from survival.stories import NAME, SCENARIO, SMALL, Outcome, Story, chance, contents, differences, judged, words

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
        """Count and change the calls of a module by these names."""
        with ExitStack() as patches:
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
        for call in calls or range(first, calls_of(story), every):
            for way in range(4):
                _failing(outcome, story, call, FAILURES[way % 2], for_ever=way > 1)
        for start in starts_of(story):
            for call in calls or range(first, start.short_calls, every):
                for for_ever in (False, True) if call % 8 == 0 else (False,):
                    _short(outcome, start, call, for_ever=for_ever)
    try:
        with small_disk() as folder:
            for turn in range(count):
                _filling(outcome, folder, chance(seed, turn))
    except PermissionError:
        outcome.count("small disks: left out, only root may mount one")
    return outcome


@dataclass(frozen=True, kw_only=True)
class Start:
    """Where a run begins or resumes: the files that are there, and the command that does it."""

    name: str
    story: Story
    files: Mapping[str, bytes]
    words: Sequence[str]

    @cached_property
    def short_calls(self) -> int:
        """How many calls there are by which the system reads and writes."""
        counter = Counter(_halve)
        with self.folder() as folder, counter.counting(os, SHORT), committing(0.0):
            command(self.words, folder)
        return counter.calls

    @contextmanager
    def folder(self) -> Iterator[Path]:
        """Yield a folder with the files."""
        with TemporaryDirectory(prefix="rubnoise-") as name:
            for path, content in self.files.items():
                (Path(name) / path).write_bytes(content)
            yield Path(name)


def starts_of(story: Story) -> Iterator[Start]:
    """Yield a run from its beginning, and from each stage in which it may be left."""
    scenario = {SCENARIO: story.text.encode()}
    yield Start(name="run", story=story, files=scenario, words=words(story))
    for stage in stages_of(story):
        yield Start(name=stage.name, story=story, files={**scenario, **stage.files}, words=["resume", stage.part, "-q"])


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


def calls_of(story: Story) -> int:
    """Return how many calls a whole run makes."""
    counter = Counter(_fail(errno.EIO))
    with (
        TemporaryDirectory(prefix="rubnoise-") as name,
        counter.counting(),
        committing(0.0),
    ):
        (Path(name) / SCENARIO).write_text(story.text, encoding="utf-8")
        command(words(story), Path(name))
    return counter.calls


def _failing(outcome: Outcome, story: Story, call: int, number: int, *, for_ever: bool) -> None:
    older = bool((call + for_ever) % 2)
    where = f"{story.name}, {errno.errorcode[number]} {'from' if for_ever else 'at'} call {call}"
    counter = Counter(_fail(number), call, for_ever=for_ever)

    def task() -> int:
        with counter.counting(), committing(0.0):
            return command(words(story, *["--force"] * older), folder)

    with TemporaryDirectory(prefix="rubnoise-") as name:
        folder = Path(name)
        (folder / SCENARIO).write_text(story.text, encoding="utf-8")
        if older:
            (folder / NAME).write_bytes(OLDER)
        ending = isolated(task)
        outcome.count(f"{errno.errorcode[number]}: exit code {ending.code}")
        for wrong in (*_told(ending), *_kept(folder, story, ending, older=older), *_afterwards(folder, story)):
            outcome.find(f"{where}: {wrong}")


def _short(outcome: Outcome, start: Start, call: int, *, for_ever: bool) -> None:
    """Let a call do half of what it is asked for: nothing may come of it."""
    where = f"{start.story.name}, {start.name}, short {'from' if for_ever else 'at'} call {call}"

    def task() -> int:
        with Counter(_halve, call, for_ever=for_ever).counting(os, SHORT), committing(0.0):
            return command(start.words, folder)

    with start.folder() as folder:
        ending = isolated(task)
        outcome.count(f"short, {start.name}: exit code {ending.code}")
        if fault := ending.fault(0):
            outcome.find(f"{where}: {fault}: {ending.err}")
        for wrong in judged(folder, start.story, others=SCENARIO.__eq__):
            outcome.find(f"{where}: {wrong}")


def _told(ending: Ending) -> Iterator[str]:
    """Yield what is wrong about how a run ended that could not be written."""
    if fault := ending.fault(0, 1, 2):
        yield f"{fault}: {ending.err}"
    elif ending.code and (ending.err.count("\n") != 1 or ending.out):
        yield f"said {ending.out!r} and {ending.err!r}"


def _kept(folder: Path, story: Story, ending: Ending, *, older: bool) -> Iterator[str]:
    """Yield what is wrong with what bears the final name."""
    if not (folder / NAME).exists():
        if older or ending.code == 0:
            yield "the result is gone"
    elif not older or (folder / NAME).read_bytes() != OLDER:
        yield from differences(contents(folder / NAME), story.expected)


def _afterwards(folder: Path, story: Story) -> Iterator[str]:
    """Yield what is wrong where the disk works again."""
    path = folder / NAME
    if path.exists() and path.read_bytes() == OLDER:
        path.unlink()
    if path.exists() and (folder / f"{NAME}.part").exists():
        ending = isolated(lambda: command(["resume", f"{NAME}.part", "-q"], folder))
    elif path.exists():
        return
    else:
        ending = isolated(lambda: command(words(story), folder))
    if ending.code:
        yield f"afterwards exit code {ending.code}: {ending.err}"
    yield from judged(folder, story, others=(SCENARIO, f".{NAME}.lock", f".{NAME}.making").__contains__)


def _filling(outcome: Outcome, folder: Path, random: Random) -> None:
    """Let another program take all the space that is left, at some moment of a run."""
    story = random.choice(FILLING)
    for each in folder.iterdir():
        each.unlink()
    (folder / SCENARIO).write_text(story.text, encoding="utf-8")
    child = Child.begin(lambda tell: _tell(isolated(lambda: command(words(story), folder)), tell))
    child.wait_for("never", random.uniform(0.0, 1.5))
    _fill(folder / "other")
    child.end()
    (folder / "other").unlink()
    ending = Ending(**json.loads(child.told[-1]))
    outcome.count(f"filled up: exit code {ending.code}")
    for wrong in (*_told(ending), *_kept(folder, story, ending, older=False), *_afterwards(folder, story)):
        outcome.find(f"filled up, {story.name}: {wrong}")


def _tell(ending: Ending, tell: Tell) -> None:
    tell(json.dumps(asdict(ending)))


def _fill(path: Path) -> None:
    with path.open("wb", buffering=0) as stream:
        for size in (1 << 20, 1 << 12):
            try:
                while True:
                    stream.write(bytes(size))
            except OSError:
                continue

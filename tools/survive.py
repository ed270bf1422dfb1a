"""Runs interrupted: `python tools/survive.py kills`, say, by the interpreter of dev.py's .venv.

kills: SIGKILL at random moments; rivals: a second writer; failing: each call of the system that makes a result fails in
turn; filling: a small disk fills up. Prints counts, and a line for each thing that was lost or wrong; exit code 1 where
there is any.
"""

import argparse
import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, Final
from unittest.mock import patch

import h5py
import xxhash
from child import SECONDS, Child, Ending, command

NAME: Final = "x.h5"
PART: Final = f"{NAME}.part"
SCENARIO: Final = "x.toml"
OLDER: Final = b"a result of before"

SLIDER: Final = {
    "strength": {"mean": "250 MPa"},
    "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
}
TWO_WAY: Final = SLIDER | {"slider": SLIDER["slider"] | {"coupling": "two-way"}}
FREE: Final = {
    "interface": {"load": "0.05 N", "hardness": "1 GPa", "mean_junction_count": 0.5},
    "strength": {"mean": "250 MPa"},
    "load": {"height_scale": "5 um", "mass": "5 g", "motion": "free", "restitution": 0.7},
}
ORIGIN: Final = ("scenario_toml", "seed", "stream_version", "propagator_constants")
"""Attributes of /provenance that do not depend on when and where a run was made."""


@dataclass(kw_only=True)
class Outcome:
    """Counts of what happened, and a line for each thing that was lost or wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def find(self, where: str, wrong: Iterable[str]) -> None:
        """Keep what should not be, and print it at once."""
        for what in wrong:
            print(f"{where}: {what}", file=sys.stderr, flush=True)
            self.findings.append(f"{where}: {what}")

    def told(self) -> str:
        """Return all of it as text, most of it counts."""
        width = max(map(len, self.counts), default=0)
        rows = [f"{what:<{width}}  {number:>8,}" for what, number in self.counts.items()]
        return "\n".join([*rows, *(f"- {finding}" for finding in self.findings), f"{len(self.findings)} found"])


@dataclass(frozen=True, kw_only=True)
class Story:
    """A run, by the sections that its scenario has beside those of the contact."""

    name: str
    sections: Mapping[str, Any] = field(default_factory=dict, hash=False)
    engine: str = "batch"
    speed: str = "1 mm/s"
    distance: str = "1500 um"
    tick: str = "2 um"
    compression: str = "none"

    @property
    def text(self) -> str:
        """The scenario as a file."""
        sections = {
            "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
            **self.sections,
            "sliding": {"distance": self.distance, "speed": self.speed},
            "output": {"tick": self.tick, "compression": self.compression},
            "run": {"engine": self.engine},
        }
        lines = ["format = 1", f"title = {json.dumps(self.name)}"]
        for name, keys in sections.items():
            lines += [f"[{name}]", *(f"{key} = {json.dumps(each)}" for key, each in keys.items())]
        return "\n".join(lines) + "\n"

    @cached_property
    def expected(self) -> dict[str, str]:
        """The content of its result if nothing stops the run, which is made here."""
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            self.write(Path(folder))
            if code := command(self.words(), Path(folder)):
                raise RuntimeError(f"{self.name}: exit code {code}")
            return contents(Path(folder) / NAME)

    def seconds(self) -> float:
        """Return how long a run takes here and now; what is expected of it is made before."""
        _ = self.expected
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            self.write(Path(folder))
            return self.begin(Path(folder)).end().seconds

    def write(self, folder: Path, *, older: bool = False) -> None:
        """Put its scenario into a folder, with a result of before if asked for."""
        (folder / SCENARIO).write_text(self.text, encoding="utf-8")
        if older:
            (folder / NAME).write_bytes(OLDER)

    def words(self, *more: str) -> list[str]:
        """Return the words of the command that makes it."""
        return ["run", SCENARIO, "-o", NAME, "-q", *more]

    def begin(self, folder: Path, *more: str) -> Child:
        """Start it in a copy of this process."""
        return Child(lambda: command(self.words(*more), folder))


SMALL: Final = (
    Story(name="events with slider", sections=SLIDER, engine="events"),
    Story(name="contact alone, compressed", compression="gzip"),
    Story(name="two-way", sections=TWO_WAY, distance="600 um"),
    Story(name="free, compressed", sections=FREE, speed="1 m/s", distance="2 mm", tick="20 um", compression="gzip"),
)
"""Runs of few calls; the rows of the last two grow."""

LONG: Final = (
    Story(name="events with slider", sections=SLIDER, engine="events", distance="20 mm", tick="1 um"),
    Story(name="batch with slider", sections=SLIDER, distance="100 mm", tick="0.5 um"),
    Story(name="compressed", compression="gzip", distance="60 mm", tick="1 um"),
    Story(name="two-way", sections=TWO_WAY, distance="20 mm", tick="1 um"),
)
"""Runs that take half a second."""

FILLING: Final = (
    Story(name="filled", sections=SLIDER, distance="25 mm", tick="0.5 um"),
    Story(name="filled, compressed", sections=SLIDER, distance="20 mm", tick="0.5 um", compression="gzip"),
    Story(name="filled, two-way", sections=TWO_WAY, distance="30 mm", tick="0.5 um"),
)
"""Runs of some megabytes; the rows of the last one grow, and those of the second wait beside their compressed copy."""


def chance(seed: int, trial: object) -> Random:
    """Return what decides by chance in one trial, the same ever again."""
    return Random(f"{seed}/{trial}")  # noqa: S311  (no secret)


def contents(path: Path) -> dict[str, str]:
    """Return the hash of each column, and the summary and where the run comes from as texts, read with h5py alone."""
    with h5py.File(path, "r") as file:
        names = [f"{group}/{column}" for group in file for column in file[group]]
        found = {name: xxhash.xxh3_128_hexdigest(file[name][:].tobytes()) for name in names}
        found |= {f"hash of {name}": file[name].attrs["xxh3_128"].decode() for name in names}
        found |= {name: repr(value) for name, value in file["summary"].attrs.items()}
        found |= {name: str(file["provenance"].attrs[name]) for name in ORIGIN}
    return found


def wrong_in(path: Path, story: Story) -> list[str]:
    """Return what is wrong with a result: the names under which it differs, or why it cannot be read."""
    expected = story.expected
    try:
        there = contents(path)
    except (OSError, KeyError, ValueError, RuntimeError) as problem:
        return [f"unreadable: {problem}"]
    return sorted(name for name in {*there, *expected} if there.get(name) != expected.get(name))


def interrupted(folder: Path, story: Story, *, older: bool, left: Sequence[str] = ()) -> Iterator[str]:
    """Yield what is wrong in a folder in which a run was interrupted, and with the same command after that.

    The final name leads to the file of before, to a complete result, or to none; only names in ``left`` may lie beside.
    """
    path = folder / NAME
    beside = {entry.name for entry in folder.iterdir()} - {NAME, SCENARIO, *left}
    yield from (f"{name} is left" for name in sorted(beside))
    untouched = older and path.exists() and path.read_bytes() == OLDER
    if older and not path.exists():
        yield "the older result is gone"
    if path.exists() and not untouched:
        yield from (f"under the final name: {wrong}" for wrong in wrong_in(path, story))
    if code := command(story.words("--force"), folder):
        yield f"the same command again: exit code {code}"
    yield from (f"made again: {wrong}" for wrong in wrong_in(path, story))
    yield from (
        f"{each.name} is left beside a result" for each in folder.iterdir() if each.name not in {NAME, SCENARIO}
    )


def kills(count: int, seed: int, stories: Sequence[Story] = LONG) -> Outcome:
    """Kill runs so many times, half of them runs that replace a result."""
    outcome, seconds = Outcome(), [story.seconds() for story in stories]
    for turn in range(count):
        number, older = turn % len(stories), bool(turn // len(stories) % 2)
        story = stories[number]
        with TemporaryDirectory(prefix="rubnoise-") as name:
            folder = Path(name)
            story.write(folder, older=older)
            child = story.begin(folder, "--force")
            time.sleep(chance(seed, turn).uniform(0.0, 1.1) * seconds[number])
            os.kill(child.number, signal.SIGKILL)
            outcome.counts[f"exit code {child.end().code}"] += 1
            outcome.counts["left a part" if (folder / PART).exists() else "left no part"] += 1
            outcome.find(f"kill {turn} of {story.name}", interrupted(folder, story, older=older, left=(PART,)))
    return outcome


def rivals(count: int, seed: int, stories: Sequence[Story] = LONG) -> Outcome:
    """Start the same run so many times while another process writes it: one makes it, the other is refused."""
    outcome = Outcome()
    for turn in range(count):
        story = stories[turn % len(stories)]
        with TemporaryDirectory(prefix="rubnoise-") as name:
            folder = Path(name)
            story.write(folder)
            first, deadline = story.begin(folder), time.monotonic() + SECONDS
            while not (folder / PART).exists() and time.monotonic() < deadline:
                time.sleep(0.001)
            time.sleep(chance(seed, turn).uniform(0.005, 0.02))  # in which it locks its part
            os.kill(first.number, signal.SIGSTOP)  # or it might end before the second begins
            second = story.begin(folder, *["--force"] * (turn % 2)).end()
            os.kill(first.number, signal.SIGCONT)
            refused = second.code == 2 and second.err == f"{folder / NAME}: another process is writing it\n"
            outcome.counts["second refused" if refused else "second came late"] += 1
            wrong = [
                f"the {who}: {fault}"
                for who, each in (("first", first.end()), ("second", second))
                if (fault := each.fault(0, *[2] * (who == "second")))
            ]
            wrong += ["a part is left"] * (folder / PART).exists()
            outcome.find(f"rival {turn} of {story.name}", [*wrong, *wrong_in(folder / NAME, story)])
    return outcome


CALLS: Final = ("open", "pwrite", "preadv", "ftruncate", "posix_fallocate", "fsync", "replace", "link", "unlink")
"""Every call of the system by which a result comes to the disk."""

FAILURES: Final = (errno.ENOSPC, errno.EIO)


@dataclass
class Disk:
    """Notes the calls of the disk, and lets the one ``at`` a number fail, or all from it on."""

    number: int = 0
    at: int | None = None
    for_ever: bool = False
    names: list[str] = field(default_factory=list)

    @contextmanager
    def counting(self) -> Iterator[None]:
        """Stand between the program and its calls."""
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
            if self.at is not None and (call == self.at or (self.for_ever and call > self.at)):
                raise OSError(self.number, os.strerror(self.number))
            return real(*given, **named)

        return called

    def run(self, story: Story, folder: Path, *, older: bool) -> int:
        """Make a run by these calls."""
        with self.counting():
            return command(story.words(*["--force"] * older), folder)


def calls_of(story: Story, *, older: bool) -> list[str]:
    """Return the names of the calls of a run, in their order."""
    disk = Disk()
    with TemporaryDirectory(prefix="rubnoise-") as folder:
        story.write(Path(folder), older=older)
        disk.run(story, Path(folder), older=older)
    return disk.names


def failing(stories: Sequence[Story] = SMALL, every: int = 1, first: int = 0) -> Outcome:
    """Let each call of runs fail, or only some from the first on, once or from there on; half replace a result."""
    outcome = Outcome()
    for story, older in ((story, older) for story in stories for older in (False, True)):
        names = calls_of(story, older=older)
        for call in range(first, len(names), every):
            disk = Disk(FAILURES[call % 2], call, for_ever=bool((call // 2 + older) % 2))
            with TemporaryDirectory(prefix="rubnoise-") as name:
                folder = Path(name)
                story.write(folder, older=older)
                ending = Child(partial(disk.run, story, folder, older=older)).end()
                outcome.counts[f"exit code {ending.code}"] += 1
                # A part stays where the disk does not let it be removed; the next run overwrites it.
                left = (PART,) if disk.for_ever or names[call] == "unlink" else ()
                wrong = [*_said(ending), *interrupted(folder, story, older=older, left=left)]
                where = f"{'from' if disk.for_ever else 'at'} {names[call]} {call}"
                outcome.find(f"{story.name}, {errno.errorcode[disk.number]} {where}", wrong)
    return outcome


def _said(ending: Ending) -> Iterator[str]:
    """Yield what is wrong with what a run that could not be written said."""
    if fault := ending.fault(0, 1, 2):
        yield f"{fault}: {ending.err}"
    elif ending.code and (ending.err.count("\n") != 1 or ending.out):
        yield f"said {ending.out!r} and {ending.err!r}"


def filling(count: int, seed: int, stories: Sequence[Story] = FILLING) -> Outcome:
    """Fill a disk of 20 MB so many times at some moment of a run; nothing is done for who may not mount one."""
    outcome = Outcome()
    with TemporaryDirectory(prefix="rubnoise-") as name:
        made = ["mount", "-t", "tmpfs", "-o", "size=20m", "rubnoise", name]
        if os.geteuid() or subprocess.run(made, check=False, capture_output=True).returncode:
            outcome.counts["small disks: left out, only root may mount one"] += 1
            return outcome
        try:
            for turn in range(count):
                _fill_up(outcome, Path(name), stories[turn % len(stories)], turn, chance(seed, turn).uniform(0.0, 0.6))
        finally:
            subprocess.run(["umount", name], check=True)
    return outcome


def _fill_up(outcome: Outcome, folder: Path, story: Story, turn: int, moment: float) -> None:
    """Let another program take all the space that is left, some seconds after a run has begun."""
    older, other, _ = bool(turn // 3 % 2), folder / "other", story.expected
    for each in folder.iterdir():
        each.unlink()
    story.write(folder, older=older)
    child = story.begin(folder, "--force")
    time.sleep(moment)
    with other.open("wb", buffering=0) as stream:
        for size in (1 << 20, 1 << 12):
            try:
                while True:
                    stream.write(bytes(size))
            except OSError:
                continue
    ending = child.end()
    other.unlink()
    outcome.counts[f"filled up: exit code {ending.code}"] += 1
    outcome.find(f"{turn}: {story.name}", [*_said(ending), *interrupted(folder, story, older=older)])


def main() -> int:
    """Do what is asked and print what came of it; return the exit code."""
    trials = {"kills": (kills, 1000), "rivals": (rivals, 100), "filling": (filling, 100)}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=[*trials, "failing"], help="what is done to the runs")
    parser.add_argument("--count", type=int, help="how often; as often as docs/survival.md tells by default")
    parser.add_argument("--seed", type=int, default=1, help="seed of every choice (1)")
    asked = parser.parse_args()
    if asked.what == "failing":
        outcome = failing()
    else:
        trial, count = trials[asked.what]
        outcome = trial(asked.count or count, asked.seed)
    print(outcome.told())
    return int(bool(outcome.findings))


if __name__ == "__main__":
    sys.exit(main())

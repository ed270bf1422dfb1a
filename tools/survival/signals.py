"""SIGINT and SIGTERM at random moments: the right exit code, soon, in one line, and the same bits in the end."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from fuzz.isolated import isolated

from survival.child import Child, Tell, telling
from survival.command import command
from survival.finding import Outcome
from survival.full import SCENARIO, words
from survival.kills import BETWEEN_COMMITS, LEFT, Pace
from survival.stories import NAME, SHORT, Story, chance, judged

SIGNALS = (signal.SIGINT, signal.SIGTERM)
SECOND_OF = 5
"""Every so many get the signal twice."""

PROCESSES_OF = 10
"""Every so many are processes of their own, which load all that a run needs."""

SAID = "said"
LEFT_HERE = LEFT | {SCENARIO}
CPU_SECONDS = 1.0
CLOCK_TICKS = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """How a run took its signals: exit code, what it said, seconds by the clock and by the processor until its end."""

    code: int
    said: str
    wall: float
    cpu: float


def signals(count: int, seed: int, stories: tuple[Story, ...] = SHORT) -> Outcome:
    """Send each of the two signals so many times."""
    outcome, stops = Outcome(), []
    paces = {story: (story.expected, Pace.of(story))[1] for story in stories}
    for turn in range(2 * count):
        random = chance(seed, turn)
        story, number = stories[turn // 2 % len(stories)], SIGNALS[turn % 2]
        twice, alone = turn // 2 % SECOND_OF == 1, turn // 2 % PROCESSES_OF == 0
        delay = random.uniform(0.0, 1.1 * paces[story].ended + (_start_seconds() if alone else 0.0))
        with TemporaryDirectory(prefix="rubnoise-") as name:
            stop = _stopped(story, Path(name), delay, number, twice=twice, alone=alone)
            stops.append(stop)
            outcome.count(f"{number.name}{' twice' if twice else ''}: {_end(stop)}")
            for wrong in (*_wrong(stop, Path(name), number), *_afterwards(story, Path(name))):
                kind = f"{number.name}{' twice' if twice else ''}{' to a process' if alone else ''}"
                outcome.find(f"{turn}: {story.name}, {kind} after {delay:.2f} s: {wrong}")
    for what, values in (("wall", [stop.wall for stop in stops]), ("cpu", [stop.cpu for stop in stops])):
        for share in (50, 95, 100):
            value = sorted(values)[max(0, len(values) * share // 100 - 1)]
            outcome.count(f"ms of {what} time until the end, {share} % of them within", round(1000 * value))
    return outcome


def _stopped(story: Story, folder: Path, delay: float, number: int, *, twice: bool, alone: bool) -> Stop:
    """Start a run and send it signals after a while."""
    (folder / SCENARIO).write_text(story.text, encoding="utf-8")
    child = Child.begin(lambda tell: _run(story, folder, tell, alone=alone))
    time.sleep(delay)
    sent, spent = time.monotonic(), _spent(child.number)
    child.send(number)
    if twice:
        time.sleep(0.002)
        child.send(number)
    code = child.end()
    ended = time.monotonic()
    said = (folder / SAID).read_text(encoding="utf-8") if (folder / SAID).exists() else ""
    (folder / SAID).unlink(missing_ok=True)
    return Stop(code=code, said=said, wall=ended - sent, cpu=max(0.0, child.cpu - spent))


def _run(story: Story, folder: Path, tell: Tell, *, alone: bool) -> int:
    """Be the run: as this copy, or in a process that has yet to load everything."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which what a shell runs behind a & is without
    said = os.open(folder / SAID, os.O_WRONLY | os.O_CREAT)
    for stream in (1, 2):
        os.dup2(said, stream)
    if alone:
        os.chdir(folder)
        os.execv(sys.executable, [sys.executable, "-m", "rubnoise", *words(story)])
    # Where Python's streams were replaced, as pytest does, they would not hear of it.
    with (
        os.fdopen(1, "w", closefd=False) as sys.stdout,
        os.fdopen(2, "w", closefd=False) as sys.stderr,
        telling(tell, seconds=BETWEEN_COMMITS),
    ):
        return command(words(story), folder)


def _end(stop: Stop) -> str:
    """Return how a run ended, in words."""
    if stop.code == 0:
        return "was whole before"
    if "continues it" in stop.said:
        return f"exit code {stop.code}, and it can go on"
    return f"exit code {stop.code}, nothing kept" if stop.code > 0 else f"left by {signal.Signals(-stop.code).name}"


def _wrong(stop: Stop, folder: Path, number: int) -> Iterator[str]:
    """Yield what is wrong about how a run took a signal; one that has not begun yet is ended by the signal itself."""
    if stop.code not in {0, 128 + number, -number}:
        yield f"exit code {stop.code}, {stop.said}"
    elif stop.code >= 0 and ("Traceback" in stop.said or stop.said.count("\n") > 1):
        yield f"said {stop.said}"
    if stop.cpu > CPU_SECONDS:
        yield f"worked for {stop.cpu:.2f} s more"
    parts = (folder / f"{NAME}.part").exists()
    if ("continues it" in stop.said and not parts) or ("nothing was kept" in stop.said and parts):
        yield f"{'a' if parts else 'no'} part is there, and it said {stop.said}"


def _afterwards(story: Story, folder: Path) -> Iterator[str]:
    """Resume the run that is there, and yield what is wrong."""
    if (folder / f"{NAME}.part").exists():
        ending = isolated(lambda: command(["resume", f"{NAME}.part", "-q"], folder))
    elif not (folder / NAME).exists():
        ending = isolated(lambda: command(words(story), folder))
    else:
        ending = None
    if ending is not None and ending.code:
        yield f"afterwards exit code {ending.code}: {ending.err}"
    yield from judged(folder, story, others=LEFT_HERE.__contains__)


def _spent(number: int) -> float:
    """Return the processor's time in s that a process and its ended children have taken."""
    fields = Path(f"/proc/{number}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / CLOCK_TICKS


@cache
def _start_seconds() -> float:
    """Return how long a process needs until it has loaded what a run needs, here and now."""
    began = time.monotonic()
    subprocess.run([sys.executable, "-c", "import rubnoise.api.running"], check=True)
    return time.monotonic() - began

"""SIGKILL, SIGINT and SIGTERM at random moments: no commit is lost, what has its name is whole, the bits are the same.

A signal that can be caught gives the right exit code, soon, and one line.
"""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from rubnoise.storage.output import OutputPaths
from survival.child import Child, Ending, Tell, command
from survival.stories import (
    LONG,
    NAME,
    SCENARIO,
    SHORT,
    Outcome,
    Story,
    afterwards,
    chance,
    make,
    telling,
    words,
    wrong_in,
)

BETWEEN_COMMITS = 0.02
"""Seconds, a fiftieth of what users have, so that there are many to lose."""

AIMS = ("course", "course", "course", "set-up", "publication")
PATIENCE = 600.0


@dataclass(kw_only=True)
class Pace:
    """Seconds until a run has been set up, until it is published and until it has ended, here and now."""

    ready: float
    publishing: float
    ended: float

    @classmethod
    def of(cls, story: Story) -> "Pace":
        """Measure a run that nothing stops; what is expected of it is made before."""
        _ = story.expected
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            child = Child.begin(
                partial(make, story.scenario, Path(folder) / NAME, again=False, seconds=BETWEEN_COMMITS)
            )
            child.wait_for("entered", PATIENCE)
            ready = time.monotonic() - child.began
            child.wait_for("publishing", PATIENCE)
            publishing = time.monotonic() - child.began
            ending = child.end()
        if ending.code:
            raise RuntimeError(f"{story.name}: {child.told[-1]}")
        return cls(ready=ready, publishing=publishing, ended=ending.seconds)


@dataclass(kw_only=True)
class KilledRun:
    """One run from its start to its end, killed on the way again and again."""

    story: Story
    folder: Path
    random: Random
    pace: Pace
    outcome: Outcome
    most: int
    kills: int = 0
    committed: int = 0
    history: list[str] = field(default_factory=list)

    @property
    def path(self) -> Path:
        """The final name."""
        return self.folder / NAME

    def go(self) -> None:
        """Kill the run until it is whole, or has been killed often enough and may end."""
        while not self.path.exists():
            ended = self._once()
            self._look()
            if ended and not self.path.exists():
                return
        for wrong in afterwards(self.folder, self.story, again=True):  # a second name of the result goes
            self._find(wrong)
        self.outcome.count("runs")

    def _once(self) -> bool:
        """Let it run and kill it; return whether it ended by itself."""
        aim = self.random.choice(AIMS) if self.kills < self.most else "none"
        again = self.random.random() < 0.5
        engine = self.random.choice(("events", "batch")) if self.random.random() < 0.3 else self.story.engine
        task = partial(make, self.story.by(engine), self.path, again=again, seconds=BETWEEN_COMMITS)
        child = Child.begin(task)
        if aim != "none":
            time.sleep(self._delay(child, aim))
            child.send(signal.SIGKILL)
        ending = child.end()
        code = ending.code
        self.history.append(f"{aim} {'resume' if again else 'run'} {engine} {child.told[-1:]}")
        self._compare(child)
        if ending.hung:
            self._find("hangs")
        if code == -signal.SIGKILL:
            self.kills += 1
            self.outcome.count(f"killed, aiming at {aim}")
            self.outcome.count(f"killed after it reported {child.told[-1].split()[0] if child.told else 'nothing'}")
        elif code:
            self._find(child.told[-1] if child.told else f"exit code {code}")
        return code != -signal.SIGKILL

    def _delay(self, child: Child, aim: str) -> float:
        """Return the seconds from now until the kill."""
        if aim == "publication":
            child.wait_for("publishing", PATIENCE)
            return self.random.uniform(0.0, 1.2 * (self.pace.ended - self.pace.publishing))
        if aim == "set-up":
            return self.random.uniform(0.0, 1.5 * self.pace.ready)
        child.wait_for("entered", PATIENCE)
        return self.random.uniform(0.0, (1.0 - self.committed / self.ticks) * (self.pace.publishing - self.pace.ready))

    @property
    def ticks(self) -> int:
        """How many ticks the whole run has."""
        return self.story.scenario.model().tick_count + 1

    def _compare(self, child: Child) -> None:
        """Compare where it resumed with what had been committed."""
        entered = child.last("entered")
        if 0 <= entered < self.committed:
            self._find(f"{self.committed} ticks had been committed, and it continued from {entered}")
        self.outcome.count("commits", sum(line.startswith("committed") for line in child.told))
        self.committed = max(self.committed, child.last("committed"))

    def _look(self) -> None:
        """Look at what the kill left."""
        paths = OutputPaths.of(self.path)
        if paths.final.exists():
            if wrong := wrong_in(paths.final, self.story.expected):
                self._find(f"under the final name: {wrong}")
        elif self.committed and not paths.part.exists():
            self._find("what was committed is gone")

    def _find(self, what: str) -> None:
        self.outcome.find(self.story.name, [f"{what}; {'; '.join(self.history[-3:])}"])


def kills(count: int, seed: int, stories: tuple[Story, ...] = LONG) -> Outcome:
    """Kill runs so many times, about twenty times each."""
    outcome = Outcome()
    paces = {story: Pace.of(story) for story in stories}
    turn = 0
    while outcome.counts["kills"] < count:
        story = stories[turn % len(stories)]
        with TemporaryDirectory(prefix="rubnoise-kills-") as folder:
            killed = KilledRun(
                story=story,
                folder=Path(folder),
                random=chance(seed, turn),
                pace=paces[story],
                outcome=outcome,
                most=min(20, count - outcome.counts["kills"]),
            )
            killed.go()
            outcome.count("kills", killed.kills)
        turn += 1
    return outcome


SIGNALS = (signal.SIGINT, signal.SIGTERM)
SECOND_OF = 5
"""Every so many get the signal twice."""

PROCESSES_OF = 10
"""Every so many are processes of their own, which load all that a run needs."""

CPU_SECONDS = 1.0
CLOCK_TICKS = os.sysconf("SC_CLK_TCK")


def signals(count: int, seed: int, stories: tuple[Story, ...] = SHORT) -> Outcome:
    """Send each of the two signals so many times."""
    outcome = Outcome()
    taken: dict[str, list[float]] = {"wall": [], "cpu": []}
    paces = {story: Pace.of(story) for story in stories}
    for turn in range(2 * count):
        random = chance(seed, turn)
        story, number = stories[turn // 2 % len(stories)], SIGNALS[turn % 2]
        twice, alone = turn // 2 % SECOND_OF == 1, turn // 2 % PROCESSES_OF == 0
        delay = random.uniform(0.0, 1.1 * paces[story].ended + (_start_seconds() if alone else 0.0))
        kind = f"{number.name}{' twice' if twice else ''}"
        where = f"{turn}: {story.name}, {kind}{' to a process' if alone else ''} after {delay:.2f} s"
        with outcome.trial(where) as folder:
            ending, wall, cpu = _stopped(story, folder, delay, number, twice=twice, alone=alone)
            taken["wall"].append(wall)
            taken["cpu"].append(cpu)
            outcome.count(f"{kind}: {_end(ending)}")
            outcome.find(where, _wrong(ending, cpu, folder, number))
            outcome.find(where, afterwards(folder, story, again=True))
    for what, values in taken.items():
        for share in (50, 95, 100):
            value = sorted(values)[max(0, len(values) * share // 100 - 1)]
            outcome.count(f"ms of {what} time until the end, {share} % of them within", round(1000 * value))
    return outcome


def _stopped(
    story: Story, folder: Path, delay: float, number: int, *, twice: bool, alone: bool
) -> tuple[Ending, float, float]:
    """Start a run and send it signals after a while; return its ending, and seconds by clock and processor until it."""
    (folder / SCENARIO).write_text(story.text, encoding="utf-8")
    child = Child.begin(lambda tell: _run(story, folder, tell, alone=alone))
    time.sleep(delay)
    sent, spent = time.monotonic(), _spent(child.number)
    child.send(number)
    if twice:
        time.sleep(0.002)
        child.send(number)
    ending = child.end()
    return ending, child.began + ending.seconds - sent, max(0.0, ending.cpu - spent)


def _run(story: Story, folder: Path, tell: Tell, *, alone: bool) -> int:
    """Be the run: as this copy, or in a process that has yet to load everything."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which what a shell runs behind a & is without
    if alone:
        os.chdir(folder)
        os.execv(sys.executable, [sys.executable, "-m", "rubnoise", *words(story)])
    with telling(tell, seconds=BETWEEN_COMMITS):
        return command(words(story), folder)


def _end(ending: Ending) -> str:
    """Return how a run ended, in words."""
    if ending.code == 0:
        return "was whole before"
    if "continues it" in ending.err:
        return f"exit code {ending.code}, and it can go on"
    return (
        f"exit code {ending.code}, nothing kept" if ending.code > 0 else f"left by {signal.Signals(-ending.code).name}"
    )


def _wrong(ending: Ending, cpu: float, folder: Path, number: int) -> Iterator[str]:
    """Yield what is wrong about how a run took a signal; one that has not begun yet is ended by the signal itself."""
    said = ending.out + ending.err
    if ending.code not in {0, 128 + number, -number}:
        yield f"exit code {ending.code}, {said}"
    elif ending.code >= 0 and ("Traceback" in said or said.count("\n") > 1):
        yield f"said {said}"
    if cpu > CPU_SECONDS:
        yield f"worked for {cpu:.2f} s more"
    parts = (folder / f"{NAME}.part").exists()
    if ("continues it" in said and not parts) or ("nothing was kept" in said and parts):
        yield f"{'a' if parts else 'no'} part is there, and it said {said}"


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

"""SIGKILL at random moments: a result that has its name is whole, no commit is lost, and the bits are the same."""

import shutil
import signal
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from random import Random
from tempfile import mkdtemp

import rubnoise
from rubnoise.scenario import Scenario
from rubnoise.storage.output import OutputPaths
from survival.child import Child, Tell, telling
from survival.finding import Outcome
from survival.stories import LONG, NAME, Story, chance, contents, differences, judged

BETWEEN_COMMITS = 0.02
"""Seconds, a fiftieth of what users have, so that there are many to lose."""

AIMS = ("course", "course", "course", "set-up", "publication")
PATIENCE = 600.0
LEFT = frozenset(f".{NAME}.{name}" for name in ("lock", "making"))
"""What a kill may leave beside a whole result, and the next run with this name removes."""


@dataclass(kw_only=True)
class Pace:
    """Seconds until a run has been set up, until it is published and until it has ended, here and now."""

    ready: float
    publishing: float
    ended: float

    @classmethod
    def of(cls, story: Story) -> "Pace":
        """Measure a run that nothing stops."""
        folder = Path(mkdtemp(prefix="rubnoise-"))
        child = Child.begin(partial(make, story.scenario, folder / NAME, again=False))
        child.wait_for("entered", PATIENCE)
        ready = time.monotonic() - child.began
        child.wait_for("publishing", PATIENCE)
        publishing = time.monotonic() - child.began
        code = child.end()
        pace = cls(ready=ready, publishing=publishing, ended=time.monotonic() - child.began)
        shutil.rmtree(folder)
        if code:
            raise RuntimeError(f"{story.name}: {child.told[-1]}")
        return pace


def make(scenario: Scenario, path: Path, tell: Tell, *, again: bool) -> None:
    """Make a run, or resume the one that is there; ``again``: by resume, where there is a part file."""
    with telling(tell, seconds=BETWEEN_COMMITS):
        if again and OutputPaths.of(path).part.exists():
            rubnoise.resume(f"{path}.part").close()
        else:
            rubnoise.run(scenario, path).close()


@dataclass(kw_only=True)
class Torture:
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
        self._judge()

    def _once(self) -> bool:
        """Let it run and kill it; return whether it ended by itself."""
        aim = self.random.choice(AIMS) if self.kills < self.most else "none"
        again = self.random.random() < 0.5
        engine = self.random.choice(("events", "batch")) if self.random.random() < 0.3 else self.story.engine
        child = Child.begin(partial(make, self.story.by(engine), self.path, again=again))
        if aim != "none":
            time.sleep(self._delay(child, aim))
            child.send(signal.SIGKILL)
        code = child.end()
        self.history.append(f"{aim} {'resume' if again else 'run'} {engine} {child.told[-1:]}")
        self._compare(child)
        if code == -signal.SIGKILL:
            self.kills += 1
            self.outcome.count(f"killed, aiming at {aim}")
            self.outcome.count(f"killed after it reported {_stage(child)}")
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
            self._find(f"{self.committed} ticks had been committed, and it went on from {entered}")
        self.outcome.count("commits", sum(line.startswith("committed") for line in child.told))
        self.committed = max(self.committed, child.last("committed"))

    def _look(self) -> None:
        """Look at what the kill left."""
        paths = OutputPaths.of(self.path)
        if paths.final.exists():
            try:
                wrong = differences(contents(paths.final), self.story.expected)
            except (OSError, KeyError, ValueError) as problem:
                wrong = [f"unreadable: {problem}"]
            if wrong:
                self._find(f"under the final name: {wrong}")
        elif self.committed and not paths.part.exists():
            self._find("what was committed is gone")

    def _judge(self) -> None:
        if (self.folder / f"{NAME}.part").exists():  # a second name of the result, for resume to take away
            rubnoise.resume(f"{self.path}.part").close()
            self.outcome.count("second names taken away")
        for wrong in judged(self.folder, self.story, others=LEFT.__contains__):
            self._find(wrong)
        self.outcome.count("runs")

    def _find(self, what: str) -> None:
        self.outcome.find(f"{self.story.name}: {what}; {'; '.join(self.history[-3:])}")


def _stage(child: Child) -> str:
    told = [line.split()[0] for line in child.told]
    return told[-1] if told else "nothing"


def kills(count: int, seed: int, stories: tuple[Story, ...] = LONG) -> Outcome:
    """Kill runs so many times, about twenty times each."""
    outcome = Outcome()
    paces = {story.name: (story.expected, Pace.of(story))[1] for story in stories}
    turn = 0
    while outcome.counts["kills"] < count:
        story = stories[turn % len(stories)]
        folder = Path(mkdtemp(prefix="rubnoise-kills-"))
        torture = Torture(
            story=story,
            folder=folder,
            random=chance(seed, turn),
            pace=paces[story.name],
            outcome=outcome,
            most=min(20, count - outcome.counts["kills"]),
        )
        torture.go()
        outcome.count("kills", torture.kills)
        shutil.rmtree(folder)
        turn += 1
    return outcome

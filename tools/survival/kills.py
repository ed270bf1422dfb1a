"""A SIGKILL at a random moment, and a second writer: a final name is a complete result, and the bits are the same."""

import signal
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from survival.child import Child, Ending, command
from survival.stories import LONG, NAME, PART, Outcome, Story, chance, interrupted, wrong_in

PATIENCE = 120.0


def begin(story: Story, folder: Path, *more: str) -> Child:
    """Start a run in a copy of this process."""
    return Child.begin(lambda: command(story.words(*more), folder))


def kills(count: int, seed: int, stories: Sequence[Story] = LONG) -> Outcome:
    """Kill runs so many times, half of them runs that replace a result."""
    outcome = Outcome()
    seconds = {story: _seconds(outcome, story) for story in stories}
    for turn in range(count):
        story, older, random = stories[turn % len(stories)], bool(turn // len(stories) % 2), chance(seed, turn)
        with outcome.trial(f"kill {turn} of {story.name}") as folder:
            story.write(folder, older=older)
            child = begin(story, folder, "--force")
            time.sleep(random.uniform(0.0, 1.1) * seconds[story])
            child.send(signal.SIGKILL)
            ending = child.end()
            outcome.count(f"exit code {ending.code}")
            outcome.count("left a part" if (folder / PART).exists() else "left no part")
            outcome.find(story.name, interrupted(folder, story, older=older, left=frozenset((PART,))))
    return outcome


def _seconds(outcome: Outcome, story: Story) -> float:
    """Return how long a run takes here and now; what is expected of it is made before."""
    _ = story.expected
    with outcome.trial(story.name) as folder:
        story.write(folder)
        return begin(story, folder).end().seconds
    return 1.0


def rivals(count: int, seed: int, stories: Sequence[Story] = LONG) -> Outcome:
    """Start the same run so many times while another process writes it: one makes it, the other is refused."""
    outcome = Outcome()
    for turn in range(count):
        story, random = stories[turn % len(stories)], chance(seed, turn)
        with outcome.trial(f"rival {turn} of {story.name}") as folder:
            story.write(folder)
            first = begin(story, folder)
            deadline = time.monotonic() + PATIENCE
            while not (folder / PART).exists() and time.monotonic() < deadline:
                time.sleep(0.001)
            time.sleep(random.uniform(0.0, 0.02))
            first.send(signal.SIGSTOP)  # or it might end before the second begins
            second = begin(story, folder, *["--force"] * (turn % 2)).end()
            first.send(signal.SIGCONT)
            outcome.find(story.name, _judged(outcome, first.end(), second, folder, story))
    return outcome


def _judged(outcome: Outcome, first: Ending, second: Ending, folder: Path, story: Story) -> Iterator[str]:
    refused = second.code == 2 and second.err == f"{folder / NAME}: another process is writing it\n"
    outcome.count("second refused" if refused else "second came late")
    if first.code:
        yield f"the first: exit code {first.code}, {first.err}"
    if not refused and (second.code not in {0, 2} or "another process" in second.err):
        yield f"the second: exit code {second.code}, {second.err}"
    yield from wrong_in(folder / NAME, story.expected)
    if (folder / PART).exists():
        yield "a part is left"

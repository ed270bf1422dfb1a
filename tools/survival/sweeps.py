"""Power cuts in sweeps, which fsync many results at once: every run that the journal lists as done is intact."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import rubnoise
from rubnoise.api.sweeping import keep_run
from rubnoise.scenario.points import Point
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.sync_many import sync_many
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.run_status import found_run
from survival.child import committing
from survival.finding import Outcome
from survival.recording import Recording
from survival.stories import SMALL, Story, chance, contents, differences
from survival.writes import folder_of

TOGETHER: Final = (1, 2, 1)
"""How many runs there are between two looks at the disk."""


def sweeps(count: int, seed: int, stories: tuple[Story, ...] = SMALL) -> Outcome:
    """Cut the power of sweeps so many times, and resume them."""
    outcome = Outcome()
    sweeping = [(story, points_of(story), recorded(story, seconds)) for story in stories for seconds in (1e9, 0.0, 1e9)]
    for turn in range(count):
        story, points, recording = sweeping[turn % len(sweeping)]
        random = chance(seed, turn)
        moment = random.choice(recording.moments)
        where = f"{turn}: {story.name}, call {moment} of {len(recording.calls)}"
        outcome.count("power cuts in sweeps")
        with folder_of(outcome, where) as root:
            (folder := SweepFolder(root)).run("x").parent.mkdir()
            recording.after_power_cut(folder.run("x").parent, moment, random)
            done = max(recording.noted("done", moment), 0)
            _check_done(outcome, story, folder, points[:done], where)
            _go_on(outcome, folder, points[done:])
            _check_done(outcome, story, folder, points, f"{where}, gone on")
            for left in sorted({path.name for path in folder.run("x").parent.iterdir()} - _own(points)):
                outcome.find(f"{where}: {left} is left over")
    return outcome


def points_of(story: Story) -> Sequence[Point]:
    """Return the runs of a sweep of a story."""
    with TemporaryDirectory(prefix="rubnoise-") as folder:
        (path := Path(folder) / "s.toml").write_text(f"{story.text}[sweep]\nreplicates = {sum(TOGETHER)}\n", "utf-8")
        return rubnoise.expand(rubnoise.load_sweep(path))


def recorded(story: Story, seconds: float) -> Recording:
    """Record the runs of a sweep, some of them flushed to disk at a time; they commit after so many seconds."""
    points = iter(points_of(story))
    with TemporaryDirectory(prefix="rubnoise-") as name:
        (folder := SweepFolder(Path(name))).run("x").parent.mkdir()
        recording = Recording(folder.run("x").parent)
        with recording.recording(), committing(seconds):
            done = 0
            for number in TOGETHER:
                waiting = [_made(next(points), folder) for _ in range(number)]
                sync_many(waiting)
                recording.note("done", done := done + number)
        return recording


def _made(point: Point, folder: SweepFolder) -> Path:
    return folder.root / keep_run(point, root=folder.root, command=("rubnoise",), durable=False).file


def _go_on(outcome: Outcome, folder: SweepFolder, points: Sequence[Point]) -> None:
    """Make what no journal lists as done, as a resumed sweep does."""
    for point in points:
        there = folder.run(point.run_id).exists()
        found = found_run(point, root=folder.root, begun=True)
        part = OutputPaths.of(folder.run(point.run_id)).part.exists()
        if found is not None:
            outcome.count("runs found whole")
        else:
            outcome.count("runs found torn" if there else "runs gone on with" if part else "runs made anew")
            _made(point, folder)


def _check_done(outcome: Outcome, story: Story, folder: SweepFolder, points: Sequence[Point], where: str) -> None:
    for point, expected in zip(points, _expected(story), strict=False):
        try:
            wrong = differences(contents(folder.run(point.run_id)), expected)
        except (OSError, KeyError, ValueError) as problem:
            wrong = [f"unreadable: {problem}"]
        if wrong:
            outcome.find(f"{where}: {point.run_id}: {wrong}")


@cache
def _expected(story: Story) -> list[Mapping[str, Any]]:
    """Return what is in the results where nothing happens."""
    with TemporaryDirectory(prefix="rubnoise-") as name:
        folder = SweepFolder(Path(name))
        folder.run("x").parent.mkdir()
        return [contents(_made(point, folder)) for point in points_of(story)]


def _own(points: Sequence[Point]) -> set[str]:
    """Return the names that may be left: results, and what the next run of each would take away."""
    names = [f"{point.run_id}.h5" for point in points]
    return {*names, *(f".{name}.{left}" for name in names for left in ("lock", "making"))}

"""A small run stopped at every call by which it reaches the disk, and in the middle of each that writes."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import rubnoise
from rubnoise.errors import RubnoiseError
from survival.child import telling
from survival.finding import Outcome
from survival.kills import LEFT
from survival.recording import Recording
from survival.stories import NAME, SMALL, Story, chance, judged


def recorded(story: Story, halfway: int | None = None, seconds: float = 0.0) -> Recording:
    """Record a run that commits after so many seconds; ``halfway``: one that resumes another after so many calls."""
    with TemporaryDirectory(prefix="rubnoise-") as name:
        folder = Path(name)
        if halfway is not None:
            recorded(story).after_kill(folder, halfway)
        recording = Recording(folder)
        with recording.recording(), telling(lambda line: _note(recording, line), seconds=seconds):
            rubnoise.run(story.scenario, folder / NAME).close()
        return recording


def writes(_count: int, seed: int, stories: tuple[Story, ...] = SMALL, every: int = 1, last: int = 0) -> Outcome:
    """Stop each run after each of its calls, after every so many, or after the last ones only, and go on."""
    outcome = Outcome()
    for story in stories:
        whole = recorded(story)
        for recording in (whole, recorded(story, halfway=len(whole.calls) // 2)):
            for moment in recording.moments[-last::every]:
                _stopped(outcome, story, recording, moment, seed, torn=False)
                if moment < len(recording.calls) and recording.calls[moment][0] == "write_all":
                    _stopped(outcome, story, recording, moment, seed, torn=True)
    return outcome


def gone_on(outcome: Outcome, story: Story, folder: Path, committed: int, *, again: bool) -> Iterator[str]:
    """Resume the run in a folder, and yield what is wrong; ``again``: by resume, where there is a part file."""
    path, told = folder / NAME, [-1]

    def tell(line: str) -> None:
        if line.startswith("entered"):
            told.append(int(line.split()[1]))

    if (again or path.exists()) and (folder / f"{NAME}.part").exists():
        outcome.count("gone on by resume")
        with telling(tell, seconds=0.0):
            rubnoise.resume(f"{path}.part").close()
    elif not path.exists():
        outcome.count("gone on by run")
        with telling(tell, seconds=0.0):
            rubnoise.run(story.scenario, path).close()
    else:
        outcome.count("whole already")
    if 0 <= told[-1] < committed:
        yield f"{committed} ticks had been committed, and it went on from {told[-1]}"
    yield from judged(folder, story, others=LEFT.__contains__)


def _stopped(outcome: Outcome, story: Story, recording: Recording, moment: int, seed: int, *, torn: bool) -> None:
    outcome.count("stopped in the middle of a write" if torn else "stopped after a call")
    where = f"{story.name}, call {moment} of {len(recording.calls)}{', torn' if torn else ''}"
    with folder_of(outcome, where) as folder:
        recording.after_kill(folder, moment, torn=torn)
        again = chance(seed, where).random() < 0.5
        for wrong in gone_on(outcome, story, folder, recording.noted("committed", moment), again=again):
            outcome.find(f"{where}: {wrong}")


@contextmanager
def folder_of(outcome: Outcome, where: str) -> Iterator[Path]:
    """Yield a folder for one trial; what is raised there was found."""
    with TemporaryDirectory(prefix="rubnoise-") as folder:
        try:
            yield Path(folder)
        except RubnoiseError as problem:
            outcome.find(f"{where}: {problem}")
        except Exception as problem:  # noqa: BLE001  (whatever it is, it should not be)
            outcome.find(f"{where}: {type(problem).__name__}: {problem}")


def _note(recording: Recording, line: str) -> None:
    what, value = line.split()
    recording.note(what, int(value))

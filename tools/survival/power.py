"""Power cuts: any part of what was not flushed is lost; what was committed or published is there."""

from pathlib import Path

from rubnoise.storage.output import OutputPaths
from survival.finding import Outcome
from survival.stories import NAME, SMALL, Story, chance
from survival.writes import folder_of, gone_on, recorded


def power(count: int, seed: int, stories: tuple[Story, ...] = SMALL) -> Outcome:
    """Cut the power so many times, and go on."""
    outcome = Outcome()
    recordings = {
        (story, often): recorded(story, seconds=0.0 if often else 1e9) for story in stories for often in (True, False)
    }
    for turn in range(count):
        (story, often), recording = list(recordings.items())[turn % len(recordings)]
        random = chance(seed, turn)
        # Chance alone would seldom meet the moments when a result has just been published.
        moment = random.choice(recording.moments[-3:] if turn % 10 > 7 else recording.moments)
        where = f"{turn}: {story.name}, {'with' if often else 'without'} commits, call {moment}"
        outcome.count(f"power cuts {'with' if often else 'without'} commits")
        with folder_of(outcome, where) as folder:
            recording.after_power_cut(folder, moment, random)
            _check_published(outcome, folder, where, published=recording.noted("published", moment) >= 0)
            committed = recording.noted("committed", moment)
            _take_away_what_is_left(outcome, folder)
            for wrong in gone_on(outcome, story, folder, committed, again=random.random() < 0.5):
                outcome.find(f"{where}: {wrong}")
    return outcome


def _check_published(outcome: Outcome, folder: Path, where: str, *, published: bool) -> None:
    if published and not (folder / NAME).exists():
        outcome.find(f"{where}: it had been published, and is gone")


def _take_away_what_is_left(outcome: Outcome, folder: Path) -> None:
    """Take away a journal and rows that are left alone beside a whole result, where they do no harm."""
    names = OutputPaths.of(folder / NAME)
    if names.final.exists() and not names.part.exists():
        for what, path in (("journals", names.journal), ("files of rows", names.growing)):
            if path.exists():
                path.unlink()
                outcome.count(f"{what} left beside a whole result")

"""What a run leaves of its files at any moment, and how it resumes: after a kill, a power cut, or with a bit turned."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import h5py

import rubnoise
from rubnoise.storage.output import OutputPaths
from survival.child import called, command
from survival.recording import Recording
from survival.stories import (
    NAME,
    SCENARIO,
    SMALL,
    Outcome,
    Story,
    chance,
    continued,
    telling,
    words,
    wrong_in,
)

PART: Final = OutputPaths.of(NAME).part.name
VERIFY = ("verify", NAME)
OTHER = "published, verified, and yet other than it was"


def recorded(story: Story, halfway: int | None = None, seconds: float = 0.0) -> Recording:
    """Record a run that commits after so many seconds; ``halfway``: one that resumes another after so many calls."""
    with TemporaryDirectory(prefix="rubnoise-") as name:
        folder = Path(name)
        if halfway is not None:
            recorded(story).after_kill(folder, halfway)
        recording = Recording(folder)

        def note(line: str) -> None:
            what, value = line.split()
            recording.note(what, int(value))

        with recording.recording(), telling(note, seconds=seconds):
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


def _stopped(outcome: Outcome, story: Story, recording: Recording, moment: int, seed: int, *, torn: bool) -> None:
    outcome.count("stopped in the middle of a write" if torn else "stopped after a call")
    where = f"{story.name}, call {moment} of {len(recording.calls)}{', torn' if torn else ''}"
    with outcome.trial(where) as folder:
        recording.after_kill(folder, moment, torn=torn)
        again = chance(seed, where).random() < 0.5
        outcome.find(where, continued(outcome, story, folder, recording.noted("committed", moment), again=again))


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
        with outcome.trial(where) as folder:
            recording.after_power_cut(folder, moment, random)
            if recording.noted("published", moment) >= 0 and not (folder / NAME).exists():
                outcome.find(where, ["it had been published, and is gone"])
            names = OutputPaths.of(folder / NAME)
            if names.final.exists() and not names.part.exists():
                # Left alone beside a whole result, they do no harm.
                names.remove_beside()
            committed = recording.noted("committed", moment)
            outcome.find(where, continued(outcome, story, folder, committed, again=random.random() < 0.5))
    return outcome


@dataclass(frozen=True, kw_only=True)
class Stage:
    """A run that has not begun or did not finish, by the files that are there."""

    name: str
    story: Story
    files: Mapping[str, bytes]

    @contextmanager
    def folder(self, changed: Mapping[str, bytes] | None = None) -> Iterator[Path]:
        """Yield a folder with its files and its scenario; ``changed``: contents by name in place of its own."""
        scenario = {SCENARIO: self.story.text.encode()}
        with TemporaryDirectory(prefix="rubnoise-") as name:
            for path, content in {**scenario, **self.files, **(changed or {})}.items():
                (Path(name) / path).write_bytes(content)
            yield Path(name)

    def words(self, *, again: bool = True) -> list[str]:
        """Return the words that go on with it: those of `resume`, or of the same `run` once more."""
        return ["resume", PART, "-q"] if again and self.files else words(self.story)

    @cached_property
    def metadata(self) -> tuple[range, ...]:
        """The stretches of the part that hold no rows."""
        with self.folder() as folder:
            return tuple(_metadata(folder / PART))

    def turned(self, bit: int) -> bytes:
        """Return the part with one bit of what is no row turned, counted from the first."""
        content, place = bytearray(self.files[PART]), bit // 8
        for stretch in self.metadata:
            if place < len(stretch):
                content[stretch[place]] ^= 1 << bit % 8
                break
            place -= len(stretch)
        return bytes(content)

    @property
    def bits(self) -> int:
        """How many bits there are to turn."""
        return 8 * sum(map(len, self.metadata))


def flips(count: int, seed: int, stories: tuple[Story, ...] = SMALL) -> Outcome:
    """Turn so many bits, one at a time, and go on each time."""
    outcome = Outcome()
    stages = [stage for story in stories for stage in stages_of(story)]
    for story in stories:
        with Stage(name="run", story=story, files={}).folder() as folder:
            # Copies of this process shall have all that is loaded for that.
            if command(words(story), folder) or command(VERIFY, folder):
                raise RuntimeError(f"{story.name}: does not verify by itself")
    for turn in range(count):
        stage = stages[turn % len(stages)]
        random = chance(seed, turn)
        bit, again = random.randrange(stage.bits), random.random() < 0.75
        where = f"{turn}: {stage.story.name}, {stage.name}, bit {bit}, {'resume' if again else 'run'}"
        outcome.find(where, resumed(outcome, stage, {PART: stage.turned(bit)}, again=again))
    return outcome


def stages_of(story: Story) -> Iterator[Stage]:
    """Yield a run as it is half-way, when its part is whole, and when only the name is missing."""
    recording = recorded(story)
    gone = next(n for n, call in enumerate(recording.calls) if call == ("remove", OutputPaths.of(NAME).journal.name))
    for name, moment in (("half-way", gone // 2), ("whole, with its journal", gone), ("whole", gone + 1)):
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            recording.after_kill(Path(folder), moment)
            files = {path.name: path.read_bytes() for path in Path(folder).iterdir()}
        yield Stage(name=name, story=story, files=files)


def _metadata(path: Path) -> Iterator[range]:
    """Yield the stretches of a file that hold no rows."""
    with h5py.File(path, "r") as file:
        columns = sorted(place for group in file.values() for column in group.values() for place in _places(column))
        end = file.id.get_filesize()
    place = 0
    for first, last in columns:
        yield range(place, first)
        place = last
    yield range(place, end)


def _places(column: h5py.Dataset) -> Iterator[tuple[int, int]]:
    if column.chunks is None:
        offset = column.id.get_offset() or 0  # of a column without rows
        yield offset, offset + column.nbytes
        return
    for number in range(column.id.get_num_chunks()):
        about = column.id.get_chunk_info(number)
        yield about.byte_offset, about.byte_offset + about.size


def resumed(outcome: Outcome, stage: Stage, changed: Mapping[str, bytes], *, again: bool) -> Iterator[str]:
    """Yield what is wrong with how `resume`, or the same `run` once more, takes changed files of a stage."""
    with stage.folder(changed) as folder:
        ending = called(stage.words(again=again), folder)
        outcome.count(f"{stage.name}: exit code {ending.code}")
        if fault := ending.fault(0, 1, 2):
            yield f"{fault}: {ending.err}"
        elif ending.code and (ending.err.count("\n") != 1 or "internal error" in ending.err):
            yield f"said {ending.err!r}"
        if not (folder / NAME).exists():
            if ending.code == 0:
                yield "there is no result"
            return
        outcome.count("published")
        verified = called(VERIFY, folder)
        if verified.code:
            yield f"published, and verify says {verified.code}: {verified.out} {verified.err}"
        elif wrong := wrong_in(folder / NAME, stage.story.expected):
            yield f"{OTHER}: {wrong}"

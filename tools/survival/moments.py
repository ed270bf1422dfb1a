"""What a run leaves of its files at any moment, and how it resumes: after a kill, a power cut, or with a bit turned."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import h5py
from fuzz.isolated import command, isolated

import rubnoise
from rubnoise.api.sweeping import keep_run
from rubnoise.errors import RubnoiseError
from rubnoise.scenario.points import Point
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.sync_many import sync_many
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.run_status import found_run
from survival.child import committing, telling
from survival.kills import LEFT
from survival.recording import Recording
from survival.stories import NAME, SCENARIO, SMALL, Outcome, Story, chance, contents, judged, words, wrong_in


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


TOGETHER: Final = (1, 2, 1)
"""How many runs there are between two looks at the disk."""


def sweeps(count: int, seed: int, stories: tuple[Story, ...] = SMALL) -> Outcome:
    """Cut the power of sweeps so many times, and resume them."""
    outcome = Outcome()
    sweeping = [
        (story, points_of(story), recorded_sweep(story, seconds)) for story in stories for seconds in (1e9, 0.0, 1e9)
    ]
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


def recorded_sweep(story: Story, seconds: float) -> Recording:
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
        if wrong := wrong_in(folder.run(point.run_id), expected):
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


VERIFY = ("verify", NAME)
OTHER = "published, verified, and yet other than it was"


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """A run that did not finish: the files it left, and which bytes of its part are no rows."""

    name: str
    files: Mapping[str, bytes]
    metadata: tuple[range, ...]

    @property
    def part(self) -> str:
        """The name of the part."""
        return OutputPaths.of(NAME).part.name

    def turned(self, bit: int) -> bytes:
        """Return the part with one bit of what is no row turned, counted from the first."""
        content, place = bytearray(self.files[self.part]), bit // 8
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
    stages = [(story, stage) for story in stories for stage in stages_of(story)]
    for story in stories:
        _verify_here(story)
    for turn in range(count):
        story, stage = stages[turn % len(stages)]
        random = chance(seed, turn)
        bit, again = random.randrange(stage.bits), random.random() < 0.75
        where = f"{turn}: {story.name}, {stage.name}, bit {bit}"
        with TemporaryDirectory(prefix="rubnoise-") as name:
            turned = {stage.part: stage.turned(bit)}
            for wrong in resumed(outcome, story, stage, turned, Path(name), again=again):
                outcome.find(f"{where}, {'resume' if again else 'run'}: {wrong}")
    return outcome


def stages_of(story: Story) -> Iterator[Stage]:
    """Yield a run as it is half-way, when its part is whole, and when only the name is missing."""
    recording = recorded(story)
    gone = next(n for n, call in enumerate(recording.calls) if call == ("remove", OutputPaths.of(NAME).journal.name))
    for name, moment in (("half-way", gone // 2), ("whole, with its journal", gone), ("whole", gone + 1)):
        yield _stage(name, recording, moment)


def _stage(name: str, recording: Recording, moment: int) -> Stage:
    with TemporaryDirectory(prefix="rubnoise-") as folder:
        recording.after_kill(Path(folder), moment)
        files = {path.name: path.read_bytes() for path in Path(folder).iterdir()}
        return Stage(name=name, files=files, metadata=tuple(_metadata(OutputPaths.of(Path(folder) / NAME).part)))


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


def resumed(
    outcome: Outcome, story: Story, stage: Stage, changed: Mapping[str, bytes], folder: Path, *, again: bool
) -> Iterator[str]:
    """Yield what is wrong with how `resume`, or the same `run` once more, takes the files of a run that did not finish.

    ``changed``: contents by name, in place of those of the stage; all are put into the folder, which is empty.
    """
    for name, content in {**stage.files, **changed}.items():
        (folder / name).write_bytes(content)
    (folder / SCENARIO).write_text(story.text, encoding="utf-8")
    given = ["resume", stage.part, "-q"] if again else words(story)
    ending = isolated(lambda: command(given, folder))
    outcome.count(f"{stage.name}: exit code {ending.code}")
    if fault := ending.fault(0, 1, 2):
        yield f"{fault}: {ending.err}"
    elif ending.code and (ending.err.count("\n") != 1 or "internal error" in ending.err):
        yield f"said {ending.err!r}"
    yield from _published(outcome, story, folder, whole=ending.code == 0)


def _published(outcome: Outcome, story: Story, folder: Path, *, whole: bool) -> Iterator[str]:
    """Yield what is wrong with what bears the final name."""
    path = folder / NAME
    if not path.exists():
        if whole:
            yield "there is no result"
        return
    outcome.count("published")
    verified = isolated(lambda: command(VERIFY, folder))
    if verified.code:
        yield f"published, and verify says {verified.code}: {verified.out} {verified.err}"
        return
    if wrong := wrong_in(path, story.expected):
        yield f"{OTHER}: {wrong}"


def _verify_here(story: Story) -> None:
    """Verify a result in this process, so that copies of it have all that is loaded for that."""
    with TemporaryDirectory(prefix="rubnoise-") as name:
        folder = Path(name)
        (folder / SCENARIO).write_text(story.text, encoding="utf-8")
        if command([*words(story)], folder) or isolated(lambda: command(VERIFY, folder)).code:
            raise RuntimeError(f"{story.name}: does not verify by itself")
        command(VERIFY, folder)

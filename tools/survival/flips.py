"""Single bits turned in runs that did not finish: what gets its final name verifies, all else is refused in a line."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
from fuzz.isolated import isolated

from rubnoise.storage.output import OutputPaths
from survival.command import command
from survival.finding import Outcome
from survival.full import SCENARIO, words
from survival.recording import Recording
from survival.stories import NAME, SMALL, Story, chance, contents, differences
from survival.writes import recorded

VERIFY = ("verify", NAME)
OTHER = "published, verified, and yet other than it was"
KEPT = 0.5
"""Share of the calls of a run after which it is stopped half-way."""


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
    for name, moment in (("half-way", int(KEPT * gone)), ("whole, with its journal", gone), ("whole", gone + 1)):
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
    try:
        wrong = differences(contents(path), story.expected)
    except (OSError, KeyError, ValueError, RuntimeError) as problem:
        wrong = [f"unreadable: {problem}"]
    if wrong:
        yield f"{OTHER}: {wrong}"


def _verify_here(story: Story) -> None:
    """Verify a result in this process, so that copies of it have all that is loaded for that."""
    with TemporaryDirectory(prefix="rubnoise-") as name:
        folder = Path(name)
        (folder / SCENARIO).write_text(story.text, encoding="utf-8")
        if command([*words(story)], folder) or isolated(lambda: command(VERIFY, folder)).code:
            raise RuntimeError(f"{story.name}: does not verify by itself")
        command(VERIFY, folder)

"""Damaged and hostile result files, thrown at the commands: `python tools/fuzz_results.py --count 10000 --jobs 2`.

Every file goes to `verify` and to one other command in turn, each in a process of its own with limits on time and
memory. Counted are crashes, hangs, tracebacks, files opened without need, and files of which verify says that
all is well though plain h5py reads something else from them than from the good one. Parts and journals of runs that did
not finish go to `resume`, or to the same `run`; what it publishes has to be the result. Exit code 1 where there is any.
"""

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from random import Random

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from fuzz.damage import SEALED, damaged  # noqa: E402
from fuzz.hostile import CONSTRUCTIONS, make, make_canary  # noqa: E402
from fuzz.isolated import Outcome as Ending  # noqa: E402
from fuzz.isolated import called, command, isolated, watched  # noqa: E402
from fuzz.truth import values  # noqa: E402
from survival.moments import OTHER, Stage, resumed, stages_of  # noqa: E402
from survival.stories import SMALL, Outcome, Story  # noqa: E402

SCENARIO = """\
format = 1
title = "a small run"

[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 5

[diameter]
law = "normal"
spread = "10 %"

[strength]
mean = "250 MPa"

[sliding]
speed = "1 mm/s"
distance = "100 um"

[slider]
mass = "5 g"
stiffness = "300 N/m"
damping = "0.05 N*s/m"

[output]
tick = "0.5 um"
"""
KINDS = {
    "none": (),
    "gzip": ("--set", "output.compression=gzip"),
    "two-way": ("--set", "slider.coupling=two-way"),
}
"""The good files, and the options with which they are run."""
VERIFY = ("verify", "{}")
COMMANDS = (
    ("info", "{}"),
    ("junction", "{}", "3"),
    ("junctions", "{}", "--sort", "diameter", "--where", "diameter > 5 um"),
    ("info", "{}", "--json"),
    ("compare", "{}"),
    ("export", "{}", "--to", "csv", "-o", "out.csv", "--group", "junctions", "--force"),
    ("listen", "{}", "-o", "out.wav", "--force"),
    ("theory", "{}"),
    ("teach", "{}", "-o", "out.html", "--force"),
    ("plot", "{}", "trace", "-o", "out.png", "--force"),
    ("plot", "{}", "lives", "-o", "out.svg", "--force"),
    ("run", "{}"),
)
GOOD = 0
ENDS = (0, 2, 3)
"""Done, refused, or found to differ; nothing else may come of a file, whatever is in it."""

RESUMED = 0.75
"""Share of the damaged parts that `resume` is given; the others are left to the same `run`."""

Task = Callable[[int, Sequence[int]], Outcome]


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing that should not be: what, with which file (its number or the name of its making), on which command."""

    fault: str
    file: str
    command: str
    said: str

    def __str__(self) -> str:
        return f"{self.file}, {self.command}: {self.fault}: {self.said[-400:]}"


class Judge:
    """Puts files to the commands, in one folder of its own."""

    def __init__(self, folder: Path) -> None:
        """Make the good files, and load now what the commands load, so that no copy has to."""
        self.folder = folder
        self.good = {kind: folder / f"good_{kind}.h5" for kind in KINDS}
        self.canary = folder / "canary.h5"
        make_canary(self.canary)
        (folder / "small.toml").write_text(SCENARIO, encoding="utf-8")
        for kind, path in self.good.items():
            self._load(("run", "small.toml", "-o", path.name, *KINDS[kind]))
        for words in (VERIFY, *COMMANDS):
            self._load(self._words(words, self.good["none"]))
        self.truth = {kind: values(path) for kind, path in self.good.items()}

    def judged(self, path: Path, name: str, kind: str, number: int, *, forged: bool) -> Iterator[Finding]:
        """Yield everything wrong about how a file was taken by verify and by one other command."""
        with watched(self.canary) as opened:
            verified = called(self._words(VERIFY, path), self.folder)
            words = COMMANDS[number % len(COMMANDS)]
            other = called(self._words(words, path), self.folder)
        yield from _findings(verified, name, VERIFY)
        yield from _findings(other, name, words)
        if opened:
            yield Finding(fault="reads another file", file=name, command=f"verify or {words[0]}", said="")
        if verified.code == GOOD and not forged and not self._is_as_it_was(path, kind):
            yield Finding(fault="changed, and called good", file=name, command="verify", said=verified.out)

    def _is_as_it_was(self, path: Path, kind: str) -> bool:
        return isolated(lambda: int(values(path) != self.truth[kind])).code == 0

    def _words(self, words: Sequence[str], path: Path) -> list[str]:
        return [word.format(path.name) for word in words]

    def _load(self, words: Sequence[str]) -> None:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()) as said:
            code = command(words, self.folder)
        if code not in ENDS:
            raise RuntimeError(f"{words}: {said.getvalue()}")


def mutations(seed: int, numbers: Sequence[int]) -> Outcome:
    """Judge damaged files by their numbers; return how many of each damage there were, and what was found."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        judge = Judge(Path(name))
        content = {kind: path.read_bytes() for kind, path in judge.good.items()}
        for number in numbers:
            random = Random(f"{seed}/{number}")  # noqa: S311  (damage is no secret)
            kinds = list(KINDS)
            kind = kinds[number % len(kinds)]
            path = judge.folder / "changed.h5"
            damage, changed = damaged(content[kind], content[kinds[(number + 1) % len(kinds)]], random)
            path.write_bytes(changed)
            outcome.count(damage)
            for finding in judge.judged(
                path, f"{damage} {number}", kind, number // len(KINDS), forged=damage in SEALED
            ):
                outcome.find(str(finding))
    return outcome


def constructions(_seed: int, numbers: Sequence[int]) -> Outcome:
    """Judge every hostile construction with every command."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        judge = Judge(Path(name))
        path = judge.folder / "hostile.h5"
        for number in numbers:
            construction = CONSTRUCTIONS[number]
            make(construction, judge.good["none"], path, judge.canary)
            outcome.count("hostile")
            for command in range(len(COMMANDS)):
                for finding in judge.judged(path, construction.__name__, "none", command, forged=True):
                    outcome.find(str(finding))
    return outcome


def parts(seed: int, numbers: Sequence[int]) -> Outcome:
    """Damage the part or the journal of runs that did not finish, by numbers, and resume them."""
    outcome = Outcome()
    stages: list[tuple[Story, Stage]] = [(story, stage) for story in SMALL for stage in stages_of(story)]
    for number in numbers:
        random = Random(f"{seed}/part/{number}")  # noqa: S311  (damage is no secret)
        story, stage = stages[number % len(stages)]
        name = random.choice(sorted(stage.files))
        damage, changed = damaged(stage.files[name], stages[(number + 1) % len(stages)][1].files[stage.part], random)
        again, endings = random.random() < RESUMED, Outcome()
        outcome.count(f"part: {damage}")
        with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as folder:
            for wrong in resumed(endings, story, stage, {name: changed}, Path(folder), again=again):
                if damage not in SEALED or not wrong.startswith(OTHER):
                    by = "resume" if again else "run"
                    outcome.find(f"{damage} {number} of {name}, {story.name}, {stage.name}, {by}: {wrong}")
    return outcome


def _findings(ending: Ending, name: str, words: Sequence[str]) -> Iterator[Finding]:
    if fault := ending.fault(*ENDS):
        yield Finding(fault=fault, file=name, command=words[0], said=ending.err.strip())


def main() -> int:
    """Throw the files, print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--count", type=int, default=1000, help="damaged files (1000)")
    parser.add_argument("--parts", type=int, default=200, help="damaged parts and journals (200)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the damage (1)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (2)")
    parser.add_argument("--only", type=int, nargs="*", help="the numbers of the damaged files to throw once more")
    asked = parser.parse_args()
    numbers: list[int] = list(range(asked.count)) if asked.only is None else asked.only
    tasks: list[tuple[Task, list[int]]] = [(mutations, numbers[job :: asked.jobs]) for job in range(asked.jobs)]
    if asked.only is None:
        tasks += [(parts, list(range(asked.parts))[job :: asked.jobs]) for job in range(asked.jobs)]
        tasks += [(constructions, list(range(len(CONSTRUCTIONS)))[job :: asked.jobs]) for job in range(asked.jobs)]
    outcome = Outcome()
    with ProcessPoolExecutor(asked.jobs) as pool:
        for each in [pool.submit(task, asked.seed, part) for task, part in tasks]:
            outcome.add(each.result())
    print(f"{outcome.counts.total()} files")
    print(outcome.told())
    return int(bool(outcome.findings))


if __name__ == "__main__":
    sys.exit(main())

"""Damaged and hostile result files, thrown at the commands: `python tools/fuzz_results.py --count 10000 --jobs 2`.

Every file goes to `verify` and to one other command in turn, each in a process of its own with limits on time and
memory. Counted are crashes, hangs, tracebacks, files opened without need, and files of which verify says that
all is well though plain h5py reads something else from them than from the good one. Exit code 1
where there is any.
"""

import argparse
import hashlib
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from fuzz.damage import SEALED, damaged  # noqa: E402
from fuzz.hostile import CONSTRUCTIONS, make, make_canary, watched  # noqa: E402
from survival.child import called, command, isolated  # noqa: E402
from survival.stories import NAME, SCENARIO, Outcome, chance  # noqa: E402

import rubnoise  # noqa: E402

SMALL_RUN = {"sliding.distance": "100 um", "output.tick": "0.5 um", "interface.mean_junction_count": 5}
"""What makes a run of Figure 5 a small one."""

VERIFY = ("verify", NAME)

KINDS = {
    "none": (),
    "gzip": ("--set", "output.compression=gzip"),
    "two-way": ("--set", "slider.coupling=two-way"),
}
"""The good files, and the options with which they are run."""

COMMANDS = (
    ("info", NAME),
    ("junction", NAME, "3"),
    ("junctions", NAME, "--sort", "diameter", "--where", "diameter > 11 um"),
    ("info", NAME, "--json"),
    ("compare", NAME),
    ("export", NAME, "--to", "csv", "-o", "out.csv", "--group", "junctions", "--force"),
    ("listen", NAME, "-o", "out.wav", "--force"),
    ("theory", NAME),
    ("teach", NAME, "-o", "out.html", "--force"),
    ("plot", NAME, "trace", "-o", "out.png", "--force"),
    ("plot", NAME, "lives", "-o", "out.svg", "--force"),
    ("run", NAME),
)
ENDS = (0, 2, 3)
"""Done, refused, or found to differ; nothing else may come of a file, whatever is in it."""

LINKS = frozenset(("DIMENSION_LIST", "REFERENCE_LIST"))
"""How columns are tied together for viewers; no value of the run."""

MISSED = "changed, and called good"


class Judge:
    """Puts files to the commands, in one folder of its own."""

    def __init__(self, folder: Path) -> None:
        """Make the good files, and load now what the commands load, so that no copy has to."""
        self.folder = folder
        self.path = folder / NAME
        self.good: dict[str, bytes] = {}
        self.truth: dict[str, str] = {}
        self.canary = folder / "canary.h5"
        make_canary(self.canary)
        small = rubnoise.example("paper/fig5").replace(SMALL_RUN)
        (folder / SCENARIO).write_text(small.to_toml(), encoding="utf-8")
        for kind, options in reversed(KINDS.items()):
            self._load(["run", SCENARIO, "-o", NAME, "--force", *options])
            self.good[kind], self.truth[kind] = self.path.read_bytes(), values(self.path)
        for words in (VERIFY, *COMMANDS):
            self._load(words)

    def judged(self, kind: str, number: int, *, forged: bool) -> Iterator[str]:
        """Yield everything wrong about how the file was taken by verify and by one other command."""
        words = COMMANDS[number % len(COMMANDS)]
        with watched(self.canary) as opened:
            endings = {each: called(each, self.folder) for each in (VERIFY, words)}
        for each, ending in endings.items():
            if fault := ending.fault(*ENDS):
                yield f"{each[0]}: {fault}: {ending.err.strip()[-400:]}"
        if opened:
            yield f"verify or {words[0]}: reads another file"
        unchanged = forged or isolated(lambda: int(values(self.path) != self.truth[kind])).code == 0
        if endings[VERIFY].code == 0 and not unchanged:
            yield f"verify: {MISSED}"

    def _load(self, words: Sequence[str]) -> None:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()) as said:
            code = command(words, self.folder)
        if code not in ENDS:
            raise RuntimeError(f"{words}: {said.getvalue()}")


def values(path: Path) -> str:
    """Return one hash of all columns and attributes by name, read with plain h5py; raises whatever that raises."""
    digest = hashlib.sha256()
    with h5py.File(path, "r") as file:
        names = [f"{group}/{column}" for group in file for column in file[group]]
        for name in sorted(["/", *file, *names]):
            owner = file[name]
            content = {key: owner.attrs[key] for key in sorted(set(owner.attrs) - LINKS)}
            if name in names:
                content[""] = owner[()]
            for key, each in content.items():
                value = np.asarray(each)
                digest.update(f"{name} {key} {value.dtype} {value.shape}".encode() + value.tobytes())
    return digest.hexdigest()


def mutations(seed: int, numbers: Sequence[int]) -> Outcome:
    """Judge damaged files by their numbers; return how many of each damage there were, and what was found."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        judge, kinds = Judge(Path(name)), list(KINDS)
        for number in numbers:
            kind, other = (kinds[each % len(kinds)] for each in (number, number + 1))
            damage, changed = damaged(judge.good[kind], judge.good[other], chance(seed, number))
            judge.path.write_bytes(changed)
            outcome.count(damage)
            forged = damage in SEALED
            outcome.find(f"{damage} {number}", judge.judged(kind, number // len(KINDS), forged=forged))
    return outcome


def constructions(_seed: int, numbers: Sequence[int]) -> Outcome:
    """Judge every hostile construction with every command."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        judge = Judge(Path(name))
        for construction in (CONSTRUCTIONS[number] for number in numbers):
            make(construction, judge.good["none"], judge.path, judge.canary)
            outcome.count("hostile")
            for number in range(len(COMMANDS)):
                outcome.find(construction.__name__, judge.judged("none", number, forged=True))
    return outcome


def main() -> int:
    """Throw the files, print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--count", type=int, default=1000, help="damaged files (1000)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the damage (1)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (2)")
    parser.add_argument("--only", type=int, nargs="+", help="the numbers of the damaged files to throw once more")
    asked = parser.parse_args()
    thrown: dict[Callable[[int, Sequence[int]], Outcome], Sequence[int]] = {
        mutations: range(asked.count) if asked.only is None else asked.only
    }
    if asked.only is None:
        thrown[constructions] = range(len(CONSTRUCTIONS))
    outcome = Outcome()
    with ProcessPoolExecutor(asked.jobs) as pool:
        tasks = [(task, numbers[job :: asked.jobs]) for task, numbers in thrown.items() for job in range(asked.jobs)]
        for each in [pool.submit(task, asked.seed, share) for task, share in tasks]:
            outcome.add(each.result())
    print(f"{outcome.counts.total()} files")
    print(outcome.told())
    return int(bool(outcome.findings))


if __name__ == "__main__":
    sys.exit(main())

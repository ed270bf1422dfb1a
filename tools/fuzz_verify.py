"""Single changes of right results, put to `verify`: `python tools/fuzz_verify.py --count 1100 --jobs 2`.

Every change is one of an attribute, a unit, a hash, a value, a column or a group, with the hashes put right where
values changed; in half of the files the hash of the attributes is put right, too. Each has to be named with exit code
3, or refused by name with 2; so has each change of the folder of a sweep: of its files, their names and their bits. A
change that nothing in the file can tell, as docs/verifying.md lists them, counts apart, and only where the hash of the
attributes was put right. Exit code 1 where anything else goes unnoticed.
"""

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import chdir, redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from random import Random
from shutil import copytree, rmtree

import h5py

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from fuzz import change_attributes, change_columns, change_folder  # noqa: E402
from fuzz.changing import Change, Place, Places, put_seal  # noqa: E402
from fuzz.hidden import is_hidden  # noqa: E402
from fuzz.isolated import called, isolated  # noqa: E402
from fuzz.truth import everything  # noqa: E402

from rubnoise.storage.schema import HASH  # noqa: E402

HEAD = """\
# A small run.
format = 1
{title}
[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 5
"""
DIAMETER = '[diameter]\nlaw = "normal"\nspread = "10 %"\n'
LOGNORMAL = '[diameter]\nlaw = "lognormal"\nspread = "60 %"\n'
REGULAR = '[birth]\nlaw = "regular"\n[pulse]\nshape = "triangle"\n'
STRENGTH = '[strength]\nmean = "250 MPa"\n'
UNEQUAL = '[strength]\nlaw = "weibull"\nmean = "250 MPa"\nspread = "40 %"\n'
SLIDING = '[sliding]\nspeed = "1 mm/s"\ndistance = "100 um"\n'
STILL = '[sliding]\ndistance = "100 um"\nstart = "empty"\n'
SLIDER = '[slider]\nmass = "5 g"\nstiffness = "300 N/m"\ndamping = "0.05 N*s/m"\n'
TWO_WAY = 'coupling = "two-way"\n'
OUTPUT = '[output]\ntick = "0.5 um"\n'
TITLE = 'title = "a small run"\n'

KINDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "everything": (HEAD.format(title=TITLE) + DIAMETER + STRENGTH + SLIDING + SLIDER + OUTPUT, ()),
    "gzip": (HEAD.format(title=TITLE) + LOGNORMAL + UNEQUAL + SLIDING + SLIDER + OUTPUT + 'compression = "gzip"\n', ()),
    "bare": (HEAD.format(title="") + STILL + OUTPUT, ()),
    "changed on the command line": (
        HEAD.format(title=TITLE) + DIAMETER + STRENGTH + SLIDING + OUTPUT,
        ("--set", "interface.mean_junction_count=8", "--seed", "3", "--engine", "batch"),
    ),
    "regular": (HEAD.format(title="") + LOGNORMAL + REGULAR + STRENGTH + STILL + OUTPUT, ()),
    "two-way": (HEAD.format(title=TITLE) + DIAMETER + STRENGTH + SLIDING + SLIDER + TWO_WAY + OUTPUT, ()),
    "extended": ('extends = "everything.toml"\nformat = 1\n[run]\nseed = 7\n', ()),
}
"""The scenarios of the right results, and the options with which they are run."""

SWEEP = """\
[sweep]
replicates = 2
[sweep.grid]
interface.mean_junction_count = [5, 8]
"""

CHANGES = (*change_attributes.CHANGES, *change_columns.CHANGES)
VERIFY = ("verify", "changed.h5", "--regenerate", "99")
RIGHT, DIFFERS, REFUSED = 0, 3, 2
SEAL = f"/provenance {HASH}"
UNLIKE = "is not what its hash was taken of"
OTHERWISE = {
    "format": "not one of rubnoise",
    "format_version": "has format version",
    "stream_version": "random streams of version",
}
"""How a refusal names an attribute without which nothing else can be asked."""


@dataclass(slots=True)
class Tally:
    """What came of the changes, by their kind: how many were named, refused, hidden; and what was found wrong."""

    named: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    hidden: Counter[str] = field(default_factory=Counter)
    found: list[str] = field(default_factory=list)

    def add(self, other: "Tally") -> None:
        """Take in another tally."""
        self.named += other.named
        self.refused += other.refused
        self.hidden += other.hidden
        self.found += other.found


class Judge:
    """Makes right results in a folder of its own, changes them, and asks verify."""

    def __init__(self, folder: Path) -> None:
        """Make the right results, and load now what verify loads, so that no copy of this process has to."""
        self.folder = folder
        self.right: dict[str, Path] = {}
        for number, (name, (text, options)) in enumerate(KINDS.items()):
            scenario = folder / ("everything.toml" if name == "everything" else f"kind_{number}.toml")
            scenario.write_text(text, encoding="utf-8")
            self.right[name] = folder / f"kind_{number}.h5"
            load(folder, ("run", scenario.name, "-q", "-o", self.right[name].name, *options))
            load(folder, ("verify", self.right[name].name, "--regenerate", "99"))

    def judge(self, change: Change, kind: str, random: Random, *, sealed: bool, tally: Tally) -> None:
        """Change a copy of a right result and put it to verify."""
        path = self.folder / "changed.h5"
        places = self._changed(change, kind, random, sealed=sealed)
        outcome, name = called(VERIFY, self.folder), change.__name__
        told = f"{name} of {kind}{', sealed' if sealed else ''}, {places[0]}"
        if fault := outcome.fault(RIGHT, DIFFERS, REFUSED):
            tally.found.append(f"{told}: {fault}: {outcome.err.strip()[-400:]}")
        elif outcome.code == RIGHT:
            if sealed and isolated(lambda: int(not is_hidden(self.right[kind], path, places))).code == 0:
                tally.hidden[name] += 1
            else:
                tally.found.append(f"{told}: unnoticed")
        elif not any(_names(outcome.out + outcome.err, place) for place in places):
            tally.found.append(f"{told}: not named: {outcome.err.strip()[-400:]}")
        else:
            (tally.refused if outcome.code == REFUSED else tally.named)[name] += 1

    def _changed(self, change: Change, kind: str, random: Random, *, sealed: bool) -> Places:
        """Make a copy that differs from the right result in more than bytes, by one change."""
        path, right = self.folder / "changed.h5", everything(self.right[kind])
        while True:
            path.write_bytes(self.right[kind].read_bytes())
            with h5py.File(path, "r+") as file:
                places = change(file, random)
                if sealed:
                    with suppress(Exception):  # what cannot be sealed any more stays as it is
                        put_seal(file)
            if everything(path) != right:
                return places


class FolderJudge:
    """Makes the folder of a sweep, changes copies of it, and asks verify."""

    def __init__(self, folder: Path) -> None:
        """Carry out the sweep, and load now what verify loads."""
        self.folder = folder
        (folder / "sweep.toml").write_text(HEAD.format(title=TITLE) + STRENGTH + SLIDING + OUTPUT + SWEEP, "utf-8")
        load(folder, ("sweep", "sweep.toml", "-q", "-o", "right", "--jobs", "1"))
        load(folder, ("verify", "right"))

    def judge(self, change: change_folder.FolderChange, random: Random, tally: Tally) -> None:
        """Change a copy of the folder and put it to verify."""
        rmtree(self.folder / "changed", ignore_errors=True)
        copytree(self.folder / "right", self.folder / "changed")
        names = change(self.folder / "changed", random)
        outcome = called(("verify", "changed"), self.folder)
        name, said = change.__name__, outcome.out + outcome.err
        if fault := outcome.fault(DIFFERS, REFUSED):
            tally.found.append(f"{name} of a folder, {names[0]}: {fault}: {outcome.err.strip()[-400:]}")
        elif not any(each in said for each in names):
            tally.found.append(f"{name} of a folder, {names[0]}: not named: {outcome.err.strip()[-400:]}")
        else:
            (tally.refused if outcome.code == REFUSED else tally.named)[name] += 1


def load(folder: Path, words: Sequence[str]) -> None:
    """Call a command in this process, so that copies of it have what it loads."""
    from rubnoise.cli.app import main

    with chdir(folder):
        sys.argv = ["rubnoise", *words]
        try:
            with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as said:
                main()
        except SystemExit as left:
            if left.code:
                raise RuntimeError(f"{words}: {out.getvalue()}{said.getvalue()}") from left


def _names(told: str, place: Place) -> bool:
    """Whether an answer says where a file differs: the attribute, the hash of all of them, or the group of a column.

    A value that does not agree with others of its row may be named as any of these.
    """
    told = " ".join(told.replace(" attribute ", " ").split())
    if place.attribute == HASH and place.path.count("/") > 1:
        return f"{place.path} {UNLIKE}" in told
    if place.attribute == "scenario_resolved" and ("/provenance scenario_toml" in told or " rows is " in told):
        return True  # the two do not agree; or a text that extends a file leaves the key open, and the rows do not fit
    if place.attribute:
        sealed = place.path in {"/", "/summary", "/provenance"} and SEAL in told
        return sealed or f" {place.attribute} " in told or OTHERWISE.get(place.attribute, str(place)) in told
    group = "/".join(place.path.split("/")[:2])
    return f"{place.path} " in told or f"{group}/" in told


def judged(seed: int, numbers: Sequence[int]) -> Tally:
    """Judge changes by their numbers."""
    tally, kinds = Tally(), list(KINDS)
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        judge = Judge(Path(name))
        for number in numbers:
            random = Random(f"{seed}/{number}")  # noqa: S311  (no secret)
            change = CHANGES[number % len(CHANGES)]
            judge.judge(change, random.choice(kinds), random, sealed=random.random() < 0.5, tally=tally)
    return tally


def folders_judged(seed: int, numbers: Sequence[int]) -> Tally:
    """Judge changes of the folder of a sweep by their numbers."""
    tally = Tally()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        judge = FolderJudge(Path(name))
        for number in numbers:
            random = Random(f"{seed}/folder/{number}")  # noqa: S311  (no secret)
            judge.judge(change_folder.CHANGES[number % len(change_folder.CHANGES)], random, tally)
    return tally


def main() -> int:
    """Change results, print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--count", type=int, default=550, help="changes (550)")
    parser.add_argument("--folders", type=int, default=100, help="changes of the folder of a sweep (100)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the changes (1)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (2)")
    parser.add_argument("--only", type=int, nargs="*", help="the numbers of the changes to make once more")
    asked = parser.parse_args()
    numbers: list[int] = list(range(asked.count)) if asked.only is None else asked.only
    tally = Tally()
    with ProcessPoolExecutor(asked.jobs) as pool:
        seeds = [asked.seed] * asked.jobs
        for task, all_of_them in (
            (judged, numbers),
            (folders_judged, range(asked.folders if asked.only is None else 0)),
        ):
            for some in pool.map(task, seeds, [all_of_them[n :: asked.jobs] for n in range(asked.jobs)]):
                tally.add(some)
    return told(tally)


def told(tally: Tally) -> int:
    """Print the counts and everything that was found; return the exit code."""
    kinds = sorted({*tally.named, *tally.refused, *tally.hidden})
    print(f"{'change':<30}{'named':>8}{'refused':>9}{'hidden':>8}")
    for name in kinds:
        print(f"{name:<30}{tally.named[name]:>8}{tally.refused[name]:>9}{tally.hidden[name]:>8}")
    named, refused, hidden = (counter.total() for counter in (tally.named, tally.refused, tally.hidden))
    print(f"{'changes':<30}{named:>8}{refused:>9}{hidden:>8}")
    for each in tally.found:
        print(f"- {each}")
    print(f"{named + refused + hidden + len(tally.found)} tried, {len(tally.found)} unnoticed or not named")
    return int(bool(tally.found))


if __name__ == "__main__":
    sys.exit(main())

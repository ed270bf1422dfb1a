"""Faults that the tests have to notice: `python3 tools/mutants.py [NAME ...] [--jobs N]`.

Each fault of tools/faults is put into a copy of the program, and the test that is named beside it runs there. It has
to fail by an assertion, and to show |z| >= 8 where it is a matter of chance; without any fault every one of these tests
has to pass. Prints a table; exit code 1 where a fault survives. dev.py has to have set up before.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

ROOT = Path(__file__).resolve().parent.parent
SEEN = 8.0
KINDS = (".py", ".js")
"""Files of the program in which a fault may be."""

ASSERTED = (" - assert", " - AssertionError", " - Failed: ", " - rubnoise.")
"""How pytest reports a test that failed by what it asserts or by an exception of ours, not by an error of its own."""

COPIED = ("src", "tests", "pyproject.toml")
LEFT = shutil.ignore_patterns("*.nbi", "*.nbc")
"""Compiled kernels: each copy has its own. Compiled modules may come, since Python tells a changed one by its time."""
WORK = ROOT / ".venv" / "bin" / "python"
PYTHON = WORK if WORK.exists() else Path(sys.executable)
FAULTS = ROOT / "tools" / "faults"


@dataclass(frozen=True)
class Edit:
    """A text that stands exactly once in the program, whatever file holds it, and what stands there instead.

    Blanks and line ends are all one, so that a text is found however it is indented or wrapped; further lines of
    ``new`` are indented as the line is in which the text begins.
    """

    old: str
    new: str


@dataclass(frozen=True)
class Mutant:
    """A fault by its name, the edits that make it, and the test that notices it, wherever in tests that stands.

    ``test`` is the name of a test function, with [parameters] for one case of it, and behind "test_file.py::" where
    several files have a test of that name. ``chance``: whether that test scores figures, so that it has to show
    |z| >= 8 and not only fail.
    """

    name: str
    edits: tuple[Edit, ...]
    test: str
    chance: bool = False


def read_faults(path: Path) -> tuple[Mutant, ...]:
    """Return the faults of one room: a table [[fault]] each, with old and new, or a list of edits."""
    faults = tomllib.loads(path.read_text(encoding="utf-8"))["fault"]
    return tuple(
        Mutant(
            name=each["name"],
            edits=tuple(Edit(edit["old"], edit["new"]) for edit in each.get("edits", [each])),
            test=each["test"],
            chance=each.get("chance", False),
        )
        for each in faults
    )


ROOMS = {path.stem: read_faults(path) for path in sorted(FAULTS.glob("*.toml"))}
MUTANTS = tuple(mutant for room in ROOMS.values() for mutant in room)


class DoesNotApply(Exception):  # noqa: N818  (a message for a person, printed as it is)
    """What a fault or its test is known by does not stand exactly once where it should."""


@dataclass(frozen=True)
class Trial:
    """What a run of one test came to: the reasons of its failures, its scores, whether all passed, and its report."""

    failures: tuple[str, ...]
    scores: tuple[tuple[float, str], ...]
    passed: bool
    report: str

    @property
    def largest(self) -> tuple[float, str]:
        """The score of the largest |z|, with its figure; 0 where there is none."""
        return max(self.scores, key=lambda score: abs(score[0]), default=(0.0, ""))


@dataclass(frozen=True)
class Verdict:
    """Whether a fault was noticed, and by what."""

    killed: bool
    evidence: str
    seconds: float


def sources(package: Path) -> dict[Path, str]:
    """Return the texts of the program's files."""
    files = (path for path in sorted(package.rglob("*")) if path.suffix in KINDS)
    return {path: path.read_text(encoding="utf-8") for path in files}


def mutated(texts: Mapping[Path, str], edit: Edit) -> tuple[Path, str]:
    """Return the file in which a fault's text stands and its text with the fault in it.

    Raises DoesNotApply unless the text stands exactly once in all files; blanks and line ends are all one.
    """
    pattern = re.compile(r"\s+".join(map(re.escape, edit.old.split())))
    found = [(path, match) for path, text in texts.items() for match in pattern.finditer(text)]
    if len(found) != 1:
        places = "".join(f"\n  {path}" for path, _ in found)
        raise DoesNotApply(f"src/rubnoise has {len(found)} times, not once: {edit.old!r}{places}")
    path, match = found[0]
    text = texts[path]
    line = text[text.rfind("\n", 0, match.start()) + 1 :]
    indent = line[: len(line) - len(line.lstrip())]
    return path, text[: match.start()] + edit.new.replace("\n", f"\n{indent}") + text[match.end() :]


def applied(mutant: Mutant, texts: Mapping[Path, str]) -> dict[Path, str]:
    """Return the texts that a fault changes, with the fault in them, by file."""
    changed: dict[Path, str] = {}
    for edit in mutant.edits:
        path, text = mutated({**texts, **changed}, edit)
        changed[path] = text
    return changed


@lru_cache(maxsize=4)
def _tests(folder: Path) -> dict[Path, str]:
    return {path: path.read_text(encoding="utf-8") for path in sorted(folder.rglob("test_*.py"))}


def test_of(mutant: Mutant, folder: Path) -> str:
    """Return the test of a fault as pytest knows it; raises DoesNotApply unless one file has a test of that name."""
    file, _, test = mutant.test.rpartition("::")
    head = f"\ndef {test.partition('[')[0]}("
    found = [path for path, text in _tests(folder / "tests").items() if head in text and file in ("", path.name)]
    if len(found) != 1:
        raise DoesNotApply(f"{len(found)} files, not one, have the test {mutant.test!r} of {mutant.name!r}")
    return f"{found[0].relative_to(folder)}::{test}"


def copy_into(folder: Path) -> Path:
    """Copy what the tests need into an empty folder, and return it."""
    for name in COPIED:
        source = ROOT / name
        (shutil.copytree(source, folder / name, ignore=LEFT) if source.is_dir() else shutil.copy(source, folder))
    # Tests read scenarios and pages, and change neither.
    for name in ("docs", "notebooks", "scenarios", "tools"):
        (folder / name).symlink_to(ROOT / name)
    return folder


def tried(
    folder: Path,
    tests: Sequence[str],
    *,
    enough: bool = False,
    seconds: float | None = None,
) -> Trial:
    """Run tests in a copy, up to the first failure if one is ``enough``; what takes more ``seconds`` fails."""
    scores = folder / "scores.txt"
    scores.unlink(missing_ok=True)
    environment = os.environ | {
        "PYTHONPATH": str(folder / "src"),
        # Python tells a changed file by its time in seconds and its size, which one fault after another may share.
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_CACHE_DIR": str(folder / "machine code"),
        "RUBNOISE_SCORES": str(scores),
        "COLUMNS": "1000",
    }
    command = [str(PYTHON), "-m", "pytest", "-q", "-rfE", "--tb=no", "-p", "no:cacheprovider", *["-x"] * enough, *tests]
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=seconds
        )
    except subprocess.TimeoutExpired:
        return Trial(failures=("TIMEOUT",), scores=(), passed=False, report=f"longer than {seconds} s")
    lines = scores.read_text(encoding="utf-8").splitlines() if scores.exists() else []
    return Trial(
        failures=tuple(line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))),
        scores=tuple((float(z), name) for z, name in (line.split("\t") for line in lines)),
        passed=done.returncode == 0,
        report=done.stdout + done.stderr,
    )


def judged(mutant: Mutant, folder: Path) -> Verdict:
    """Put a fault into a copy, run its test there, take it out again, and say whether it was noticed."""
    begun = time.monotonic()
    package = folder / "src" / "rubnoise"
    before = sources(package)
    texts = applied(mutant, before)
    times = {path: path.stat() for path in texts}
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
    try:
        # Where faults are a matter of chance all cases are scored, and the largest score counts.
        trial = tried(folder, [test_of(mutant, folder)], enough=not mutant.chance)
    finally:
        for path, status in times.items():
            path.write_text(before[path], encoding="utf-8")
            # What was compiled of it before holds again.
            os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    killed, evidence = _evidence(mutant, trial)
    return Verdict(killed, evidence, time.monotonic() - begun)


def _evidence(mutant: Mutant, trial: Trial) -> tuple[bool, str]:
    if trial.passed:
        return False, "survives"
    if not trial.failures or not all(any(word in line for word in ASSERTED) for line in trial.failures):
        return False, "no assertion failed: " + (trial.report.strip().splitlines() or ["no word from pytest"])[-1]
    if not mutant.chance:
        return True, "asserted"
    z, figure = trial.largest
    return abs(z) >= SEEN, f"z = {z:+.1f}, {figure}"


def verdicts(mutants: Iterable[Mutant], folders: Sequence[Path]) -> Iterable[tuple[Mutant, Verdict]]:
    """Try faults in turn, as many at a time as there are copies."""
    free: SimpleQueue[Path] = SimpleQueue()
    for folder in folders:
        free.put(folder)

    def attempt(mutant: Mutant) -> tuple[Mutant, Verdict]:
        folder = free.get()
        try:
            return mutant, judged(mutant, folder)
        finally:
            free.put(folder)

    with ThreadPoolExecutor(len(folders)) as pool:
        yield from pool.map(attempt, mutants)


def chosen(names: Sequence[str]) -> list[Mutant]:
    """Return the mutants of these names, or all; ends the program for a name that is none's."""
    by_name = {mutant.name: mutant for mutant in MUTANTS}
    unknown = [name for name in names if name not in by_name]
    if unknown:
        raise SystemExit(f"no fault is called {unknown[0]!r}; there are: {', '.join(by_name)}")
    return [by_name[name] for name in names] if names else list(MUTANTS)


def main() -> int:
    """Try the faults and print what noticed them."""
    parser = argparse.ArgumentParser(description="Faults that the tests have to notice.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="faults by name; all where none is given")
    parser.add_argument("--jobs", type=int, default=1, help="how many at a time")
    asked = parser.parse_args()
    mutants = chosen(asked.names)
    with tempfile.TemporaryDirectory(prefix="rubnoise-mutants-") as place:
        folders = [copy_into(Path(tempfile.mkdtemp(dir=place))) for _ in range(max(asked.jobs, 1))]
        return _report(mutants, folders)


def _report(mutants: Sequence[Mutant], folders: Sequence[Path]) -> int:
    sound = tried(folders[0], sorted({test_of(mutant, folders[0]) for mutant in mutants}))
    if not sound.passed:
        print(sound.report, "without any fault these tests have to pass", sep="\n", file=sys.stderr)
        return 1
    z, figure = sound.largest
    print(f"{'no fault':44} passed     largest z = {z:+.1f}, {figure}", flush=True)
    survived = 0
    for mutant, verdict in verdicts(mutants, folders):
        survived += not verdict.killed
        word = "killed" if verdict.killed else "SURVIVED"
        print(f"{mutant.name:44} {word:9}  {verdict.evidence:48} {mutant.test}  {verdict.seconds:.0f} s", flush=True)
    print(f"{len(mutants) - survived} of {len(mutants)} killed")
    return int(survived > 0)


if __name__ == "__main__":
    sys.exit(main())

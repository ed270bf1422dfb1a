"""Faults that the tests have to notice: `python3 tools/mutants.py [NAME ...] [--jobs N]`, once dev.py has set up.

Each fault of tools/mutations.py is put into a copy of the program, and the test that is named beside it runs there. It
has to fail by an assertion, and to show |z| >= 8 where it is a matter of chance; without any fault every one of these
tests has to pass. Prints a table; exit code 1 where a fault survives.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bootstrap import ROOT, WORK
from mutations import MUTANTS, Edit, Mutant

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

SEEN = 8.0
COPIED = ("src", "tests", "pyproject.toml")
LEFT = shutil.ignore_patterns("__pycache__", "*.pyc")
PYTHON = WORK.python if WORK.python.exists() else Path(sys.executable)


class DoesNotApply(Exception):  # noqa: N818  (a message for a person, printed as it is)
    """The text that a fault replaces does not stand exactly once where it should."""


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


def mutated(text: str, edit: Edit) -> str:
    """Return a file's text with a fault in it; raises DoesNotApply unless the old text stands there once."""
    if text.count(edit.old) != 1:
        raise DoesNotApply(f"src/rubnoise/{edit.file} has {text.count(edit.old)} times, not once: {edit.old!r}")
    return text.replace(edit.old, edit.new)


def applied(mutant: Mutant, package: Path) -> dict[Path, str]:
    """Return the texts of the files of a package that a fault changes, with the fault in them."""
    texts: dict[Path, str] = {}
    for edit in mutant.edits:
        path = package / edit.file
        texts[path] = mutated(texts.get(path) or path.read_text(encoding="utf-8"), edit)
    return texts


def copy_into(folder: Path) -> Path:
    """Copy what the tests need into an empty folder, and return it."""
    for name in COPIED:
        source = ROOT / name
        (shutil.copytree(source, folder / name, ignore=LEFT) if source.is_dir() else shutil.copy(source, folder))
    # Tests read scenarios and pages, and change neither.
    for name in ("docs", "scenarios", "tools"):
        (folder / name).symlink_to(ROOT / name)
    return folder


def tried(folder: Path, tests: Sequence[str], compiled: str = "as it is") -> Trial:
    """Run tests in a copy; ``compiled`` names the machine code that may be used again."""
    scores = folder / "scores.txt"
    scores.unlink(missing_ok=True)
    environment = os.environ | {
        "PYTHONPATH": str(folder / "src"),
        # Python and the compiler tell a changed file by its time and size, which one fault after another may share.
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_CACHE_DIR": str(folder / "machine code" / compiled),
        "RUBNOISE_SCORES": str(scores),
        "COLUMNS": "1000",
    }
    command = [str(PYTHON), "-m", "pytest", "-q", "-rfE", "--tb=no", "-p", "no:cacheprovider", *tests]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
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
    texts = applied(mutant, folder / "src" / "rubnoise")
    before = {path: path.read_text(encoding="utf-8") for path in texts}
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
    try:
        # The compiler's cache does not see that a file has changed whose functions another one calls.
        is_compiled = any(path.parent.name == "simulation" for path in texts)
        trial = tried(folder, [mutant.test], mutant.name.replace("/", " ") if is_compiled else "as it is")
    finally:
        for path, text in before.items():
            path.write_text(text, encoding="utf-8")
    killed, evidence = _evidence(mutant, trial)
    return Verdict(killed, evidence, time.monotonic() - begun)


def _evidence(mutant: Mutant, trial: Trial) -> tuple[bool, str]:
    if trial.passed:
        return False, "survives"
    if not trial.failures or not all(" - assert" in line or " - AssertionError" in line for line in trial.failures):
        return False, "no assertion failed: " + (trial.report.strip().splitlines() or ["no word from pytest"])[-1]
    if mutant.identity:
        return True, "identity"
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
    parser.add_argument("--list", action="store_true", help="only print the names, with file and test")
    asked = parser.parse_args()
    mutants = chosen(asked.names)
    if asked.list:
        for mutant in mutants:
            print(f"{mutant.name:40} {mutant.edits[0].file:28} {mutant.test}")
        return 0
    with tempfile.TemporaryDirectory(prefix="rubnoise-mutants-") as place:
        folders = [copy_into(Path(tempfile.mkdtemp(dir=place))) for _ in range(max(asked.jobs, 1))]
        return _report(mutants, folders)


def _report(mutants: Sequence[Mutant], folders: Sequence[Path]) -> int:
    sound = tried(folders[0], sorted({mutant.test for mutant in mutants}))
    if not sound.passed:
        print(sound.report, "without any fault these tests have to pass", sep="\n", file=sys.stderr)
        return 1
    z, figure = sound.largest
    print(f"{'no fault':38} passed     largest z = {z:+.1f}, {figure}", flush=True)
    survived = 0
    for mutant, verdict in verdicts(mutants, folders):
        survived += not verdict.killed
        word = "killed" if verdict.killed else "SURVIVED"
        test = mutant.test.removeprefix("tests/")
        print(f"{mutant.name:38} {word:9}  {verdict.evidence:48} {test}  {verdict.seconds:.0f} s", flush=True)
    print(f"{len(mutants) - survived} of {len(mutants)} killed")
    return int(survived > 0)


if __name__ == "__main__":
    sys.exit(main())

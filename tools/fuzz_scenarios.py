"""Damaged scenarios, thrown at `check` and `run --dry-run`: `python tools/fuzz_scenarios.py --count 5000 --jobs 2`.

Each is made from one of scenarios/, by bytes, tokens or lines, and goes to one of the two commands in a process of its
own with limits on time and memory. It has to be accepted or refused; whatever else happens is counted and printed, and
the exit code is 1 then.
"""

import argparse
import os
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from random import Random

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from fuzz.isolated import called  # noqa: E402
from fuzz.words import changed  # noqa: E402

COMMANDS = (("check", "{}"), ("run", "{}", "--dry-run", "-o", "result.h5"), ("check", "{}", "--json"))
ENDS = (0, 2)
SECONDS = 300.0
"""Births are counted before a run is accepted or refused: 2e9 of them take a minute on a machine that is idle."""
MEMORY_BYTES = 1 << 29


@dataclass(slots=True, kw_only=True)
class Tally:
    """How many scenarios of each change there were, how they ended, the longest time taken, and what went wrong."""

    changes: Counter[str] = field(default_factory=Counter)
    ends: Counter[int] = field(default_factory=Counter)
    seconds: float = 0.0
    found: list[str] = field(default_factory=list)

    def add(self, other: "Tally") -> None:
        """Add what another process counted."""
        self.changes += other.changes
        self.ends += other.ends
        self.seconds = max(self.seconds, other.seconds)
        self.found += other.found


def scenarios() -> list[Path]:
    """Return the scenarios that are shipped."""
    return sorted((ROOT / "scenarios").rglob("*.toml"))


def thrown(seed: int, numbers: Sequence[int]) -> Tally:
    """Throw scenarios by their numbers."""
    tally = Tally()
    sources = scenarios()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        folder = Path(name)
        _load(folder, sources[0])
        for number in numbers:
            random = Random(f"{seed}/{number}")  # noqa: S311  (damage is no secret)
            source = random.choice(sources)
            change, content = changed(source.read_bytes(), random)
            (folder / "changed.toml").write_bytes(content)
            words = [word.format("changed.toml") for word in COMMANDS[number % len(COMMANDS)]]
            outcome = called(words, folder, seconds=SECONDS, memory=MEMORY_BYTES)
            tally.changes[change] += 1
            tally.ends[outcome.code] += 1
            tally.seconds = max(tally.seconds, outcome.seconds)
            if fault := outcome.fault(*ENDS):
                tally.found.append(f"{change} {number} of {source.name}, {words[0]}: {fault}: {outcome.err[-400:]}")
    return tally


def _load(folder: Path, source: Path) -> None:
    """Load now what the commands load, so that no copy has to."""
    from rubnoise.cli.app import main

    here = Path.cwd()
    os.chdir(folder)
    sys.argv = ["rubnoise", "check", str(source)]
    try:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()), suppress(SystemExit):
            main()
    finally:
        os.chdir(here)


def main() -> int:
    """Throw the scenarios, print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--count", type=int, default=1000, help="damaged scenarios (1000)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the damage (1)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (2)")
    parser.add_argument("--only", type=int, nargs="*", help="the numbers of the scenarios to throw once more")
    asked = parser.parse_args()
    numbers: list[int] = list(range(asked.count)) if asked.only is None else asked.only
    tally = Tally()
    with ProcessPoolExecutor(asked.jobs) as pool:
        parts = [pool.submit(thrown, asked.seed, numbers[job :: asked.jobs]) for job in range(asked.jobs)]
        for part in parts:
            tally.add(part.result())
    for name, count in sorted(tally.changes.items()):
        print(f"{name:<20}{count:>8}")
    for code, count in sorted(tally.ends.items()):
        print(f"exit code {code:<10}{count:>8}")
    print(f"longest {tally.seconds:.1f} s")
    print("\n".join([*tally.found, f"{len(tally.found)} found"]))
    return int(bool(tally.found))


if __name__ == "__main__":
    sys.exit(main())

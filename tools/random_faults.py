"""Random faults in a room: `tools/random_faults.py ROOM TESTS [--count N] [--seed S]`, with cosmic-ray installed.

Draws faults of cosmic-ray in the files of `src/rubnoise/ROOM`, puts one at a time into a copy of the program, and runs
the tests there. Those that take a minute more than twice their time without a fault hang, which is noticed, too. Prints
each fault with its line, and how many survive.
"""

import argparse
import re
import sys
import tempfile
import time
from pathlib import Path
from random import Random

from cosmic_ray.ast import ast_nodes, get_ast_from_path  # type: ignore[import-not-found]
from cosmic_ray.mutating import mutate_code  # type: ignore[import-not-found]
from cosmic_ray.plugins import get_operator, operator_names  # type: ignore[import-not-found]

sys.path.insert(0, str(Path(__file__).resolve().parent))

import mutants

SECONDS = 60


def faults(path: Path) -> list[tuple[Path, str, int, int]]:
    """Return file, operator, number and line of every fault that can be drawn in a file."""
    tree = get_ast_from_path(path)
    found = []
    for name in operator_names():
        if get_operator(name).arguments() or re.search("Bit|Shift", name):  # no operators of the program
            continue
        operator, number = get_operator(name)(), 0
        for node in ast_nodes(tree):
            for (line, _), _ in operator.mutation_positions(node):
                found.append((path, name, number, line))
                number += 1
    return found


def main() -> int:
    """Draw faults and print those that survive."""
    parser = argparse.ArgumentParser(description="Random faults in a room.")
    parser.add_argument("room", help="a folder or file of src/rubnoise")
    parser.add_argument("tests", nargs="+", help="what to run against each fault")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="rubnoise-random-") as place:
        copy = mutants.copy_into(Path(place))
        room = copy / "src" / "rubnoise" / asked.room
        every = [each for path in sorted(room.rglob("*.py") if room.is_dir() else [room]) for each in faults(path)]
        drawn = Random(asked.seed).sample(every, min(asked.count, len(every)))  # noqa: S311  (no secret)
        begun = time.monotonic()
        if not mutants.tried(copy, asked.tests, enough=True).passed:
            raise SystemExit("without any fault these tests have to pass")
        longest = SECONDS + 2.0 * (time.monotonic() - begun)
        survived = 0
        for path, name, number, line in drawn:
            before = path.read_text(encoding="utf-8")
            path.write_text(mutate_code(before, get_operator(name)(), number), encoding="utf-8")
            compiled = f"random {name} {number}".replace("/", " ")
            trial = mutants.tried(copy, asked.tests, compiled, enough=True, seconds=longest)
            path.write_text(before, encoding="utf-8")
            survived += trial.passed
            word = "SURVIVED" if trial.passed else "hangs" if trial.failures == ("TIMEOUT",) else "killed"
            shown = before.splitlines()[line - 1].strip()
            place_of_it = path.relative_to(copy / "src" / "rubnoise")
            print(f"{word:9} {place_of_it}:{line}  {name.rpartition('/')[2]}  {shown}", flush=True)
    print(f"{survived} of {len(drawn)} survived")
    return int(survived > 0)


if __name__ == "__main__":
    sys.exit(main())

"""Write what is generated or frozen: `python3 tools/dev.py generate [NAME ...]`, everything without a name.

Each name below is a kind of file; a test finds one that is out of date. `golden` and `frozen` hold what the program
computes today: write them after a change that was meant, and read the difference.
"""

import argparse
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FROZEN = (
    *("tests/shell/test_refusals.py", "tests/docs/test_constants.py", "tests/unit/test_laws.py"),
    *("tests/unit/test_pulses.py", "tests/unit/test_refusals.py", "tests/unit/test_scenario_traps.py"),
)
"""Tests that hold frozen values or words."""


def called(*words: str) -> Callable[[], object]:
    """Return what calls a program of ours in the project's folder; raises CalledProcessError where it fails."""
    return lambda: subprocess.run([sys.executable, *words], cwd=ROOT, check=True)


def schema() -> None:
    """Write the schema of scenario files."""
    text = subprocess.run([sys.executable, "-m", "rubnoise", "schema"], stdout=subprocess.PIPE, check=True).stdout
    (ROOT / "scenarios" / "scenario.schema.json").write_bytes(text)


STEPS: dict[str, tuple[str, Callable[[], object]]] = {
    "pages": ("keys, columns, numbers and the map of the package in docs", called("tools/generate_docs.py")),
    "schema": ("scenarios/scenario.schema.json", schema),
    "notebooks": ("plain notebooks", called("tools/export_notebooks.py")),
    "drawings": ("drawings that explain the model, light and dark", called("tools/draw_pages.py")),
    "gallery": ("the pictures of docs/gallery.md, in minutes", called("tools/generate_gallery.py")),
    "paper": ("claims of the paper and of its field, in minutes", called("tools/paper")),
    "golden": ("bits and values of golden runs", called("-m", "tests.reference.hashes", "--write")),
    "frozen": ("frozen values and words of refusals", called("-m", "pytest", "-n0", "--freeze", *FROZEN)),
    "ceilings": ("how much each room holds at most, lowered", called("-m", "tests.architecture.test_ceilings")),
}


def main() -> int:
    """Do the steps that are named, or all."""
    about = "".join(f"\n  {name:<10} {words}" for name, (words, _) in STEPS.items())
    parser = argparse.ArgumentParser(
        prog="dev.py generate", epilog=f"names:{about}", formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME")
    names = parser.parse_args().names
    if unknown := sorted(set(names) - set(STEPS)):
        parser.error(f"no such name: {', '.join(unknown)}")
    for name in names or STEPS:
        print(f"generate: {name}", file=sys.stderr)
        STEPS[name][1]()
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Make a study that a page tells of: `.venv/bin/python tools/studies NAME ...`; NAME --help says more of each."""

import sys
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("detection", "free_motion", "inference", "two_way")


def main() -> int:
    """Call the study that is named with the words behind its name, and return its exit code."""
    if len(sys.argv) < 2 or sys.argv[1] not in NAMES:
        print(f"studies: give one of these names: {', '.join(NAMES)}", file=sys.stderr)
        return 2
    name = sys.argv.pop(1)
    sys.argv[0] = f"studies {name}"
    sys.path[:0] = [str(ROOT), str(ROOT / "src"), str(ROOT / "tools")]  # studies use what tests and tools have
    return int(import_module(f"studies.{name}").main())


if __name__ == "__main__":
    sys.exit(main())

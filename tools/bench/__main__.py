"""The benchmark's command line: `python3 tools/dev.py bench [--quick] [--output FOLDER]`."""

import argparse
import sys
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

DOCS = Path(__file__).resolve().parents[2] / "docs"


def main(arguments: Sequence[str]) -> int:
    """Measure, then write or print the page; where something was computed wrong, only say what, and return 1."""
    parser = argparse.ArgumentParser(prog="tools/dev.py bench", description="rubnoise beside other tools.")
    parser.add_argument("--quick", action="store_true", help="a taste in a minute or two; printed, not written")
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="where performance.md goes instead of docs")
    asked = parser.parse_args(arguments)
    from bench import measure
    from bench.checks import Wrong
    from bench.page import page

    begin = time.monotonic()

    def tell(text: str) -> None:
        print(f"bench: {time.monotonic() - begin:5.0f} s  {text}", file=sys.stderr, flush=True)

    try:
        with TemporaryDirectory() as folder:
            found = measure.measured(measure.QUICK if asked.quick else measure.FULL, Path(folder), tell)
        text = page(found, datetime.now(UTC).date())
    except Wrong as wrong:
        print(*(f"bench: wrong: {fault}" for fault in wrong.args), sep="\n", file=sys.stderr)
        return 1
    output = asked.output or (None if asked.quick else DOCS)
    if output is None:
        print(text, end="")
    else:
        (output / "performance.md").write_text(text, encoding="utf-8")
        print(f"{output / 'performance.md'} written")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""The benchmark's command line: `python3 tools/dev.py bench [--quick] [--output FOLDER]`."""

import argparse
import sys
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bench.results import Results, Tell

DOCS = Path(__file__).resolve().parents[2] / "docs"


def main(arguments: Sequence[str]) -> int:
    """Measure, then write or print the page; where something was computed wrong, only say what, and return 1."""
    asked = _parser().parse_args(arguments)
    from bench.checks import Wrong
    from bench.page import page
    from bench.plan import FULL, QUICK
    from bench.results import measured

    try:
        with TemporaryDirectory() as folder:
            found = measured(QUICK if asked.quick else FULL, Path(folder), _teller())
        text = page(found, datetime.now(UTC).date())
    except Wrong as wrong:
        print(*(f"bench: wrong: {fault}" for fault in wrong.args), sep="\n", file=sys.stderr)
        return 1
    output = asked.output or (None if asked.quick else DOCS)
    if output is None:
        print(text, end="")
    else:
        _write(output, text, found)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="tools/dev.py bench", description="rubnoise beside everything else.")
    parser.add_argument("--quick", action="store_true", help="a taste in a minute or two; printed, not written")
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="where performance.md goes instead of docs")
    return parser


def _write(folder: Path, text: str, found: "Results") -> None:
    from bench.picture import picture

    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    (folder / "pictures" / "performance.png").write_bytes(picture(found))
    (folder / "performance.md").write_text(text, encoding="utf-8")
    print(f"{folder / 'performance.md'} written")


def _teller() -> "Tell":
    begin = time.monotonic()
    return lambda text: print(f"bench: {time.monotonic() - begin:5.0f} s  {text}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

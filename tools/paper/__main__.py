"""The command line of the paper: `python tools/paper`, in an environment of `tools/dev.py sync`."""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # beside this package, as its modules name it

from paper.ledger import LEDGERS, Claim, Ledger, as_row, unexpected
from paper.pages import place, written

EPILOG = "Exit code 1 if a page is out of date, 3 if simulation and theory, or a verdict and the expected one, differ."


def main(arguments: Sequence[str] | None = None) -> int:
    """Settle every claim, and write the pages, print the rows or compare the pages with them."""
    asked = _parser().parse_args(arguments)
    ledgers = [Ledger(path, _tell) for path in LEDGERS.values()]
    settled = [(ledger, list(ledger.claims())) for ledger in ledgers]
    claims = [claim for _, own in settled for claim in own]
    wrong = unexpected(claims)
    print(*(f"paper: {line}" for line in wrong), sep="\n", end="\n" if wrong else "", file=sys.stderr)
    if asked.json:
        print(json.dumps({"claims": [as_row(claim, each) for claim in claims for each in claim.numbers]}))
    elif not wrong:
        return _pages(settled, check=asked.check)
    return 3 if wrong else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python tools/paper", description=__doc__, epilog=EPILOG)
    parser.add_argument("--json", action="store_true", help="print every claim's rows; write nothing")
    parser.add_argument("--check", action="store_true", help="say which page is out of date; write nothing")
    return parser


def _pages(settled: Sequence[tuple[Ledger, Sequence[Claim]]], *, check: bool) -> int:
    """Write each page that is out of date, or only say so; return 1 for one that was found so."""
    stale = 0
    for ledger, claims in settled:
        path, text = place(ledger), written(ledger, claims)
        if text == path.read_text(encoding="utf-8"):
            continue
        stale += 1
        if not check:
            path.write_text(text, encoding="utf-8")
        print(f"docs/{path.name}", "is out of date" if check else "written")
    return int(check and stale > 0)


def _tell(text: str) -> None:
    print(text, file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())

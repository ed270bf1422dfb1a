"""The command line of the paper: `python tools/paper`, in an environment of `tools/dev.py sync`."""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # above this package, as its modules name it

from paper.figures import FIGURES, Sources, draw
from paper.ledger import LEDGERS, Ledger, as_row, unexpected
from paper.pages import place, written
from rubnoise.errors import RubnoiseError
from rubnoise.figures.style import FORMATS

EPILOG = """Without options every claim is tested, and docs/paper.md and docs/field.md are written. With -o the figures
are drawn and no claim is tested. Exit code 2: refused; 3: a verdict is not as expected, and no page is written."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw figures, or settle every claim and write the pages, or print the rows."""
    asked = _parser().parse_args(arguments)
    try:
        if asked.figures or asked.output:
            sources = Sources(folder=asked.scenarios, tell=_tell)
            draw(asked.figures, asked.output or Path("figures"), asked.format or (), sources, force=asked.force)
            return 0
        return _claims(as_json=asked.json)
    except RubnoiseError as problem:
        print(f"paper: {problem}", file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python tools/paper", description=__doc__, epilog=EPILOG)
    parser.add_argument("figures", nargs="*", metavar="FIG", help=f"{', '.join(FIGURES)}; all of them without a name")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="draw figures into a folder")
    parser.add_argument("--format", action="append", choices=FORMATS, help="of the figures; repeat it for several")
    parser.add_argument("--scenarios", type=Path, metavar="DIR", help="a folder with scenarios of the same names")
    parser.add_argument("--force", action="store_true", help="replace existing pictures")
    parser.add_argument("--json", action="store_true", help="print a row for every number of a claim; write nothing")
    return parser


def _claims(*, as_json: bool) -> int:
    ledgers = [Ledger(path, _tell) for path in LEDGERS.values()]
    settled = [(ledger, list(ledger.claims())) for ledger in ledgers]
    claims = [claim for _, own in settled for claim in own]
    wrong = unexpected(claims)
    for line in wrong:
        print(f"paper: {line}", file=sys.stderr)
    if as_json:
        print(json.dumps({"claims": [as_row(claim, each) for claim in claims for each in claim.numbers]}))
    elif not wrong:
        for ledger, own in settled:
            place(ledger).write_text(written(ledger, own), encoding="utf-8")
    return 3 if wrong else 0


def _tell(text: str) -> None:
    print(text, file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())

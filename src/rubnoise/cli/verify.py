"""`rubnoise verify`: check that every value of a result file is right."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from rubnoise.cli.commands import Command
from rubnoise.cli.layout import grouped, json_text, printable, remark
from rubnoise.cli.options import AsJson, ResultFile
from rubnoise.cli.progress import StatusLine, on_terminal, watching_reads
from rubnoise.errors import RunDiffers
from rubnoise.regular_file import is_folder

if TYPE_CHECKING:
    from rubnoise.runs.verification import Check, Difference, Verification

REGENERATE: Final = "--regenerate"


class BareCount(Command):
    """A command whose option --regenerate may have no number."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Add the default number to the option if it has none."""
        words = []
        for word, following in zip(args, [*args[1:], ""], strict=True):
            bare = word == REGENERATE and not following.lstrip("-").isdigit()
            words += [word, "1"] if bare else [word]
        return super().parse_args(ctx, words)


SETTINGS: Final = {"cls": BareCount}
"""How the command is registered."""


def command(
    file: ResultFile,
    *,
    regenerate: Annotated[
        int | None,
        typer.Option(
            REGENERATE,
            help="Refuse a file whose random numbers cannot be drawn again here; rows are made again in any case.",
            metavar="[K]",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Play a run again, and compare every value of its result.

    The exit code is 3 if something differs.

    For the folder of a sweep, check its names and index too, and every run.

    Example: rubnoise verify fig5.h5
    """
    from rubnoise.cli.loading import finished_run
    from rubnoise.runs.verification import verify

    if regenerate is not None and regenerate < 1:
        raise typer.BadParameter(f"{REGENERATE}: {regenerate} is no number; it is 1 or more")
    blocks, shown = regenerate or 0, on_terminal() and not as_json
    if is_folder(file):
        from rubnoise.runs.verify import verify_sweep

        with StatusLine(shown=shown) as line:
            found = verify_sweep(file, blocks, lambda done, runs: line.show(f"{done:,} of {runs:,} runs verified"))
    else:
        with finished_run(file) as run, watching_reads(run, shown=shown):
            found = verify(run, blocks)
    print(json_text(verification_as_json(found, file)) if as_json else "\n".join(format_verification(found, file)))
    if found.different:
        places = [check.first for check in found.different if check.first is not None]
        first = next((place for place in places if place.row is not None), places[0])  # one with a row says most
        raise RunDiffers(printable(f"{file}: differs: {first}{f'; {found.remark}' if found.remark else ''}"))


def verification_as_json(found: "Verification", file: Path) -> dict[str, Any]:
    """Return a verification by name."""
    return {
        "folder" if is_folder(file) else "file": str(file),
        "verified": not found.different,
        "different": list(found.failing),
        "checks": {check.name: _fields(check) for check in found.checks},
        "left_out": found.left_out,
        **({"remark": found.remark} if found.remark else {}),
    }


def format_verification(found: "Verification", file: Path) -> Iterator[str]:
    """Yield a table of the checks, the first wrong place of each failed check, and the verdict."""
    of_file = "its hashes and its run, played again"
    parts = "its runs, made again, and the index of these" if is_folder(file) else of_file
    yield f"{printable(str(file))}: compared with {parts}"
    yield f"\n{'check':<24}{'values':>16}{'different':>14}"
    for check in found.checks:
        yield f"  {check.name.replace('_', ' '):<22}{grouped(check.values):>16}{grouped(check.different):>14}"
        if check.first is not None:
            yield remark(printable(f"  {check.first}"))
    if found.omitted:
        yield "\nleft out"
        yield from (remark(printable(f"{each.name}: {each.reason}")) for each in found.omitted)
    if found.remark:
        yield "\n" + remark(printable(found.remark))
    yield ""
    failing = len(found.different)
    holding = f"{len(found.checks) - failing} of {len(found.checks)} checks hold"
    yield remark(f"{holding}; {grouped(found.values)} values checked")


def _fields(check: "Check") -> dict[str, Any]:
    fields: dict[str, Any] = {"values": check.values, "different": check.different}
    if check.first is None:
        return fields
    difference: Difference = check.first
    row = {} if difference.row is None else {"row": difference.row}
    return fields | {"place": difference.place, "found": difference.found, "expected": difference.expected} | row

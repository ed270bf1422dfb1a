"""`rubnoise compare`: a result held against the theory of its own scenario."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rubnoise.analysis.comparing.findings import Comparison


def command(
    file: Annotated[Path, typer.Argument(help="A result file.", metavar="RUN.h5", show_default=False)],
    *,
    bound: Annotated[
        float | None,
        typer.Option(
            help="Largest |z| of a figure that agrees; default: the family-wise bound of all figures.",
            metavar="Z",
            show_default=False,
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
) -> None:
    """Compare the stored rows of a result with exact theory; the exit code is 3 if a value is outside.

    Example: rubnoise compare fig5.h5
    """
    import json
    from math import isfinite

    from rubnoise.analysis.comparison import compare
    from rubnoise.analysis.records import RecordTooShort
    from rubnoise.analysis.stored_model import stored_model
    from rubnoise.cli.compare_text import described
    from rubnoise.cli.layout import printable
    from rubnoise.cli.results import finished_run
    from rubnoise.errors import Refused, RunOutside

    if bound is not None and not (isfinite(bound) and bound > 0.0):
        raise typer.BadParameter(f"--bound: {bound} is no bound on |z|; it is a number above 0")
    with finished_run(file) as run:
        try:
            found = compare(stored_model(run), run, bound)
        except RecordTooShort as refusal:
            raise Refused(str(refusal)) from refusal
        print(json.dumps(contents(found, file)) if as_json else "\n".join(described(found, file)))
    if found.outside:
        raise RunOutside(f"{printable(str(file))}: outside: {', '.join(found.outside)}")


def contents(found: "Comparison", file: Path) -> dict[str, Any]:
    """Return a comparison by name."""
    from rubnoise.analysis.agreement import FAMILY_WISE_ERROR, as_json

    identities = {
        each.name: {"deviation": each.deviation, "allowed": each.allowed, "holds": each.holds}
        for each in found.identities
    }
    return {
        "file": str(file),
        "agrees": not found.outside,
        "outside": found.outside,
        "bound": found.bound,
        "family_wise_error": FAMILY_WISE_ERROR if found.by_family else None,
        "begins": {part.heading: part.begins for part in found.parts if part.figures},
        "figures": as_json(found.figures),
        "identities": identities,
        "left_out": {each.name: each.reason for each in found.left_out},
    }

"""`rubnoise info`: what is in a result file, measured beside exact."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rubnoise.api import Run


def command(
    file: Annotated[Path, typer.Argument(help="A result file.", metavar="RUN.h5", show_default=False)],
    *,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
) -> None:
    """Say what is in a result file, and how its figures compare with the exact ones.

    Example: rubnoise info fig5.h5
    """
    import json

    from rubnoise import api
    from rubnoise.errors import RunFileRefused

    with api.open(file) as run:
        if not run.provenance["finished"]:
            raise RunFileRefused(f"{file}: unfinished; the run that writes it goes on or was stopped")
        answer = contents(run, file)
        print(json.dumps(answer) if as_json else "\n".join(described(run, answer)))


def contents(run: "Run", file: Path) -> dict[str, Any]:
    """Return what a result file holds and what follows from its scenario, by name."""
    from rubnoise.analysis.agreement import as_json
    from rubnoise.cli.derivation import derived

    origin, groups = run.provenance, run.groups()
    return {
        "file": str(file),
        "title": run.attributes["title"],
        "format_version": run.attributes["format_version"],
        "source": run.attributes["source"],
        "seed": origin["seed"],
        "command": origin["command"],
        "started": origin["started"],
        "finished": origin["finished"],
        "bytes": file.stat().st_size,
        "groups": {name: {"rows": len(group), "columns": list(group.names)} for name, group in groups.items()},
        "derived": derived(run.scenario),
        "summary": as_json(run.summary),
    }


def described(run: "Run", answer: dict[str, Any]) -> list[str]:
    """Return the same as lines to print."""
    from rubnoise.cli import derivation
    from rubnoise.cli.layout import agreement_table, grouped, line, printable, size

    lines = [
        f"{answer['file']}: {printable(answer['title'])}",
        line("written by", answer["source"]),
        line("from, to", f"{answer['started']}, {answer['finished']}"),
        line("command", answer["command"], whole=True),
        line("seed", str(answer["seed"])),
        line("size", size(answer["bytes"])),
    ]
    lines += [
        line(f"/{name}", f"{grouped(group['rows'])} rows: {', '.join(group['columns'])}")
        for name, group in answer["groups"].items()
    ]
    lines += ["", "from its scenario", *derivation.described(run.scenario, answer["derived"])]
    return [*lines, "", "measured beside exact", *agreement_table(run.summary)]

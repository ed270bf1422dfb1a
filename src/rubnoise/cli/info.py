"""`rubnoise info`: what is in a result file, measured beside exact."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rubnoise.api import Run


def command(
    file: Annotated[
        Path,
        typer.Argument(
            help="A result file, a part file, or the folder of a sweep.", metavar="RUN.h5|DIR", show_default=False
        ),
    ],
    *,
    figures: Annotated[
        str | None,
        typer.Option(
            help="Of a sweep: these figures of each point, over its replicates.", metavar="NAME,...", show_default=False
        ),
    ] = None,
    over: Annotated[
        str | None,
        typer.Option(
            help="The same over the points with this value of a swept key.", metavar="KEY=VALUE", show_default=False
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
) -> None:
    """Show a result file, with measured and exact figures, or the progress of a run or a sweep.

    Of a sweep, --figures tells numbers with their 95 % intervals, and --over ratios with theirs.

    Example: rubnoise info fig5.h5
    """
    import json

    from rubnoise import api
    from rubnoise.regular_file import is_folder
    from rubnoise.storage.resume import SUFFIX, refusal

    if is_folder(file):
        _tell_of_sweep(file, figures, over, as_json=as_json)
        return
    if figures is not None or over is not None:
        raise typer.BadParameter("--figures and --over are for the folder of a sweep")
    if file.suffix == SUFFIX:
        _tell_of_part(file, as_json=as_json)
        return
    with api.open(file) as run:
        if not run.provenance["finished"]:
            raise refusal(file)
        answer = contents(run, file)
        print(json.dumps(answer) if as_json else "\n".join(described(run, answer)))


def _tell_of_sweep(folder: Path, figures: str | None, over: str | None, *, as_json: bool) -> None:
    import json

    from rubnoise import api
    from rubnoise.cli import sweep_info

    if over is not None and figures is None:
        raise typer.BadParameter("--over is for --figures")
    with api.open_sweep(folder) as sweep:
        answer = sweep_info.contents(sweep, folder)
        if figures is not None:
            answer["estimates"] = sweep_info.estimates(sweep, [name.strip() for name in figures.split(",")], over)
    print(json.dumps(answer) if as_json else "\n".join(sweep_info.described(answer)))


def _tell_of_part(part: Path, *, as_json: bool) -> None:
    import json

    from rubnoise.cli import info_part

    answer = info_part.contents(part)
    print(json.dumps(answer) if as_json else "\n".join(info_part.described(answer)))


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
        **({"intervention": origin["intervention"]} if "intervention" in origin else {}),
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
    from rubnoise.cli.terminal import sentence

    lines = [
        sentence(f"{answer['file']}: {printable(answer['title'])}"),
        line("written by", answer["source"]),
        line("from, to", f"{answer['started']}, {answer['finished']}"),
        line("command", answer["command"], whole=True),
        *([line("intervention", answer["intervention"], whole=True)] if "intervention" in answer else []),
        line("seed", str(answer["seed"])),
        line("size", size(answer["bytes"])),
    ]
    lines += [
        line(f"/{name}", f"{grouped(group['rows'])} rows: {', '.join(group['columns'])}")
        for name, group in answer["groups"].items()
    ]
    lines += ["", "from its scenario", *derivation.described(run.scenario, answer["derived"])]
    return [*lines, "", "measured over the whole run, with exact values", *agreement_table(run.summary)]

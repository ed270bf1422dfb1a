"""`rubnoise sweep`: every run of a sweep that is not done yet, and an index of them all."""

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from rubnoise.answer import Answer, Row, Table
from rubnoise.cli.layout import as_wide_text, grouped, show
from rubnoise.cli.options import AsJson, EngineName, Quiet
from rubnoise.cli.progress import announce_compilation_by_workers, on_terminal, watching_sweep
from rubnoise.cli.signals import interrupted_at_once

if TYPE_CHECKING:
    from rubnoise.api.sweep_result import SweepResult
    from rubnoise.runs.sweep import Unmet
    from rubnoise.scenario.sweep import Sweep

MOST_FAILURES: Final = 20
"""Failed runs that text shows."""


@interrupted_at_once
def command(
    file: Annotated[Path, typer.Argument(help="A file with a table [sweep], or one run's for --over.", metavar="FILE")],
    *,
    folder: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="The folder; default: FILE's name without .toml, in this folder.", metavar="DIR"
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option("--jobs", "-j", help="Number of processes; default: the number of processors.", metavar="N"),
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(help="A Dask scheduler: its address or its scheduler file.", metavar="ADDRESS")
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(help="Make only one of several parts, e.g. 2/8 for a task of a batch queue.", metavar="I/N"),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", help="Change a key, e.g. --set sweep.replicates=40.", metavar="KEY=VALUE"),
    ] = None,
    over: Annotated[
        list[str] | None,
        typer.Option(help="Values of a key, e.g. --over sliding.speed=5,10,20mm/s.", metavar="KEY=V,V"),
    ] = None,
    engine: EngineName = None,
    force: Annotated[
        bool, typer.Option("--force", help="Leave the runs of other scenarios that are in the folder.")
    ] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Make every run of a sweep, in one folder with an index.

    The same command resumes an interrupted sweep: it skips finished runs, and adds new points and replicates. Exit
    code 1 if a run failed.

    Several --over make a grid, beside the file's own, whose key they replace; the file may be that of one run.

    Example: rubnoise sweep scenarios/paper/fig7.toml -o fig7
    """
    from rubnoise.api.sweep_result import open_sweep
    from rubnoise.cli.loading import axes, overrides, sweep_of
    from rubnoise.runs.sweep import carry_out

    sweep = sweep_of(file, (*overrides(changes, engine=engine), *axes(over)), quiet=quiet or as_json)
    place = Path(file.stem) if folder is None else folder
    shown = on_terminal() and not quiet and not as_json
    if not quiet and not as_json:
        announce_compilation_by_workers()
    with watching_sweep(shown=shown) as watch:
        imprecise = carry_out(
            sweep,
            place,
            jobs=jobs,
            executor=cluster,
            shard=shard,
            force=force,
            command=["rubnoise", *sys.argv[1:]],
            watch=watch,
        )
    result = open_sweep(place)
    answer = outcome(sweep, result, imprecise)
    if as_json:
        show(answer, as_json=True)
    elif not quiet:
        print(as_wide_text(replace(answer, rows=(), tables=answer.tables[1:] if result.failures else answer.tables)))
    if result.failures and not as_json:
        count = len(result.failures)
        told = f"{grouped(count)} {'run' if count == 1 else 'runs'} failed; the same command tries again"
        print(as_wide_text(Answer(title=told, tables=tuple(failures(result)))), file=sys.stderr)
    if result.failures:
        raise typer.Exit(1)


def outcome(sweep: "Sweep", result: "SweepResult", imprecise: "list[Unmet]") -> Answer:
    """Return what came of a sweep: how many runs, and which points are short of the requested precision."""
    counts = {state: result.count(state) for state in ("done", "failed", "planned")}
    short = Table(
        name="imprecise",
        columns={
            **{key: [str(unmet.values[key]) for unmet in imprecise] for key in sweep.keys},
            "replicates": [unmet.replicates for unmet in imprecise],
            "relative_standard_error": [unmet.reached for unmet in imprecise],
        },
    )
    known: dict[str, Any] = {"folder": str(result.path), "index": str(result.path / "index.h5")}
    known |= {"points": len(sweep.cases), "runs": len(result.runs), **counts}
    return Answer(
        title=f"{result.path}: {grouped(len(sweep.cases))} points, {runs_in_words(result)}",
        rows=tuple(
            Row(name=name, value=value, fails=name == "failed" and bool(value)) for name, value in known.items()
        ),
        tables=(*failures(result), *([short] if imprecise else [])),
        notes=tuple(f"warning: {warning}" for warning in sweep.warnings),
    )


def failures(result: "SweepResult") -> Iterator[Table]:
    """Yield the runs that failed, with their points and the reasons."""
    failed = result.failures
    if failed:
        columns: dict[str, list[Any]] = {"run_id": [each.run_id for each in failed]}
        columns |= {key: [str(each.values[key]) for each in failed] for key in result.keys}
        columns |= {"replicate": [each.replicate for each in failed], "reason": [each.reason for each in failed]}
        yield Table(name="failures", columns=columns, shown=range(min(len(failed), MOST_FAILURES)))


def runs_in_words(result: "SweepResult") -> str:
    """Return the number of runs, and how many are done, failed and planned."""
    counts = {state: result.count(state) for state in ("done", "failed", "planned")}
    told = ", ".join(f"{grouped(count)} {state}" for state, count in counts.items() if count)
    return f"{grouped(len(result.runs))} runs: {told}"

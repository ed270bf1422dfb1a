"""`rubnoise sweep`: every run of a sweep that is not done yet, and an index of them all."""

import sys
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rubnoise.answer import printable
from rubnoise.cli.layout import grouped, json_text, remark
from rubnoise.cli.options import AsJson, EngineName, Quiet
from rubnoise.cli.progress import announce_compilation_by_workers, interrupted_at_once, on_terminal, watching_sweep

if TYPE_CHECKING:
    from rubnoise.api.sweep_result import SweepResult
    from rubnoise.runs.stopping_rule import Unmet
    from rubnoise.scenario.sweep import Sweep


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
            cluster=cluster,
            shard=shard,
            force=force,
            command=["rubnoise", *sys.argv[1:]],
            watch=watch,
        )
    answer = outcome_as_json(sweep, open_sweep(place), imprecise)
    if as_json:
        print(json_text(answer))
    elif not quiet:
        print("\n".join(format_outcome(answer)))
    if answer["failures"] and not as_json:
        print("\n".join(format_failures(answer["failures"])), file=sys.stderr)
    if answer["failures"]:
        raise typer.Exit(1)


def outcome_as_json(sweep: "Sweep", result: "SweepResult", imprecise: "list[Unmet]") -> dict[str, Any]:
    """Return the outcome of a sweep, by name."""
    return {
        "folder": str(result.path),
        "index": str(result.path / "index.h5"),
        "points": len(sweep.cases),
        "runs": len(result.runs),
        **{state: result.count(state) for state in ("done", "failed", "planned")},
        "failures": [asdict(failure) for failure in result.failures],
        "imprecise": [asdict(unmet) for unmet in imprecise],
        "warnings": list(sweep.warnings),
    }


def format_outcome(answer: dict[str, Any]) -> list[str]:
    """Return the same as lines to print; failed runs have a table of their own."""
    points, runs = grouped(answer["points"]), grouped(answer["runs"])
    lines = [f"{answer['folder']}: {points} points, {runs} runs: {states_in_words(answer)}"]
    for short in answer["imprecise"]:
        reached = f"{values_in_words(short['values'])}: relative standard error {short['reached']:.2g}"
        lines.append(remark(f"precision not reached: {reached} with {grouped(short['replicates'])} replicates"))
    return lines


def format_failures(failed: list[dict[str, Any]], most: int = 20) -> list[str]:
    """Return a table of runs that failed."""
    lines = [f"{grouped(len(failed))} {'run' if len(failed) == 1 else 'runs'} failed; the same command tries again:"]
    for each in failed[:most]:
        where = ", ".join(part for part in (values_in_words(each["values"]), f"replicate {each['replicate']}") if part)
        lines += [f"  {each['run_id']}  {where}", f"    {printable(each['reason'])}"]
    return lines + ([f"  and {grouped(len(failed) - most)} more"] if len(failed) > most else [])


def states_in_words(answer: Mapping[str, Any]) -> str:
    """Return how many runs are done, failed and planned."""
    return ", ".join(f"{grouped(answer[state])} {state}" for state in ("done", "failed", "planned") if answer[state])


def values_in_words(values: Mapping[str, Any]) -> str:
    """Return the swept values of a point."""
    return printable(", ".join(f"{key} = {value}" for key, value in values.items()))

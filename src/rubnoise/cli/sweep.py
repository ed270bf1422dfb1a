"""`rubnoise sweep`: every run of a sweep that is not done yet, and an index of them all."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rubnoise.cli.layout import grouped, json_text, printable, remark
from rubnoise.cli.options import AsJson, EngineName, Quiet
from rubnoise.cli.progress import announce_compilation_by_workers, interrupted_at_once, on_terminal, watching_sweep

if TYPE_CHECKING:
    from rubnoise.scenario.sweep import Sweep
    from rubnoise.sweep.conduct import SweepOutcome


@interrupted_at_once
def command(
    file: Annotated[Path, typer.Argument(help="A file with a table [sweep].", metavar="FILE")],
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
    authority: Annotated[
        Path | None,
        typer.Option("--tls-ca-file", help="Use TLS with the cluster: certificate of its authority.", metavar="PEM"),
    ] = None,
    certificate: Annotated[
        Path | None, typer.Option("--tls-cert", help="The certificate for the cluster.", metavar="PEM")
    ] = None,
    key: Annotated[
        Path | None, typer.Option("--tls-key", help="Its key, if it is not in the same file.", metavar="PEM")
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(help="Make only one of several parts, e.g. 2/8 for a task of a batch queue.", metavar="I/N"),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", help="Change a key, e.g. --set sweep.replicates=40.", metavar="KEY=VALUE"),
    ] = None,
    engine: EngineName = None,
    merge: Annotated[
        bool,
        typer.Option("--merge", help="At the end, or that of the last shard, write all into one file, merged.h5."),
    ] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Make every run of a sweep, each a result file in one folder, with an index of them all.

    The same command resumes an interrupted sweep: it skips finished runs, and adds new points and replicates. Exit
    code 1 if a run failed.

    Example: rubnoise sweep scenarios/paper/fig7.toml -o fig7
    """
    from rubnoise.api.sweeping import carry_out
    from rubnoise.cli.loading import overrides, sweep_of

    security = _security(authority, certificate, key, cluster)
    sweep = sweep_of(file, overrides(changes, engine=engine), quiet=quiet or as_json)
    place = Path(file.stem) if folder is None else folder
    shown = on_terminal() and not quiet and not as_json
    if not quiet and not as_json:
        announce_compilation_by_workers()
    with watching_sweep(shown=shown) as watch:
        ending = carry_out(
            sweep,
            place,
            jobs=jobs,
            cluster=cluster,
            shard=shard,
            security=security,
            command=["rubnoise", *sys.argv[1:]],
            watch=watch,
        )
    # Of shards that end one after another the last one merges, when no run is left for the others.
    merged = _merged(place) if merge and (shard is None or not ending.known.count("planned")) else None
    _print_outcome(sweep, place, ending, merged=merged, as_json=as_json, quiet=quiet)
    if merge and merged is None and not quiet and not as_json:
        print(remark("not merged yet: the shard that ends last does that"))
    if ending.known.count("failed"):
        raise typer.Exit(1)


def _security(authority: Path | None, certificate: Path | None, key: Path | None, cluster: str | None) -> Any:
    """Return the TLS settings for a cluster, None if no option gives them."""
    if authority is None and certificate is None and key is None:
        return None
    if cluster is None:
        raise typer.BadParameter("--tls-ca-file, --tls-cert and --tls-key are for --cluster")
    if authority is None or certificate is None:
        raise typer.BadParameter("--tls-ca-file and --tls-cert go together")
    from rubnoise.sweep.cluster import security_of

    return security_of(authority, certificate, key)


def _merged(folder: Path) -> Path:
    from rubnoise.sweep.folder import SweepFolder
    from rubnoise.sweep.index import merge

    return merge(SweepFolder(folder))


def _print_outcome(
    sweep: "Sweep", folder: Path, ending: "SweepOutcome", *, merged: Path | None, as_json: bool, quiet: bool
) -> None:
    answer = outcome_as_json(sweep, folder, ending, merged)
    if as_json:
        print(json_text(answer))
    elif not quiet:
        print("\n".join(format_outcome(answer)))
    if answer["failures"] and not as_json:
        print("\n".join(format_failures(answer["failures"])), file=sys.stderr)


def outcome_as_json(sweep: "Sweep", folder: Path, ending: "SweepOutcome", merged: Path | None) -> dict[str, Any]:
    """Return the outcome of a sweep, by name."""
    known = ending.known
    failed = [
        {
            "run_id": point.run_id,
            "values": dict(point.values),
            "replicate": point.replicate,
            "reason": known.reasons[known.places[point.run_id]],
        }
        for point in ending.points
        if known.states[known.places[point.run_id]] == "failed"
    ]
    return {
        "folder": str(folder),
        "index": str(folder / "index.h5"),
        "merged": None if merged is None else str(merged),
        "points": len(sweep.cases),
        "runs": len(ending.points),
        "done": known.count("done"),
        "failed": known.count("failed"),
        "planned": known.count("planned"),
        "failures": failed,
        "imprecise": [
            {"values": dict(unmet.values), "replicates": unmet.replicates, "reached": unmet.reached}
            for unmet in ending.imprecise
        ],
        "warnings": list(sweep.warnings),
    }


def format_outcome(answer: dict[str, Any]) -> list[str]:
    """Return the same as lines to print; failed runs have a table of their own."""
    points, runs = grouped(answer["points"]), grouped(answer["runs"])
    lines = [f"{answer['folder']}: {points} points, {runs} runs: {states_in_words(answer)}"]
    if answer["merged"]:
        lines.append(remark(f"everything in one file: {answer['merged']}"))
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

"""`rubnoise run`: a scenario file in, a result file out."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rubnoise.api import Run
    from rubnoise.scenario import Scenario


def command(
    file: Annotated[Path, typer.Argument(help="The scenario, a TOML file.", metavar="FILE", show_default=False)],
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="The result file; FILE's name with .h5, here, when left out.", metavar="OUT.h5"
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the random streams, in place of the file's.")] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", help="Change a key, e.g. --set interface.mean_junction_count=50.", metavar="KEY=VALUE"),
    ] = None,
    engine: Annotated[str | None, typer.Option(help="Engine, in place of the file's.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing result.")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Check everything, run nothing, write nothing.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print nothing but what is wrong.")] = False,
) -> None:
    """Run a scenario and keep everything in one HDF5 file: every junction's life, area, force and motion.

    Example: rubnoise run scenarios/paper/fig5.toml -o fig5.h5 --seed 7
    """
    from rubnoise.cli.loading import overrides, scenario_of

    scenario = scenario_of(file, overrides(changes, seed=seed, engine=engine), quiet=quiet or as_json)
    path = Path(f"{file.stem}.h5") if output is None else output
    if dry_run:
        _foresee(scenario, path, force=force, as_json=as_json, quiet=quiet)
    else:
        _run(scenario, path, force=force, as_json=as_json, quiet=quiet)


def _run(scenario: "Scenario", path: Path, *, force: bool, as_json: bool, quiet: bool) -> None:
    import time

    from rubnoise import api
    from rubnoise.cli.progress import announce_compilation, on_terminal, watching
    from rubnoise.storage.output import check_output

    check_output(path, force=force)
    shown = on_terminal() and not quiet and not as_json
    if shown:
        announce_compilation()
    began = time.monotonic()
    with watching(scenario.model().distance, shown=shown) as watcher:
        watcher.counting()
        result = api.run(scenario, path, force=force, watch=watcher, command=["rubnoise", *sys.argv[1:]])
    with result:
        if as_json:
            _print_json(result, path, scenario.warnings)
        elif not quiet:
            _print_result(result, path, time.monotonic() - began)


def _print_result(result: "Run", path: Path, seconds: float) -> None:
    from rubnoise.cli import layout

    rows, ticks = layout.grouped(len(result.junctions)), layout.grouped(len(result.trace))
    print(f"{path}: {rows} junctions, {ticks} ticks, {layout.size(path.stat().st_size)}, in {seconds:.1f} s")
    print("\n".join(layout.agreement_table(result.summary)))
    for doubt in _doubts(result):
        print(layout.remark(f"warning: {doubt}"), file=sys.stderr)


def _doubts(result: "Run") -> list[str]:
    """Return what makes the result doubtful."""
    from rubnoise.cli import layout

    spread = [figure.observed for figure in result.summary if figure.name == "one_way_validity"]
    return [layout.one_way_warning(validity) for validity in spread if validity > layout.WORTH_A_WARNING]


def _print_json(result: "Run", path: Path, warnings: tuple[str, ...]) -> None:
    import json

    from rubnoise.analysis.agreement import as_json

    answer = {
        "output": str(path),
        "seed": result.provenance["seed"],
        "junctions": len(result.junctions),
        "ticks": len(result.trace),
        "bytes": path.stat().st_size,
        "summary": as_json(result.summary),
        "warnings": [*warnings, *_doubts(result)],
    }
    print(json.dumps(answer))


def _foresee(scenario: "Scenario", path: Path, *, force: bool, as_json: bool, quiet: bool) -> None:
    import json

    from rubnoise.cli.foresight import told
    from rubnoise.cli.layout import duration, grouped, line, size
    from rubnoise.storage.budget import check_room, counted, expected
    from rubnoise.storage.output import check_output

    check_output(path, force=force)
    check_room(scenario, expected(scenario), path)  # births beyond any disk are not even counted
    budget = counted(scenario)
    check_room(scenario, budget, path)
    foreseen = told(budget)
    if as_json:
        print(json.dumps({"output": str(path), "dry_run": True} | foreseen | {"warnings": list(scenario.warnings)}))
    elif not quiet:
        print(f"{path}: nothing run, nothing written")
        print(line("junctions", grouped(budget.junctions)))
        print(line("ticks", grouped(budget.ticks)))
        print(line("file size", size(budget.result_bytes)))
        print(line("memory", f"about {size(foreseen['peak_memory'])}"))
        print(line("time", duration(foreseen["seconds"])))

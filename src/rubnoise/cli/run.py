"""`rubnoise run`: a scenario file in, a result file out."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rubnoise.cli.choices import engines
from rubnoise.cli.progress import interrupted_at_once

if TYPE_CHECKING:
    from rubnoise.scenario import Scenario


@interrupted_at_once
def command(
    file: Annotated[Path, typer.Argument(help="The scenario, a TOML file.", metavar="FILE", show_default=False)],
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="The result file; default: FILE's name with .h5, in this folder.", metavar="OUT.h5"
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of the random streams, instead of the file's.", metavar="N")
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", help="Change a key, e.g. --set sliding.distance=5mm.", metavar="KEY=VALUE"),
    ] = None,
    engine: Annotated[
        str | None,
        typer.Option(
            help="events or batch, instead of the file's; both give the same bits.",
            metavar="ENGINE",
            autocompletion=engines,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing result.")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Check everything, run nothing, write nothing.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print only errors.")] = False,
) -> None:
    """Run a scenario and keep everything in one HDF5 file: every junction's life, area, force and motion.

    It resumes an unfinished run of the same scenario at this output.

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
    from rubnoise.cli.outcome import tell
    from rubnoise.cli.progress import announce_compilation, on_terminal, watching
    from rubnoise.cli.starting import prepare_kernels
    from rubnoise.storage.output import check_output

    check_output(path, force=force, unfinished=True)
    prepare_kernels()
    if not force and not quiet:
        _tell_of_going_on(scenario, path)
    shown = on_terminal() and not quiet and not as_json
    if shown:
        announce_compilation()
    began = time.monotonic()
    with watching(scenario.model().distance, shown=shown) as watcher:
        watcher.counting()
        result = api.run(scenario, path, force=force, watch=watcher, command=["rubnoise", *sys.argv[1:]])
    with result:
        tell(result, path, time.monotonic() - began, warnings=scenario.warnings, as_json=as_json, quiet=quiet)


def _tell_of_going_on(scenario: "Scenario", path: Path) -> None:
    """Say on stderr that a run of this scenario did not finish there, and from where it goes on."""
    from rubnoise.api.resuming import interrupted
    from rubnoise.storage.resume import SUFFIX, look

    if interrupted(scenario, path) is not None:
        part = f"{path}{SUFFIX}"
        print(f"{part}: resumes an unfinished run at {look(part).share:.0%}", file=sys.stderr)


def _foresee(scenario: "Scenario", path: Path, *, force: bool, as_json: bool, quiet: bool) -> None:
    import json

    from rubnoise.cli.foresight import told
    from rubnoise.cli.layout import duration, grouped, line, size
    from rubnoise.storage.forecast import check_disk_space, counted, expected
    from rubnoise.storage.output import check_output

    check_output(path, force=force, unfinished=True)
    check_disk_space(scenario, expected(scenario), path)  # births beyond any disk are not even counted
    budget = counted(scenario)
    check_disk_space(scenario, budget, path)
    foreseen = told(budget)
    if as_json:
        print(json.dumps({"output": str(path), "dry_run": True} | foreseen | {"warnings": list(scenario.warnings)}))
    elif not quiet:
        print(f"{path}: nothing run, nothing written")
        print(line("junctions", grouped(budget.junctions)))
        print(line("ticks", grouped(budget.ticks)))
        if budget.slider_rows_at_most is not None:
            print(line("slider", f"{grouped(budget.slider_rows_at_most)} rows at most"))
        print(line("file size", size(budget.result_bytes)))
        if budget.disk_bytes > budget.result_bytes:
            print(line("free disk", size(budget.disk_bytes)))
        print(line("memory", f"about {size(foreseen['peak_memory'])}"))
        print(line("time", duration(foreseen["seconds"])))

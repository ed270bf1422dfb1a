"""`rubnoise run`: a scenario file in, a result file out, and a few lines about it."""

import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from shlex import quote
from shutil import which
from typing import TYPE_CHECKING, Annotated

import typer

import rubnoise
from rubnoise.answer import Answer, rows, size
from rubnoise.cli.layout import grouped, sentence, show, too_short_for_motion
from rubnoise.cli.options import AsJson, EngineName, Quiet, ReplaceResult
from rubnoise.cli.progress import announce_compilation, on_terminal, watching
from rubnoise.cli.signals import interrupted_at_once
from rubnoise.regular_file import STANDARD_INPUT

if TYPE_CHECKING:
    from rubnoise.api.run import Run
    from rubnoise.scenario import Scenario


@interrupted_at_once
def command(
    file: Annotated[Path, typer.Argument(help="The scenario, a TOML file; - is standard input.", metavar="FILE")],
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
    engine: EngineName = None,
    force: ReplaceResult = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Check everything, run nothing, write nothing.")] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Run a scenario, and keep everything in one HDF5 file.

    It holds every junction's life, area, force and motion.

    A signal, a kill or a full disk leaves no result: run it again, and the bits are the same.

    Example: rubnoise run scenarios/paper/fig5.toml -o fig5.h5 --seed 7
    """
    from rubnoise.cli.loading import overrides, scenario_of
    from rubnoise.storage.output import check_output

    scenario = scenario_of(file, overrides(changes, seed=seed, engine=engine), quiet=quiet or as_json)
    stem = "rubnoise" if str(file) == STANDARD_INPUT else file.stem
    path = Path(f"{stem}.h5") if output is None else output
    check_output(path, force=force, reads=scenario.files)
    if dry_run:
        _print_forecast(scenario, path, as_json=as_json, quiet=quiet)
    else:
        _run(scenario, path, force=force, as_json=as_json, quiet=quiet or as_json)


def _run(scenario: "Scenario", path: Path, *, force: bool, as_json: bool, quiet: bool) -> None:
    from numba.core.event import TimingListener, install_listener

    doubts = _doubts(scenario, quiet=quiet)
    if not quiet:
        announce_compilation()
    began, compiling = time.monotonic(), TimingListener()  # type: ignore[no-untyped-call]
    shown = on_terminal() and not quiet
    with watching(scenario.model().distance, shown=shown) as watch, install_listener("numba:compile", compiling):
        result = rubnoise.run(scenario, path, force=force, watch=watch, command=["rubnoise", *sys.argv[1:]])
    with result:
        seconds = time.monotonic() - began - (compiling.duration if compiling.done else 0.0)
        _print_result(result, path, seconds, [*scenario.warnings, *doubts], as_json=as_json, quiet=quiet)


def _print_forecast(scenario: "Scenario", path: Path, *, as_json: bool, quiet: bool) -> None:
    from rubnoise.cli.derivation import FREE_ROWS, budget_rows
    from rubnoise.storage.forecast import check_disk_space, counted, expected

    check_disk_space(scenario, expected(scenario), path)  # births beyond any disk are not even counted
    budget = counted(scenario)
    check_disk_space(scenario, budget, path)
    warnings = [*scenario.warnings, *_doubts(scenario, quiet=quiet or as_json)]
    notes = [] if scenario.model().free is None else [FREE_ROWS]
    told = (*rows("result", ("output", str(path))), *budget_rows(budget))
    answer = Answer(title=f"{path}: nothing run, nothing written", rows=told)
    _print(answer, warnings, notes, as_json=as_json, quiet=quiet)


def _print(answer: Answer, warnings: list[str], notes: list[str], *, as_json: bool, quiet: bool) -> None:
    """Print an answer; text has no warnings, which were printed before."""
    warned = [f"warning: {warning}" for warning in warnings] if as_json else []
    if as_json or not quiet:
        show(replace(answer, notes=(*warned, *notes)), as_json=as_json)


def _print_result(
    result: "Run", path: Path, seconds: float, warnings: list[str], *, as_json: bool, quiet: bool
) -> None:
    """Print the outcome of a run, with its path and the seconds that it took."""
    junctions, ticks, count = len(result.junctions), len(result.trace), path.stat().st_size
    told = (("output", str(path)), ("seed", result.provenance["seed"]), ("junctions", junctions), ("ticks", ticks))
    answer = Answer(
        title=f"{path}: {grouped(junctions)} junctions, {grouped(ticks)} ticks, {size(count)}, in {seconds:.1f} s",
        rows=(*rows("result", *told, ("bytes", count, "B")), *(replace(row, part="summary") for row in result.summary)),
    )
    _print(answer, warnings, [], as_json=as_json, quiet=quiet)
    if not (as_json or quiet):
        print("next:")
        print("\n".join(f"  {program()} {each} {quote(str(path))}" for each in ("plot", "page", "junctions")))


def program() -> str:
    """Return what a shell calls this program: rubnoise where that finds it, else its path."""
    own = Path(sys.argv[0])
    found = which("rubnoise")
    if found is None and own.name == "rubnoise":
        return quote(os.path.relpath(own))
    return "rubnoise"


def _doubts(scenario: "Scenario", *, quiet: bool) -> list[str]:
    """Return the reasons why the result will be doubtful or too short, and print them before the run."""
    from rubnoise.analysis.moments import missing_for_motion, one_way_warnings
    from rubnoise.cli.derivation import load_as_json, load_warnings
    from rubnoise.theory.exact import exact
    from rubnoise.theory.motion import response

    if scenario.too_large:
        return []  # it has no run, and says why
    model, doubts = scenario.model(), []
    if model.slider is not None and not model.is_two_way:
        doubts += one_way_warnings(model, response(model).one_way_validity)
    if model.held is not None:
        doubts += load_warnings(load_as_json(exact(model)))
    if missing := missing_for_motion(model):
        doubts.append(too_short_for_motion(missing.decays, missing.needed))
    if not quiet:
        for doubt in doubts:
            print(sentence(f"warning: {doubt}", "  "), file=sys.stderr)
    return doubts

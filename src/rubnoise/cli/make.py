"""`rubnoise run`, `sweep` and `demo`: a scenario in, results out, and a few lines about them."""

import os
import sys
import time
import webbrowser
from dataclasses import replace
from pathlib import Path
from shlex import quote
from shutil import which
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

import rubnoise
from rubnoise.answer import Answer, Table, rows, size
from rubnoise.cli.terminal import (
    AsCsv,
    AsJson,
    Changes,
    EngineName,
    Quiet,
    ReplaceResult,
    announce_compilation,
    argument,
    bar,
    flag,
    option,
    output,
    sentence,
    show,
    write_texts,
)
from rubnoise.cli.write import lesson_page, report_page, view_page
from rubnoise.errors import OutputRefused, refusing_files
from rubnoise.regular_file import STANDARD_INPUT

if TYPE_CHECKING:
    from rubnoise.runs.sweep import SweepProgress, Unmet
    from rubnoise.scenario import Scenario
    from rubnoise.scenario.sweep import Sweep


def run(
    file: Annotated[Path, argument("FILE", "The scenario, a TOML file; - is standard input.")],
    *,
    output: Annotated[Path | None, output("OUT.h5", "The result file; default: FILE's name with .h5, here.")] = None,
    seed: Annotated[int | None, option("N", "Seed of the random streams, instead of the file's.")] = None,
    changes: Changes = None,
    engine: EngineName = None,
    force: ReplaceResult = False,
    dry_run: Annotated[bool, flag("Check everything, run nothing, write nothing.", "--dry-run")] = False,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    quiet: Quiet = False,
) -> None:
    """Run a scenario, and keep everything in one HDF5 file.

    It holds every junction's life, area, force and motion.

    A signal, a kill or a full disk leaves no result: run it again, and the bits are the same.

    Example: rubnoise run scenarios/paper/fig5.toml -o fig5.h5 --seed 7
    """
    from rubnoise.cli.loading import loaded, overrides
    from rubnoise.scenario import load
    from rubnoise.storage.output import check_output

    scenario = loaded(load, file, overrides(changes, seed=seed, engine=engine), quiet=quiet or as_json)
    stem = "rubnoise" if str(file) == STANDARD_INPUT else file.stem
    path = Path(f"{stem}.h5") if output is None else output
    check_output(path, force=force, reads=scenario.files)
    doubts = _doubts(scenario, quiet=quiet or as_json)
    quiet = quiet or as_json or as_csv
    answer = _forecast(scenario, path) if dry_run else _run(scenario, path, force=force, quiet=quiet)
    if as_json or as_csv:
        warned = (f"warning: {warning}" for warning in (*scenario.warnings, *doubts))
        show(replace(answer, notes=(*warned, *answer.notes)), as_json=as_json, as_csv=as_csv)
    elif not quiet:
        show(answer)
        if not dry_run:
            print("next:")
            print("\n".join(f"  {program()} {each} {quote(str(path))}" for each in ("plot", "page", "junctions")))


def _run(scenario: "Scenario", path: Path, *, force: bool, quiet: bool) -> Answer:
    """Run a scenario into its file, and return the outcome with the seconds that it took."""
    from numba.core.event import TimingListener, install_listener

    if not quiet:
        announce_compilation()
    began, compiling = time.monotonic(), TimingListener()  # type: ignore[no-untyped-call]
    distance, shown = scenario.model().distance, sys.stderr.isatty() and not quiet
    with bar("counting the births", shown=shown) as show_bar, install_listener("numba:compile", compiling):

        def watch(reached: float, junctions: int, live: int) -> None:
            words = f"{reached / 1000.0:.6g} of {distance / 1000.0:.6g} mm, {junctions:,} junctions, {live:,} alive"
            show_bar(reached, distance, words)

        result = rubnoise.run(scenario, path, force=force, watch=watch, command=["rubnoise", *sys.argv[1:]])
    with result:
        seconds = time.monotonic() - began - (compiling.duration if compiling.done else 0.0)
        junctions, ticks, count = len(result.junctions), len(result.trace), path.stat().st_size
        told = (("output", str(path)), ("seed", result.provenance["seed"]), ("junctions", junctions), ("ticks", ticks))
        summary = [replace(row, part="summary") for row in result.summary]
    return Answer(
        title=f"{path}: {junctions:,} junctions, {ticks:,} ticks, {size(count)}, in {seconds:.1f} s",
        rows=(*rows("result", *told, ("bytes", count, "B")), *summary),
    )


def _forecast(scenario: "Scenario", path: Path) -> Answer:
    """Return what a run would take, and that nothing was run."""
    from rubnoise.cli.derivation import FREE_ROWS, cost
    from rubnoise.storage.forecast import check_disk_space, counted, expected

    check_disk_space(expected(scenario), path)  # births beyond any disk are not even counted
    budget = counted(scenario)
    check_disk_space(budget, path)
    return Answer(
        title=f"{path}: nothing run, nothing written",
        rows=(*rows("result", ("output", str(path))), *cost(budget)),
        notes=() if scenario.model().free is None else (FREE_ROWS,),
    )


def program() -> str:
    """Return what a shell calls this program: rubnoise where that finds it, else its path."""
    own = Path(sys.argv[0])
    return quote(os.path.relpath(own)) if which("rubnoise") is None and own.name == "rubnoise" else "rubnoise"


def _doubts(scenario: "Scenario", *, quiet: bool) -> list[str]:
    """Return the reasons why the result will be doubtful or too short, and print them before the run."""
    from rubnoise.cli.derivation import motion_warnings, too_short_for_motion
    from rubnoise.theory.exact import exact

    if scenario.too_large:
        return []  # it has no run, and says why
    model = scenario.model()
    doubts = motion_warnings(exact(model)) if model.slider is not None or model.held is not None else []
    doubts += too_short_for_motion(model)
    if not quiet:
        for doubt in doubts:
            print(sentence(f"warning: {doubt}", "  "), file=sys.stderr)
    return doubts


def sweep(
    file: Annotated[Path, argument("FILE", "A file with a table [sweep], or one run's for --over.")],
    *,
    folder: Annotated[Path | None, output("DIR", "The folder; default: FILE's name without .toml, here.")] = None,
    jobs: Annotated[int | None, option("N", "Number of processes; default: of processors.", "--jobs", "-j")] = None,
    cluster: Annotated[str | None, option("ADDRESS", "A Dask scheduler: its address or its scheduler file.")] = None,
    shard: Annotated[
        str | None, option("I/N", "Make only one of several parts, e.g. 2/8 for a task of a batch queue.")
    ] = None,
    changes: Changes = None,
    over: Annotated[
        list[str] | None, option("KEY=V,V", "Values of a key, e.g. --over sliding.speed=5,10,20mm/s.")
    ] = None,
    engine: EngineName = None,
    force: Annotated[bool, flag("Leave the runs of other scenarios that are in the folder.", "--force")] = False,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    quiet: Quiet = False,
) -> None:
    """Make every run of a sweep, in one folder with an index.

    The same command resumes an interrupted sweep: it skips finished runs, and adds new points and replicates. Exit
    code 1 if a run failed.

    Several --over make a grid, beside the file's own, whose key they replace; the file may be that of one run.

    Example: rubnoise sweep scenarios/paper/fig7.toml -o fig7
    """
    from rubnoise.api.sweep_result import open_sweep
    from rubnoise.cli.ask import failures, runs_in_words, sweep_answer
    from rubnoise.cli.loading import axes, loaded, overrides
    from rubnoise.runs.sweep import carry_out
    from rubnoise.scenario.sweep import load_sweep

    asked = loaded(load_sweep, file, (*overrides(changes, engine=engine), *axes(over)), quiet=quiet or as_json)
    place = Path(file.stem) if folder is None else folder
    quiet = quiet or as_json or as_csv
    if not quiet:
        announce_compilation(by_workers=True)
    with bar(shown=sys.stderr.isatty() and not quiet) as show_bar:

        def watch(progress: "SweepProgress") -> None:
            ended = progress.done + progress.failed
            failed = f", {progress.failed:,} failed" if progress.failed else ""
            show_bar(ended, progress.runs, f"{ended:,} of {progress.runs:,} runs{failed}")

        imprecise = carry_out(
            asked,
            place,
            jobs=jobs,
            executor=cluster,
            shard=shard,
            force=force,
            command=["rubnoise", *sys.argv[1:]],
            watch=watch,
        )
    result = open_sweep(place)
    failed, short = list(failures(result)), _short_of_precision(asked, imprecise)
    title = f"{place}: {len(asked.cases):,} points, {runs_in_words(result)}"
    notes = tuple(f"warning: {warning}" for warning in asked.warnings)
    if as_json or as_csv:
        whole = replace(sweep_answer(result, place, short), title=title, notes=notes)
        show(whole, as_json=as_json, as_csv=as_csv)
    elif not quiet:
        show(Answer(title=title, tables=tuple(short), notes=notes))
    if failed and not as_json:
        count = len(result.failures)
        told = f"{count:,} {'run' if count == 1 else 'runs'} failed; the same command tries again"
        show(Answer(title=told, tables=tuple(failed)), to=sys.stderr)
    if failed:
        raise typer.Exit(1)


def _short_of_precision(sweep: "Sweep", imprecise: "list[Unmet]") -> list[Table]:
    """Return a table of the points that are short of the requested precision; none if there are none."""
    columns: dict[str, list[Any]] = {key: [str(unmet.values[key]) for unmet in imprecise] for key in sweep.keys}
    columns["replicates"] = [unmet.replicates for unmet in imprecise]
    columns["relative_standard_error"] = [unmet.reached for unmet in imprecise]
    return [Table(name="imprecise", columns=columns)] if imprecise else []


# The demo.
SCENARIO: Final = "first/rubbing"
FILES: Final = {
    "rubbing.h5": "the result: every junction's life, area, force and motion",
    "rubbing.png": "a picture of it beside theory",
    "rubbing.html": "a page to explore it: zoom, filter, and follow single junctions",
    "rubbing_report.html": "a report to send to a colleague",
    "lesson.html": "lessons about births and deaths, for a class",
}
"""What the folder holds at the end, and what each is."""


def demo(
    folder: Annotated[Path, argument("[FOLDER]", "The folder; it is made if it is missing.")] = Path("rubnoise-demo"),
    *,
    no_open: Annotated[bool, flag("Do not open a browser.", "--no-open")] = False,
    quiet: Quiet = False,
) -> None:
    """Run a first contact; draw, report, view and teach it.

    The pages open in the browser, where there is one. The folder may hold an earlier demo, which is replaced, and
    nothing else.

    Example: rubnoise demo
    """
    with refusing_files(folder):
        folder.mkdir(parents=True, exist_ok=True)
        others = sorted(each.name for each in folder.iterdir() if each.name not in FILES)
    if others:
        raise OutputRefused(f"{folder}: holds {others[0]}, which no demo makes; name another folder")
    result, picture, *pages = (folder / name for name in FILES)
    if not quiet:
        announce_compilation()
    with rubnoise.run(SCENARIO, result, force=True, command=["rubnoise", "demo"]) as run:
        run.plot().savefig(picture, dpi=150)
    texts = (view_page(result)[0], report_page(result), lesson_page(Path(SCENARIO)))
    write_texts(dict(zip(pages, texts, strict=True)), force=True)
    if not quiet:
        print("\n".join(sentence(f"{folder / name}: {what}") for name, what in FILES.items()))
    desktop = sys.platform == "darwin" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not no_open and desktop and sys.stdout.isatty():  # a browser of text would take the terminal
        for path in pages:
            webbrowser.open(path.resolve().as_uri())

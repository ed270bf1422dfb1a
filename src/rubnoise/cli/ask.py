"""`rubnoise info`, `compare` and `verify`: what a result holds, and how it agrees with theory and with itself."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

import rubnoise
from rubnoise.answer import Answer, Row, Table, printable, rows
from rubnoise.cli.terminal import AsCsv, AsJson, ResultFile, ResultOrSweep, bar, option, show
from rubnoise.cli.vocabulary import named
from rubnoise.errors import NotPassed, Refused
from rubnoise.figure_names import FAILED, STATES
from rubnoise.regular_file import INDEX, is_folder

if TYPE_CHECKING:
    from rubnoise.analysis.replicates import PooledEstimate
    from rubnoise.api.run import Run
    from rubnoise.api.sweep_result import SweepResult
    from rubnoise.model import Model


def info(
    file: ResultOrSweep,
    *,
    figures: Annotated[
        str | None, option("NAME,...", "Of a sweep: these figures of each point, over its replicates.")
    ] = None,
    over: Annotated[str | None, option("KEY=VALUE", "The same over the points with this value of a swept key.")] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Show what a result or a sweep contains.

    Of a result these are measured and exact figures; of a sweep its progress.

    Of a sweep, --figures shows values with their 95 % intervals, and --over shows ratios with theirs.

    Example: rubnoise info fig5.h5
    """
    if is_folder(file):
        if over is not None and figures is None:
            raise typer.BadParameter("--over is for --figures")
        names = [] if figures is None else [name.strip() for name in figures.split(",")]
        with rubnoise.open_sweep(file) as sweep:
            answer = sweep_answer(sweep, file, estimates(sweep, names, over))
    elif figures is not None or over is not None:
        raise typer.BadParameter("--figures and --over are for the folder of a sweep")
    else:
        from rubnoise.api.run import Run
        from rubnoise.storage.reader import open_run

        with Run(open_run(file)) as run:
            answer = run_answer(run, file)
    show(answer, as_json=as_json, as_csv=as_csv)


def run_answer(run: "Run", file: Path) -> Answer:
    """Return the content of a result file, the numbers that follow from its scenario, and its figures."""
    from rubnoise.cli.derivation import derived

    told, origin = run.attributes, run.provenance
    names = ("command", "intervention", "seed", "started", "finished")
    known = derived(run.scenario, f"{file}: {told['title']}", warned=False)
    heard, bands = _normal_motion(run)
    own = (
        *rows("", *((name, told[name]) for name in ("source", "format_version"))),
        *rows("", *((name, origin.get(name)) for name in names), ("bytes", file.stat().st_size, "B")),
        *rows("groups", *((name, len(each), "", ", ".join(each.names)) for name, each in run.groups().items())),
    )
    figures = (replace(row, part="summary") for row in run.summary)
    return replace(known, rows=(*own, *known.rows, *figures, *heard), tables=tuple(bands))


def _normal_motion(run: "Run") -> tuple[list[Row], list[Table]]:
    """Return the normal velocity of a run under a load that weighs, in all and in third octaves; otherwise nothing.

    Roughness noise is reported so: in dB re 50 nm/s.
    """
    from rubnoise.analysis.spectra import heard_bands
    from rubnoise.theory.coupling import level

    try:
        bands = heard_bands(run.reader(), run.model())
    except Refused:
        return [], []
    velocity = next((row.value for row in run.summary if row.name == "normal_velocity_std"), None)
    whole = None if velocity is None else level(velocity)
    told = rows("normal_velocity", ("velocity", velocity, "um/s"), ("level", whole, "dB", "re 50 nm/s"))
    return list(told), [bands]


def sweep_answer(sweep: "SweepResult", folder: Path, more: "list[Table]") -> Answer:
    """Return the content of the folder of a sweep, its failed runs, and ``more`` tables."""
    known: dict[str, Any] = {"folder": str(folder), "index": str(folder / INDEX)}
    known |= {name: sweep.attributes[name] for name in ("source", "command", "written")}
    known |= {"points": len(sweep.points), "runs": len(sweep.runs)}
    known |= {state: sweep.count(state) for state in STATES}
    size_of_all = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    lists = {name: list(getattr(sweep, name)) or None for name in ("grid", "side_by_side", "figures", "summaries")}
    found = rows("", *known.items(), ("bytes", size_of_all, "B"), *lists.items())
    return Answer(
        title=f"{folder}: {sweep.title}",
        rows=tuple(replace(row, fails=row.name == FAILED and row.value > 0) for row in found),
        tables=(*failures(sweep), *more),
    )


_MOST_FAILURES: Final = 20  # that text shows


def failures(sweep: "SweepResult") -> Iterator[Table]:
    """Yield the runs that failed, with their points and the reasons."""
    if failed := sweep.failures:
        columns: dict[str, list[Any]] = {"run_id": [each.run_id for each in failed]}
        columns |= {key: [str(each.values[key]) for each in failed] for key in sweep.keys}
        columns |= {name: [getattr(each, name) for each in failed] for name in ("replicate", "reason")}
        yield Table(name="failures", columns=columns, shown=range(min(len(failed), _MOST_FAILURES)))


def runs_in_words(sweep: "SweepResult") -> str:
    """Return the number of runs, and how many are done, failed and planned."""
    counts = {state: sweep.count(state) for state in STATES}
    told = ", ".join(f"{count:,} {state}" for state, count in counts.items() if count)
    return f"{len(sweep.runs):,} runs: {told}"


def estimates(sweep: "SweepResult", names: Sequence[str], over: str | None = None) -> list[Table]:
    """Return figures of each point over its replicates with their 95 % intervals, and ratios ``over`` other points.

    Raises Refused for a figure that no run has, and for a text that is not KEY=VALUE of a point.
    """
    if unknown := [name for name in names if name not in sweep.figures]:
        raise Refused(f'"{unknown[0]}": no figure of this sweep; there are {", ".join(sweep.figures) or "none yet"}')
    key, _, text = (over or "").partition("=")
    if over is not None and key not in sweep.keys:
        raise Refused(f"--over {over}: not KEY=VALUE with a swept key; swept: {', '.join(sweep.keys)}")
    written = {str(values.get(key)): values.get(key) for values in sweep.values}
    if over is not None and text not in written:
        raise Refused(f'--over {over}: no point has the value "{text}"; there are {", ".join(written)}')
    found = []
    for name in names:
        columns: dict[str, list[Any]] = {each: [str(values[each]) for values in sweep.values] for each in sweep.keys}
        columns |= _intervals("", sweep.estimates(name))
        if over is not None:
            try:
                columns |= _intervals("ratio_", sweep.ratios(name, key, written[text]))
            except ValueError as problem:
                raise Refused(
                    f"--over {over}: {problem}, and all else as at another; keys that go side by side change together"
                ) from problem
        unit = sweep.runs[name].units.strip("1")
        units = dict.fromkeys(("value", "standard_error", "low", "high"), unit)
        found.append(Table(name=name, columns=columns, units=units))
    return found


def _intervals(prefix: str, estimates: "Sequence[PooledEstimate]") -> dict[str, list[Any]]:
    """Return the columns of estimates: value, standard error, 95 % interval and number of runs."""
    columns: dict[str, list[Any]] = {
        "value": [each.value for each in estimates],
        "standard_error": [each.standard_error for each in estimates],
        "low": [each.value - each.reach for each in estimates],
        "high": [each.value + each.reach for each in estimates],
        "runs": [each.runs for each in estimates],
    }
    return {f"{prefix}{name}": values for name, values in columns.items()}


# Compare and verify.
def compare(
    file: ResultFile,
    *,
    bound: Annotated[float | None, option("Z", "Largest |z| that agrees; default: the bound of all figures.")] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Compare the rows of a result with exact theory.

    The exit code is 3 if a value is outside.

    Example: rubnoise compare fig5.h5
    """
    from rubnoise.api.run import Run
    from rubnoise.cli.loading import finished_run

    with finished_run(file) as result:
        run = Run(result)
        found = run.compare(bound)
        title = f"{file}: compared with the theory of its scenario"
        rows = (*found.rows, *_white_noise(run.model()))
        show(replace(found, title=title, rows=rows), as_json=as_json, as_csv=as_csv)
    if found.outside:
        raise NotPassed(f"{printable(str(file))}: outside: {', '.join(found.outside)}")


def _white_noise(model: "Model") -> list[Row]:
    """Return what white noise of the same level at low frequency (Kilburn) would make of a one-way slider, if any."""
    from rubnoise.theory.ancestors import white_noise

    if not model.is_two_way and model.separation is None:
        with suppress(Refused):
            white = white_noise(model)
            return named("white_noise", {name: white[name] for name in ("displacement_std", "velocity_std")})
    return []


def verify(
    file: ResultFile,
    *,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Play a run again, and compare every value of its result.

    The exit code is 3 if something differs.

    For the folder of a sweep, check its names and index too, and every run.

    Example: rubnoise verify fig5.h5
    """
    from rubnoise.cli.loading import finished_run
    from rubnoise.runs import verification

    whole = "its hashes and its run, played again"
    with ExitStack() as stack:
        show_bar = stack.enter_context(bar(shown=sys.stderr.isatty() and not as_json))
        if is_folder(file):
            whole = "its runs, made again, and the index of these"

            def watch(done: int, runs: int) -> None:
                show_bar(done, runs, f"{done:,} of {runs:,} runs")

            found = verification.verify_sweep(file, watch=watch)
        else:
            run = stack.enter_context(finished_run(file))
            run.watch = lambda column, row, rows: show_bar(row, rows, column)
            found = verification.verify(run)
    show(replace(found, title=f"{file}: compared with {whole}"), as_json=as_json, as_csv=as_csv)
    if found.different:
        said = [check.first for check in found.different]
        first = next((each for each in said if " row " in each), said[0])  # one with a row says most
        raise NotPassed(printable(f"{file}: differs: {first}{f'; {found.remark}' if found.remark else ''}"))

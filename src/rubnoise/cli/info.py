"""`rubnoise info`: the content of a result, or of the folder of a sweep."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import rubnoise
from rubnoise.answer import Answer, Row, Table, finite, printable, size
from rubnoise.cli.layout import grouped, json_text, line, sentence, show
from rubnoise.cli.options import AsJson, ResultOrSweep
from rubnoise.cli.sweep import format_failures, states_in_words, values_in_words
from rubnoise.errors import Refused
from rubnoise.regular_file import is_folder

if TYPE_CHECKING:
    from rubnoise.analysis.replicates import PooledEstimate
    from rubnoise.api.run import Run
    from rubnoise.api.sweep_result import SweepResult


def command(
    file: ResultOrSweep,
    *,
    figures: Annotated[
        str | None,
        typer.Option(help="Of a sweep: these figures of each point, over its replicates.", metavar="NAME,..."),
    ] = None,
    over: Annotated[
        str | None, typer.Option(help="The same over the points with this value of a swept key.", metavar="KEY=VALUE")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show what a result or a sweep contains.

    Of a result these are measured and exact figures; of a sweep its progress.

    Of a sweep, --figures shows values with their 95 % intervals, and --over shows ratios with theirs.

    Example: rubnoise info fig5.h5
    """
    if is_folder(file):
        _show_sweep(file, figures, over, as_json=as_json)
        return
    if figures is not None or over is not None:
        raise typer.BadParameter("--figures and --over are for the folder of a sweep")
    from rubnoise.api.run import Run
    from rubnoise.storage.reader import open_run

    with Run(open_run(file)) as run:
        show(run_answer(run, file), as_json=as_json)


def _show_sweep(folder: Path, figures: str | None, over: str | None, *, as_json: bool) -> None:
    if over is not None and figures is None:
        raise typer.BadParameter("--over is for --figures")
    with rubnoise.open_sweep(folder) as sweep:
        answer = sweep_as_json(sweep, folder)
        if figures is not None:
            answer["estimates"] = estimates_as_json(sweep, [name.strip() for name in figures.split(",")], over)
    print(json_text(answer) if as_json else "\n".join(format_sweep(answer)))


def run_answer(run: "Run", file: Path) -> Answer:
    """Return the content of a result file, the numbers that follow from its scenario, and its figures."""
    from rubnoise.cli.derivation import derived

    known = derived(run.scenario, f"{file}: {run.attributes['title']}", warned=False)
    heard, bands = _normal_motion(run)
    figures = [figure.row("summary") for figure in run.summary]
    return replace(known, rows=(*_origin(run, file), *known.rows, *figures, *heard), tables=tuple(bands))


def _origin(run: "Run", file: Path) -> Iterator[Row]:
    """Yield where a file comes from, and its groups with the numbers of their rows."""
    origin = run.provenance
    known = {
        "source": run.attributes["source"],
        "format_version": run.attributes["format_version"],
        "command": origin["command"],
        "intervention": origin.get("intervention"),
        "seed": origin["seed"],
        "started": origin["started"],
        "finished": origin["finished"],
    }
    yield from (Row(name=name, value=value) for name, value in known.items() if value is not None)
    yield Row(name="bytes", value=file.stat().st_size, unit="B")
    for name, group in run.groups().items():
        yield Row(part="groups", name=name, value=len(group), note=", ".join(group.names))


def _normal_motion(run: "Run") -> tuple[list[Row], list[Table]]:
    """Return the normal velocity of a run under a load that weighs, in all and in third octaves; otherwise nothing.

    Roughness noise is reported so: in dB re 50 nm/s.
    """
    from rubnoise.analysis.third_octaves import heard_bands

    try:
        heard = heard_bands(run.reader(), run.model())
    except Refused:
        return [], []
    rows = [
        Row(part="normal_velocity", name="velocity", value=heard.velocity, unit="um/s"),
        Row(part="normal_velocity", name="level", value=heard.whole_level, unit="dB", note="re 50 nm/s"),
    ]
    columns = {"frequency": heard.frequency, "level": heard.level}
    columns |= {} if heard.exact is None else {"exact": heard.exact}
    return rows, [Table(name="third_octaves", columns=columns, units={"frequency": "Hz", "level": "dB", "exact": "dB"})]


def sweep_as_json(sweep: "SweepResult", folder: Path) -> dict[str, Any]:
    """Return the content of the folder of a sweep, by name."""
    attributes = sweep.attributes
    return {
        "folder": str(folder),
        "title": sweep.title,
        "source": attributes["source"],
        "command": attributes["command"],
        "written": attributes["written"],
        "grid": list(sweep.grid),
        "side_by_side": list(sweep.side_by_side),
        "points": len(sweep.points),
        "runs": len(sweep.runs),
        "done": sweep.count("done"),
        "failed": sweep.count("failed"),
        "planned": sweep.count("planned"),
        "bytes": sum(file.stat().st_size for file in folder.rglob("*") if file.is_file()),
        "figures": list(sweep.figures),
        "summaries": list(sweep.summaries),
        "failures": [asdict(each) for each in sweep.failures],
    }


def estimates_as_json(sweep: "SweepResult", names: Sequence[str], over: str | None = None) -> list[dict[str, Any]]:
    """Return figures of each point over its replicates with their 95 % intervals, and ratios ``over`` other points.

    Raises Refused for a figure that no run has, and for a text that is not KEY=VALUE of a point.
    """
    if unknown := [name for name in names if name not in sweep.figures]:
        raise Refused(f'"{unknown[0]}": no figure of this sweep; there are {", ".join(sweep.figures) or "none yet"}')
    found: list[dict[str, Any]] = [{"values": values, "figures": {}} for values in sweep.values]
    for name in names:
        for point, estimate in zip(found, sweep.estimates(name), strict=True):
            point["figures"][name] = _interval(estimate)
    if over is None:
        return found
    key, value = _swept_value(sweep, over)
    for point in found:
        point["over"] = {}
    for name in names:
        try:
            ratios = sweep.ratios(name, key, value)
        except ValueError as problem:
            raise Refused(
                f"--over {over}: {problem}, and all else as at another; keys that go side by side change together"
            ) from problem
        for point, estimate in zip(found, ratios, strict=True):
            point["over"][name] = _interval(estimate)
    return found


def _swept_value(sweep: "SweepResult", over: str) -> tuple[str, Any]:
    """Return the key and the value, as written in the file, of KEY=VALUE."""
    key, _, text = over.partition("=")
    if key not in sweep.keys:
        raise Refused(f"--over {over}: not KEY=VALUE with a swept key; swept: {', '.join(sweep.keys)}")
    written = list(dict.fromkeys(str(values[key]) for values in sweep.values))
    if text not in written:
        raise Refused(f'--over {over}: no point has the value "{text}"; there are {", ".join(written)}')
    return key, next(values[key] for values in sweep.values if str(values[key]) == text)


def _interval(estimate: "PooledEstimate") -> dict[str, float | int | None]:
    """Return value, standard error, 95 % interval and the number of runs; unknown ones are None."""
    numbers = {
        "value": estimate.value,
        "standard_error": estimate.standard_error,
        "low": estimate.value - estimate.reach,
        "high": estimate.value + estimate.reach,
        "runs": estimate.runs,
    }
    return dict(finite(numbers))


def format_sweep(answer: Mapping[str, Any]) -> list[str]:
    """Return the same as lines to print."""
    lines = [
        sentence(f"{answer['folder']}: {printable(answer['title'])}"),
        line("written by", f"{answer['source']}, {answer['written']}"),
        line("command", answer["command"], whole=True),
        line("points", grouped(answer["points"])),
        line("runs", f"{grouped(answer['runs'])}: {states_in_words(answer)}"),
        line("size", size(answer["bytes"])),
        *(line("swept", key) for key in answer["grid"]),
        *(line("swept in parallel", key) for key in answer["side_by_side"]),
        line("figures of each run", ", ".join(answer["figures"])),
    ]
    lines += ["", *format_failures(answer["failures"])] if answer["failures"] else []
    return lines + (["", *_estimate_lines(answer["estimates"])] if "estimates" in answer else [])


def _estimate_lines(points: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield a line for each figure of each point, below the swept values."""
    for point in points:
        yield sentence(values_in_words(point["values"]))
        for name, estimate in point["figures"].items():
            over = point.get("over", {}).get(name, {"runs": 0})
            # A point over itself is 1, which needs no telling.
            ratio = f"; ratio {_with_interval(over)}" if over["runs"] and over["standard_error"] != 0.0 else ""
            runs = f" ({estimate['runs']} runs)" if estimate["runs"] else ""
            yield line(name.replace("_", " "), f"{_with_interval(estimate)}{runs}{ratio}")


def _with_interval(estimate: Mapping[str, Any]) -> str:
    """Return a value with the decimals of two digits of its 95 % interval."""
    if estimate["value"] is None:
        return "not known"
    if estimate["low"] is None:
        return f"{estimate['value']:.5g}"
    reach = 0.5 * (estimate["high"] - estimate["low"])
    if reach == 0.0:
        return f"{estimate['value']:g}"
    places = max(1 - floor(log10(reach)), 0)
    return f"{estimate['value']:.{places}f} +- {reach:.{places}f}"

"""`rubnoise info`: the content of a result, or of the folder of a sweep."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import rubnoise
from rubnoise.cli.layout import agreement_table, finite, grouped, json_text, line, printable, sentence, size
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
        answer = run_as_json(run, file)
        print(json_text(answer) if as_json else "\n".join(format_run(run, answer)))


def _show_sweep(folder: Path, figures: str | None, over: str | None, *, as_json: bool) -> None:
    if over is not None and figures is None:
        raise typer.BadParameter("--over is for --figures")
    with rubnoise.open_sweep(folder) as sweep:
        answer = sweep_as_json(sweep, folder)
        if figures is not None:
            answer["estimates"] = estimates_as_json(sweep, [name.strip() for name in figures.split(",")], over)
    print(json_text(answer) if as_json else "\n".join(format_sweep(answer)))


def run_as_json(run: "Run", file: Path) -> dict[str, Any]:
    """Return the content of a result file and the numbers that follow from its scenario, by name."""
    from rubnoise.analysis.agreement import as_json
    from rubnoise.cli.derivation import derivation_as_json

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
        "derived": derivation_as_json(run.scenario),
        "summary": as_json(run.summary),
        **_normal_motion(run),
    }


def _normal_motion(run: "Run") -> dict[str, Any]:
    """Return the normal velocity of a run under a load that weighs, in all and in third octaves; otherwise empty."""
    from rubnoise.analysis.third_octaves import heard_bands

    try:
        heard = heard_bands(run.reader(), run.model())
    except Refused:
        return {}
    bands = {"frequency": heard.frequency.tolist(), "level": heard.level.tolist()}
    exact = {} if heard.exact is None else {"exact": heard.exact.tolist()}
    found = {"velocity": heard.velocity, "level": heard.whole_level, "third_octaves": bands | exact}
    return {"normal_velocity": found}


def format_run(run: "Run", answer: dict[str, Any]) -> list[str]:
    """Return the same as lines to print."""
    from rubnoise.cli import derivation

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
    lines += ["", "from its scenario", *derivation.format_derivation(run.scenario, answer["derived"])]
    lines += ["", "measured over the whole run, with exact values", *agreement_table(run.summary)]
    return [*lines, *_heard_lines(answer["normal_velocity"])] if "normal_velocity" in answer else lines


def _heard_lines(heard: Mapping[str, Any]) -> Iterator[str]:
    """Yield the normal velocity as roughness noise is reported: levels in dB re 50 nm/s."""
    yield from ("", "noise of the normal motion, in dB re 50 nm/s")
    yield line("all frequencies", f"{heard['level']:.1f} dB, {heard['velocity']:.4g} um/s")
    bands = heard["third_octaves"]
    for place, (frequency, level) in enumerate(zip(bands["frequency"], bands["level"], strict=True)):
        exact = f", exact {bands['exact'][place]:.1f}" if "exact" in bands else ""
        yield line(f"third octave at {frequency:.4g} Hz", f"{level:.1f}{exact}")


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

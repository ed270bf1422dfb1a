"""What is in the folder of a sweep, for `rubnoise info`."""

from collections.abc import Iterator, Mapping, Sequence
from math import floor, isfinite, log10
from pathlib import Path
from typing import Any

from rubnoise.analysis.replicates import Pooled
from rubnoise.api.sweep_result import SweepResult
from rubnoise.errors import Refused


def contents(sweep: SweepResult, folder: Path) -> dict[str, Any]:
    """Return what the folder of a sweep holds, by name."""
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
        "failures": [
            {"run_id": each.run_id, "values": dict(each.values), "replicate": each.replicate, "reason": each.reason}
            for each in sweep.failures
        ],
    }


def estimates(sweep: SweepResult, names: Sequence[str], over: str | None = None) -> list[dict[str, Any]]:
    """Return figures of each point over its replicates with their 95 % intervals, and ratios ``over`` other points.

    Raises Refused for a figure that no run has, and for what is not KEY=VALUE of a point.
    """
    if unknown := [name for name in names if name not in sweep.figures]:
        raise Refused(f'"{unknown[0]}": no figure of this sweep; there are {", ".join(sweep.figures) or "none yet"}')
    found: list[dict[str, Any]] = [{"values": values, "figures": {}} for values in sweep.values]
    for name in names:
        for point, estimate in zip(found, sweep.estimates(name), strict=True):
            point["figures"][name] = _interval(estimate)
    if over is None:
        return found
    key, value = _of_a_point(sweep, over)
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


def _of_a_point(sweep: SweepResult, over: str) -> tuple[str, Any]:
    """Return the key and the value, as written in the file, of KEY=VALUE."""
    key, _, text = over.partition("=")
    if key not in sweep.keys:
        raise Refused(f"--over {over}: not KEY=VALUE with a swept key; swept: {', '.join(sweep.keys)}")
    written = list(dict.fromkeys(str(values[key]) for values in sweep.values))
    if text not in written:
        raise Refused(f'--over {over}: no point has the value "{text}"; there are {", ".join(written)}')
    return key, next(values[key] for values in sweep.values if str(values[key]) == text)


def _interval(estimate: Pooled) -> dict[str, float | int | None]:
    """Return value, standard error, 95 % interval and the number of runs; None for what is not known."""
    numbers = {
        "value": estimate.value,
        "standard_error": estimate.standard_error,
        "low": estimate.value - estimate.reach,
        "high": estimate.value + estimate.reach,
    }
    told: dict[str, float | int | None] = {name: each if isfinite(each) else None for name, each in numbers.items()}
    return {**told, "runs": estimate.runs}


def described(answer: Mapping[str, Any]) -> list[str]:
    """Return the same as lines to print."""
    from rubnoise.cli.layout import grouped, line, printable, size
    from rubnoise.cli.sweep import failures
    from rubnoise.cli.terminal import sentence

    states = ", ".join(f"{grouped(answer[state])} {state}" for state in ("done", "failed", "planned") if answer[state])
    lines = [
        sentence(f"{answer['folder']}: {printable(answer['title'])}"),
        line("written by", f"{answer['source']}, {answer['written']}"),
        line("command", answer["command"], whole=True),
        line("points", grouped(answer["points"])),
        line("runs", f"{grouped(answer['runs'])}: {states}"),
        line("size", size(answer["bytes"])),
        *(line("swept", key) for key in answer["grid"]),
        *(line("swept in parallel", key) for key in answer["side_by_side"]),
        line("figures of each run", ", ".join(answer["figures"])),
    ]
    lines += ["", *failures(answer["failures"])] if answer["failures"] else []
    return lines + (["", *_table(answer["estimates"])] if "estimates" in answer else [])


def _table(points: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield a line for each figure of each point, below the swept values."""
    from rubnoise.cli.layout import line, printable
    from rubnoise.cli.terminal import sentence

    for point in points:
        yield sentence(printable(", ".join(f"{key} = {value}" for key, value in point["values"].items())))
        for name, told in point["figures"].items():
            over = point.get("over", {}).get(name, {"runs": 0})
            # A point over itself is 1, which needs no telling.
            ratio = f"; ratio {_with_interval(over)}" if over["runs"] and over["standard_error"] != 0.0 else ""
            runs = f" ({told['runs']} runs)" if told["runs"] else ""
            yield line(name.replace("_", " "), f"{_with_interval(told)}{runs}{ratio}")


def _with_interval(told: Mapping[str, Any]) -> str:
    """Return a value to two digits of the 95 % interval about it."""
    if told["value"] is None:
        return "not known"
    if told["low"] is None:
        return f"{told['value']:.5g}"
    reach = 0.5 * (told["high"] - told["low"])
    if reach == 0.0:
        return f"{told['value']:g}"
    places = max(1 - floor(log10(reach)), 0)
    return f"{told['value']:.{places}f} +- {reach:.{places}f}"

"""What is in the folder of a sweep, for `rubnoise info`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rubnoise.api.sweep_result import SweepResult


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
    return lines + (["", *failures(answer["failures"])] if answer["failures"] else [])

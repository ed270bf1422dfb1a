"""What a run that has just ended tells: its result in short, as text or as JSON."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rubnoise.api import Run


def tell(
    result: "Run", path: Path, seconds: float, *, warnings: Sequence[str] = (), as_json: bool, quiet: bool
) -> None:
    """Print what became of a run that took so many seconds and lies at a path."""
    if as_json:
        _print_json(result, path, warnings)
    elif not quiet:
        _print_result(result, path, seconds)


def _print_result(result: "Run", path: Path, seconds: float) -> None:
    from rubnoise.cli import layout
    from rubnoise.cli.terminal import sentence

    rows, ticks = layout.grouped(len(result.junctions)), layout.grouped(len(result.trace))
    size = layout.size(path.stat().st_size)
    print(sentence(f"{path}: {rows} junctions, {ticks} ticks, {size}, in {seconds:.1f} s"))
    print("\n".join(layout.agreement_table(result.summary)))
    for doubt in _doubts(result):
        print(layout.remark(f"warning: {doubt}"), file=sys.stderr)


def _doubts(result: "Run") -> list[str]:
    """Return what makes the result doubtful, or what it is too short for."""
    from rubnoise.analysis.summary import missing_for_motion
    from rubnoise.cli import layout

    spread = [figure.observed for figure in result.summary if figure.name == "one_way_validity"]
    doubts = [layout.one_way_warning(validity) for validity in spread if validity > layout.WORTH_A_WARNING]
    missing = missing_for_motion(result.scenario.model())
    return doubts if missing is None else [*doubts, layout.too_short_for_motion(missing.decays, missing.needed)]


def _print_json(result: "Run", path: Path, warnings: Sequence[str]) -> None:
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

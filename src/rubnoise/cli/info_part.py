"""What `rubnoise info` says of a run that did not finish: how far it is, and whether somebody writes it."""

from pathlib import Path
from typing import Any

from rubnoise.cli.layout import grouped, line, printable, size
from rubnoise.cli.terminal import sentence
from rubnoise.errors import resume_hint
from rubnoise.storage.resume import look


def contents(file: Path) -> dict[str, Any]:
    """Return how far a run is, by name."""
    found = look(file)
    about, origin = found.description, found.description.provenance
    return {
        "file": str(file),
        "title": about.title,
        "source": found.source,
        "seed": origin.seed,
        "command": origin.command,
        "started": origin.started,
        "bytes": file.stat().st_size,
        "share": found.share,
        "done": {"junctions": found.junctions, "ticks": found.ticks, **found.grown},
        "whole": {"junctions": about.extent.junctions, "ticks": about.extent.ticks},
        "committed": found.committed or None,
        "being_written": found.being_written,
    }


def described(answer: dict[str, Any]) -> list[str]:
    """Return the same as lines to print."""
    done, whole = answer["done"], answer["whole"]
    rows = ", ".join(
        f"{grouped(count)} of {grouped(whole[name])} {name}" if name in whole else f"{grouped(count)} rows of /{name}"
        for name, count in done.items()
    )
    hint = "a process is writing it" if answer["being_written"] else resume_hint(answer["file"])
    return [
        sentence(f"{answer['file']}: {printable(answer['title'])}, unfinished"),
        line("written by", answer["source"]),
        line("from", answer["started"]),
        line("command", answer["command"], whole=True),
        line("seed", str(answer["seed"])),
        line("size", size(answer["bytes"])),
        line("done", f"{answer['share']:.0%}: {rows}"),
        line("last commit", answer["committed"] or "none yet"),
        line("now", hint, whole=True),
    ]

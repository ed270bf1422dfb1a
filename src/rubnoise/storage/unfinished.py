"""A run that did not finish, as its part file and the journal beside it tell of it."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from rubnoise.errors import Refused, RunFileRefused, resume_hint
from rubnoise.storage.described import described
from rubnoise.storage.history import History, identity
from rubnoise.storage.layout import RunDescription, grows, stored_groups
from rubnoise.storage.output import OutputPaths, is_being_written
from rubnoise.storage.provenance import TIME
from rubnoise.storage.reader import open_run

SUFFIX: Final = ".part"


@dataclass(frozen=True, slots=True, kw_only=True)
class Unfinished:
    """What is known of a run that did not finish, without reading its rows.

    junctions, ticks: rows at the last commit; grown: those of each group of which nobody knows how many there will be;
    committed: its time in UTC, empty before the first; being_written: whether a process writes it now.
    """

    description: RunDescription
    source: str
    junctions: int
    ticks: int
    grown: Mapping[str, int]
    committed: str
    being_written: bool

    @property
    def share(self) -> float:
        """How much of the run's ticks is done, from 0 to 1."""
        return self.ticks / max(self.description.extent.ticks, 1)


def paths_of(part: str | os.PathLike[str]) -> OutputPaths:
    """Return the names that go with a part file; raises RunFileRefused for one that is named otherwise or missing."""
    path = Path(part)
    if path.suffix != SUFFIX or not path.stem:
        raise RunFileRefused(f"{part}: is not an unfinished run: their names end in {SUFFIX}")
    try:
        path.lstat()
    except OSError as problem:
        whole = path.with_suffix("")
        there = f"; {whole} is there" if os.path.lexists(whole) else ""
        reason = "no such file" if isinstance(problem, FileNotFoundError) else str(problem.strerror).lower()
        raise RunFileRefused(f"{part}: {reason}{there}") from problem
    return OutputPaths.of(path.with_suffix(""))


def look(part: str | os.PathLike[str]) -> Unfinished:
    """Return how far a run is that did not finish; one that is being written is looked at without harm.

    Raises RunFileRefused as open_run does.
    """
    paths = paths_of(part)
    with open_run(part) as run:
        description, source = described(run), str(run.attributes["source"])
    growing = [group.name for group in stored_groups(description.features) if grows(group, description.extent)]
    history = _history(paths.journal)
    commits = history.commits if history.run == identity(description) else []
    rows = {group: mark.rows for (group, _), mark in commits[-1].marks.items()} if commits else {}
    return Unfinished(
        description=description,
        source=source,
        junctions=rows.get("junctions", 0),
        ticks=rows.get("trace", 0),
        grown={group: rows.get(group, 0) for group in growing},
        committed=datetime.fromtimestamp(commits[-1].moment, UTC).strftime(TIME) if commits else "",
        being_written=is_being_written(paths),
    )


def _history(journal: Path) -> History:
    try:
        return History.read(journal)
    except OSError as problem:
        raise RunFileRefused(f"{journal}: {(problem.strerror or str(problem)).lower()}") from problem


def refusal(path: str | os.PathLike[str]) -> Refused:
    """Return what to raise where a whole result is wanted and the run did not finish."""
    hint = f"; {resume_hint(str(path))}" if Path(path).suffix == SUFFIX else ""
    return RunFileRefused(f"{path}: unfinished{hint}")

"""An unfinished run: its progress according to part file and journal, and how it is resumed.

Rows are compared with the hashes of the last good commit; rows that differ are computed again.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from rubnoise.errors import OutputRefused, Refused, RunFileRefused, resume_hint
from rubnoise.record.reader import Attributes
from rubnoise.storage import disk, lock
from rubnoise.storage.growing import GrowingFile
from rubnoise.storage.journal import Commit, Ending, History, identity
from rubnoise.storage.layout import RunDescription, grows, stored_groups
from rubnoise.storage.life_curve import LIFE_TABLES
from rubnoise.storage.output import OutputPaths, give_final_name, naming_file, reserve, sole_writer
from rubnoise.storage.part import Part, open_part
from rubnoise.storage.provenance import TIME
from rubnoise.storage.reader import RunFile, open_unfinished, refusing
from rubnoise.storage.run_description import check_structure, description_of

SUFFIX: Final = ".part"


@dataclass(frozen=True, slots=True, kw_only=True)
class Unfinished:
    """The progress of an unfinished run, found without reading its rows.

    junctions, ticks: rows at the last commit; grown: those of each group whose number only the end of the run shows;
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
        """The share of the run's ticks that is done, from 0 to 1."""
        return self.ticks / max(self.description.extent.ticks, 1)


def paths_of(part: str | os.PathLike[str]) -> OutputPaths:
    """Return the paths that belong to a part file; raises RunFileRefused if it is missing or not named like one."""
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
    """Return the progress of an unfinished run, also while it is being written.

    Raises RunFileRefused as open_unfinished does.
    """
    paths = paths_of(part)
    with open_unfinished(part) as run:
        description, source = description_of(run), str(run.attributes["source"])
    growing = [group.name for group in stored_groups(description.features) if grows(group, description.extent)]
    history = _history_or_refusal(paths.journal)
    commits = history.commits if history.run == identity(description) else []
    rows = {group: mark.rows for (group, _), mark in commits[-1].marks.items()} if commits else {}
    return Unfinished(
        description=description,
        source=source,
        junctions=rows.get("junctions", 0),
        ticks=rows.get("trace", 0),
        grown={group: rows.get(group, 0) for group in growing},
        committed=datetime.fromtimestamp(commits[-1].moment, UTC).strftime(TIME) if commits else "",
        being_written=lock.is_held(paths.lock),
    )


class CommittedRun:
    """The committed rows of an unfinished run, read like those of a result.

    Growing groups are left out. A `rubnoise.record.reader.Reader`.
    """

    def __init__(self, run: RunFile, found: Unfinished) -> None:
        """Take the first rows of an open part file."""
        self._run = run
        self._rows = {"junctions": found.junctions, "trace": found.ticks, "slider": found.ticks, "load": found.ticks}
        self._left_out = frozenset(found.grown) | (set(run.columns) - {*self._rows, *LIFE_TABLES})
        self.path, self.extent = run.path, run.extent
        self.attributes, self.provenance = run.attributes, run.provenance
        self.summary: Attributes = {}

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Names of the columns of each group."""
        return {group: names for group, names in self._run.columns.items() if group not in self._left_out}

    def rows(self, group: str) -> int:
        """Return the number of committed rows of a group."""
        return min(self._rows.get(group, self._run.rows(group)), self._run.rows(group))

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Return committed rows ``start`` to ``stop`` (to the last when None) of a column."""
        first, last, _ = slice(start, stop).indices(self.rows(group))
        return self._run.column(group, name, first, max(first, last))


@contextmanager
def committed_run(part: Path) -> Iterator[CommittedRun]:
    """Open a part file to read its committed rows.

    Raises RunFileRefused as `look` does, if nothing is committed, and if /junctions is a growing group.
    """
    found = look(part)
    if not found.ticks:
        raise RunFileRefused(f"{part}: nothing of this run is committed yet")
    if "junctions" in found.grown:
        hint = "a process is writing it" if found.being_written else resume_hint(str(part))
        raise RunFileRefused(f"{part}: an unfinished run in free motion holds no junctions yet; {hint}")
    with open_unfinished(part) as run:
        yield CommittedRun(run, found)


def _history_or_refusal(journal: Path) -> History:
    try:
        return History.read(journal)
    except OSError as problem:
        raise RunFileRefused(f"{journal}: {(problem.strerror or str(problem)).lower()}") from problem


def progress(path: str | os.PathLike[str]) -> str:
    """Return a text with the progress of an unfinished run and how to resume it."""
    try:
        found = look(path)
    except RunFileRefused:
        return "unfinished"
    hint = "a process is writing it" if found.being_written else resume_hint(str(path))
    return f"unfinished: {found.ticks:,} of {found.description.extent.ticks:,} ticks; {hint}"


def refusal(path: str | os.PathLike[str]) -> Refused:
    """Return the error to raise if a complete result is needed and the run did not finish."""
    hint = f"; {resume_hint(str(path))}" if Path(path).suffix == SUFFIX else ""
    return RunFileRefused(f"{path}: unfinished{hint}")


def taken_up(paths: OutputPaths, opening: ExitStack) -> tuple[Part, RunDescription, Commit | None]:
    """Open a part, which ``opening`` closes, after its last good commit; without one the run begins at its start.

    Rows after that commit count as not written. Raises RunFileRefused if the part cannot be read, OutputRefused if the
    disk has not the space for the whole file.
    """
    with mended(paths) as run:
        description = description_of(run)
        part = opening.enter_context(open_part(paths, run))
    history = History.read(paths.journal)
    if history.run != identity(description) or list(history.columns) != part.names:
        history = History()  # that one is of another run, or of other columns
    reserve(part.descriptor, os.fstat(part.descriptor).st_size)
    return part, description, part.go_on_from(history.commits)


def publish_complete(paths: OutputPaths, check: Callable[[RunFile], None], *, force: bool) -> bool:
    """Publish a part that needs no more rows; return whether that has completed the run. The caller holds the lock.

    Such a part either has its final name already, and only left-over files are removed, or it is complete and is
    renamed if ``check``, too, finds nothing wrong. Raises RunFileRefused for a
    part that cannot be read or whose structure is damaged, OutputRefused if a file of another run has the name.
    """
    with mended(paths) as run:
        description = description_of(run)
        if paths.final.exists() and _is_result_of(paths, description):
            paths.remove_beside()
            disk.remove(paths.part)
        elif paths.final.exists() and not force:
            raise OutputRefused(f"{paths.final}: exists already (force=True replaces it)")
        elif run.provenance["finished"] and not run.damaged():
            check(run)
            with naming_file(paths.final):
                disk.sync_file(paths.part)
                paths.remove_beside()
                give_final_name(paths, run.descriptor, force=force)
        else:
            return False
    return True


def examined(paths: OutputPaths) -> RunDescription:
    """Return the description of the run of a part file.

    Raises RunFileRefused if it cannot be read, OutputRefused while another process writes it.
    """
    with sole_writer(paths), mended(paths) as run:
        return description_of(run)


@contextmanager
def mended(paths: OutputPaths) -> Iterator[RunFile]:
    """Open a part file; changes that a kill interrupted are completed first.

    Raises RunFileRefused if it cannot be read, or its structure is not that of a part.
    """
    history = History.read(paths.journal)
    if history.ending is not None:
        _mend(paths, history.run, history.ending)
    with open_unfinished(paths.part) as run:
        check_structure(run)
        yield run


def _mend(paths: OutputPaths, run: str | None, ending: Ending) -> None:
    """Complete interrupted changes, unless part and journal are of different runs."""
    try:
        with open_unfinished(paths.part) as found:
            of_another = identity(description_of(found)) != run
    except RunFileRefused:
        of_another = False
    if of_another:
        raise RunFileRefused(f"{paths.journal}: belongs to another run than the part file (force=True starts over)")
    with refusing(paths.part), ExitStack() as opened:
        part = disk.reopen(paths.part)
        opened.callback(disk.close, part)
        growing = None
        if ending.grown and paths.growing.exists():
            growing = GrowingFile.found(paths.growing, ending.grown_groups)
            opened.callback(growing.close)
        ending.carry_out(part, growing)
        disk.sync(part)


def _is_result_of(paths: OutputPaths, description: RunDescription) -> bool:
    """Whether the final path leads to the part itself, or to a complete result of the same run."""
    if paths.final.samefile(paths.part):
        return True
    try:
        with open_unfinished(paths.final) as run:
            is_of_it = bool(run.provenance["finished"]) and identity(description_of(run)) == identity(description)
            return is_of_it and not run.damaged()
    except RunFileRefused:
        return False

"""A part file taken up again: what of it is good, and from which state it goes on."""

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Self

from rubnoise.errors import OutputRefused, RubnoiseError, RunFileRefused
from rubnoise.simulation.state import State
from rubnoise.storage import disk
from rubnoise.storage.described import described
from rubnoise.storage.ending import Ending
from rubnoise.storage.growing import GrowingFile
from rubnoise.storage.history import History, identity, state_at
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputPaths, give_final_name, reserve, sole_writer
from rubnoise.storage.part import Part, open_part
from rubnoise.storage.reader import RunFile, open_run, refusing


@dataclass(frozen=True, slots=True, kw_only=True)
class TakenUp:
    """A part file opened behind its last good commit.

    ``state`` is None where there is none and the run begins at its start; ``journal_bytes`` of the journal are good.
    """

    part: Part
    description: RunDescription
    state: State | None
    journal_bytes: int

    @classmethod
    def of(cls, paths: OutputPaths, opening: ExitStack) -> Self:
        """Open a part, which closes with ``opening``; what lies behind the last good commit counts as not written.

        Raises RunFileRefused for a part that cannot be read, OutputRefused where the disk has no room for all of it.
        """
        with mended(paths) as run:
            description = described(run)
            part = opening.enter_context(open_part(paths, run))
        history = _history(paths, description, part)
        reserve(part.descriptor, os.fstat(part.descriptor).st_size)
        commit = part.go_on_from(history.commits)
        return cls(
            part=part,
            description=description,
            state=state_at(paths.journal, commit) if commit else None,
            journal_bytes=commit.end if commit else 0,
        )


def settle(paths: OutputPaths, check: Callable[[RunFile], None], *, force: bool) -> bool:
    """Finish what needs no more rows; return whether there was nothing else to do. The lock must be held.

    That is a part that got its final name already, beside which it and its journal were left over, and one that is
    whole and only lacks the name, which it gets when ``check``, too, finds nothing wrong. Raises RunFileRefused for a
    part that cannot be read or whose structure is damaged, OutputRefused where a file of another run bears the name.
    """
    with mended(paths) as run:
        description = described(run)
        if paths.final.exists() and _is_result_of(paths, description):
            paths.remove_beside()
            disk.remove(paths.part)
        elif paths.final.exists() and not force:
            raise OutputRefused(f"{paths.final}: exists already (--force replaces it)")
        elif run.provenance["finished"] and not run.damaged():
            check(run)
            _publish(paths, run, force=force)
        else:
            return False
    return True


def _publish(paths: OutputPaths, run: RunFile, *, force: bool) -> None:
    try:
        _sync(paths)
        paths.remove_beside()
        give_final_name(paths, run.descriptor, force=force)
    except OSError as problem:
        raise RubnoiseError(f"{paths.final}: writing failed: {problem.strerror or problem}") from problem


def examined(paths: OutputPaths) -> RunDescription:
    """Return what run a part file is of.

    Raises RunFileRefused where it cannot be read, OutputRefused while another process writes it.
    """
    with sole_writer(paths), mended(paths) as run:
        return described(run)


@contextmanager
def mended(paths: OutputPaths) -> Iterator[RunFile]:
    """Open a part file, its last changes carried out where a kill came between them.

    Raises RunFileRefused for one that cannot be read, or whose structure is not that of a part.
    """
    history = History.read(paths.journal)
    if history.ending is not None:
        _mend(paths, history.run, history.ending)
    with open_run(paths.part, strict=True) as run:
        yield run


def _mend(paths: OutputPaths, run: str | None, ending: Ending) -> None:
    """Carry out the last changes, unless the part is seen to be of another run than the journal."""
    try:
        with open_run(paths.part) as found:
            of_another = identity(described(found)) != run
    except RunFileRefused:
        of_another = False
    if of_another:
        raise RunFileRefused(f"{paths.journal}: belongs to another run than the part file (--force starts over)")
    with refusing(paths.part), ExitStack() as opened:
        part = disk.reopen(paths.part)
        opened.callback(disk.close, part)
        growing = None
        if ending.grown and paths.growing.exists():
            growing = GrowingFile.found(paths.growing, ending.grown_groups)
            opened.callback(growing.close)
        ending.carry_out(part, growing)
        disk.sync(part)


def _history(paths: OutputPaths, description: RunDescription, part: Part) -> History:
    """Return what the journal tells of this run; nothing where it is of another one, or of other columns."""
    history = History.read(paths.journal)
    is_of_this = history.run == identity(description) and list(history.columns) == part.names
    return history if is_of_this else History()


def _is_result_of(paths: OutputPaths, description: RunDescription) -> bool:
    """Whether the final name is that of the part, or of a whole result of the same run."""
    if paths.final.samefile(paths.part):
        return True
    try:
        with open_run(paths.final) as run:
            is_of_it = bool(run.provenance["finished"]) and identity(described(run)) == identity(description)
            return is_of_it and not run.damaged()
    except RunFileRefused:
        return False


def _sync(paths: OutputPaths) -> None:
    part = disk.reopen(paths.part)
    try:
        disk.sync(part)
    finally:
        disk.close(part)

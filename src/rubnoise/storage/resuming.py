"""A part file taken up again: what of it is good, and from which state it goes on."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Self

from rubnoise.errors import OutputRefused, RunFileRefused
from rubnoise.simulation.state import State
from rubnoise.storage import disk
from rubnoise.storage.ending import carry_out
from rubnoise.storage.history import History, identity, state_at
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputPaths, give_final_name, reserve, sole_writer
from rubnoise.storage.part import Part, open_part
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.unfinished import described


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
        history = _history(paths, description)
        part = opening.enter_context(open_part(paths.part))
        reserve(part.descriptor, paths.part.stat().st_size)
        commit = part.go_on_from(history.commits)
        return cls(
            part=part,
            description=description,
            state=state_at(paths.journal, commit) if commit else None,
            journal_bytes=commit.end if commit else 0,
        )


def settle(paths: OutputPaths, *, force: bool) -> bool:
    """Finish what needs no more rows; return whether there was nothing else to do. The lock must be held.

    That is a part that got its final name already, beside which it and its journal were left over, and one that is
    whole and only lacks the name. Raises RunFileRefused for a part that cannot be read, OutputRefused where a file of
    another run bears the name.
    """
    with mended(paths) as run:
        description, whole = described(run), bool(run.provenance["finished"]) and not run.damaged()
    if paths.final.exists() and _is_result_of(paths, description):
        disk.remove(paths.journal)
        disk.remove(paths.part)
    elif paths.final.exists() and not force:
        raise OutputRefused(f"{paths.final}: exists already (--force replaces it)")
    elif whole:
        _sync(paths)
        disk.remove(paths.journal)
        give_final_name(paths, force=force)
    else:
        return False
    return True


def examined(paths: OutputPaths) -> RunDescription:
    """Return what run a part file is of.

    Raises RunFileRefused where it cannot be read, OutputRefused while another process writes it.
    """
    with sole_writer(paths), mended(paths) as run:
        return described(run)


@contextmanager
def mended(paths: OutputPaths) -> Iterator[RunFile]:
    """Open a part file, its last changes carried out where a kill came between them."""
    history = History.read(paths.journal)
    if history.ending is not None:
        _mend(paths, history.run, history.ending)
    with open_run(paths.part) as run:
        yield run


def _mend(paths: OutputPaths, run: str | None, ending: bytes) -> None:
    """Carry out the last changes, unless the part is seen to be of another run than the journal."""
    try:
        with open_run(paths.part) as found:
            of_another = identity(described(found)) != run
    except RunFileRefused:
        of_another = False
    if of_another:
        raise RunFileRefused(f"{paths.journal}: is of another run than the part file beside it (--force starts over)")
    part = disk.reopen(paths.part)
    try:
        carry_out(part, ending)
    finally:
        disk.close(part)


def _history(paths: OutputPaths, description: RunDescription) -> History:
    """Return what the journal tells of this run; nothing where it is of another one."""
    history = History.read(paths.journal)
    return history if history.run == identity(description) else History()


def _is_result_of(paths: OutputPaths, description: RunDescription) -> bool:
    try:
        with open_run(paths.final) as run:
            return bool(run.provenance["finished"]) and identity(described(run)) == identity(description)
    except RunFileRefused:
        return False


def _sync(paths: OutputPaths) -> None:
    part = disk.reopen(paths.part)
    try:
        disk.sync(part)
    finally:
        disk.close(part)

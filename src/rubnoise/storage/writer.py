"""The writer of result files: a sink that leaves a complete file with its final name, or a part to resume."""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from time import monotonic
from types import TracebackType
from typing import Final, Self

from rubnoise.errors import OutputRefused, RubnoiseError, RunStopped, resume_hint
from rubnoise.record.sink import Columns, Sink
from rubnoise.record.tally import TALLIED
from rubnoise.simulation.state import State
from rubnoise.storage import disk
from rubnoise.storage.journal import Journal, packed_commit, packed_run, state_at
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputAppearedError, check_output, give_final_name, reason_of, sole_writer
from rubnoise.storage.part import compressed, make_part
from rubnoise.storage.provenance import now
from rubnoise.storage.resume import SUFFIX, taken_up
from rubnoise.storage.schema import Scalar
from rubnoise.storage.structure import Written

COMMIT_SECONDS: Final = 1.0
"""Least time in s between two commits: a power cut may cost so much, and a short run makes no commit."""


class RunWriter:
    """Writes one run to ``path``: enter it, write every row, publish.

    Rows go to ``NAME.h5.part``, which has its final size from the start; ``publish`` gives it the final name.
    ``commit`` writes the state to ``NAME.h5.part.journal``, at most once a second, after all rows are on disk. If
    the context ends without ``publish``, both files stay if there was a commit, or if a signal stopped a run that had
    finished a block; otherwise the part is removed. An older file at the path stays. Memory does not depend on the
    length of the run.

    Without a description it resumes the existing part: ``description`` and ``state`` are then those found, None being
    the start, and ``replay`` writes its rows to a sink. Without ``safe`` there are neither journal nor hashes, which
    serves only to measure their cost. Without ``durable`` a run that ends before its first commit does not wait for the
    disk: a kill loses nothing then, a power cut may until another call has flushed the file to disk (see sync_many).
    Entering raises OutputRefused (see check_output; also for a full disk or a second writer), and RunFileRefused for a
    part that cannot be read.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        description: RunDescription | None,
        *,
        force: bool = False,
        safe: bool = True,
        durable: bool = True,
    ) -> None:
        self._path = path
        self._given = description
        self._force = force
        self._safe = safe
        self._durable = durable
        self._keep_part = description is None
        self._open = ExitStack()
        self.state: State | None = None
        self.written: Written | None = None

    def __enter__(self) -> Self:
        again = self._given is None
        paths = check_output(self._path, force=self._force, unfinished=again)
        with ExitStack() as opening:
            opening.enter_context(sole_writer(paths))
            check_output(self._path, force=self._force, unfinished=again)
            self._paths = paths
            if self._given is None:
                self._take_up(opening)
            else:
                self._begin(self._given, opening)
            self._rows = self._part.rows()
            self._open = opening.pop_all()
        self._committed_at = monotonic()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if isinstance(error, RunStopped):
            self._stop(error)
        self._open.close()

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Write rows of a group (see Sink)."""
        with self._naming_file():
            self._part.write(group, first_row, columns)

    def commit(self, state: State) -> None:
        """Record that all rows before a state have been written; once a second flush everything to disk (fsync)."""
        self.state, self._rows = state, self._part.rows()
        if self._safe and monotonic() - self._committed_at >= COMMIT_SECONDS:
            with self._naming_file():
                self._commit(state)

    def replay(self, sink: Sink) -> None:
        """Write the rows of before the resumption that a summary needs to a sink."""
        self._part.replay(sink, TALLIED)

    def publish(self, summary: Mapping[str, Scalar], *, between: Callable[[], None] = lambda: None) -> None:
        """Fill in hashes, summary and the time of the end, and give the file its final name.

        ``between`` is called now and then while a file is compressed, and may raise to stop. Raises RubnoiseError if a
        column lacks rows, if the disk fails, or if, without ``force``, another process created the file meanwhile.
        ``written`` is then that file.
        """
        with self._naming_file():
            if self._journal.begun and self.state is not None:
                self._commit(self.state)
            finished, durable = now(), self._durable or self._journal.begun
            with self._completed(summary, finished, between, durable=durable) as checked:
                self._name(checked, durable=durable)
                self.written = self._written(os.fstat(checked), summary, finished)

    def _begin(self, description: RunDescription, opening: ExitStack) -> None:
        """Make a new part; an old journal is removed first and flushed, so that it never lies beside this part."""
        disk.remove(self._paths.growing)
        if self._paths.journal.exists():
            disk.remove(self._paths.journal)
            disk.sync_folder(self._paths.journal.parent)
        try:
            part = make_part(self._paths, description, hashed=self._safe, durable=self._durable)
        except OSError as problem:
            raise OutputRefused(f"{self._paths.final}: cannot be written: {reason_of(problem)}") from problem
        self._own = os.fstat(part.descriptor)
        opening.callback(self._discard)
        self._part = opening.enter_context(part)
        self._keep_journal(description, opening)

    def _take_up(self, opening: ExitStack) -> None:
        self._part, description, commit = taken_up(self._paths, opening)
        self.state = state_at(self._paths.journal, commit) if commit else None
        self._own = os.fstat(self._part.descriptor)
        self._keep_journal(description, opening, commit.end if commit else 0)

    def _keep_journal(self, description: RunDescription, opening: ExitStack, size: int = 0) -> None:
        self.description = description
        self._journal = Journal(self._paths.journal, packed_run(description, self._part.names), size)
        opening.callback(self._journal.close)

    def _commit(self, state: State, *, durable: bool = True) -> None:
        marks = self._part.marks(self._rows)
        if durable:
            self._part.sync()
        self._journal.append("rows", packed_commit(marks, state), durable=durable)
        self._keep_part = True
        self._committed_at = monotonic()

    @contextmanager
    def _completed(
        self, summary: Mapping[str, Scalar], finished: str, between: Callable[[], None], *, durable: bool
    ) -> Iterator[int]:
        """Yield the complete part, open, after it has been read back and compared with what was written."""
        if self.description.compression == "gzip":
            with compressed(self._part, self._paths.making, self.description, summary, finished, between) as descriptor:
                self._own = os.fstat(descriptor)
                disk.rename(self._paths.making, self._paths.part)
                # Before the journal is removed: without it, a raw part that still exists would begin at its start.
                disk.sync_folder(self._paths.part.parent)
                yield descriptor
            return
        ending, descriptor = self._part.completion(summary, finished), self._part.descriptor
        if self._safe:
            if durable:
                self._part.sync_growing()
            self._journal.append("end", ending.packed(), durable=durable)
        self._part.carry_out(ending)
        (disk.sync if durable else disk.begin_sync)(descriptor)
        if self._safe:
            self._part.check(ending)
        yield descriptor

    def _written(self, file: os.stat_result, summary: Mapping[str, Scalar], finished: str) -> Written:
        if self.description.compression == "gzip" or not self._safe:
            return Written(file)
        part, features = self._part, self.description.features
        return Written.of(file, features, part.words, part.columns(), summary, finished)

    def _name(self, checked: int, *, durable: bool) -> None:
        # The part is complete and needs no file beside it any more; a kill may leave the one that is removed last.
        self._journal.close()
        self._paths.remove_beside()
        try:
            give_final_name(self._paths, checked, force=self._force, durable=durable)
        except OutputAppearedError:
            self._keep_part = True
            raise

    def _stop(self, stopped: RunStopped) -> None:
        """Keep all rows up to the last block, and report that.

        There is no fsync: rows handed to the system outlive the process, and hashes show rows lost in a power cut. If
        the disk fails here, the last commit stays.
        """
        with suppress(OSError):
            if self._safe and self.state is not None:
                self._commit(self.state, durable=False)
        if self._keep_part:
            stopped.kept = f"{self._path}{SUFFIX}"

    def _discard(self) -> None:
        """Remove the remaining files, but not a file of another process that has the name of the part."""
        if not self._keep_part:
            self._paths.remove_beside()
            if disk.is_file(self._paths.part, self._own):
                disk.remove(self._paths.part)

    @contextmanager
    def _naming_file(self) -> Iterator[None]:
        """Turn an error of the disk into one that names the file and a remedy."""
        try:
            yield
        except (OSError, disk.NotAsWritten) as problem:
            text = f"{self._paths.final}: writing failed: {reason_of(problem)}"
            if self._keep_part:
                text += f"; after you fix this, {resume_hint(f'{self._path}{SUFFIX}')}"
            raise RubnoiseError(text) from problem

"""The writer of result files: a sink that ends in a whole file under the final name, or in none."""

import os
from collections.abc import Mapping
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from rubnoise.errors import OutputRefused, RubnoiseError
from rubnoise.record.sink import Columns
from rubnoise.storage.compress import compress_part
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputAppearedError, OutputPaths, check_output, give_final_name, sole_writer
from rubnoise.storage.part import Part, make_part
from rubnoise.storage.provenance import now
from rubnoise.storage.schema import Scalar


class RunWriter:
    """Writes one run to ``path``: enter it, write every row, publish.

    Rows go to ``NAME.h5.part``, which has its final size from the start; ``publish`` gives it the final name. Left
    without having published, it removes the part, and an older file at the path is as it was. Memory does not depend
    on the length of the run. Entering raises OutputRefused (see check_output; a full disk and a second writer too).
    """

    def __init__(self, path: str | os.PathLike[str], description: RunDescription, *, force: bool = False) -> None:
        self._path = path
        self._description = description
        self._force = force
        self._open = ExitStack()
        self._keep_part = False

    def __enter__(self) -> Self:
        paths = check_output(self._path, force=self._force)
        with ExitStack() as opening:
            opening.enter_context(sole_writer(paths))
            check_output(self._path, force=self._force)
            _make_part(paths, self._description)
            opening.callback(self._discard, paths)
            self._part = opening.enter_context(Part(paths.part))
            self._open = opening.pop_all()
        self._paths = paths
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._open.close()

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Write rows of a group (see Sink)."""
        try:
            self._part.write(group, first_row, columns)
        except OSError as problem:
            raise self._failed(problem) from problem

    def publish(self, summary: Mapping[str, Scalar]) -> None:
        """Fill in hashes, summary and the time of the end, and give the file its final name.

        Raises RubnoiseError where a column lacks rows, where the disk fails, or where, without ``force``, somebody
        created the file meanwhile.
        """
        try:
            self._finish(summary)
            give_final_name(self._paths, force=self._force)
        except OSError as problem:
            raise self._failed(problem) from problem
        except OutputAppearedError:
            self._keep_part = True
            raise

    def _finish(self, summary: Mapping[str, Scalar]) -> None:
        if self._description.compression == "none":
            self._part.complete(summary, now())
        else:
            compress_part(self._part, self._paths, self._description, summary, now())

    def _discard(self, paths: OutputPaths) -> None:
        if not self._keep_part:
            paths.part.unlink(missing_ok=True)

    def _failed(self, problem: OSError) -> RubnoiseError:
        return RubnoiseError(f"{self._paths.final}: writing failed: {problem.strerror or problem}")


def _make_part(paths: OutputPaths, description: RunDescription) -> None:
    try:
        make_part(paths.part, paths.making, description)
    except OSError as problem:
        raise OutputRefused(f"{paths.final}: cannot be written: {problem.strerror or problem}") from problem

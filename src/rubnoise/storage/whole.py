"""A file that is written whole or not at all, whatever it holds."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rubnoise.errors import RubnoiseError
from rubnoise.storage import disk
from rubnoise.storage.output import OutputAppearedError, check_output, give_final_name, sole_writer


@contextmanager
def whole_file(path: str | os.PathLike[str], *, force: bool) -> Iterator[Path]:
    """Yield the name under which to write a file; once that is done it gets its own name, on the disk.

    Raises OutputRefused, before anything is created, where nothing may or can be written, RubnoiseError where the disk
    fails. Whatever is raised meanwhile leaves nothing behind.
    """
    paths = check_output(path, force=force)
    with sole_writer(paths):
        check_output(path, force=force)
        try:
            yield paths.part
            _settle(paths.part)
            give_final_name(paths, force=force)
        except OutputAppearedError:
            raise
        except BaseException as problem:
            disk.remove(paths.part)
            if isinstance(problem, OSError):
                raise RubnoiseError(f"{paths.final}: writing failed: {problem.strerror or problem}") from problem
            raise


def _settle(part: Path) -> None:
    descriptor = os.open(part, os.O_RDONLY | os.O_CLOEXEC)
    try:
        disk.sync(descriptor)
    finally:
        os.close(descriptor)

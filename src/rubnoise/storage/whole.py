"""A file that is written whole or not at all, whatever it holds."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rubnoise.errors import RubnoiseError
from rubnoise.storage import disk
from rubnoise.storage.output import (
    OutputAppearedError,
    OutputPaths,
    OutputSwappedError,
    check_output,
    give_final_name,
    sole_writer,
)


@contextmanager
def whole_file(path: str | os.PathLike[str], *, force: bool) -> Iterator[Path]:
    """Yield the name under which to write a file; once that is done it gets its own name, on the disk.

    Raises OutputRefused, before anything is created, where nothing may or can be written, RubnoiseError where the disk
    fails. Whatever is raised meanwhile leaves nothing behind.
    """
    paths = check_output(path, force=force)
    with sole_writer(paths):
        check_output(path, force=force)
        with _telling(paths), _new(paths.part) as descriptor:
            yield paths.part
            disk.sync(descriptor)
            give_final_name(paths, descriptor, force=force)


@contextmanager
def _new(part: Path) -> Iterator[int]:
    """Make a file anew that others may write by its name; it goes where it does not get another name."""
    disk.remove(part)
    descriptor = disk.create(part)
    try:
        yield descriptor
    except (OutputAppearedError, OutputSwappedError):
        raise
    except BaseException:
        disk.remove(part)
        raise
    finally:
        disk.close(descriptor)


@contextmanager
def _telling(paths: OutputPaths) -> Iterator[None]:
    """Say of a disk that fails which file it is about."""
    try:
        yield
    except OSError as problem:
        raise RubnoiseError(f"{paths.final}: writing failed: {problem.strerror or problem}") from problem
    except disk.NotAsWritten as problem:
        raise RubnoiseError(f"{paths.final}: writing failed: {problem}") from problem

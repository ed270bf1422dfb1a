"""Decide whether a result may be written, and give a file its final name when it is complete.

Whatever is refused is refused before any file is created. A file is written as ``NAME.part`` beside its final name, and
a lock on that file keeps other writers away. A part of a process that has ended is overwritten.
"""

import errno
import os
import stat
import warnings
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from time import monotonic, sleep
from typing import Final

from rubnoise.errors import OutputRefused, RubnoiseError, reason_of, refusing_files
from rubnoise.regular_file import lock

PATIENCE_SECONDS: Final = 0.3  # longer than a copy of a process that has ended keeps its lock
PART: Final = ".part"  # the end of the name of a file that is not whole yet
NO_ROOM: Final = frozenset((errno.ENOSPC, errno.EDQUOT))
CANNOT_RESERVE: Final = frozenset((errno.EOPNOTSUPP, errno.ENOTSUP, errno.ENOSYS, errno.EINVAL))


class WrittenWithLess(UserWarning):
    """A file is written without a lock, or without its space reserved: the file system has no such thing."""


class OutputInUse(OutputRefused):
    """Another process is writing the output."""


def part_of(path: str | os.PathLike[str]) -> Path:
    """Return the path of the part of a result; raises OutputRefused for the name of a folder."""
    if os.fspath(path).endswith("/"):
        raise OutputRefused(f"{path}: names a folder; name a file")
    final = Path(path).absolute()
    return final.with_name(f"{final.name}{PART}")


def check_output(path: str | os.PathLike[str], *, force: bool, reads: Iterable[str | os.PathLike[str]] = ()) -> Path:
    """Return the absolute path of a result, or raise OutputRefused with the reason; creates nothing.

    Refused are a folder that is missing or not writable, anything at the path or at that of its part that is no regular
    file, and, unless ``force``, a file that exists already.
    Also refused, even with ``force``, is a file that the caller ``reads``, by whatever name: it would be lost.
    """
    try:
        final, part = Path(path).absolute(), part_of(path)
        if not final.parent.is_dir():
            raise OutputRefused(f"{final.parent}: no such folder")
        # Before the folder's rights: a message that /dev is not writable does not help when the output is /dev/null.
        for name in (final, part):
            # Nor may it be a link: renaming over it would leave its target unchanged.
            if (about := _status(name)) and not stat.S_ISREG(about.st_mode):
                raise OutputRefused(f"{name}: exists and is not a regular file")
        if not os.access(final.parent, os.W_OK | os.X_OK):
            raise OutputRefused(f"{final.parent}: the folder is not writable")
        for name, read in product((final, part), reads):
            with suppress(OSError):  # one of the two is not there
                if name.samefile(read):
                    raise OutputRefused(f"{name}: is read here ({read}), so it can't be the output; take another name")
    except (OSError, ValueError) as problem:
        raise OutputRefused(f"{path}: cannot be written: {reason_of(problem)}") from problem
    if not force and _status(final):
        raise OutputRefused(f"{final}: exists already (force=True replaces it)")
    return final


def _status(path: Path) -> os.stat_result | None:
    """Return what the system says of what is at a path; None if nothing is there."""
    with suppress(FileNotFoundError):
        return path.lstat()
    return None


def _leads_to(path: Path, descriptor: int) -> bool:
    """Whether a path leads to an open file."""
    about = _status(path)
    return about is not None and os.path.samestat(about, os.fstat(descriptor))


@dataclass(slots=True, kw_only=True)
class PartFile:
    """A file that is being written, open and locked: ``finish`` gives it its final name."""

    final: Path
    path: Path
    descriptor: int
    force: bool
    stays: bool = False

    def failing(self) -> AbstractContextManager[None]:
        """Return what turns an error of the disk into a RubnoiseError that names the file."""
        return refusing_files(self.final, RubnoiseError, "writing failed: ")

    def reserve(self, size: int, descriptor: int | None = None) -> None:
        """Take the disk space of the file, or of another one that belongs to it; raises OutputRefused without room."""
        if not size or not hasattr(os, "posix_fallocate"):  # which macOS lacks
            return
        try:
            os.posix_fallocate(self.descriptor if descriptor is None else descriptor, 0, size)
        except OSError as problem:
            if problem.errno in NO_ROOM:
                raise OutputRefused(
                    f"{self.final}: no room for the {size:,} bytes of the result: {reason_of(problem)}; a shorter"
                    " sliding.distance or a longer output.tick makes it smaller"
                ) from problem
            if problem.errno not in CANNOT_RESERVE:
                raise
            _note("this file system reserves no space: a disk that is too small shows only when it is full")

    def finish(self) -> None:
        """Give the complete file its final name; it is on disk then (fsync).

        Raises RubnoiseError if another file has the name of the part by now, which stays, and, without ``force``, if
        one has the final name, beside which the part stays.
        """
        os.fsync(self.descriptor)
        if not _leads_to(self.path, self.descriptor):
            raise RubnoiseError(
                f"{self.path}: another file has taken its place during the run; it is left as it is, and {self.final}"
                " is not written"
            )
        if not self.force and _status(self.final):
            self.stays = True
            raise RubnoiseError(
                f"{self.final} appeared during the run and is left as it is; the whole result is {self.path}"
            )
        self.path.replace(self.final)
        with suppress(PermissionError):  # of a folder that may be written, and not read
            folder = os.open(self.final.parent, os.O_RDONLY)
            try:
                os.fsync(folder)
            finally:
                os.close(folder)

    def remove(self) -> None:
        """Remove the file if it still has the name of the part."""
        with suppress(OSError):  # of a folder that is gone, say: the file is no result either way
            if not self.stays and _leads_to(self.path, self.descriptor):
                self.path.unlink(missing_ok=True)


@contextmanager
def part_file(path: str | os.PathLike[str], *, force: bool) -> Iterator[PartFile]:
    """Yield the new part of a result, removed at the end if it is not final; raises OutputRefused or OutputInUse."""
    final, name = check_output(path, force=force), part_of(path)
    with refusing_files(final, OutputRefused, "cannot be written: "):
        descriptor = _locked(name, final)
    part = PartFile(final=final, path=name, descriptor=descriptor, force=force)
    try:
        check_output(path, force=force)  # another process may have just written it
        os.ftruncate(descriptor, 0)
        yield part
    finally:
        part.remove()
        os.close(descriptor)


def _locked(part: Path, final: Path) -> int:
    """Return the descriptor of a part that exists or is made, locked, before anything in it is changed.

    While a process waits for the lock, the file may get its final name. So the name must still lead to the open file.
    """
    while True:
        descriptor = os.open(part, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
        try:
            _wait_for_lock(descriptor, final)
            if _leads_to(part, descriptor):
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def _wait_for_lock(descriptor: int, final: Path) -> None:
    """Lock a file if the system has locks; raises OutputInUse if another process holds it longer than a moment."""
    deadline = monotonic() + PATIENCE_SECONDS
    while True:
        try:
            return lock(descriptor)
        except BlockingIOError as problem:
            if monotonic() > deadline:
                raise OutputInUse(f"{final}: another process is writing it") from problem
            sleep(PATIENCE_SECONDS / 100)
        except OSError:
            return _note("this file system has no locks: never write one result by two processes at once")


def _note(text: str) -> None:
    warnings.warn(text, WrittenWithLess, stacklevel=2)


@contextmanager
def whole_file(path: str | os.PathLike[str], *, force: bool) -> Iterator[Path]:
    """Yield a temporary path to write a file; when the block ends, the file is flushed to disk and renamed.

    Raises OutputRefused, before anything is created, if nothing may or can be written, RubnoiseError if the disk
    fails. If the block raises, the file is removed.
    """
    with part_file(path, force=force) as part, part.failing():
        yield part.path
        part.finish()

"""Decide whether a result may be written, and give a file its final name when it is complete.

Everything that is refused is refused before any file is created.
"""

import os
import shutil
import stat
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from rubnoise.errors import OutputRefused, RubnoiseError
from rubnoise.storage import disk, lock

NO_LOCKS = (
    "a run is written on Linux and macOS only, where locks keep a second writer out; on Windows use its Subsystem for"
    " Linux (WSL), or keep the run in memory with rubnoise.simulate"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputPaths:
    """The paths that belong to one result, all in its folder."""

    final: Path
    part: Path
    journal: Path
    growing: Path
    making: Path
    lock: Path

    @classmethod
    def of(cls, path: str | os.PathLike[str]) -> Self:
        """Return the paths that belong to a result; a later change of the working directory does not change them."""
        final = Path(path).absolute()
        return cls(
            final=final,
            part=final.with_name(f"{final.name}.part"),
            journal=final.with_name(f"{final.name}.part.journal"),
            growing=final.with_name(f"{final.name}.part.rows"),
            making=final.with_name(f".{final.name}.making"),
            lock=final.with_name(f".{final.name}.lock"),
        )

    @property
    def names(self) -> tuple[Path, ...]:
        """All of them."""
        return self.final, self.part, self.journal, self.growing, self.making, self.lock

    def remove_beside(self) -> None:
        """Remove the files beside an unfinished part: its journal, and its growing rows, which need the journal."""
        disk.remove(self.growing)
        disk.remove(self.journal)


def check_output(
    path: str | os.PathLike[str], *, force: bool, unfinished: bool = False, reads: Iterable[str | os.PathLike[str]] = ()
) -> OutputPaths:
    """Return the names for a result, or raise OutputRefused with the reason; creates nothing.

    If a result or a part is in the way, the lock file that a killed run has left beside it is removed.

    Refused are a folder that is missing or not writable, anything at the path that is no regular file, and, unless
    ``force``, a file that exists already: a complete one or, unless ``unfinished``, the part of an unfinished run.
    Also refused, even with ``force``, is a file that the caller ``reads``, by whatever name: it would be lost.
    """
    try:
        if os.fspath(path).endswith(("/", os.sep)):
            raise OutputRefused(f"{path}: names a folder; name a file")
        paths = OutputPaths.of(path)
        if not paths.final.parent.is_dir():
            raise OutputRefused(f"{paths.final.parent}: no such folder")
        # Before the folder's rights: a message that /dev is not writable does not help when the output is /dev/null.
        for name in paths.names:
            mode = _mode(name)
            # Nor may it be a link: renaming over it would leave its target unchanged.
            if mode is not None and not stat.S_ISREG(mode):
                raise OutputRefused(f"{name}: exists and is not a regular file")
        if not os.access(paths.final.parent, os.W_OK | os.X_OK):
            raise OutputRefused(f"{paths.final.parent}: the folder is not writable")
        _check_not_read(paths, reads)
    except (OSError, ValueError) as problem:
        raise OutputRefused(f"{path}: cannot be written: {reason_of(problem)}") from problem
    if not force:
        try:
            _check_absent(paths, unfinished=unfinished)
        except OutputRefused:
            lock.remove_stale(paths.lock)
            raise
    return paths


@contextmanager
def sole_writer(paths: OutputPaths) -> Iterator[None]:
    """Hold the lock of a result; raises OutputRefused if another process is writing it."""
    with ExitStack() as held:
        try:
            held.enter_context(lock.holding(paths.lock))
        except lock.Held as problem:
            raise OutputInUse(f"{paths.final}: another process is writing it") from problem
        except OSError as problem:
            raise OutputRefused(f"{paths.final}: cannot be locked: {reason_of(problem)}") from problem
        yield


def check_locks(path: str | os.PathLike[str]) -> None:
    """Raise OutputRefused on a system without the locks that the file of a run or of a sweep needs."""
    if not lock.AVAILABLE:
        raise OutputRefused(f"{path}: {NO_LOCKS}")


_SMALLER = "a shorter sliding.distance or a longer output.tick makes it smaller"


def reserve(descriptor: int, size: int, *, later: int = 0) -> None:
    """Allocate the disk space of a whole file now; raises OutputRefused if there is not enough.

    ``later``: further bytes that must be free, but are not allocated yet.
    """
    missing = size + later - os.fstat(descriptor).st_blocks * 512
    free = shutil.disk_usage(descriptor).free
    if missing > free:
        raise OutputRefused(f"the result needs {missing:,} bytes, and the disk has {free:,} free; {_SMALLER}")
    try:
        disk.allocate(descriptor, size)
    except OSError as problem:
        raise OutputRefused(
            f"no room for the {size:,} bytes of the result: {reason_of(problem)}; {_SMALLER}"
        ) from problem


def give_final_name(paths: OutputPaths, checked: int, *, force: bool, durable: bool = True) -> None:
    """Rename a complete part file to its final name; if ``durable``, flush its folder to disk.

    ``checked`` is the open file that was found complete: if another file has the name of the part by now, it stays
    and is not published (OutputSwappedError). Without ``force`` a file that appeared meanwhile under the final name is
    left alone, too (OutputAppearedError), and the part stays.
    """
    if not disk.is_file(paths.part, os.fstat(checked)):
        raise OutputSwappedError(
            f"{paths.part}: another file has taken its place during the run; it is left as it is, and {paths.final} is"
            " not written"
        )
    _rename(paths, force=force)
    if durable:
        disk.sync_folder(paths.final.parent)


def _rename(paths: OutputPaths, *, force: bool) -> None:
    if force:
        return disk.rename(paths.part, paths.final)
    try:
        disk.link(paths.part, paths.final)
    except OSError as problem:
        if _mode(paths.final) is not None:
            raise OutputAppearedError(
                f"{paths.final} appeared during the run and is left as it is; the whole result is {paths.part}"
            ) from problem
        # File systems without hard links have no rename that keeps an existing file, either.
        disk.rename(paths.part, paths.final)
    else:
        with suppress(OSError):  # the result has its name: a second one that stays makes it no less whole
            disk.remove(paths.part)


class OutputInUse(OutputRefused):
    """Another process is writing the output."""


class OutputAppearedError(RubnoiseError):
    """Another process created the output file during the run."""


class OutputSwappedError(RubnoiseError):
    """Another process has replaced the part file during the run."""


def _mode(path: Path) -> int | None:
    """Return the type and permissions of what is at a path, or None if it does not exist."""
    try:
        return path.lstat().st_mode
    except FileNotFoundError:
        return None


def _check_absent(paths: OutputPaths, *, unfinished: bool) -> None:
    if _mode(paths.final) is not None:
        raise OutputRefused(f"{paths.final}: exists already (force=True replaces it)")
    if not unfinished and _mode(paths.part) is not None:
        raise OutputRefused(f"{paths.part}: belongs to a running or stopped run (force=True replaces a stopped one)")


def _check_not_read(paths: OutputPaths, reads: Iterable[str | os.PathLike[str]]) -> None:
    for read in map(Path, reads):
        for name in paths.names:
            with suppress(OSError):  # one of the two is not there
                if name.samefile(read):
                    raise OutputRefused(f"{name}: is read here ({read}), so it can't be the output; take another name")


def reason_of(problem: Exception) -> str:
    """Return why the disk failed, in the words of the system if it has any."""
    return (problem.strerror if isinstance(problem, OSError) else None) or str(problem)


@contextmanager
def whole_file(path: str | os.PathLike[str], *, force: bool) -> Iterator[Path]:
    """Yield a temporary path to write a file; when the block ends, the file is flushed to disk and renamed.

    Raises OutputRefused, before anything is created, if nothing may or can be written, RubnoiseError if the disk
    fails. If the block raises, the file is removed.
    """
    with whole_files([path], force=force) as (part,), naming_file(path):
        yield part


@contextmanager
def whole_files(paths: Sequence[str | os.PathLike[str]], *, force: bool) -> Iterator[list[Path]]:
    """Yield paths as `whole_file` does; when all files are on disk they are renamed, all or none of them.

    The caller names the file in an error of the disk (see `naming_file`).
    """
    outputs = [check_output(path, force=force) for path in paths]
    with ExitStack() as held:
        if not lock.AVAILABLE:
            yield [held.enter_context(_unlocked_file(each, force=force)) for each in outputs]
            return
        made = []
        for path, each in zip(paths, outputs, strict=True):
            held.enter_context(sole_writer(each))
            check_output(path, force=force)
            with naming_file(each.final):
                made.append(held.enter_context(new_file(each.part)))
        yield [each.part for each in outputs]
        for each, descriptor in zip(outputs, made, strict=True):
            with naming_file(each.final):
                disk.sync(descriptor)
        for each, descriptor in zip(outputs, made, strict=True):
            with naming_file(each.final):
                give_final_name(each, descriptor, force=force)


@contextmanager
def _unlocked_file(paths: OutputPaths, *, force: bool) -> Iterator[Path]:
    """Do as `whole_file` on a system without locks; the file is closed before it is renamed, as Windows needs."""
    with naming_file(paths.final):
        try:
            with new_file(paths.part):
                pass
            yield paths.part
            disk.sync_file(paths.part)
            _rename(paths, force=force)
        except OutputAppearedError:
            raise
        except BaseException:
            disk.remove(paths.part)
            raise


@contextmanager
def new_file(path: Path) -> Iterator[int]:
    """Open a new file for reading and writing; it is removed if the block raises before the file is renamed."""
    disk.remove(path)
    descriptor = disk.create(path)
    try:
        yield descriptor
    except (OutputAppearedError, OutputSwappedError):
        raise
    except BaseException:
        disk.remove(path)
        raise
    finally:
        disk.close(descriptor)


@contextmanager
def naming_file(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn an error of the disk into a RubnoiseError that names the file."""
    try:
        yield
    except (OSError, disk.NotAsWritten) as problem:
        raise RubnoiseError(f"{Path(path).absolute()}: writing failed: {reason_of(problem)}") from problem

"""Fsync many results at once: for short runs, one fsync each would take longer than writing."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Literal

from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk
from rubnoise.storage.journal import History
from rubnoise.storage.output import OutputInUse, OutputPaths, sole_writer
from rubnoise.storage.reader import InUse, TooNew, Unseen
from rubnoise.storage.resume import mended
from rubnoise.storage.run_description import description_of


def sync_many(paths: Iterable[Path]) -> dict[Path, OSError]:
    """See whole files onto the disk, then their names, and return those with which it went wrong.

    Raises OSError if a folder fails, which says nothing of any file.
    """
    wrong: dict[Path, OSError] = {}
    for folder, of_folder in _by_folder(paths).items():
        for path in of_folder:
            try:
                _sync(path)
            except OSError as problem:
                wrong[path] = problem
        disk.sync_folder(folder)
    return wrong


def clear_unsynced(path: Path, kind: Literal["whole", "torn", "other"] | None) -> None:
    """Remove what a kill or a power cut has left of a run that was not synced, if it cannot be recovered.

    ``kind`` is what the file under its final name is, if there is one; a truncated one is removed. A part is removed if
    the complete result is there, and if it has no commit: before one all of it was on the disk. Files that another
    process writes stay as they are.
    """
    paths = OutputPaths.of(path)
    beside = (paths.part, paths.journal, paths.growing, paths.making, paths.lock)
    if kind != "torn" and not any(each.exists() for each in beside):
        return
    with suppress(OutputInUse), sole_writer(paths):
        if kind == "torn":
            disk.remove(paths.final)
        if kind == "whole" or not paths.part.exists() or _is_lost(paths):
            disk.remove(paths.part)
            paths.remove_beside()
        disk.remove(paths.making)


def is_of_truncated(refusal: RunFileRefused) -> bool:
    """Whether a file was refused like one that a power cut has truncated, and not because it could not be read."""
    return not isinstance(refusal, InUse | TooNew | Unseen) and not isinstance(refusal.__cause__, OSError)


def _by_folder(paths: Iterable[Path]) -> dict[Path, list[Path]]:
    folders: dict[Path, list[Path]] = {}
    for path in paths:
        folders.setdefault(path.parent, []).append(path)
    return folders


def _sync(path: Path) -> None:
    descriptor = disk.reopen(path)
    try:
        disk.sync(descriptor)
    finally:
        disk.close(descriptor)


def _is_lost(paths: OutputPaths) -> bool:
    if not History.read(paths.journal).commits:
        return True
    try:
        with mended(paths) as run:
            description_of(run)
    except RunFileRefused as refusal:
        return is_of_truncated(refusal)
    return False

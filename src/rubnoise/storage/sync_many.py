"""Fsync many results at once: for short runs, one fsync each would take longer than writing."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Literal

from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk
from rubnoise.storage.journal import History
from rubnoise.storage.output import OutputInUse, OutputPaths, sole_writer
from rubnoise.storage.reader import InUse, TooNew
from rubnoise.storage.resume import mended
from rubnoise.storage.run_description import description_of

FileState = Literal["intact", "truncated", "other"]
"""What a file under the final name of a run is; ``other``: the result of something else, or unreadable."""


def sync_many(paths: Iterable[Path]) -> dict[Path, OSError]:
    """Flush complete files to disk, then their folders; return the files that failed with their errors.

    Raises OSError if a folder fails, since then no single file is to blame.
    """
    wrong: dict[Path, OSError] = {}
    folders: dict[Path, list[Path]] = {}
    for path in paths:
        folders.setdefault(path.parent, []).append(path)
    for folder, of_folder in folders.items():
        for path in of_folder:
            try:
                disk.sync_file(path)
            except OSError as problem:
                wrong[path] = problem
        disk.sync_folder(folder)
    return wrong


def clear_unsynced(path: Path, state: FileState | None) -> None:
    """Remove the files that a kill or a power cut has left of a run that was not flushed, if they cannot be recovered.

    ``state`` is that of the file under its final name, if there is one; a truncated file is removed. A part is
    removed if the complete result exists, or if it has no commit, since only a commit flushes it. Files that another
    process is writing stay.
    """
    paths = OutputPaths.of(path)
    beside = (paths.part, paths.journal, paths.growing, paths.making, paths.lock)
    if state != "truncated" and not any(each.exists() for each in beside):
        return
    with suppress(OutputInUse), sole_writer(paths):
        if state == "truncated":
            disk.remove(paths.final)
        if state == "intact" or not paths.part.exists() or _is_lost(paths):
            disk.remove(paths.part)
            paths.remove_beside()
        disk.remove(paths.making)


def is_of_truncated(refusal: RunFileRefused) -> bool:
    """Whether a file was refused for its content, as one truncated by a power cut, and not because reading failed."""
    return not isinstance(refusal, InUse | TooNew) and not isinstance(refusal.__cause__, OSError)


def _is_lost(paths: OutputPaths) -> bool:
    if not History.read(paths.journal).commits:
        return True
    try:
        with mended(paths) as run:
            description_of(run)
    except RunFileRefused as refusal:
        return is_of_truncated(refusal)
    return False

"""Fsync many results at once: for short runs, one fsync each would take longer than writing."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Literal

from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk
from rubnoise.storage.output import OutputInUse, part_file, part_of
from rubnoise.storage.reader import InUse, TooNew, Unseen

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
    """Remove the files that a kill or a power cut has left of a run that was not flushed.

    ``state`` is that of the file under its final name, if there is one; a truncated file is removed, and a part.
    Files that another process is writing stay.
    """
    if state == "truncated" or part_of(path).exists():
        with suppress(OutputInUse), part_file(path, force=True):
            if state == "truncated":
                disk.remove(path)


def is_of_truncated(refusal: RunFileRefused) -> bool:
    """Whether a file was refused for its content, as one truncated by a power cut, and not because reading failed."""
    return not isinstance(refusal, InUse | TooNew | Unseen) and not isinstance(refusal.__cause__, OSError)

"""Results of many short runs seen onto the disk together: to wait for each alone takes longer than its bytes."""

from collections.abc import Iterable
from pathlib import Path

from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk
from rubnoise.storage.history import History
from rubnoise.storage.output import OutputInUse, OutputPaths, sole_writer
from rubnoise.storage.reader import InUse, TooNew, open_run
from rubnoise.storage.resuming import mended
from rubnoise.storage.unfinished import described


def settle(paths: Iterable[Path]) -> dict[Path, OSError]:
    """See whole files onto the disk, then their names, and return those with which it went wrong.

    Raises OSError where a folder fails, which tells nothing of any file.
    """
    wrong: dict[Path, OSError] = {}
    for folder, of_folder in _by_folder(paths).items():
        for path in of_folder:
            try:
                _settle(path)
            except OSError as problem:
                wrong[path] = problem
        disk.sync_folder(folder)
    return wrong


def clear_unsettled(path: Path, text: str) -> None:
    """Remove what a kill or a power cut has left of a run that was not settled, as far as nothing can be made of it.

    A result stays that is whole in every respect, ``text`` being the scenario that it has to tell, and a part with a
    commit, before which all of it was on the disk. So does what another process writes, what may not be looked at, and
    what is of a later version.
    """
    paths = OutputPaths.of(path)
    try:
        with sole_writer(paths):
            if paths.final.exists() and _is_torn(paths, text):
                disk.remove(paths.final)
            if paths.part.exists() and (paths.final.exists() or _is_lost(paths)):
                disk.remove(paths.part)
                disk.remove(paths.journal)
    except OutputInUse:
        return


def _by_folder(paths: Iterable[Path]) -> dict[Path, list[Path]]:
    folders: dict[Path, list[Path]] = {}
    for path in paths:
        folders.setdefault(path.parent, []).append(path)
    return folders


def _settle(path: Path) -> None:
    descriptor = disk.reopen(path)
    try:
        disk.sync(descriptor)
    finally:
        disk.close(descriptor)


def _is_torn(paths: OutputPaths, text: str) -> bool:
    try:
        with open_run(paths.final) as run:
            # Columns have hashes, and HDF5 has checksums of what is shorter than a page; a longer text has neither.
            return run.provenance["scenario_toml"] != text or not run.summary or bool(run.damaged())
    except RunFileRefused as refusal:
        return _says_torn(refusal)


def _is_lost(paths: OutputPaths) -> bool:
    if not History.read(paths.journal).commits:
        return True
    try:
        with mended(paths) as run:
            described(run)
    except RunFileRefused as refusal:
        return _says_torn(refusal)
    return False


def _says_torn(refusal: RunFileRefused) -> bool:
    return not isinstance(refusal, InUse | TooNew) and not isinstance(refusal.__cause__, OSError)

"""A raw part file rewritten in gzip chunks, at publication."""

from collections.abc import Callable, Mapping

import h5py

from rubnoise.storage import disk
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.pages import Unfailing
from rubnoise.storage.part import Part, new_file
from rubnoise.storage.schema import CHUNK_ROWS, Scalar
from rubnoise.storage.structure import LIBRARY_VERSIONS, complete, compose


def compress_part(
    part: Part,
    paths: OutputPaths,
    description: RunDescription,
    summary: Mapping[str, Scalar],
    finished: str,
    between: Callable[[], None],
) -> None:
    """Write a compressed copy of a whole part under a passing name and put it in the part's place.

    Memory is that of one chunk; ``between`` is called after each, and may raise to stop. Raises OSError, and
    RubnoiseError where rows are missing; the part is left as it was.
    """
    digests = part.digests()
    with new_file(paths.making) as descriptor:
        target = Unfailing(descriptor)
        try:
            with h5py.File(target, "w", libver=LIBRARY_VERSIONS) as file:
                compose(file, description, compressed=True)
                _copy(part, file, between)
                complete(file, digests, summary, finished)
        finally:
            target.settle()
        disk.sync(descriptor)
        disk.rename(paths.making, paths.part)
        disk.sync_folder(paths.part.parent)  # before the journal goes: without it the raw part would begin at its start


def _copy(part: Part, file: h5py.File, between: Callable[[], None]) -> None:
    for (group, name), column in part.columns():
        first = 0
        for panel in column.panels(CHUNK_ROWS):
            file[group][name][first : first + panel.size] = panel
            first += panel.size
            between()

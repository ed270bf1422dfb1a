"""A raw part file rewritten in gzip chunks, at publication."""

import os
from collections.abc import Mapping

import h5py

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
) -> None:
    """Write a compressed copy of a whole part under a passing name and put it in the part's place.

    Memory is that of one chunk. Raises OSError, and RubnoiseError where rows are missing; the part is left as it was.
    """
    digests = part.digests()
    with new_file(paths.making) as descriptor:
        target = Unfailing(descriptor)
        try:
            with h5py.File(target, "w", libver=LIBRARY_VERSIONS) as file:
                compose(file, description, compressed=True)
                _copy(part, file)
                complete(file, digests, summary, finished)
        finally:
            target.settle()
        os.fsync(descriptor)
        paths.making.rename(paths.part)


def _copy(part: Part, file: h5py.File) -> None:
    for (group, name), column in part.columns():
        first = 0
        for panel in column.panels(CHUNK_ROWS):
            file[group][name][first : first + panel.size] = panel
            first += panel.size

"""A raw part file rewritten in gzip chunks, at publication."""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import h5py

from rubnoise.errors import RunFileRefused
from rubnoise.storage import disk
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.pages import Unfailing
from rubnoise.storage.part import Part, new_file
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import CHUNK_ROWS, Scalar
from rubnoise.storage.structure import LIBRARY_VERSIONS, complete, compose
from rubnoise.storage.written import Written


@contextmanager
def compressed(
    part: Part,
    making: Path,
    description: RunDescription,
    summary: Mapping[str, Scalar],
    finished: str,
    between: Callable[[], None],
) -> Iterator[int]:
    """Write a compressed copy of a whole part under a passing name and yield it, open, read back and on the disk.

    Memory is that of one chunk; ``between`` is called after each, and may raise to stop. Raises OSError, NotAsWritten
    where the disk has another file, and RubnoiseError where rows are missing; the part is left as it was.
    """
    digests = part.digests()
    with new_file(making) as descriptor:
        target = Unfailing(descriptor)
        try:
            with h5py.File(target, "w", libver=LIBRARY_VERSIONS) as file:
                extent = replace(description.extent, **part.grown_rows())
                compose(file, replace(description, extent=extent), compressed=True)
                _copy(part, file, between)
                complete(file, digests, summary, finished)
        finally:
            target.settle()
        disk.sync(descriptor)
        _check(making, Written.of(os.fstat(descriptor), description, part.columns(), summary, finished))
        yield descriptor


def _copy(part: Part, file: h5py.File, between: Callable[[], None]) -> None:
    for (group, name), column in part.columns():
        first = 0
        for panel in column.panels(CHUNK_ROWS):
            file[group][name][first : first + panel.size] = panel
            first += panel.size
            between()


def _check(path: Path, written: Written) -> None:
    """Read a compressed file once; raises NotAsWritten unless it says and holds what was written."""
    try:
        with open_run(path, strict=True) as run:
            if not written.is_in(run) or run.damaged():
                raise disk.NotAsWritten("its compressed copy")
    except RunFileRefused as refusal:
        raise disk.NotAsWritten("its compressed copy") from refusal

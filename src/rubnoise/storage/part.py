"""The unfinished file: made whole in structure, then filled column by column while HDF5 is not open."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

import h5py

from rubnoise.contact.pulses import Pulse
from rubnoise.errors import RubnoiseError
from rubnoise.record.sink import Columns
from rubnoise.storage.columns import ColumnFile
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.life_curve import life_curve
from rubnoise.storage.output import reserve
from rubnoise.storage.pages import Overlay
from rubnoise.storage.pulse import stored_pulse
from rubnoise.storage.schema import LIFE_CURVE, Scalar
from rubnoise.storage.soundness import read_text
from rubnoise.storage.structure import LIBRARY_VERSIONS, complete, compose, places

SLACK_BYTES = 64 * 1024
"""Reserved beyond the columns, so that hashes and summary find room on a disk that has filled up meanwhile."""


def make_part(path: Path, making: Path, description: RunDescription) -> None:
    """Make a part file under a passing name, with its space reserved, and rename it when its structure is whole.

    Where it will be compressed, the copy may turn out as large as the part: so much more has to be free.
    Raises OSError, and OutputRefused where the disk has no room; nothing is left behind then.
    """
    structure = Overlay()
    with h5py.File(structure, "w", libver=LIBRARY_VERSIONS) as file:
        compose(file, description, compressed=False)
    with new_file(making) as descriptor:
        structure.commit(descriptor)
        copy = 0 if description.compression == "none" else structure.size
        reserve(descriptor, structure.size + SLACK_BYTES, later=copy)
        making.rename(path)


@contextmanager
def new_file(path: Path) -> Iterator[int]:
    """Open a new file for reading and writing; it is removed again when the block fails before it got another name."""
    path.unlink(missing_ok=True)
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
    try:
        yield descriptor
    except BaseException:
        path.unlink(missing_ok=True)
        raise
    finally:
        os.close(descriptor)


class Part:
    """A part file opened for rows. Its columns are found by reading its structure, however old the file is."""

    def __init__(self, path: Path) -> None:
        self.descriptor = os.open(path, os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW)
        self._columns: dict[str, dict[str, ColumnFile]] = {}
        try:
            pulse = self._find_columns()
            self.write(LIFE_CURVE.name, 0, life_curve(pulse.shape))
        except BaseException:
            os.close(self.descriptor)
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self.descriptor)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Write rows of a group (see Sink)."""
        files = self._columns[group]
        for name, values in columns.items():
            files[name].write(first_row, values)

    def columns(self) -> Iterator[tuple[tuple[str, str], ColumnFile]]:
        """Yield every column with the names of its group and itself."""
        for group, files in self._columns.items():
            for name, column in files.items():
                yield (group, name), column

    def digests(self) -> dict[tuple[str, str], str]:
        """Return the hash of every column; raises RubnoiseError where rows are missing."""
        for (group, name), column in self.columns():
            if column.rows_written != column.rows:
                raise RubnoiseError(f"/{group}/{name} has {column.rows_written} of its {column.rows} rows")
        return {key: column.digest() for key, column in self.columns()}

    def complete(self, summary: Mapping[str, Scalar], finished: str) -> None:
        """Fill in hashes, summary and the time of the end, and see the whole file onto the disk."""
        digests = self.digests()
        changed = Overlay(self.descriptor)
        with h5py.File(changed, "r+", libver=LIBRARY_VERSIONS) as file:
            complete(file, digests, summary, finished)
        changed.commit(self.descriptor)
        os.fsync(self.descriptor)

    def _find_columns(self) -> Pulse:
        with h5py.File(Overlay(self.descriptor), "r", libver=LIBRARY_VERSIONS) as file:
            found = places(file)
            pulse = stored_pulse(read_text(file["provenance"], "scenario_resolved"))
        for (group, name), place in found.items():
            self._columns.setdefault(group, {})[name] = ColumnFile(self.descriptor, place)
        return pulse

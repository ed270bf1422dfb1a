"""The reader of result files: it opens a file or refuses it with one sentence, and reads columns on demand.

A file may come from anywhere. HDF5 reads its structure once, and only what our schema names (see objects). Rows are
then read, or mapped where they are many, from the places that were checked. All goes through one descriptor: where
another file takes the name meanwhile, an open run shows the rows of the old one.
"""

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from mmap import ACCESS_COPY, ALLOCATIONGRANULARITY, mmap
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self, TypeVar
from weakref import finalize

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import column_chunks
from rubnoise.record.sink import Extent
from rubnoise.regular_file import NotRegular, open_regular
from rubnoise.storage import disk
from rubnoise.storage.chunks import rows_of_chunks
from rubnoise.storage.layout import row_count, stored_extent
from rubnoise.storage.objects import REMEDY, Place, naming_damage, opened_by_hdf5
from rubnoise.storage.run_structure import Answer, RunStructure, structure_of
from rubnoise.storage.schema import GROUPS, Feature, Scalar

if TYPE_CHECKING:
    from rubnoise.storage.inventory import Inventory

SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"

READ_BYTES: Final = 64 * 1024**2
"""Longer columns are mapped: the system then reads the rows that are used."""

Watch = Callable[[str, int, int], None]
"""Called at each read with the path of the column, the row up to which is read, and how many rows there are."""


class TooNew(RunFileRefused):
    """A run file in a newer format version than this rubnoise knows."""


class InUse(RunFileRefused):
    """A file that another program is writing."""


class OpenFile(ABC):
    """An open file of ours, whose structure has been read. Use it as a context manager, or close it.

    Copies, also in other processes, open the file again.
    """

    called: ClassVar = "file"

    def __init__(self, path: str | os.PathLike[str], descriptor: int) -> None:
        """Take over the descriptor of a file."""
        self.path = Path(path)
        self._place = self.path.absolute()
        self.descriptor = descriptor
        self._close = finalize(self, os.close, descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; nothing can be read any more."""
        self._close()

    @property
    def closed(self) -> bool:
        """Whether the file was closed."""
        return not self._close.alive

    @property
    @abstractmethod
    def seal(self) -> str | None:
        """The stored hash of the file's attributes; None if it has none."""

    def __reduce__(self) -> tuple[Any, ...]:
        with self._reading():
            return reopened, (type(self), self._place, self.seal)

    def inventory(self) -> "Inventory":
        """Return everything in the file, also objects of others; raises RunFileRefused if it cannot be read."""
        from rubnoise.storage.inventory import inventory_of

        with self._reading(), naming_damage(), opened_by_hdf5(self._place, self.descriptor) as file:
            return inventory_of(file)

    def stored_rows(self, place: Place, first: int, last: int) -> NDArray[Any]:
        """Return rows that lie in one piece of the file, as an array that the caller may change.

        Raises RunFileRefused if the file does not have them any more.
        """
        dtype = np.dtype(place.dtype)
        start, size = place.offset + first * dtype.itemsize, max(last - first, 0) * dtype.itemsize
        if os.fstat(self.descriptor).st_size < start + size:
            raise RunFileRefused(f"cut short; {REMEDY}")
        if size > READ_BYTES:
            page = start - start % ALLOCATIONGRANULARITY
            mapped = mmap(self.descriptor, start + size - page, access=ACCESS_COPY, offset=page)
            return np.frombuffer(mapped, dtype, last - first, start - page)
        values: NDArray[Any] = np.empty(size // dtype.itemsize, dtype)
        if disk.read_into(self.descriptor, values.view(np.uint8).data, start) < size:
            raise RunFileRefused(f"cut short; {REMEDY}")
        return values

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """Put the path in front of the message of a refusal; raises ValueError if the file is closed."""
        if self.closed:
            raise ValueError(f"{self.path}: the {self.called} is closed")
        with refusing(self.path):
            yield


Opened = TypeVar("Opened", bound=OpenFile)


class RunFile(OpenFile):
    """An open run file. Opening reads its structure only; each column is read when it is needed.

    ``watch``, if it is set, is called at each read.
    """

    called = "run file"

    def __init__(self, path: str | os.PathLike[str], descriptor: int, file: h5py.File) -> None:
        """Take over the descriptor of a file, and read its structure, which HDF5 has opened."""
        self._found: RunStructure = structure_of(file, os.fstat(descriptor).st_size)
        if self._found.later:
            raise TooNew(self._found.later)
        self.features: frozenset[Feature] = self._found.features
        self.extent = stored_extent({group: self.rows(group) for group in self.columns}, self.features)
        _check_lengths(self._found, self.extent)
        self.watch: Watch | None = None
        self._unpacking: h5py.File | None = None
        self._datasets: dict[tuple[str, str], h5py.Dataset] = {}
        super().__init__(path, descriptor)

    @property
    def columns(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the columns in each group, the dimension scale first."""
        return {group: tuple(columns) for group, columns in self._found.columns.items()}

    @property
    @property
    def is_compressed(self) -> bool:
        """Whether the columns are stored in compressed chunks."""
        return any(
            place.rows and not place.offset for group in self._found.columns.values() for place in group.values()
        )

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        return next(iter(self._found.columns[group].values())).rows

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows ``start`` to ``stop`` (to the end when None) of a column, in the units of the schema.

        More than 64 MB of them are mapped. The caller may change them; the file stays as it is. Raises KeyError for a
        name that the file does not have, RunFileRefused if its bytes cannot be read.
        """
        place = self._found.columns[group][name]
        first, last, _ = slice(start, stop).indices(place.rows)
        if self.watch is not None:
            self.watch(f"/{group}/{name}", last, place.rows)
        with self._reading():
            if place.offset or not place.rows:
                return self.stored_rows(place, first, max(first, last))
            return self._unpacked(group, name, first, max(first, last))

    def _unpacked(self, group: str, name: str, first: int, last: int) -> NDArray[Any]:
        """Return rows of a compressed column, whose chunks HDF5 finds; it keeps the file open from the first one on."""
        with naming_damage():
            if self._unpacking is None:
                self._unpacking = opened_by_hdf5(self._place, self.descriptor)
            if (group, name) not in self._datasets:
                self._datasets[group, name] = self._unpacking[group][name]
            return rows_of_chunks(self._datasets[group, name], first, last)

    def close(self) -> None:
        """Close the file; nothing can be read any more."""
        if self._unpacking is not None:
            self._unpacking.close()
        super().close()

    @property
    def attributes(self) -> dict[str, Scalar]:
        """Format, title, source and the formula of a junction's area."""
        return dict(self._value(self._found.attributes))

    @property
    def summary(self) -> dict[str, Scalar]:
        """Measured and exact figures by name."""
        return dict(self._value(self._found.summary))

    @property
    def provenance(self) -> dict[str, Scalar]:
        """Scenario, software, seed, command and times."""
        return dict(self._value(self._found.provenance))

    @property
    def seal(self) -> str | None:
        """The stored hash of the file's attributes; None if it has none."""
        return self._value(self._found.seal)

    def damaged(self) -> tuple[str, ...]:
        """Return the columns that cannot be read or differ from their stored hash; reads the whole file."""
        return tuple(
            f"/{group}/{name}"
            for group, columns in self.columns.items()
            for name in columns
            if not self._is_intact(group, name)
        )

    def digest(self, group: str, name: str) -> str:
        """Return the stored hash of a column; raises RunFileRefused if it cannot be read."""
        return self._value(self._found.digests[group, name])

    def _value(self, answer: Answer) -> Any:
        """Return what was read at one place; raises RunFileRefused if it could not be read."""
        with self._reading():
            if isinstance(answer, RunFileRefused):
                raise RunFileRefused(str(answer))
            return answer

    def _is_intact(self, group: str, name: str) -> bool:
        digest = xxhash.xxh3_128()
        try:
            for values in column_chunks(self, group, name):
                digest.update(values.data)
            return bool(digest.hexdigest() == self.digest(group, name))
        except RunFileRefused:
            return False


def open_run(path: str | os.PathLike[str]) -> RunFile:
    """Open the file of a finished run for reading, also one from elsewhere.

    Raises RunFileRefused, with the reason in one sentence, for a path that is missing or not a regular file, a file
    that is not HDF5, not a run, unfinished, cut short or damaged; TooNew for a later format.
    """
    return opened(RunFile, path)


def opened(kind: type[Opened], path: str | os.PathLike[str]) -> Opened:
    """Open a file of ours of one kind; raises as `open_run` does."""
    with refusing(path):
        descriptor = open_regular(path)
        try:
            _check_signature(descriptor, path)
            _share(descriptor)
            with naming_damage(), opened_by_hdf5(path, descriptor) as file:
                return kind(path, descriptor, file)  # type: ignore[call-arg]
        except BaseException:
            os.close(descriptor)
            raise


def reopened(kind: type[Opened], path: Path, seal: str | None) -> Opened:
    """Open again a file that was open elsewhere; raises RunFileRefused if its seal shows that it was replaced."""
    file = opened(kind, path)
    if file.seal == seal:
        return file
    file.close()
    raise RunFileRefused(f"{path}: has changed since it was opened")


@contextmanager
def refusing(path: str | os.PathLike[str]) -> Iterator[None]:
    """Put the path of the file in front of the message of a refusal."""
    try:
        yield
    except RunFileRefused as refusal:
        raise type(refusal)(f"{path}: {refusal}") from refusal
    except OSError as problem:
        raise RunFileRefused(f"{path}: {(problem.strerror or str(problem)).lower()}") from problem


def _check_signature(descriptor: int, path: str | os.PathLike[str]) -> None:
    """Check the first bytes, which show most wrong files, before HDF5 is asked."""
    try:
        found = disk.read(descriptor, len(SIGNATURE), 0)
    except BlockingIOError as problem:
        raise NotRegular(path) from problem
    if found == SIGNATURE:
        return
    if os.fstat(descriptor).st_size == 0:
        raise RunFileRefused(f"is empty; {REMEDY}")
    if os.fspath(path).endswith(".toml"):
        raise RunFileRefused(
            f"is a scenario, not a result; `rubnoise check {path}` says what follows from it, `rubnoise run` runs it"
        )
    raise RunFileRefused("is not an HDF5 file; `rubnoise run` makes one")


def _share(descriptor: int) -> None:
    """Take the lock that HDF5 takes for reading, as long as the file is open."""
    if not disk.share(descriptor):
        raise InUse("is being written by another program")


def _check_lengths(found: RunStructure, extent: Extent) -> None:
    for group in GROUPS:
        for name, column in found.columns.get(group.name, {}).items():
            if column.rows != row_count(group, extent):
                raise RunFileRefused(f"/{group.name}/{name} has another number of rows than its group")

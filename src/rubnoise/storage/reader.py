"""The reader of result files: it opens a file or refuses it with one sentence, and reads columns on demand.

A file may come from anywhere. Its structure is read in the sandbox (see read_structure), its rows with plain
reads from places that were checked: in this process HDF5 never opens it. Both use one descriptor, so the file cannot
be replaced in between.
"""

import json
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self, TypeVar
from weakref import finalize

import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import column_chunks
from rubnoise.record.sink import Extent
from rubnoise.regular_file import NotRegular, open_regular
from rubnoise.storage import disk, lock
from rubnoise.storage.layout import DTYPES, row_count, stored_extent
from rubnoise.storage.rows import REMEDY, StoredColumn
from rubnoise.storage.schema import FORMAT_VERSION, GROUPS, Feature, Scalar

if TYPE_CHECKING:
    from rubnoise.storage.inventory import Inventory
    from rubnoise.storage.sandbox import LookName
    from rubnoise.storage.structure import Written

SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"

Watch = Callable[[str, int, int], None]
"""Called at each read with the path of the column, the row up to which is read, and how many rows there are."""


class TooNew(RunFileRefused):
    """A run file in a newer format version than this rubnoise knows."""


class InUse(RunFileRefused):
    """A file that another program is writing."""


class Unseen(RunFileRefused):
    """A file whose content is unknown, because the process that read it was killed or took too long."""


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
        with self._reading():
            return looked_at(self.descriptor, "inventory")["objects"]

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

    def __init__(self, path: str | os.PathLike[str], descriptor: int, found: Mapping[str, Any]) -> None:
        """Take over the descriptor of an open file, and the structure that was read from it."""
        if "index" in found:
            raise RunFileRefused("is the index of a sweep, not the result of a run")
        self._found = found
        self.features: frozenset[Feature] = frozenset(found["features"])
        self._columns = {group: _stored(group, columns) for group, columns in found["columns"].items()}
        self.extent = stored_extent({group: self.rows(group) for group in self._columns}, self.features)
        _check_lengths(self._columns, self.extent)
        self.watch: Watch | None = None
        super().__init__(path, descriptor)

    @property
    def columns(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the columns in each group, the dimension scale first."""
        return {group: tuple(columns) for group, columns in self._columns.items()}

    @property
    def is_compressed(self) -> bool:
        """Whether the columns are stored in compressed chunks."""
        return any(column.chunk_rows for columns in self._columns.values() for column in columns.values())

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        return next(iter(self._columns[group].values())).rows

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows ``start`` to ``stop`` (to the end when None) of a column, in the units of the schema.

        Raises KeyError for a name that the file does not have, RunFileRefused if its bytes cannot be read.
        """
        column = self._columns[group][name]
        first, last, _ = slice(start, stop).indices(column.rows)
        if self.watch is not None:
            self.watch(f"/{group}/{name}", last, column.rows)
        with self._reading():
            return column.read(self.descriptor, first, max(first, last))

    @property
    def attributes(self) -> dict[str, Scalar]:
        """Format, title, source and the formula of a junction's area."""
        return self._value(self._found["attributes"])

    @property
    def summary(self) -> dict[str, Scalar]:
        """Measured and exact figures by name."""
        return self._value(self._found["summary"])

    @property
    def provenance(self) -> dict[str, Scalar]:
        """Scenario, software, seed, command and times."""
        return self._value(self._found["provenance"])

    @property
    def seal(self) -> str | None:
        """The stored hash of the file's attributes; None if it has none."""
        return self._value(self._found["seal"])

    def damaged(self) -> tuple[str, ...]:
        """Return the columns that cannot be read or differ from their stored hash; reads the whole file."""
        return tuple(
            f"/{group}/{name}"
            for group, columns in self._columns.items()
            for name in columns
            if not self._is_intact(group, name)
        )

    def digest(self, group: str, name: str) -> str:
        """Return the stored hash of a column; raises RunFileRefused if it cannot be read."""
        return str(self._value(self._found["columns"][group][name]["digest"]))

    def _value(self, answer: Mapping[str, Any]) -> Any:
        """Return a copy of what was read at one place; raises RunFileRefused if it could not be read."""
        with self._reading():
            if "refused" in answer:
                raise RunFileRefused(answer["refused"])
            return dict(answer["value"]) if isinstance(answer["value"], dict) else answer["value"]

    def _is_intact(self, group: str, name: str) -> bool:
        try:
            return self._hash(group, name) == self.digest(group, name)
        except RunFileRefused:
            return False

    def _hash(self, group: str, name: str) -> str:
        digest = xxhash.xxh3_128()
        for values in column_chunks(self, group, name):
            digest.update(values.data)
        return digest.hexdigest()


def open_run(path: str | os.PathLike[str], own: "Written | None" = None) -> RunFile:
    """Open a run file for reading, also one from elsewhere.

    ``own`` is the file that this process has just written: it is not read in the sandbox. Raises RunFileRefused, with
    the reason in one sentence, for a path that is missing or not a regular file, a file that is not HDF5, not a run,
    cut short or damaged; TooNew for a later format.
    """
    return opened(RunFile, path, own)


def opened(kind: type[Opened], path: str | os.PathLike[str], own: "Written | None" = None) -> Opened:
    """Open a file of ours of one kind; raises as `open_run` does."""
    descriptor, found = examined(path, own)
    try:
        with refusing(path):
            return kind(path, descriptor, found)  # type: ignore[call-arg]
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


def examined(path: str | os.PathLike[str], own: "Written | None" = None) -> tuple[int, dict[str, Any]]:
    """Return a descriptor of a file, locked for reading, and its structure; raises as `open_run` does."""
    with refusing(path):
        descriptor = open_regular(path)
        try:
            _check_signature(descriptor, path)
            _share(descriptor)
            return descriptor, _found(descriptor, own)
        except BaseException:
            os.close(descriptor)
            raise


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
    """Check the first bytes, which show most wrong files, before a child process is made."""
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
    if not lock.share(descriptor):
        raise InUse("is being written by another program")


def _found(descriptor: int, own: "Written | None") -> dict[str, Any]:
    """Return the structure that a child process found in the file; raises RunFileRefused if the file is damaged."""
    known = None if own is None or not own.is_still(os.fstat(descriptor)) else own
    if known is not None and known.found is not None:
        return dict(known.found)
    found = looked_at(descriptor, "structure", own=known is not None)
    if "too_new" in found:
        version, source = found["too_new"], found["source"]
        raise TooNew(
            f"has format version {version}, written by {source}; this one reads versions up to {FORMAT_VERSION}."
            f" {source} or later is needed"
        )
    return found


def looked_at(descriptor: int, look: "LookName", *, own: bool = False) -> dict[str, Any]:
    """Return what the sandbox finds in an open file; raises RunFileRefused if the file is not valid."""
    from rubnoise.storage.sandbox import look_at, look_of

    try:
        found: dict[str, Any] = json.loads(look_of((look,))(descriptor) if own else look_at(descriptor, (look,)))
    except (ValueError, RecursionError) as problem:
        raise RunFileRefused(f"damaged: its structure cannot be read; {REMEDY}") from problem
    if "refused" in found:
        raise (Unseen if found.get("unseen") else RunFileRefused)(found["refused"])
    return found


def _stored(group: str, columns: Mapping[str, Any]) -> dict[str, StoredColumn]:
    return {
        name: StoredColumn(
            dtype=np.dtype(DTYPES[group, name]),
            rows=place["rows"],
            offset=place.get("offset", 0),
            chunk_rows=place.get("chunk_rows", 0),
            chunks=tuple(map(tuple, place.get("chunks", ()))),
        )
        for name, place in columns.items()
    }


def _check_lengths(columns: Mapping[str, Mapping[str, StoredColumn]], extent: Extent) -> None:
    for group in GROUPS:
        for name, column in columns.get(group.name, {}).items():
            if column.rows != row_count(group, extent):
                raise RunFileRefused(f"/{group.name}/{name} has another number of rows than its group")

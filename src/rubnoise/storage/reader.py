"""The reader of result files: it opens a file or refuses it with one sentence, and reads columns on demand.

A file may come from anywhere. HDF5 reads its structure once, and only what our schema names (see objects). Rows are
then read, or mapped where they are many, from the places that were checked. All goes through one descriptor: where
another file takes the name meanwhile, an open run shows the rows of the old one.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from mmap import ACCESS_COPY, ALLOCATIONGRANULARITY, mmap
from pathlib import Path
from typing import Any, Final, Self
from weakref import finalize

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

from rubnoise.errors import Refused, RunFileRefused, naming, refusing_files
from rubnoise.record.rows import column_chunks
from rubnoise.regular_file import NotRegular, lock, open_regular, read_into
from rubnoise.storage import inventory, objects, schema
from rubnoise.storage.layout import stored_groups

SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"

READ_BYTES: Final = 64 * 1024**2  # longer columns are mapped: the system then reads the rows that are used
UNREADABLE: Final = "unreadable"

Watch = Callable[[str, int, int], None]
"""Called at each read with the path of the column, the row up to which is read, and how many rows there are."""


class TooNew(RunFileRefused):
    """A run file in a newer format version than this rubnoise knows."""


class InUse(RunFileRefused):
    """A file that another program is writing."""


class RunFile:
    """An open run file. Opening reads its structure and its attributes; each column is read when it is needed.

    ``attributes`` are format, title, source and the formula of a junction's area, ``summary`` measured and exact
    figures by name, ``provenance`` scenario, software, seed, command and times, ``seal`` is the stored hash of all of
    these, empty without one. Use it as a context manager, or close it. ``watch``, if it is set, is called at each read.
    Copies, also in other processes, open the file again.
    """

    def __init__(self, path: str | os.PathLike[str], descriptor: int, file: h5py.File) -> None:
        """Take over a descriptor and what HDF5 has opened by it; raises RunFileRefused, and any error of HDF5."""
        self.path, self.descriptor = Path(path), descriptor
        self.watch: Watch | None = None
        self._place, self._file = self.path.absolute(), file
        check_format(file, schema.FORMAT, schema.FORMAT_VERSION, "run its scenario again")
        self.provenance = read_provenance(file)
        if not self.provenance["finished"]:
            raise RunFileRefused("is a part of a run that did not end; the same command makes the run again")
        self.attributes, self.summary = objects.read_attributes(file, schema.ROOT), read_summary(file)
        self.seal = objects.stored_hash(file["provenance"])
        self.features = _features(file)
        self._columns: dict[str, dict[str, h5py.Dataset]] = {}
        for group in stored_groups(self.features):
            owner = objects.sound_group(file, group.name)
            columns = {each.name: objects.sound_column(owner, each) for each in group.columns}
            self._columns[group.name] = columns
            for name, dataset in columns.items():
                if dataset.size != self.rows(group.name):
                    raise RunFileRefused(f"/{group.name}/{name} has another number of rows than its group")
        self._close = finalize(self, os.close, descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> tuple[Any, ...]:
        with self._reading():
            return _reopened, (self._place, self.seal)

    def close(self) -> None:
        """Close the file; nothing can be read any more."""
        self._file.close()
        self._close()

    @property
    def closed(self) -> bool:
        """Whether the file was closed."""
        return not self._close.alive

    @property
    def columns(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the columns in each group, the dimension scale first."""
        return {group: tuple(columns) for group, columns in self._columns.items()}

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        return int(next(iter(self._columns[group].values())).size)

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows ``start`` to ``stop`` (to the end when None) of a column, in the units of the schema.

        More than 64 MB of them are mapped. The caller may change them; the file stays as it is. Raises KeyError for a
        name that the file does not have, RunFileRefused if its bytes cannot be read.
        """
        dataset = self._columns[group][name]
        with self._reading():
            first, last, _ = slice(start, stop).indices(dataset.size)
            if self.watch is not None:
                self.watch(f"/{group}/{name}", last, dataset.size)
            offset = dataset.id.get_offset() or 0
            if offset or not dataset.size:
                return self._stored_rows(offset, dataset.dtype, first, max(first, last))
            with objects.naming_damage():  # HDF5 finds the chunks of a compressed column
                return objects.rows_of_chunks(dataset, first, max(first, last))

    def _stored_rows(self, offset: int, dtype: np.dtype[Any], first: int, last: int) -> NDArray[Any]:
        """Return rows that lie in one piece; raises RunFileRefused if the file does not have them any more."""
        start, size = offset + first * dtype.itemsize, (last - first) * dtype.itemsize
        if os.fstat(self.descriptor).st_size >= start + size:
            if size > READ_BYTES:
                page = start - start % ALLOCATIONGRANULARITY
                mapped = mmap(self.descriptor, start + size - page, access=ACCESS_COPY, offset=page)
                return np.frombuffer(mapped, dtype, last - first, start - page)
            values: NDArray[Any] = np.empty(last - first, dtype)
            if read_into(self.descriptor, values.view(np.uint8).data, start) == size:
                return values
        raise RunFileRefused(f"cut short; {objects.REMEDY}")

    def damaged(self) -> dict[str, str]:
        """Return what is wrong with columns by their paths, such as UNREADABLE; reads the whole file."""
        found = dict[str, str]()
        for group, name in ((group, name) for group, names in self.columns.items() for name in names):
            place, digest = f"/{group}/{name}", xxhash.xxh3_128()
            found[place] = UNREADABLE
            with suppress(RunFileRefused):
                for values in column_chunks(self, group, name):
                    digest.update(values.data)
                found[place] = "beside a damaged hash"
                with objects.naming_damage():
                    right = objects.stored_hash(self._columns[group][name])
                found[place] = "" if digest.hexdigest() == right else "not what its hash was taken of"
        return {place: damage for place, damage in found.items() if damage}

    def inventory(self) -> inventory.Inventory:
        """Return everything in the file, also objects of others; raises RunFileRefused if it cannot be read."""
        with self._reading(), objects.naming_damage():
            return inventory.inventory_of(self._file)

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """Put the path in front of the message of a refusal; raises ValueError if the file is closed."""
        if self.closed:
            raise ValueError(f"{self.path}: the run file is closed")
        with refusing(self.path):
            yield


def open_run(path: str | os.PathLike[str]) -> RunFile:
    """Open the file of a finished run for reading, also one from elsewhere.

    Raises RunFileRefused, with the reason in one sentence, for a path that is missing or not a regular file, a file
    that is not HDF5, not a run, unfinished, cut short or damaged; TooNew for a later format.
    """
    with refusing(path), ExitStack() as opening:
        descriptor = open_regular(path)
        opening.callback(os.close, descriptor)
        _check_signature(descriptor, path)
        try:  # as HDF5 does for reading
            lock(descriptor, shared=True)
        except BlockingIOError as problem:
            raise InUse("is being written by another program") from problem
        except OSError:  # the file system has no locks, so no other process has one either
            pass
        with objects.naming_damage():
            file = opening.enter_context(objects.opened_by_hdf5(path, descriptor))
            found = RunFile(path, descriptor, file)
        opening.pop_all()
        return found


def _reopened(path: Path, seal: str) -> RunFile:
    """Open again a file that was open elsewhere; raises RunFileRefused if its seal shows that it was replaced."""
    file = open_run(path)
    if file.seal == seal:
        return file
    file.close()
    raise RunFileRefused(f"{path}: has changed since it was opened")


@contextmanager
def refusing(path: str | os.PathLike[str]) -> Iterator[None]:
    """Put the path of the file in front of the message of a refusal."""
    with naming(path), refusing_files(path, RunFileRefused):
        yield


@contextmanager
def calculating(source: object) -> Iterator[None]:
    """Say of values that no run has which result holds them, since its rows may hold anything."""
    try:
        yield
    except Refused:  # which may be an IndexError as well
        raise
    except (ArithmeticError, ValueError, IndexError) as problem:
        reason = " ".join(str(problem).split())
        raise RunFileRefused(f"{source}: {reason}; verify says which values are wrong") from problem


def _check_signature(descriptor: int, path: str | os.PathLike[str]) -> None:
    """Check the first bytes, which show most wrong files, before HDF5 is asked."""
    try:
        found = os.pread(descriptor, len(SIGNATURE), 0)
    except BlockingIOError as problem:
        raise NotRegular(path) from problem
    if found == SIGNATURE:
        return
    if os.fstat(descriptor).st_size == 0:
        raise RunFileRefused(f"is empty; {objects.REMEDY}")
    if os.fspath(path).endswith(".toml"):
        follows = f"`rubnoise check {path}` says what follows from it, `rubnoise run` runs it"
        raise RunFileRefused(f"is a scenario, not a result; {follows}")
    raise RunFileRefused("is not an HDF5 file; `rubnoise run` makes one")


def check_format(file: h5py.File, wanted: str, ours: int, remedy: str) -> None:
    """Raise RunFileRefused for a file that is not of the ``wanted`` kind and version; TooNew for a newer version."""
    found = objects.read_attribute(file, "format") if "format" in file.attrs else ""
    if found != wanted and found in schema.FORMATS:
        raise RunFileRefused(f"is {schema.FORMATS[found]}, not {schema.FORMATS[wanted]}")
    if found != wanted:
        raise RunFileRefused("is an HDF5 file, but not one of rubnoise")
    version = objects.read_attribute(file, "format_version", int)
    if version > ours:
        source = objects.read_attribute(file, "source", str)
        written = f"has format version {version}, written by {source}"
        raise TooNew(f"{written}; this one reads versions up to {ours}. {source} or later is needed")
    if version < ours:
        raise RunFileRefused(f"has format version {version}, and this rubnoise reads version {ours}: {remedy}")


def _features(file: h5py.File) -> frozenset[schema.Feature]:
    """Return the features of the run, found by the objects that exist only with them."""
    objects.sound_group(file, "junctions")
    there = frozenset(feature for feature, place in schema.TELLTALES.items() if objects.linked(file, place))
    for feature, needed in schema.NEEDED:
        if feature in there and there.isdisjoint(needed):
            raise RunFileRefused(f"has /{schema.TELLTALES[feature]} without /{schema.TELLTALES[needed[0]]}")
    return there


def read_summary(file: h5py.File) -> dict[str, schema.Scalar]:
    """Return the figures of /summary by name; raises RunFileRefused if one is not a plain value."""
    group = objects.sound_group(file, "summary")
    objects.check_count("/summary", h5py.h5a.get_num_attrs(group.id), "attributes")
    return {name: objects.read_attribute(group, name) for name in group.attrs if name != "NX_class"}


def read_provenance(file: h5py.File) -> dict[str, schema.Scalar]:
    """Return the attributes of /provenance by name; raises RunFileRefused if one is missing or not as it should be."""
    group = objects.sound_group(file, "provenance")
    more = {schema.INTERVENTION: str} if schema.INTERVENTION in group.attrs else {}
    return objects.read_attributes(group, {**schema.PROVENANCE, **more})

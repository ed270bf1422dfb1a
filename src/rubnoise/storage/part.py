"""The unfinished file of a run: made with its final structure, filled column by column without HDF5, then compressed.

Rows of each column go through a `ColumnFile` (see columns), which hashes them and writes them at their place. A gzip
file is made from the raw part at publication, chunk by chunk.
"""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import h5py

from rubnoise.contact.pulses import Pulse
from rubnoise.errors import RubnoiseError, RunFileRefused
from rubnoise.record.sink import Columns, Extent, Sink
from rubnoise.storage import disk
from rubnoise.storage.columns import ColumnFile, Mark
from rubnoise.storage.growing import GrowingFile
from rubnoise.storage.journal import Commit, Ending
from rubnoise.storage.layout import ByteRange, Name, RunDescription, between, digest_of, grows, stored_groups
from rubnoise.storage.life_curve import LIFE_TABLES, life_tables, pulse_of, stored_pulse
from rubnoise.storage.output import OutputPaths, new_file, reserve
from rubnoise.storage.pages import PagedFile, Unfailing
from rubnoise.storage.reader import RunFile, open_run, refusing
from rubnoise.storage.run_description import check_structure, places_of, rest_digest
from rubnoise.storage.schema import CHUNK_ROWS, Feature, Scalar
from rubnoise.storage.structure import LIBRARY_VERSIONS, Words, Written, complete, compose, enlarge

SLACK_BYTES = 64 * 1024
"""Reserved beyond the columns, so that hashes and summary find room on a disk that has filled up meanwhile."""


def make_part(paths: OutputPaths, description: RunDescription, *, hashed: bool = True, durable: bool = True) -> "Part":
    """Make a part file under a temporary name, with its space reserved, and rename it when its structure is on disk.

    A file for growing rows is made before. Without ``durable`` it is renamed without fsync.
    If it will be compressed, the copy may be as large as the part, so twice the space must be free.
    Raises OSError, and OutputRefused if the disk has no room; nothing is left behind then.
    """
    structure = PagedFile()
    with h5py.File(structure, "w", libver=LIBRARY_VERSIONS) as file:
        columns = compose(file, description, compressed=False)
    groups = _growing_groups(columns, description.features, description.extent)
    with ExitStack() as opening:
        growing = GrowingFile.new(paths.growing, groups) if groups else None
        if growing is not None:
            opening.callback(disk.remove, paths.growing)
            opening.callback(growing.close)
        disk.remove(paths.making)
        descriptor = disk.create(paths.making)
        opening.callback(disk.remove, paths.making)
        opening.callback(disk.close, descriptor)
        structure.commit(descriptor)
        copy = 0 if description.compression == "none" else structure.size
        reserve(descriptor, structure.size + SLACK_BYTES, later=copy)
        if durable:
            disk.sync(descriptor)  # a power cut could leave the name of a file that cannot be read
        pulse = pulse_of(description.scenario_resolved)
        part = Part(descriptor, columns, structure, Words.of(description), pulse, growing, hashed=hashed)
        disk.rename(paths.making, paths.part)
        opening.pop_all()
    return part


def open_part(paths: OutputPaths, run: RunFile) -> "Part":
    """Open a part file for writing; its structure has been read and checked, and ``run`` is open for reading.

    Raises RunFileRefused if a column cannot be written, and if the file is not the one that was read.
    """
    with ExitStack() as opening, refusing(paths.part):
        descriptor = disk.reopen(paths.part)
        opening.callback(disk.close, descriptor)
        structure = _structure(paths.part, descriptor, run)
        growing = None
        if groups := _growing_groups(places_of(run), run.features, run.extent):
            growing = GrowingFile.found(paths.growing, groups)
            opening.callback(growing.close)
        pulse = stored_pulse(run.provenance["scenario_resolved"])
        part = Part(descriptor, places_of(run), structure, Words(run.attributes, run.provenance), pulse, growing)
        opening.pop_all()
    return part


def _growing_groups(columns: Iterable[Name], features: frozenset[Feature], extent: Extent) -> dict[str, list[str]]:
    """Return the columns of the groups whose rows grow, by group."""
    growing = [group.name for group in stored_groups(features) if grows(group, extent)]
    return {name: [column for group, column in columns if group == name] for name in growing}


def _structure(path: Path, descriptor: int, run: RunFile) -> PagedFile:
    """Return everything of an open part except its rows."""
    if not all(disk.is_file(path, os.fstat(each)) for each in (run.descriptor, descriptor)):
        raise RunFileRefused("another file has taken its place just now")
    for (group, name), place in places_of(run).items():
        if place.rows and not place.offset:
            raise RunFileRefused(f"/{group}/{name} is compressed: nothing can be written to it any more")
    size = os.fstat(descriptor).st_size
    rest = between(places_of(run).values(), size)
    pieces = [(place.start, disk.read(descriptor, len(place), place.start)) for place in rest]
    if digest_of(pieces) != rest_digest(run):
        raise RunFileRefused("was changed just now")
    return PagedFile.of(pieces, size)


class Part:
    """A part file opened to write rows into its columns.

    ``descriptor`` is closed when the context ends; ``structure`` is everything in the file except its rows, in memory,
    so that no other program can change it, and ``words`` are its attributes. ``growing`` holds the growing rows, if
    there are any. Without ``hashed`` its columns get no hashes.
    """

    def __init__(
        self,
        descriptor: int,
        columns: Mapping[Name, ByteRange],
        structure: PagedFile,
        words: Words,
        pulse: Pulse,
        growing: GrowingFile | None = None,
        *,
        hashed: bool = True,
    ) -> None:
        self.descriptor = descriptor
        self.words = words
        self._places = columns
        self._structure = structure
        self._growing = growing
        self._hashed = hashed
        self._columns: dict[str, dict[str, ColumnFile]] = {}
        for (group, name), place in columns.items():
            self._columns.setdefault(group, {})[name] = (
                ColumnFile(growing.descriptor, growing.place((group, name)), hashed=hashed)
                if growing is not None and group in growing.groups
                else ColumnFile(descriptor, place, hashed=hashed)
            )
        for group, lives in life_tables(pulse).items():
            if group in self._columns:
                self.write(group, 0, lives)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        disk.close(self.descriptor)
        if self._growing is not None:
            self._growing.close()

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Write rows of a group (see Sink)."""
        files = self._columns[group]
        for name, values in columns.items():
            files[name].write(first_row, values)

    def columns(self) -> Iterator[tuple[Name, ColumnFile]]:
        """Yield every column with the name of its group and its own."""
        for group, files in self._columns.items():
            for name, column in files.items():
                yield (group, name), column

    def rows(self) -> dict[str, int]:
        """Return how many rows each group has so far."""
        return {group: next(iter(files.values())).rows_written for group, files in self._columns.items()}

    @property
    def names(self) -> list[Name]:
        """The columns that the run fills, in the order of their marks."""
        return [name for name, _ in self._filled()]

    def marks(self, rows: Mapping[str, int]) -> list[Mark]:
        """Write all waiting rows, and return a mark of every column after the first rows of its group."""
        return [column.mark(rows[group]) for (group, _), column in self._filled()]

    def sync(self) -> None:
        """Flush all written rows to disk (fsync)."""
        disk.sync_rows(self.descriptor)
        self.sync_growing()

    def sync_growing(self) -> None:
        """Flush the growing rows to disk."""
        if self._growing is not None:
            self._growing.sync()

    def go_on_from(self, commits: Sequence[Commit]) -> Commit | None:
        """Return the last commit whose rows are all in the file, and continue after it (from the start if None)."""
        fitting = [column.matching([commit.marks[name] for commit in commits]) for name, column in self._filled()]
        last = commits[min(fitting) - 1] if min(fitting) else None
        for name, column in self._filled():
            column.go_on_from(last.marks[name].rows if last else 0)
        return last

    def replay(self, sink: Sink, watched: Mapping[str, Mapping[str, object]]) -> None:
        """Write the rows so far of the watched columns, by group and name, to a sink again."""
        for group, names in watched.items():
            files = {name: file for name, file in self._columns.get(group, {}).items() if name in names}
            readers = [file.chunks(CHUNK_ROWS, file.rows_written) for file in files.values()]
            first = 0
            for chunks in zip(*readers, strict=True):
                sink.write(group, first, dict(zip(files, chunks, strict=True)))
                first += len(chunks[0])

    def completion(self, summary: Mapping[str, Scalar], finished: str) -> Ending:
        """Return the ending of the file, with hashes, summary and end time; nothing is written yet.

        Raises RubnoiseError if rows are missing.
        """
        digests, grown = self.digests(), {}
        try:
            with h5py.File(self._structure, "r+", libver=LIBRARY_VERSIONS) as file:
                grown = enlarge(file, self.grown_rows())
                complete(file, self.words, digests, summary, finished)
        except (OSError, RuntimeError, LookupError, ValueError) as problem:  # of one that was not made here
            raise RubnoiseError(f"HDF5 fails on the structure of the part: {problem}") from problem
        size, places = self._structure.size, {**self._places, **grown}
        return Ending(tuple(self._structure.pieces(between(places.values(), size))), size, tuple(grown.items()))

    def grown_rows(self) -> dict[str, int]:
        """Return the number of rows in each growing group."""
        groups = () if self._growing is None else self._growing.groups
        return {group: rows for group, rows in self.rows().items() if group in groups}

    def carry_out(self, ending: Ending) -> None:
        """Write the ending into the file, which then has all of its rows."""
        ending.carry_out(self.descriptor, self._growing)
        for (group, name), place in ending.grown:
            self._columns[group][name] = self._columns[group][name].moved(self.descriptor, place)

    def check(self, ending: Ending) -> None:
        """Read the whole file once; raises NotAsWritten unless it has its ending and every row that was written."""
        if not ending.is_in(self.descriptor):
            raise disk.NotAsWritten("its structure")
        for (group, name), column in self.columns():
            if column.stored_digest() != column.digest():
                raise disk.NotAsWritten(f"/{group}/{name}")

    def digests(self) -> dict[Name, str]:
        """Return the hash of every column; raises RubnoiseError if rows are missing."""
        for (group, name), column in self.columns():
            column.flush()
            if column.rows_written != column.rows:
                raise RubnoiseError(f"/{group}/{name} has {column.rows_written} of its {column.rows} rows")
        return {key: column.digest() for key, column in self.columns()} if self._hashed else {}

    def _filled(self) -> Iterator[tuple[Name, ColumnFile]]:
        return ((name, column) for name, column in self.columns() if name[0] not in LIFE_TABLES)


@contextmanager
def compressed(
    part: Part,
    making: Path,
    description: RunDescription,
    summary: Mapping[str, Scalar],
    finished: str,
    between: Callable[[], None],
) -> Iterator[int]:
    """Write a compressed copy of a complete part under a temporary name; yield it open, read back and flushed.

    Memory is that of one chunk; ``between`` is called after each, and may raise to stop. Raises OSError, NotAsWritten
    if the disk has another file, and RubnoiseError if rows are missing; the part is left as it was.
    """
    digests, words = part.digests(), Words.of(description)
    with new_file(making) as descriptor:
        target = Unfailing(descriptor)
        try:
            with h5py.File(target, "w", libver=LIBRARY_VERSIONS) as file:
                extent = replace(description.extent, **part.grown_rows())
                compose(file, replace(description, extent=extent), compressed=True)
                _copy(part, file, between)
                complete(file, words, digests, summary, finished)
        finally:
            target.raise_first_error()
        disk.sync(descriptor)
        written = Written.of(os.fstat(descriptor), description.features, words, part.columns(), summary, finished)
        _check_hashes(making, written)
        yield descriptor


def _copy(part: Part, file: h5py.File, between: Callable[[], None]) -> None:
    for (group, name), column in part.columns():
        first = 0
        for chunk in column.chunks(CHUNK_ROWS):
            file[group][name][first : first + chunk.size] = chunk
            first += chunk.size
            between()


def _check_hashes(path: Path, written: Written) -> None:
    """Read a compressed file once; raises NotAsWritten unless its attributes and rows are those written."""
    try:
        with open_run(path) as run:
            check_structure(run)
            if not _says(run, written.found or {}) or run.damaged():
                raise disk.NotAsWritten("its compressed copy")
    except RunFileRefused as refusal:
        raise disk.NotAsWritten("its compressed copy") from refusal


def _says(run: RunFile, found: Mapping[str, Any]) -> bool:
    """Whether a file has the attributes that were found in another one, compressed or not."""
    told = {
        "features": sorted(run.features),
        "attributes": {"value": run.attributes},
        "summary": {"value": run.summary},
        "provenance": {"value": run.provenance},
    }
    hashes = {(group, name): run.digest(group, name) for group, names in run.columns.items() for name in names}
    return told == {name: found.get(name) for name in told} and hashes == {
        (group, name): about["digest"]["value"]
        for group, columns in found.get("columns", {}).items()
        for name, about in columns.items()
    }

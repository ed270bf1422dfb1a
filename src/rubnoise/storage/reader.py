"""The reader of result files: opens one of ours or says in a sentence why not, and reads columns when asked."""

import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

import h5py
import xxhash
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.record.sink import Extent
from rubnoise.storage.layout import row_count, stored_columns, stored_groups
from rubnoise.storage.schema import CHUNK_ROWS, FORMAT, FORMAT_VERSION, GROUPS, HASH, Feature, Scalar
from rubnoise.storage.soundness import (
    has_hard_link,
    read_attribute,
    read_integer,
    read_text,
    sound_dataset,
    sound_group,
)

SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"
ROOT_ATTRIBUTES: Final = ("Conventions", "format", "format_version", "title", "source", "junction_area_formula")
PROVENANCE_TEXTS: Final = (
    "scenario_toml",
    "scenario_resolved",
    "software",
    "environment",
    "propagator_constants",
    "command",
    "started",
    "finished",
)
PROVENANCE_NUMBERS: Final = ("seed", "stream_version", "calibrated_diameter")
SUMMARY_LIMIT: Final = 256


class TooNew(RunFileRefused):
    """A run file in a format version that this rubnoise does not know yet."""


class RunFile:
    """An open run file. Opening reads its structure only; each column is read when it is asked for.

    Use it as a context manager, or close it.
    """

    def __init__(self, path: str | os.PathLike[str], file: h5py.File) -> None:
        self.path = Path(path)
        self._file = file
        _check_format(file)
        self.features: frozenset[Feature] = _features(file)
        self._datasets = _datasets(file, self.features, Path(path).stat().st_size)
        self.extent = Extent(
            junctions=self.rows("junctions"),
            ticks=self.rows("trace"),
            blocks=self.rows("blocks") if "blocks" in self._datasets else 0,
        )
        _check_lengths(self._datasets, self.extent)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; columns can no longer be read."""
        self._file.close()

    @property
    def columns(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the columns in each group, the dimension scale first."""
        return {group: tuple(datasets) for group, datasets in self._datasets.items()}

    @property
    def closed(self) -> bool:
        """Whether the file was closed."""
        return not self._file

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        return int(next(iter(self._datasets[group].values())).size)

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Read rows ``start`` to ``stop`` (to the end when None) of a column, in the units of the schema.

        Raises KeyError for a name that the file does not have, RunFileRefused where its bytes cannot be read.
        """
        dataset = self._datasets[group][name]
        with self._reading():
            values: NDArray[Any] = dataset[start:stop]
        return values

    @property
    def attributes(self) -> dict[str, Scalar]:
        """Format, title, source and the formula of a junction's area."""
        with self._reading():
            return {name: read_attribute(self._file, name) for name in ROOT_ATTRIBUTES}

    @property
    def summary(self) -> dict[str, Scalar]:
        """Measured and exact figures by name; empty in a part file."""
        with self._reading():
            group = sound_group(self._file, "summary")
            names = [name for name in group.attrs if name != "NX_class"]
            if len(names) > SUMMARY_LIMIT:
                raise RunFileRefused(f"/summary has {len(names)} attributes")
            return {name: read_attribute(group, name) for name in names}

    @property
    def provenance(self) -> dict[str, Scalar]:
        """Scenario, software, seed, command and times; ``finished`` is empty in a part file."""
        with self._reading():
            group = sound_group(self._file, "provenance")
            texts = {name: read_text(group, name) for name in PROVENANCE_TEXTS}
            return texts | {name: read_attribute(group, name) for name in PROVENANCE_NUMBERS}

    def damaged(self) -> tuple[str, ...]:
        """Return the columns that are unreadable or do not have the hash written beside them; reads the whole file."""
        return tuple(
            f"/{group}/{name}"
            for group, datasets in self._datasets.items()
            for name in datasets
            if not self._is_intact(group, name)
        )

    @contextmanager
    def _reading(self) -> Iterator[None]:
        if not self._file:
            raise ValueError(f"{self.path}: the run file is closed")
        with _refusing(self.path):
            yield

    def _is_intact(self, group: str, name: str) -> bool:
        try:
            return self._hash(group, name) == self._recorded_hash(group, name)
        except RunFileRefused:
            return False

    def _hash(self, group: str, name: str) -> str:
        digest = xxhash.xxh3_128()
        for first in range(0, self.rows(group), CHUNK_ROWS):
            digest.update(self.column(group, name, first, first + CHUNK_ROWS).data)
        return digest.hexdigest()

    def _recorded_hash(self, group: str, name: str) -> str:
        with self._reading():
            return read_text(self._datasets[group][name], HASH)


def open_run(path: str | os.PathLike[str]) -> RunFile:
    """Open a run file for reading.

    Raises RunFileRefused, with the reason in one sentence, for a path that is missing or no regular file, a file that
    is not HDF5, not a run, cut short or damaged; TooNew for one of a later format.
    """
    with _refusing(path):
        _check_signature(path)
        file = h5py.File(path, "r")
        try:
            return RunFile(path, file)
        except BaseException:
            file.close()
            raise


@contextmanager
def _refusing(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn whatever a damaged file makes HDF5 say into one sentence that begins with the path."""
    try:
        yield
    except RunFileRefused as refusal:
        raise type(refusal)(f"{path}: {refusal}") from refusal
    except BlockingIOError as problem:
        raise RunFileRefused(f"{path}: is being written by another program") from problem
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, UnicodeError) as problem:
        raise RunFileRefused(f"{path}: {_reason(problem)}") from problem


def _reason(problem: Exception) -> str:
    if isinstance(problem, OSError) and problem.filename is not None:
        return str(problem.strerror).lower()
    if "unable to lock file" in str(problem):
        return "cannot be locked on this file system (HDF5_USE_FILE_LOCKING=FALSE in the environment reads it anyway)"
    return "cut short" if "truncated file" in str(problem) else f"damaged: {problem}"


def _check_signature(path: str | os.PathLike[str]) -> None:
    """Look before HDF5 does: opening a pipe would wait for ever, and most wrong files show in their first bytes."""
    if not stat.S_ISREG(Path(path).stat().st_mode):
        raise RunFileRefused("is not a regular file")
    with Path(path).open("rb") as stream:
        if stream.read(len(SIGNATURE)) != SIGNATURE:
            raise RunFileRefused("is empty" if Path(path).stat().st_size == 0 else "is not an HDF5 file")


def _check_format(file: h5py.File) -> None:
    if "format" not in file.attrs or read_attribute(file, "format") != FORMAT:
        raise RunFileRefused("is an HDF5 file, but not one of rubnoise")
    version = read_integer(file, "format_version")
    if version > FORMAT_VERSION:
        source = read_text(file, "source")
        raise TooNew(
            f"has format version {version}, written by {source}; this one reads versions up to {FORMAT_VERSION}."
            f" {source} or later is needed"
        )
    if version < 1:
        raise RunFileRefused(f"has format version {version}, which never was")


def _features(file: h5py.File) -> frozenset[Feature]:
    """Return what the run has beyond the bare contact, told by the columns that only exist with it."""
    junctions = sound_group(file, "junctions")
    told: dict[Feature, bool] = {
        "strength": has_hard_link(junctions, "shear_strength"),
        "speed": has_hard_link(junctions, "birth_time"),
        "slider": has_hard_link(file, "slider"),
    }
    if told["slider"] and not (told["speed"] and told["strength"]):
        raise RunFileRefused("has a slider without a speed or a strength")
    return frozenset(feature for feature, present in told.items() if present)


def _datasets(file: h5py.File, features: frozenset[Feature], file_size: int) -> dict[str, dict[str, h5py.Dataset]]:
    found: dict[str, dict[str, h5py.Dataset]] = {}
    for group in stored_groups(features):
        if group.added and not has_hard_link(file, group.name):
            continue
        owner = sound_group(file, group.name)
        columns = stored_columns(group, features)
        found[group.name] = {column.name: sound_dataset(owner, column, file_size) for column in columns}
    return found


def _check_lengths(datasets: Mapping[str, Mapping[str, h5py.Dataset]], extent: Extent) -> None:
    for group in GROUPS:
        for name, dataset in datasets.get(group.name, {}).items():
            if dataset.size != row_count(group, extent):
                raise RunFileRefused(f"/{group.name}/{name} has another number of rows than its group")

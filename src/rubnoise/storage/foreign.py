"""Measured traces in files of other programs, opened by their kind: text, WAV, MATLAB 5, HDF5 and netCDF.

Soft links of HDF5 lead on within the file; links and storage in other files are not followed.
"""

import os
import posixpath
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any, BinaryIO, Final

import h5py
import numpy as np

from rubnoise.errors import UNFINISHED, NoColumn, Refused, RunFileRefused
from rubnoise.regular_file import is_hdf5, open_regular, open_stream, read_at_most, size_of
from rubnoise.storage.measured import Asked, Measured, measured
from rubnoise.storage.objects import opened_by_hdf5
from rubnoise.storage.samples import Source, column_of
from rubnoise.storage.schema import FORMAT
from rubnoise.storage.text_heads import Head, spelled
from rubnoise.storage.text_table import TextTable

LARGEST: Final = 2 * 1024**3
"""Bytes of a file of text, sound, MATLAB or netCDF-3."""

MOST_UNPACKED: Final = 10_000_000
"""Values of a vector of MATLAB: a file says how many it has before they are unpacked."""

MOST_VALUES: Final = 100_000_000
_MOST_LINKS: Final = 16
_ATTRIBUTES: Final = ("scale_factor", "add_offset", "_FillValue", "missing_value", "units")
_LISTED: Final = 12
_NUMBERS: Final = frozenset(
    ["double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))]
)


def read_measured(trace: str | os.PathLike[str], asked: Asked = Asked(), *, every: bool = False) -> Measured:  # noqa: B008
    """Return a column of a file, or ``every`` one; ``FILE.h5:PATH`` is a dataset. Raises Refused, with the line."""
    return measured(opened(trace, asked.column), asked, every=every)


def opened(trace: str | os.PathLike[str], column: str | None = None) -> Source:
    """Return the columns of a file by its kind; raises Refused for a file of none. ``column`` names one of MATLAB."""
    text = os.fspath(trace)
    if "\0" in text:
        raise Refused(f"{text[:40]!r}: no file has a zero byte in its name")
    begin, _, name = text.rpartition(":")
    inside = bool(begin) and not Path(text).exists() and Path(begin).exists()
    path, name = (Path(begin), name) if inside else (Path(text), "")
    if is_hdf5(path):
        if not name:
            raise Refused(f"{path}: which dataset? {path}:PATH names one")
        return _of_hdf5(path, name)
    if (held := size_of(path)) > LARGEST:
        raise Refused(f"{path}: has {held:,} bytes; traces of up to {LARGEST:,} are read")
    if read_at_most(path, 3) == b"CDF":
        with _naming(path, "netCDF file", "convert it to netCDF-4 or CSV"):
            return _of_netcdf(path, name)
    if path.suffix.lower() == ".wav":
        with open_stream(path) as stream, _naming(path, "WAV file", "save it as PCM of 16 or 24 bits"):
            return _of_wave(path, stream)
    if path.suffix.lower() == ".mat":
        with open_stream(path) as stream, _naming(path, "MATLAB 5 file", "save it with -v6 or -v7"):
            return _of_matlab(path, stream, column)
    return TextTable.of(path)


@contextmanager
def _naming(path: Path, kind: str, remedy: str) -> Iterator[None]:
    """Turn what a library raises on a damaged file, which may be any error, into a refusal that names the file."""
    try:
        yield
    except NoColumn:
        raise
    except Refused as refused:
        raise Refused(f"{path}: {refused}") from refused
    except MemoryError as problem:
        raise Refused(f"{path}: is damaged, or there is no memory to unpack it; save fewer values") from problem
    except Exception as problem:
        said = isinstance(problem, ValueError | Warning)
        why = " ".join(str(problem).split())[:200].rstrip(".") if said else "it is cut or damaged"
        raise Refused(f"{path}: is no {kind} that can be read: {why}; {remedy}") from problem


def _of_wave(path: Path, stream: BinaryIO) -> Source:
    """Return the channels of a sound; whole numbers are parts of full scale."""
    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.filterwarnings("error", message="Reached EOF|Incomplete|Unknown")
        rate, sound = wavfile.read(stream)
    channels = sound.reshape(len(sound), -1)
    if not rate or not channels.size:
        raise Refused(f"has {len(sound)} samples at {rate} Hz; both are needed")
    if sound.dtype.kind in "iu":
        zero, full = (128.0, 128.0) if sound.dtype == np.uint8 else (0.0, -float(np.iinfo(sound.dtype).min))
        channels = (channels - zero) / full
    arrays = [np.ascontiguousarray(each, dtype=np.float64) for each in channels.T]
    heads = [Head(str(number), "", str(number)) for number in range(1, len(arrays) + 1)]
    return Source(path=path, heads=heads, arrays=arrays, step=1.0 / rate, word="sample", of_file=True)


def _of_matlab(path: Path, stream: BinaryIO, wanted: str | None) -> Source:
    """Return the vectors of a MATLAB file that are as long as the wanted one: those beside the times, or one of them.

    A file says how many values a vector has before they are unpacked.
    """
    from scipy.io import loadmat, whosmat

    shapes = {name: shape for name, shape, kind in whosmat(stream) if kind in _NUMBERS}
    sizes = {name: max(shape) for name, shape in shapes.items() if prod(shape) == max(shape) > 1}
    if not sizes:
        there = ", ".join(f"{name} {'x'.join(map(str, shape))}" for name, shape in list(shapes.items())[:_LISTED])
        raise Refused(f"has no vector of real numbers; it has {there or 'no numbers'}")
    heads = [Head(name, "s" if name.lower() in {"t", "time"} else "", name) for name in sizes]
    others = [head.name for head in heads if not head.unit]
    if wanted is None and len({sizes[name] for name in others}) > 1:
        raise NoColumn(f"{path}: which column? column= takes one of: {', '.join(others[:_LISTED])}")
    chosen = [*others, *sizes][0]
    if wanted is not None:
        chosen = heads[column_of(Source(path=path, heads=heads), wanted, "column")].name
    alike = [head for head in heads if sizes[head.name] == sizes[chosen]]
    kept = [head for head in alike if wanted is None or head.unit or head.name == chosen]
    if sizes[chosen] > MOST_UNPACKED:
        raise Refused(
            f"{chosen} has {sizes[chosen]:,} values; up to {MOST_UNPACKED:,} are read; save it as CSV or HDF5"
        )
    stream.seek(0)
    found = loadmat(stream, squeeze_me=True, variable_names=[head.name for head in kept])
    arrays = [np.asarray(found[head.name]) for head in kept]
    for head, array in zip(kept, arrays, strict=True):
        if array.dtype.kind not in "fiu" or array.shape != (sizes[chosen],):
            raise Refused(f"{head.name} is no vector of real numbers")
    return Source(path=path, heads=kept, arrays=[each.astype(np.float64) for each in arrays], of_file=True)


def _of_netcdf(path: Path, name: str) -> Source:
    """Return a variable of a netCDF-3 file, at the places of the variable of its dimension."""
    from scipy.io import netcdf_file

    with netcdf_file(path, "r", mmap=False) as file:
        found = file.variables.get(name.strip("/"))
        if found is None:
            there = ", ".join(list(file.variables)[:_LISTED])
            raise NoColumn(f"{path}: which variable? {path}:NAME names one of: {there or 'none'}")
        long = [dimension for dimension, side in zip(found.dimensions, found.shape, strict=True) if side != 1]
        scale = file.variables.get(long[0]) if len(long) == 1 else None
        parts = [(name, found)] if scale is None or scale is found else [(name, found), (long[0], scale)]
        about = [{key: getattr(part, key, None) for key in _ATTRIBUTES} for _, part in parts]
        return _unpacked(
            path, [(each, part.data.copy(), said) for (each, part), said in zip(parts, about, strict=True)]
        )


def _of_hdf5(path: Path, name: str) -> Source:
    """Return a dataset of HDF5, at the places of its dimension scale."""
    descriptor = open_regular(path)
    try:
        with opened_by_hdf5(path, descriptor) as file:
            _check_finished(path, file)
            dataset = _dataset(file, name)
            axis = dataset.dims[int(np.argmax(dataset.shape))]
            scale = axis[0] if len(axis) else None
            parts = [(name, dataset[()], dataset.attrs)]
            if scale is not None and _is_here(scale) and scale.size == dataset.size and scale.dtype.kind in "fiu":
                parts.append((scale.name or f"scale of {name}", scale[()], scale.attrs))
            return _unpacked(path, parts)
    except NoColumn as refused:
        raise NoColumn(f"{path}: {refused}") from refused
    except RunFileRefused:
        raise
    except Exception as problem:
        raise NoColumn(f"{path}: damaged or no HDF5: {' '.join(str(problem).split())}") from problem
    finally:
        os.close(descriptor)


def _unpacked(path: Path, parts: Sequence[tuple[str, Any, Mapping[str, Any]]]) -> Source:
    """Return values as their attributes tell: scale_factor, add_offset, and what stands for a missing one."""
    heads, arrays, missing = [], [], {}
    for number, (name, raw, about) in enumerate(parts):
        if raw.dtype.kind not in "fiu" or raw.size != max(raw.shape, default=0):
            raise Refused(f"{name} has {raw.ndim} dimensions of {raw.dtype}; one of numbers is needed")
        said = {key: np.ravel(about[key]) for key in _ATTRIBUTES[:-1] if about.get(key) is not None}
        flat = raw.ravel()
        values = flat.astype(np.float64) * said.get("scale_factor", [1.0])[0] + said.get("add_offset", [0.0])[0]
        for key in ("_FillValue", "missing_value"):
            for filling in said.get(key, ()):
                if (flat == filling).any():
                    missing[number] = f"its {key}, {filling:g}"
                    values[flat == filling] = np.nan
        unit = spelled(_text(about.get("units")).partition(" since ")[0])
        heads.append(Head(name.rpartition("/")[2] if number else name, unit, name))
        arrays.append(values)
    return Source(path=path, heads=heads, arrays=arrays, missing=missing, of_file=True)


def _text(attribute: Any) -> str:
    """Return an attribute as a text: one, an array of one, or bytes in UTF-8 or Latin-1."""
    if isinstance(attribute, np.ndarray):
        attribute = attribute.ravel()[0] if attribute.size else None
    if isinstance(attribute, bytes):
        try:
            return attribute.decode()
        except UnicodeDecodeError:
            return attribute.decode("latin-1")
    return "" if attribute is None or isinstance(attribute, h5py.Empty) else str(attribute)


def _dataset(file: h5py.File, name: str) -> h5py.Dataset:
    """Return the dataset of numbers with a path; raises NoColumn for anything else."""
    dataset = _linked(file, name)
    if not isinstance(dataset, h5py.Dataset):
        there: list[str] = []
        file.visititems(lambda path, item: there.append(path) if isinstance(item, h5py.Dataset) else None)
        raise NoColumn(f"{name} is no dataset in it; it has {', '.join(there[:_LISTED]) or 'none'}")
    if not _is_here(dataset):
        raise NoColumn(f"{name} has its values in other files, which are not read")
    if dataset.dtype.kind not in "fiu" or not dataset.size or dataset.size != max(dataset.shape, default=0):
        raise NoColumn(f"{name} has {dataset.ndim} dimensions of {dataset.dtype}; one of numbers is needed")
    if dataset.size > MOST_VALUES:
        raise NoColumn(f"{name} has {dataset.size:,} values; up to {MOST_VALUES:,} are read from a file of others")
    return dataset


def _linked(file: h5py.File, path: str, links: int = _MOST_LINKS) -> h5py.HLObject | None:
    """Return the object at a path, reached by hard and soft links within the file; None if there is none."""
    owner, parts = file["/"], [part for part in path.split("/") if part]
    for number, part in enumerate(parts, 1):
        link = owner.get(part, getlink=True) if isinstance(owner, h5py.Group) else None
        if isinstance(link, h5py.SoftLink) and links:
            return _linked(file, posixpath.join(owner.name, link.path, *parts[number:]), links - 1)
        if not isinstance(link, h5py.HardLink):
            return None
        owner = owner[part]
    return owner


def _is_here(dataset: h5py.Dataset) -> bool:
    """Whether the values of a dataset lie in its own file."""
    creation = dataset.id.get_create_plist()
    return creation.get_layout() != h5py.h5d.VIRTUAL and not creation.get_external_count()


def _check_finished(path: Path, file: h5py.File) -> None:
    """Refuse the part file of a run of ours, whose last rows were never computed."""
    origin = _linked(file, "provenance")
    finished = "unknown" if origin is None else _text(origin.attrs.get("finished", "unknown"))
    if _text(file.attrs.get("format")) == FORMAT and finished == "":
        raise RunFileRefused(f"{path}: {UNFINISHED}")

"""Measured traces in files of other programs, opened by their kind: text, WAV, MATLAB 5, HDF5 and netCDF.

Soft links of HDF5 lead on within the file; links and storage in other files are not followed.
"""

import os
import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np

from rubnoise.errors import NoColumn, Refused, naming
from rubnoise.regular_file import open_stream, read_at_most
from rubnoise.storage.measured import Head, Source
from rubnoise.storage.objects import linked, naming_damage, opened_by_hdf5
from rubnoise.storage.schema import FORMAT
from rubnoise.storage.text_table import read_table
from rubnoise.units import spelled

MOST_UNPACKED: Final = 10_000_000  # values of a vector of MATLAB: a file says how many before they are unpacked
MOST_VALUES: Final = 100_000_000
_MOST_LINKS: Final = 16
_NUMBERS: Final = ("double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))

Columns = tuple[list[tuple[Head, Any]], float]
"""Columns with their names and units, and the step in s that the file names, or 0."""


def opened(trace: str | os.PathLike[str], column: str | None = None) -> Source:
    """Return the columns of a file by its kind; raises Refused for a file of none.

    ``FILE.h5:PATH`` is a dataset; ``column`` names one of MATLAB, with which others are as long.
    """
    text = os.fspath(trace)
    begin, _, name = text.rpartition(":")
    inside = not os.path.exists(text) and os.path.exists(begin)  # noqa: PTH110  (of any text, also of no path)
    path, name = (Path(begin), name) if inside else (Path(text), "")
    kind = {b"\x89HD": "HDF", b"CDF": "CDF"}.get(read_at_most(path, 3), path.suffix.lower())
    if kind not in _KINDS:
        return read_table(path)
    what, remedy, read = _KINDS[kind]
    with naming(path), naming_damage(f"is no {what} that can be read", remedy, NoColumn):
        columns, step = read(path, name or column or "")
        arrays = {n: np.ascontiguousarray(np.ravel(values), dtype=np.float64) for n, (_, values) in enumerate(columns)}
    return Source(path=path, heads=[head for head, _ in columns], arrays=arrays, step=step, of_file=True)


def _of_wave(path: Path, _: str) -> Columns:
    """Return the channels of a sound; whole numbers are parts of full scale."""
    from scipy.io import wavfile

    with open_stream(path) as stream, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.filterwarnings("error", message="Reached EOF|Incomplete|Unknown")
        rate, sound = wavfile.read(stream)
    if not rate or not sound.size:
        raise Refused(f"has {len(sound)} samples at {rate} Hz; both are needed")
    channels = sound.reshape(len(sound), -1)
    if sound.dtype.kind in "iu":
        zero, full = (128.0, 128.0) if sound.dtype == np.uint8 else (0.0, -float(np.iinfo(sound.dtype).min))
        channels = (channels - zero) / full
    return [(Head(str(n), "", str(n)), each) for n, each in enumerate(channels.T, 1)], 1.0 / rate


def _of_matlab(path: Path, wanted: str) -> Columns:
    """Return the vectors of a MATLAB file that are as long as the wanted one, or as the longest."""
    from scipy.io import loadmat, whosmat

    with open_stream(path) as stream:
        shapes = {name: shape for name, shape, kind in whosmat(stream) if kind in _NUMBERS}
        sizes = {name: max(shape) for name, shape in shapes.items() if np.prod(shape, dtype=object) == max(shape) > 1}
        size = sizes.get(wanted, max(sizes.values(), default=0))
        if size > MOST_UNPACKED:
            raise Refused(f"has vectors of {size:,} values; up to {MOST_UNPACKED:,} are read; save it as CSV or HDF5")
        stream.seek(0)
        found = loadmat(stream, squeeze_me=True, variable_names=[name for name in sizes if sizes[name] == size])
    real = {n: each for n, each in found.items() if n in sizes and each.shape == (size,) and each.dtype.kind in "fiu"}
    if not real:
        there = ", ".join(f"{name} {'x'.join(map(str, shape))}" for name, shape in shapes.items())
        raise Refused(f"has no vector of real numbers; it has {there or 'no numbers'}")
    return [(Head(name, "s" if name.lower() in {"t", "time"} else "", name), each) for name, each in real.items()], 0.0


def _of_netcdf(path: Path, name: str) -> Columns:
    """Return a variable of a netCDF-3 file, at the places of the variable of its dimension."""
    from scipy.io import netcdf_file

    with open_stream(path) as stream, netcdf_file(stream, "r", mmap=False) as file:
        if name.strip("/") not in file.variables:
            raise NoColumn(f"which variable? FILE:NAME takes one of: {', '.join(file.variables) or 'none'}")
        found = file.variables[name.strip("/")]
        axes = [axis for axis, side in zip(found.dimensions, found.shape, strict=True) if side != 1]
        scales = {axis: file.variables[axis] for axis in axes if axis in file.variables}
        return [_unpacked(each, part.data, vars(part)) for each, part in ({name: found} | scales).items()], 0.0


def _of_hdf5(path: Path, name: str) -> Columns:
    """Return a dataset of HDF5, at the places of its dimension scale."""
    with open_stream(path) as stream, opened_by_hdf5(path, stream.fileno()) as file:
        dataset = linked(file, name, soft=_MOST_LINKS)
        if not isinstance(dataset, h5py.Dataset):
            if not name and _text(file.attrs.get("format")) == FORMAT:
                raise NoColumn(f'is a result of rubnoise; of a result, Trace(rubnoise.open("{path}")) takes the trace')
            there: list[str] = []
            file.visititems(lambda each, item: there.append(each) if isinstance(item, h5py.Dataset) else None)
            wrong = f"{name} is no dataset in it; it has" if name else "which dataset? FILE:PATH takes one of:"
            raise NoColumn(f"{wrong} {', '.join(there) or 'none'}")
        axis = dataset.dims[int(np.argmax(dataset.shape))] if dataset.shape else ()
        scales = [axis[number] for number in range(len(axis)) if axis[number].size == dataset.size]
        return [_stored(name, dataset), *(_stored(each.name or "scale", each) for each in scales[:1])], 0.0


def _stored(name: str, dataset: h5py.Dataset) -> tuple[Head, Any]:
    """Return the values of a dataset, all of them in the file itself."""
    creation = dataset.id.get_create_plist()
    if creation.get_layout() == h5py.h5d.VIRTUAL or creation.get_external_count():
        raise NoColumn(f"{name} has its values in other files, which are not read")
    if dataset.size is not None and dataset.size > MOST_VALUES:
        raise NoColumn(f"{name} has {dataset.size:,} values; up to {MOST_VALUES:,} are read from a file of others")
    return _unpacked(name, dataset[()], dataset.attrs)


def _unpacked(name: str, raw: Any, about: Mapping[str, Any]) -> tuple[Head, Any]:
    """Return values as their attributes tell: scale_factor, add_offset, and what stands for a missing one."""
    if raw.dtype.kind not in "fiu" or not raw.size or raw.size != max(raw.shape):
        raise NoColumn(f"{name} has {raw.ndim} dimensions of {raw.dtype}; one of numbers is needed")
    scale, offset = (np.ravel(about.get(key, usual))[0] for key, usual in (("scale_factor", 1.0), ("add_offset", 0.0)))
    values, missing = raw.astype(np.float64) * scale + offset, ""
    for key in ("_FillValue", "missing_value"):
        for filling in np.ravel(about.get(key, ())):
            if (raw == filling).any():
                values[raw == filling], missing = np.nan, f"its {key}, {filling:g}"
    unit = spelled(_text(about.get("units")).partition(" since ")[0])
    return Head(name.rpartition("/")[2], unit, name, missing=missing), values


def _text(attribute: Any) -> str:
    """Return an attribute as a text: one, an array of one, or bytes in UTF-8 or Latin-1; empty for none."""
    text: Any = next(iter(np.ravel(attribute).tolist()), "")
    with suppress(UnicodeDecodeError, AttributeError):
        return str(text.decode())
    return text.decode("latin-1") if isinstance(text, bytes) else text if isinstance(text, str) else ""


_KINDS: Final[Mapping[str, tuple[str, str, Callable[[Path, str], Columns]]]] = {
    ".wav": ("WAV file", "save it as PCM of 16 or 24 bits", _of_wave),
    ".mat": ("MATLAB 5 file", "save it with -v6 or -v7", _of_matlab),
    "CDF": ("netCDF file", "convert it to netCDF-4 or CSV", _of_netcdf),
    "HDF": ("HDF5 file", "copy it again", _of_hdf5),
}
"""What a file is called, what helps if it is damaged, and what reads it, by its first bytes or its ending."""

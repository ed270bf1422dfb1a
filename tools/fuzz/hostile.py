"""Result files made to harm: each is a good one with a part replaced, by h5py's own means."""

import ctypes
import os
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np

ROWS = 10**15
COLUMN = "trace/real_contact_area"
CHUNK = 65_536
OPENED = 0x20
EVENT_BYTES = 16
"""Of inotify, by which the kernel of Linux reports what any process opens."""

Construction = Callable[[h5py.File, Path], None]


def claimed_rows(file: h5py.File, _canary: Path) -> None:
    """Claim 10^15 rows in chunks, of which none was written."""
    _remake(file["trace"], ROWS, chunks=(CHUNK,), shuffle=True, compression="gzip")


def claimed_contiguous_rows(file: h5py.File, _canary: Path) -> None:
    """Claim 10^15 rows in one piece."""
    _remake(file["trace"], ROWS)


def bomb(file: h5py.File, _canary: Path) -> None:
    """Pack a gigabyte of zeros into a megabyte of chunks."""
    _remake(file["trace"], 500 * CHUNK, chunks=(CHUNK,), shuffle=True, compression="gzip")
    for column in file["trace"].values():
        packed = zlib.compress(bytes(CHUNK * column.dtype.itemsize), 9)
        for chunk in range(500):
            column.id.write_direct_chunk((chunk * CHUNK,), packed)


def chunk_bomb(file: h5py.File, _canary: Path) -> None:
    """Pack a hundred megabytes into a chunk of half a megabyte."""
    values = _taken(file, COLUMN)
    column = file.create_dataset(COLUMN, values.shape, "<f8", chunks=values.shape, shuffle=True, compression="gzip")
    column.id.write_direct_chunk((0,), zlib.compress(bytes(10**8), 9))


def external_storage(file: h5py.File, canary: Path) -> None:
    """Keep a column in another file."""
    values = _taken(file, COLUMN)
    file.create_dataset(COLUMN, values.shape, "<f8", external=[(str(canary), 0, values.nbytes)])


def external_link(file: h5py.File, canary: Path) -> None:
    """Link a column to another file."""
    _taken(file, COLUMN)
    file[COLUMN] = h5py.ExternalLink(str(canary), "/values")


def external_group(file: h5py.File, canary: Path) -> None:
    """Link a group to another file."""
    del file["summary"]
    file["summary"] = h5py.ExternalLink(str(canary), "/")


def soft_link(file: h5py.File, _canary: Path) -> None:
    """Link a column to another one."""
    _taken(file, COLUMN)
    file[COLUMN] = h5py.SoftLink("/trace/distance")


def soft_loop(file: h5py.File, _canary: Path) -> None:
    """Link two columns to one another."""
    _taken(file, COLUMN)
    file[COLUMN] = h5py.SoftLink("/trace/other")
    file["trace/other"] = h5py.SoftLink(f"/{COLUMN}")


def virtual_dataset(file: h5py.File, canary: Path) -> None:
    """Make a column a view of another file."""
    values = _taken(file, COLUMN)
    layout = h5py.VirtualLayout(values.shape, "<f8")
    layout[:] = h5py.VirtualSource(str(canary), "values", values.shape)
    file.create_virtual_dataset(COLUMN, layout)


def unlimited_virtual_dataset(file: h5py.File, canary: Path) -> None:
    """Make a column a view whose very length is found in another file."""
    values = _taken(file, COLUMN)
    layout = h5py.VirtualLayout(values.shape, "<f8", maxshape=(None,))
    source = h5py.VirtualSource(str(canary), "values", values.shape, maxshape=(None,))
    layout[: h5py.h5s.UNLIMITED] = source[: h5py.h5s.UNLIMITED]
    file.create_virtual_dataset(COLUMN, layout)


def nested_groups(file: h5py.File, _canary: Path) -> None:
    """Nest 20 000 groups in the trace."""
    owner = file["trace"]
    for _ in range(20_000):
        owner = owner.create_group("g")


def many_groups(file: h5py.File, _canary: Path) -> None:
    """Put 20 000 groups beside the columns."""
    for n in range(20_000):
        file["trace"].create_group(f"g{n}")


def cyclic_links(file: h5py.File, _canary: Path) -> None:
    """Link groups in a circle, by hard links."""
    file["trace/again"] = file["/"]
    file["junctions/again"] = file["trace"]
    del file["summary"]
    file["summary"] = file["/"]


def aliased_columns(file: h5py.File, _canary: Path) -> None:
    """Make two columns one and the same."""
    _taken(file, COLUMN)
    file[COLUMN] = file["trace/distance"]


def unknown_filter(file: h5py.File, _canary: Path) -> None:
    """Have a column pass a filter of a plug-in."""
    values = _taken(file, COLUMN)
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_chunk(values.shape)
    creation.set_filter(32_015, h5py.h5z.FLAG_OPTIONAL, (3,))
    space = h5py.h5s.create_simple(values.shape)
    h5py.h5d.create(file.id, COLUMN.encode(), h5py.h5t.IEEE_F64LE, space, creation)
    file[COLUMN].id.write_direct_chunk((0,), values.tobytes())


def other_filter(file: h5py.File, _canary: Path) -> None:
    """Have a column pass a filter that h5py has and we have not."""
    values = _taken(file, COLUMN)
    file.create_dataset(COLUMN, data=values, chunks=values.shape, compression="lzf", fletcher32=True)


def texts_of_any_length(file: h5py.File, _canary: Path) -> None:
    """Make a column of texts, and attributes of texts of any length."""
    values = _taken(file, COLUMN)
    file.create_dataset(COLUMN, data=["x" * 1000] * values.size, dtype=h5py.string_dtype())


def attributes_of_any_length(file: h5py.File, _canary: Path) -> None:
    """Keep title and scenario as texts of any length."""
    file.attrs["title"] = "x" * 10**6
    file["provenance"].attrs["scenario_resolved"] = "{" * 10**5
    file["summary"].attrs["mean"] = ["x"] * 1000


def references(file: h5py.File, _canary: Path) -> None:
    """Keep references in place of numbers."""
    values = _taken(file, COLUMN)
    column = file.create_dataset(COLUMN, values.shape, h5py.ref_dtype)
    column[0] = file.ref
    file.attrs["title"] = file.ref
    file["provenance"].attrs["seed"] = file["trace/distance"].regionref[:]


def large_attributes(file: h5py.File, _canary: Path) -> None:
    """Keep attributes of 30 MB."""
    file["provenance"].attrs["scenario_toml"] = np.bytes_(b"x" * 30_000_000)
    file["provenance"].attrs["command"] = np.zeros(10**6)


def many_attributes(file: h5py.File, _canary: Path) -> None:
    """Keep 20 000 attributes."""
    summary, alone = file["summary"].id, h5py.h5s.create(h5py.h5s.SCALAR)
    for n in range(20_000):  # h5py's own way makes each twice, and looks through all for it
        h5py.h5a.create(summary, f"figure_{n}".encode(), h5py.h5t.IEEE_F64LE, alone).write(np.array(1.0))


def other_type(file: h5py.File, _canary: Path) -> None:
    """Keep a column of numbers in another order of bytes, of records, of enumerations."""
    values = _taken(file, COLUMN)
    file[COLUMN] = values.astype(">f8")
    state = _taken(file, "junctions/state")
    file.create_dataset("junctions/state", data=state, dtype=h5py.enum_dtype({"a": 0, "b": 1}, "|u1"))
    diameter = _taken(file, "junctions/diameter")
    file["junctions/diameter"] = diameter.astype([("x", "<f4"), ("y", "<i4")], casting="unsafe")


def named_type(file: h5py.File, _canary: Path) -> None:
    """Put a type where a column belongs."""
    _taken(file, COLUMN)
    file[COLUMN] = np.dtype("<f8")


def deep_scenario(file: h5py.File, _canary: Path) -> None:
    """Nest the scenario 100 000 levels deep."""
    file["provenance"].attrs["scenario_resolved"] = np.bytes_(b'{"a":' * 100_000 + b"1" + b"}" * 100_000)


def long_number(file: h5py.File, _canary: Path) -> None:
    """Write a number of a million digits into the scenario."""
    file["provenance"].attrs["scenario_resolved"] = np.bytes_(b'{"format": ' + b"9" * 10**6 + b"}")


def endless_scenario(file: h5py.File, _canary: Path) -> None:
    """Ask for 10^12 km of sliding in the scenario."""
    text = file["provenance"].attrs["scenario_resolved"]
    plain = text.decode() if isinstance(text, bytes) else str(text)
    distance = plain.split('"distance": ')[1].split(",")[0].split("}")[0]
    changed = plain.replace(f'"distance": {distance}', '"distance": "1e12 km"')
    file["provenance"].attrs["scenario_resolved"] = np.bytes_(changed.encode())


def wild_numbers(file: h5py.File, _canary: Path) -> None:
    """Write nan, infinity and the largest numbers into every column."""
    wild = np.array([np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, -0.0])
    for group in ("junctions", "trace", "slider"):
        for column in file[group].values():
            if column.dtype.kind == "f":
                column[...] = np.resize(wild, column.shape)
            else:
                column[...] = np.iinfo(column.dtype).max


def no_rows(file: h5py.File, _canary: Path) -> None:
    """Leave no row in any column."""
    for group in ("junctions", "trace", "slider"):
        _remake(file[group], 0)


CONSTRUCTIONS: tuple[Construction, ...] = tuple(
    each for each in list(globals().values()) if getattr(each, "__module__", "") == __name__
)
"""Every function above."""


def make_canary(path: Path) -> None:
    """Make the file that no command may open."""
    with h5py.File(path, "w") as file:
        file["values"] = np.arange(1000.0)


def make(construction: Construction, good: bytes, path: Path, canary: Path) -> None:
    """Make a hostile file from a good one."""
    path.write_bytes(good)
    with h5py.File(path, "r+") as file:
        construction(file, canary)
    os.utime(path)


@contextmanager
def watched(path: Path) -> Iterator[list[int]]:
    """Yield a list that holds, afterwards, one entry for each time that the file was opened."""
    opened: list[int] = []
    library = ctypes.CDLL(None, use_errno=True)
    descriptor = library.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
    if descriptor < 0 or library.inotify_add_watch(descriptor, os.fsencode(path), OPENED) < 0:
        raise OSError(ctypes.get_errno(), f"{path}: cannot be watched")
    try:
        yield opened
        with suppress(BlockingIOError):
            opened += os.read(descriptor, 1 << 16)[::EVENT_BYTES]
    finally:
        os.close(descriptor)


def _remake(group: h5py.Group, rows: int, **layout: Any) -> None:
    """Make the columns of a group anew, with so many rows, none of them written."""
    for name, column in list(group.items()):
        dtype = column.dtype
        del group[name]
        group.create_dataset(name, (rows,), dtype, **layout)


def _taken(file: h5py.File, name: str) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    """Return the values of a column, and remove it."""
    values = file[name][:]
    del file[name]
    return values

"""Damaged and hostile result files, thrown at the commands: `python tools/fuzz_results.py --count 10000 --jobs 2`.

Every file goes to `verify` and to one other command in turn, each in a process of its own with limits on time and
memory. Counted are crashes, hangs, tracebacks, files opened without need, and files of which verify says that
all is well though plain h5py reads something else from them than from the good one. Exit code 1
where there is any.
"""

import argparse
import ctypes
import hashlib
import os
import struct
import sys
import tempfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from functools import partial
from io import StringIO
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np
from child import Child, called, command
from survive import NAME, SCENARIO, Outcome, chance

import rubnoise

# Damage to the bytes of a file; some of it with HDF5's checksums put right.
NUMBERS = (0, 1, 2, 0x7F, 0xFF, 0xFFFF, 1 << 31, (1 << 32) - 1, 1 << 40, 10**15, 1 << 62, (1 << 63) - 1, (1 << 64) - 1)
HEADER = b"OHDR"
SIZES = (1, 2, 4, 8, 64, 512, 4096)

Damage = Callable[[bytearray, bytes, Random], None]


def bits(content: bytearray, _other: bytes, random: Random) -> None:
    """Turn some bits."""
    for _ in range(random.choice((1, 1, 1, 2, 8))):
        content[random.randrange(len(content))] ^= 1 << random.randrange(8)


def cut_short(content: bytearray, _other: bytes, random: Random) -> None:
    """Cut the end off."""
    del content[random.randrange(len(content)) :]


def replaced(content: bytearray, other: bytes, random: Random) -> None:
    """Put zeros, ones, noise, a number or a piece of this or another file in the place of a run, or nothing."""
    gone, size = random.choice((0, *SIZES)), random.choice(SIZES)
    first, source = random.randrange(len(content)), random.choice((bytes(content), other))
    begin = random.choice((first, random.randrange(len(source))))
    pieces = (bytes(size), b"\xff" * size, random.randbytes(size), _number(random), source[begin : begin + size])
    piece = random.choice(pieces) if gone == 0 else random.choice((b"", *pieces))
    content[first : first + random.choice((gone, len(piece)))] = piece


def sealed_header(content: bytearray, _other: bytes, random: Random) -> None:
    """Change an object header and put its checksum right: forged, as our own hashes could be."""
    if headers := list(_headers(content)):
        first, last = random.choice(headers)
        for _ in range(random.choice((1, 1, 2, 4))):
            number = _number(random)
            place = random.randrange(first + 6, max(first + 7, last - len(number)))
            if random.random() < 0.5:
                content[place] ^= 1 << random.randrange(8)
            else:
                content[place : place + len(number)] = number
        content[last : last + 4] = struct.pack("<I", lookup3(bytes(content[first:last])))


DAMAGES: tuple[Damage, ...] = (*(bits,) * 4, cut_short, *(replaced,) * 6, *(sealed_header,) * 4)


def lookup3(data: bytes) -> int:
    """Return Bob Jenkins' lookup3 hash of some bytes, the checksum of HDF5's metadata."""
    mask = 0xFFFFFFFF
    a = b = c = (0xDEADBEEF + len(data)) & mask

    def turned(value: int, by: int) -> int:
        return ((value << by) | (value >> (32 - by))) & mask

    padded = data + bytes(-len(data) % 12)
    pieces = [struct.unpack_from("<III", padded, place) for place in range(0, len(padded), 12)]
    for x, y, z in pieces[:-1]:
        a, b, c = (a + x) & mask, (b + y) & mask, (c + z) & mask
        for by in (4, 6, 8, 16, 19, 4):
            a = (a - c) & mask ^ turned(c, by)
            c = (c + b) & mask
            a, b, c = b, c, a
    if not pieces:
        return c
    x, y, z = pieces[-1]
    a, b, c = (a + x) & mask, (b + y) & mask, (c + z) & mask
    for by in (14, 11, 25, 16, 4, 14, 24):
        c = ((c ^ b) - turned(b, by)) & mask
        a, b, c = b, c, a
    return b


def _headers(content: bytearray) -> Iterator[tuple[int, int]]:
    """Yield where each object header begins, and where its checksum stands."""
    place = content.find(HEADER)
    while place >= 0:
        flags = content[place + 5] if place + 5 < len(content) else 0
        after = place + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
        width = 1 << (flags & 3)
        last = after + width + int.from_bytes(content[after : after + width], "little")
        if last + 4 <= len(content):
            yield place, last
        place = content.find(HEADER, place + 1)


def _number(random: Random) -> bytes:
    """Return a number that programs stumble over, in 1 to 8 bytes."""
    size = random.choice((1, 2, 4, 8))
    return (random.choice(NUMBERS) & ((1 << 8 * size) - 1)).to_bytes(size, "little")


# Hostile files: each is a good one with a part replaced, by h5py's own means.
GROUP, NAME_OF_COLUMN, OTHER = "trace", "real_contact_area", "trace/distance"
COLUMN = f"{GROUP}/{NAME_OF_COLUMN}"
CHUNK = 65_536
PACKED: dict[str, Any] = {"chunks": (CHUNK,), "shuffle": True, "compression": "gzip"}

Construction = Callable[[h5py.File, Path], object]

LINKS: dict[str, Callable[[h5py.File, Path], object]] = {
    "external link": lambda _, canary: h5py.ExternalLink(str(canary), "/values"),
    "soft link": lambda _, __: h5py.SoftLink(f"/{OTHER}"),
    "soft link to itself": lambda _, __: h5py.SoftLink(f"/{COLUMN}"),
    "another column": lambda file, _: file[OTHER],
    "a group above it": lambda file, _: file["/"],
    "a type": lambda _, __: np.dtype("<f8"),
    "another order of bytes": lambda file, _: file[OTHER][:].astype(">f8"),
    "references": lambda file, _: np.full(len(file[OTHER]), file.ref, h5py.ref_dtype),
    "records": lambda file, _: file[OTHER][:].astype([("x", "<f4"), ("y", "<i4")], casting="unsafe"),
}
"""What stands in the place of a column, by name."""

DATASETS: dict[str, Callable[[int, Path], dict[str, Any]]] = {
    "external storage": lambda rows, canary: {"dtype": "<f8", "external": [(str(canary), 0, 8 * rows)]},
    "a filter that we have not": lambda rows, _: {
        "dtype": "<f8",
        "chunks": (rows,),
        "compression": "lzf",
        "fletcher32": True,
    },
    "texts": lambda rows, _: {"data": ["x" * 1000] * rows, "dtype": h5py.string_dtype()},
    "an enumeration": lambda _, __: {"dtype": h5py.enum_dtype({"a": 0, "b": 1}, "|u1")},
}
"""How a column is made anew, by name, from its number of rows."""

ROWS: dict[str, tuple[int, dict[str, Any]]] = {
    "claimed rows": (10**15, PACKED),
    "claimed rows in one piece": (10**15, {}),
    "no rows": (0, {}),
}
"""Rows of which none is written, and how they are kept."""

ATTRIBUTES: dict[str, tuple[str, str, Any]] = {
    "a long title": ("/", "title", "x" * 10**6),
    "unfinished keys": ("provenance", "scenario_resolved", "{" * 10**5),
    "texts for numbers": ("summary", "mean", ["x"] * 1000),
    "30 MB": ("provenance", "scenario_toml", np.bytes_(b"x" * 30_000_000)),
    "numbers for a text": ("provenance", "command", np.zeros(10**6)),
    "deep keys": ("provenance", "scenario_resolved", np.bytes_(b'{"a":' * 100_000 + b"1" + b"}" * 100_000)),
    "a long number": ("provenance", "scenario_resolved", np.bytes_(b'{"format": ' + b"9" * 10**6 + b"}")),
}
"""An attribute and its value, by name."""


def made_anew(rows: int, layout: dict[str, Any], file: h5py.File, _canary: Path) -> None:
    """Make the columns of a group anew, with so many rows, none of them written."""
    for name, column in list(file[GROUP].items()):
        dtype = column.dtype
        del file[GROUP][name]
        file[GROUP].create_dataset(name, (rows,), dtype, **layout)


def taken(file: h5py.File, name: str = COLUMN) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the values of a column, and remove it."""
    values: np.ndarray[Any, np.dtype[np.float64]] = file[name][:]
    del file[name]
    return values


def linked(made: Callable[[h5py.File, Path], object], file: h5py.File, canary: Path) -> None:
    """Put something else in the place of a column."""
    taken(file)
    file[COLUMN] = made(file, canary)


def stored(made: Callable[[int, Path], dict[str, Any]], file: h5py.File, canary: Path) -> None:
    """Make a column anew."""
    rows = len(taken(file))
    file.create_dataset(COLUMN, (rows,), **made(rows, canary))


def told(owner: str, name: str, value: object, file: h5py.File, _canary: Path) -> None:
    """Replace an attribute."""
    file[owner].attrs[name] = value


def bomb(file: h5py.File, canary: Path) -> None:
    """Pack a gigabyte of zeros into a megabyte of chunks."""
    made_anew(500 * CHUNK, PACKED, file, canary)
    for column in file[GROUP].values():
        packed = zlib.compress(bytes(CHUNK * column.dtype.itemsize), 9)
        for chunk in range(500):
            column.id.write_direct_chunk((chunk * CHUNK,), packed)


def chunk_bomb(file: h5py.File, _canary: Path) -> None:
    """Pack a hundred megabytes into a chunk of half a megabyte."""
    shape = taken(file).shape
    column = file.create_dataset(COLUMN, shape, "<f8", chunks=shape, shuffle=True, compression="gzip")
    column.id.write_direct_chunk((0,), zlib.compress(bytes(10**8), 9))


def unknown_filter(file: h5py.File, _canary: Path) -> None:
    """Have a column pass a filter of a plug-in."""
    values = taken(file)
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_chunk(values.shape)
    creation.set_filter(32_015, h5py.h5z.FLAG_OPTIONAL, (3,))
    space = h5py.h5s.create_simple(values.shape)
    h5py.h5d.create(file.id, COLUMN.encode(), h5py.h5t.IEEE_F64LE, space, creation)
    file[COLUMN].id.write_direct_chunk((0,), values.tobytes())


def virtual_dataset(maxshape: tuple[None] | None, file: h5py.File, canary: Path) -> None:
    """Make a column a view of another file, in which its very length may be found."""
    shape = taken(file).shape
    layout = h5py.VirtualLayout(shape, "<f8", maxshape=maxshape)
    part = slice(None, None if maxshape is None else h5py.h5s.UNLIMITED)
    layout[part] = h5py.VirtualSource(str(canary), "values", shape, maxshape=maxshape)[part]
    file.create_virtual_dataset(COLUMN, layout)


def external_group(file: h5py.File, canary: Path) -> None:
    """Link a group to another file."""
    del file["summary"]
    file["summary"] = h5py.ExternalLink(str(canary), "/")


def nested_groups(file: h5py.File, _canary: Path) -> None:
    """Nest 20 000 groups in the trace."""
    owner = file[GROUP]
    for _ in range(20_000):
        owner = owner.create_group("g")


def many_groups(file: h5py.File, _canary: Path) -> None:
    """Put 20 000 groups beside the columns."""
    for n in range(20_000):
        file[GROUP].create_group(f"g{n}")


def many_attributes(file: h5py.File, _canary: Path) -> None:
    """Keep 2 000 attributes."""
    summary, alone = file["summary"].id, h5py.h5s.create(h5py.h5s.SCALAR)
    for n in range(2_000):  # h5py's own way makes each twice, and looks through all for it
        h5py.h5a.create(summary, f"figure_{n}".encode(), h5py.h5t.IEEE_F64LE, alone).write(np.array(1.0))


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
    for column in (each for group in ("junctions", GROUP, "slider") for each in file[group].values()):
        column[...] = np.resize(wild, column.shape) if column.dtype.kind == "f" else np.iinfo(column.dtype).max


CONSTRUCTIONS: dict[str, Construction] = {
    **{name: partial(linked, made) for name, made in LINKS.items()},
    **{name: partial(stored, made) for name, made in DATASETS.items()},
    **{name: partial(made_anew, *each) for name, each in ROWS.items()},
    **{name: partial(told, *each) for name, each in ATTRIBUTES.items()},
    "a view of another file": partial(virtual_dataset, None),
    "an endless view of another file": partial(virtual_dataset, (None,)),
    **{
        each.__name__: each
        for each in (
            *(bomb, chunk_bomb, unknown_filter, external_group, nested_groups),
            *(many_groups, many_attributes, endless_scenario, wild_numbers),
        )
    },
}
"""How to make each hostile file from a good one, by name."""

# The judge.
SMALL_RUN = {"sliding.distance": "100 um", "output.tick": "0.5 um", "interface.mean_junction_count": 5}
"""What makes a run of Figure 5 a small one."""

VERIFY = ("verify", NAME)

KINDS = {
    "none": (),
    "gzip": ("--set", "output.compression=gzip"),
    "two-way": ("--set", "slider.coupling=two-way"),
}
"""The good files, and the options with which they are run."""

COMMANDS = (
    ("info", NAME),
    ("junctions", NAME, "3"),
    ("junctions", NAME, "--sort", "diameter", "--where", "diameter > 11 um"),
    ("info", NAME, "--json"),
    ("compare", NAME),
    ("export", NAME, "--to", "csv", "-o", "out.csv", "--group", "junctions", "--force"),
    ("listen", NAME, "-o", "out.wav", "--force"),
    ("theory", NAME),
    ("page", NAME, "-o", "out.html", "--force"),
    ("plot", NAME, "trace", "-o", "out.png", "--force"),
    ("plot", NAME, "lives", "-o", "out.svg", "--force"),
    ("run", NAME),
)
ENDS = (0, 2, 3)
"""Done, refused, or found to differ; nothing else may come of a file, whatever is in it."""

OF_VIEWERS = frozenset(("DIMENSION_LIST", "REFERENCE_LIST"))
"""How columns are tied together for viewers; no value of the run."""

MISSED = "changed, and called good"
OPENED, EVENT_BYTES = 0x20, 16
"""Of inotify, by which the kernel of Linux reports what any process opens."""


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


class Judge:
    """Puts files to the commands, in one folder of its own."""

    def __init__(self, folder: Path) -> None:
        """Make the good files, and load now what the commands load, so that no copy has to."""
        self.folder = folder
        self.path = folder / NAME
        self.good: dict[str, bytes] = {}
        self.truth: dict[str, str] = {}
        self.canary = folder / "canary.h5"
        with h5py.File(self.canary, "w") as file:
            file["values"] = np.arange(1000.0)
        small = rubnoise.example("paper/fig5").replace(SMALL_RUN)
        (folder / SCENARIO).write_text(small.to_toml(), encoding="utf-8")
        for kind, options in reversed(KINDS.items()):
            self._load(["run", SCENARIO, "-o", NAME, "--force", *options])
            self.good[kind], self.truth[kind] = self.path.read_bytes(), values(self.path)
        for words in (VERIFY, *COMMANDS):
            self._load(words)

    def make(self, construction: Construction) -> None:
        """Make a hostile file from a good one."""
        self.path.write_bytes(self.good["none"])
        with h5py.File(self.path, "r+") as file:
            construction(file, self.canary)
        os.utime(self.path)

    def judged(self, kind: str, number: int, *, forged: bool) -> Iterator[str]:
        """Yield everything wrong about how the file was taken by verify and by one other command."""
        words = COMMANDS[number % len(COMMANDS)]
        with watched(self.canary) as opened:
            endings = {each: called(each, self.folder) for each in (VERIFY, words)}
        for each, ending in endings.items():
            if fault := ending.fault(*ENDS):
                yield f"{each[0]}: {fault}: {ending.err.strip()[-400:]}"
        if opened:
            yield f"verify or {words[0]}: reads another file"
        unchanged = forged or Child(lambda: int(values(self.path) != self.truth[kind])).end().code == 0
        if endings[VERIFY].code == 0 and not unchanged:
            yield f"verify: {MISSED}"

    def _load(self, words: Sequence[str]) -> None:
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()) as said:
            code = command(words, self.folder)
        if code not in ENDS:
            raise RuntimeError(f"{words}: {said.getvalue()}")


def values(path: Path) -> str:
    """Return one hash of all columns and attributes by name, read with plain h5py; raises whatever that raises."""
    digest = hashlib.sha256()
    with h5py.File(path, "r") as file:
        names = [f"{group}/{column}" for group in file for column in file[group]]
        for name in sorted(["/", *file, *names]):
            owner = file[name]
            content = {key: owner.attrs[key] for key in sorted(set(owner.attrs) - OF_VIEWERS)}
            if name in names:
                content[""] = owner[()]
            for key, each in content.items():
                value = np.asarray(each)
                digest.update(f"{name} {key} {value.dtype} {value.shape}".encode() + value.tobytes())
    return digest.hexdigest()


def mutations(seed: int, numbers: Sequence[int]) -> Outcome:
    """Judge damaged files by their numbers; return how many of each damage there were, and what was found."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as name:
        judge, kinds = Judge(Path(name)), list(KINDS)
        for number in numbers:
            kind, other = (kinds[each % len(kinds)] for each in (number, number + 1))
            random, changed = chance(seed, number), bytearray(judge.good[kind])
            damage = random.choice(DAMAGES)
            damage(changed, judge.good[other], random)
            judge.path.write_bytes(changed)
            outcome.counts[damage.__name__] += 1
            found = judge.judged(kind, number // len(KINDS), forged=damage is sealed_header)
            outcome.find(f"{damage.__name__} {number}", found)
    return outcome


def constructions(_seed: int, numbers: Sequence[int]) -> Outcome:
    """Judge every hostile construction with every command."""
    outcome = Outcome()
    with tempfile.TemporaryDirectory(prefix="rubnoise-fuzz-") as place:
        judge, names = Judge(Path(place)), list(CONSTRUCTIONS)
        for name in (names[number] for number in numbers):
            judge.make(CONSTRUCTIONS[name])
            outcome.counts["hostile"] += 1
            for number in range(len(COMMANDS)):
                outcome.find(name, judge.judged("none", number, forged=True))
    return outcome


def main() -> int:
    """Throw the files, print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--count", type=int, default=1000, help="damaged files (1000)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the damage (1)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (2)")
    parser.add_argument("--only", type=int, nargs="+", help="the numbers of the damaged files to throw once more")
    asked = parser.parse_args()
    thrown: dict[Callable[[int, Sequence[int]], Outcome], Sequence[int]] = {mutations: asked.only or range(asked.count)}
    if asked.only is None:
        thrown[constructions] = range(len(CONSTRUCTIONS))
    outcome = Outcome()
    with ProcessPoolExecutor(asked.jobs) as pool:
        tasks = [(task, numbers[job :: asked.jobs]) for task, numbers in thrown.items() for job in range(asked.jobs)]
        for each in [pool.submit(task, asked.seed, share) for task, share in tasks]:
            outcome.counts += each.result().counts
            outcome.findings += each.result().findings
    print(f"{outcome.counts.total()} files")
    print(outcome.told())
    return int(bool(outcome.findings))


if __name__ == "__main__":
    sys.exit(main())

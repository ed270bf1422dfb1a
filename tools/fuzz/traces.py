"""Measured traces that are damaged, hostile or of the wrong kind: each is made of its number alone."""

import struct
import tomllib
import zlib
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from random import Random
from typing import Final

import h5py
import numpy as np
from numpy.typing import NDArray
from scipy.io import savemat, wavfile

from fuzz.damage import damaged

Made = tuple[str, list[str]]
"""The name of a file and the options with which it is read."""

SPEED: Final = ["--speed", "1 mm/s"]
ROWS: Final = 3000
_WORDS: Final = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
ODD: Final = (*_WORDS["odd"], "5" * 400, "x" * 140_000)
HEADS: Final = tuple(_WORDS["heads"])
UNITS: Final = (*_WORDS["units"], "N" * 300)
PREAMBLES: Final = (*_WORDS["preambles"], "x" * 2_000_000 + "\n")
PATHS: Final = (*_WORDS["paths"], "x" * 5000)
OPTIONS: Final = (
    *([f"--{name}", value] for name, values in _WORDS["options"].items() for value in values),
    *([f"--{name}"] for name, values in _WORDS["options"].items() if not values),
    ["--column", "x" * 3000],
)


def _smooth(noise: "NDArray[np.float64]", length: int) -> "NDArray[np.float64]":
    return np.convolve(noise, np.ones(length), "same") if noise.size > length else noise


def signal(random: Random) -> "NDArray[np.float64]":
    """Return values of one of many kinds, some of which are nobody's friction."""
    draw = np.random.default_rng(random.getrandbits(32))
    count = random.choice((0, 1, 2, 3, 7, 63, 64, 65, 200, ROWS, ROWS))
    noise = draw.standard_normal(count)
    kinds: tuple[Callable[[], object], ...] = (
        lambda: noise,
        lambda: 50.0 + _smooth(noise, 40),
        lambda: np.cumsum(noise),
        lambda: np.full(count, random.choice((0.0, 5.0, 1e-300, 1e59))),
        lambda: np.arange(count) % 37,
        lambda: np.sign(noise) * 5.0,
        lambda: np.where(np.arange(count) == count // 2, 1e9, 0.0),
        lambda: random.choice((1e300, 1e60, 1e50, 1e-50, 1e-70, 1e-300)) * (50.0 + noise),
        lambda: np.sin(np.pi * np.arange(count)) + 5.0,
        lambda: np.abs(noise) ** 20,
        lambda: np.round(50.0 + _smooth(noise, 60), 1),
        lambda: np.concatenate([50.0 + noise[: count // 2], -50.0 + noise[count // 2 :]]),
    )
    return np.asarray(random.choice(kinds)(), dtype=np.float64)


def table(random: Random, folder: Path) -> Made:
    """Write a table of text with some damage."""
    values = signal(random)
    head = random.choice(HEADS) if random.random() < 0.5 else HEADS[0]
    mark = random.choice(",;\t") if random.random() < 0.3 else ","
    step = random.choice((1e-3, 1e-3, 1e-3, 0.0, -1e-3, 1e-300, 1e300, 1e-6))
    digits = random.choice((3, 6, 9, 0))
    rows = [f"{step * n:.{digits}f}{mark}{value:.6g}" for n, value in enumerate(values.tolist())]
    for _ in range(random.choice((0, 0, 1, 3)) if rows else 0):
        at = random.randrange(len(rows)) if random.random() < 0.6 else random.randrange(min(3, len(rows)))
        changed = (
            f"{rows[at].split(mark)[0]}{mark}{random.choice(ODD)}",
            random.choice(ODD),
            rows[at] + mark + "5",
            rows[at].split(mark)[0],
            rows[random.randrange(len(rows))],
            "",
        )
        rows[at] = random.choice(changed)
    text = (
        random.choice(PREAMBLES)
        + head
        + "\n"
        + random.choice(("", "", "s,mN\n", "s;N\n", "err,err\n"))
        + "\n".join(rows)
    )
    content = text.replace("\n", random.choice(("\n", "\n", "\r\n", "\r"))).encode(
        random.choice(("utf-8",) * 5 + ("utf-16", "utf-8-sig")), "replace"
    )
    return _written(random, folder, "a.csv", content)


def sound(random: Random, folder: Path) -> Made:
    """Write a WAV file with some damage in its header."""
    values = signal(random)
    kind = random.choice(("u1", "<i2", "<i4", "<f4", "<f8"))
    out = BytesIO()
    with np.errstate(all="ignore"):
        wavfile.write(out, random.choice((1, 8000, 44100)), np.clip(values, -1e30, 1e30).astype(kind))
    content = bytearray(out.getvalue())
    for _ in range(random.choice((0, 1, 1, 2))):
        at = random.choice((4, 16, 20, 22, 24, 28, 32, 34, 40))
        content[at : at + 2] = struct.pack("<H", random.choice((0, 1, 2, 3, 7, 8, 255, 65535)))
    return _written(random, folder, "a.wav", bytes(content))


def matlab(random: Random, folder: Path) -> Made:
    """Write a MATLAB file of odd content, or one that unpacks to far more than it has."""
    values = signal(random)
    content: dict[str, object] = {"force": values}
    odd = (
        values.astype(np.complex128),
        values.reshape(-1, 1),
        np.zeros((4, 4)),
        "text",
        {"a": values},
        np.array([values, "x"], dtype=object),
        values > 0,
    )
    if random.random() < 0.5:
        content[random.choice(("force", "b", "t"))] = random.choice(odd)
    out = BytesIO()
    savemat(out, content, do_compression=random.random() < 0.6)
    found = bytearray(out.getvalue())
    if random.random() < 0.2:
        packed = zlib.compress(bytes(random.choice((1 << 20, 1 << 28))), 9)
        found[128:] = struct.pack("<II", 15, len(packed)) + packed
    return _written(random, folder, "a.mat", bytes(found))


def dataset(random: Random, folder: Path) -> Made:
    """Write an HDF5 file of another program, often damaged."""
    values = signal(random)
    with h5py.File(folder / "a.h5", "w") as file:
        file["force"] = random.choice(
            (values, values.astype("f2"), values[:, None], values.astype(np.complex128), np.bytes_(b"x"))
        )
        if random.random() < 0.7:
            file["force"].attrs["units"] = random.choice(("mN", b"N", "parsec", "", 5, "V"))
        if values.size and random.random() < 0.6 and file["force"].ndim == 1:
            file["time"] = random.choice((1e-3, 0.0, -1.0)) * np.arange(values.size)
            file["time"].attrs["units"] = random.choice(("s", "um", "parsec", ""))
            file["time"].make_scale("time")
            file["force"].dims[0].attach_scale(file["time"])
            if random.random() < 0.3:
                del file["time"]
    name, words = _written(random, folder, "a.h5", (folder / "a.h5").read_bytes())
    return name + random.choice((":force", ":/force", "", ":/gone", ":", ":/", ":\n")), words


def odd_path(random: Random, _folder: Path) -> Made:
    """Name what is no file."""
    return _with(random, random.choice(PATHS))


KINDS: Final = (table, table, table, table, sound, matlab, dataset, odd_path)


def made(seed: int, number: int, folder: Path) -> Made:
    """Write the trace of a number, and return its name and the options with which it is read."""
    random = Random(f"{seed} {number}")  # noqa: S311  (damage is no secret)
    with np.errstate(all="ignore"):
        return KINDS[number % len(KINDS)](random, folder)


def _written(random: Random, folder: Path, name: str, content: bytes) -> Made:
    if content and random.random() < 0.25:
        _, content = damaged(content, content, random)
    (folder / name).write_bytes(content)
    return _with(random, name)


def _with(random: Random, name: str) -> Made:
    words = list(SPEED) if random.random() < 0.8 else []
    if random.random() < 0.35:
        words += random.choice(OPTIONS)
    if random.random() < 0.35:
        words += ["--unit", random.choice(UNITS) if random.random() < 0.5 else "mN"]
    if random.random() < 0.3:
        words += ["--rate", "1 kHz"]
    return name, words

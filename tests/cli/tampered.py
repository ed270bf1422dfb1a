"""Sweeps for the tests of the command line: what is in their folders, and changes from outside."""

import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np

from rubnoise.storage.index import POINTS, RUNS, SUMMARIES
from tests.cli.terminal import columns, command, start
from tests.unit.tampering import put_text

# Sweeps for the tests of the command line, and what is in their folders.
TABLE = """
[sweep]
replicates = 3
[sweep.grid]
interface.mean_junction_count = [10, 40]
"""
SLOW = ("--set", "sliding.distance=15 mm", "--set", "output.tick=0.005 um", "--set", "sweep.replicates=4")
"""Changes that make each run last the better part of a second."""


def runs_of(folder: Path) -> dict[str, dict[str, bytes]]:
    """Return the bytes of every column of every run in a folder, by name."""
    return {path.stem: columns(path) for path in sorted((folder / "runs").glob("*.h5"))}


def begin_sweep(folder: Path, *arguments: str | Path, cold: bool = False) -> "subprocess.Popen[str]":
    """Start a sweep in a process of its own, and return it when a run is being written."""
    begun = start(command(*arguments), cold=cold, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(12_000):
        if any((folder / "runs").glob("*.part")) or begun.poll() is not None:
            break
        time.sleep(0.01)
    assert begun.poll() is None, "the sweep ended before it began"
    return begun


# Folders of sweeps, changed from outside: one change for each seed.
ODD: tuple[Any, ...] = (
    None, True, 0, 1, -1, 10**13, 2**63 - 1, 10**400, 1e300, float("nan"), float("inf"), "", "x", "../../x", "a/b",
    "\0", "\ud800", "run", [], [1], [[]], ["x"], ["x.y"], {}, {"x": 1}, {"x": {"y": None}}, [None], [{}], "[" * 5000,
)  # fmt: skip
"""Values that nobody expects."""

NUMBERS = (-(2**63), -(10**13), -1, 3, 6, 7, 10**6, 10**13, 2**63 - 1)
REALS = (float("nan"), float("inf"), -float("inf"), 1e300, -1e300, 0.0, 5e-324)


def tampered(folder: Path, seed: int) -> str:
    """Change one thing in a folder, or two; return what it was."""
    random = Random(seed)  # noqa: S311  (the same changes every time)
    return "; ".join(random.choice(CHANGES)(folder, random) for _ in range(random.choice((1, 1, 2))))


def _odd(random: Random) -> Any:
    return random.choice(ODD)


def _text(folder: Path, random: Random) -> str:
    name = random.choice(("grid", "side_by_side", "scenario_resolved", "scenario_resolved", "title", "scenario_toml"))
    with h5py.File(folder / "index.h5", "r+") as file:
        known = file.attrs[name].decode()
        value = _odd(random)
        if name == "scenario_resolved" and random.random() < 0.7:
            value = json.loads(known)
            section = random.choice([key for key, table in value.items() if isinstance(table, dict)])
            key = random.choice([*value[section], "x"])
            value[section] = _odd(random) if random.random() < 0.2 else value[section] | {key: _odd(random)}
        elif name in {"grid", "side_by_side"} and random.random() < 0.7:
            others = ["interface.mean_junction_count", "sliding.distance", "run.seed", "reason", "x.y", "x", 1]
            value = random.sample(others, random.randint(0, 3))
        text = json.dumps(value) if random.random() < 0.8 else str(value)
        put_text(file, name, text.encode("utf-8", "backslashreplace").decode())
    return f"{name} of the index is {text[:60]!r}"


def _column(folder: Path, random: Random) -> str:
    with h5py.File(folder / "index.h5", "r+") as file:
        names = [f"{RUNS}/{name}" for name in file[RUNS]] + [f"{POINTS}/{name}" for name in file[POINTS]] * 2
        names += [f"{POINTS}/values", f"{RUNS}/point", f"{RUNS}/replicate"] * 5
        name = random.choice(names)
        values = file[name][()]
        change, words = random.choice(WAYS)
        changed = change(values, random)
        del file[name]
        if changed is not None:
            file.create_dataset(name, data=changed)
    return f"/{name} {words}"


def _one_odd(values: Any, random: Random) -> Any:
    kind = values.dtype.kind
    if kind == "S":
        value = _odd(random)
        text = (json.dumps(value) if random.random() < 0.7 else str(value)).encode("utf-8", "backslashreplace")
        values = values.astype(f"S{max(2, len(text), values.dtype.itemsize)}")
        values[random.randrange(values.size)] = text
        return values
    values[random.randrange(values.size)] = random.choice(REALS if kind == "f" else NUMBERS)
    return values


WAYS: tuple[tuple[Callable[[Any, Random], Any], str], ...] = (
    *((_one_odd, "has an odd value"),) * 6,
    (lambda _values, _random: None, "is gone"),
    (lambda values, _random: values[:-1], "is shorter"),
    (lambda values, _random: np.stack([values, values], axis=1), "has two dimensions"),
    (lambda values, _random: np.arange(float(values.size)), "holds doubles"),
    (lambda values, _random: np.full(values.size, b"xx"), "holds texts"),
    (lambda values, _random: np.arange(values.size), "holds whole numbers"),
)


def _more(folder: Path, random: Random) -> str:
    name = random.choice((f"{RUNS}/x", f"{RUNS}/x.y", f"{POINTS}/x", f"{SUMMARIES}/x"))
    with h5py.File(folder / "index.h5", "r+") as file:
        rows = file[POINTS if name.startswith(POINTS) else RUNS]["point"].size
        file.create_dataset(name, data=np.zeros((random.choice((1, rows)), 2)[: random.choice((1, 2))]))
    return f"/{name} is new"


CHANGES = (_text, _text, _column, _column, _column, _more)

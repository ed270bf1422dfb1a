"""Result files of every kind, and values in them changed behind the back of their hashes."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

import rubnoise
from rubnoise.scenario import Scenario, build
from rubnoise.storage.schema import HASH
from rubnoise.storage.seal import read_provenance, read_root, read_summary, seal_of

EVERYTHING: dict[str, dict[str, Any]] = {
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": "0.2 um"},
    "strength": {"mean": "250 MPa"},
    "sliding": {"speed": "1 mm/s", "distance": "700 um"},
    "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
    "output": {"tick": "0.5 um"},
}
"""Fig. 5 in short: two blocks with a slider."""


def scenario_of(*left_out: str, **changes: dict[str, Any]) -> Scenario:
    """Return a scenario like EVERYTHING, with tables and keys changed or left out."""
    names = [name for name in dict.fromkeys([*EVERYTHING, *changes]) if name not in left_out]
    tables = {name: EVERYTHING.get(name, {}) | changes.get(name, {}) for name in names}
    kept = {name: {key: value for key, value in table.items() if value is not None} for name, table in tables.items()}
    return build({"format": 1, **kept})


def run_of(path: Path, *left_out: str, seed: int = 1, **changes: dict[str, Any]) -> Path:
    """Run such a scenario into a file."""
    rubnoise.run(scenario_of(*left_out, **changes), path, seed=seed).close()
    return path


def change(path: Path, column: str, by: Callable[[NDArray[Any]], NDArray[Any]], *, seal: bool = True) -> None:
    """Change a column by a function of its values; ``seal`` writes the hash of what it has become beside it."""
    with h5py.File(path, "r+") as file:
        dataset = file[column]
        values = by(dataset[:]).astype(dataset.dtype)
        dataset[...] = values
        if seal:
            put_text(dataset, HASH, xxhash.xxh3_128(values.tobytes()).hexdigest())


def flip(path: Path, column: str, row: int, bit: int = 0, *, seal: bool = True) -> None:
    """Change one bit of one value; bit 0 is the least of its digits."""

    def flipped(values: NDArray[Any]) -> NDArray[Any]:
        bits = values.copy().view(f"u{values.dtype.itemsize}")
        bits[row] ^= bits.dtype.type(1 << bit)
        return bits.view(values.dtype)

    change(path, column, flipped, seal=seal)


def put(path: Path, column: str, row: int, value: float, *, seal: bool = True) -> None:
    """Set one value."""

    def with_it(values: NDArray[Any]) -> NDArray[Any]:
        values = values.copy()
        values[row] = value
        return values

    change(path, column, with_it, seal=seal)


def tell(path: Path, group: str, name: str, value: object, *, seal: bool = True) -> None:
    """Set an attribute as the program writes it; ``seal`` puts the hash of all attributes right."""
    with h5py.File(path, "r+") as file:
        owner = file[group]
        if isinstance(value, str):
            put_text(owner, name, value)
        else:
            owner.attrs[name] = value
        if seal:
            put_seal(file)


def forget(path: Path, group: str, name: str, *, seal: bool = True) -> None:
    """Take an attribute away."""
    with h5py.File(path, "r+") as file:
        del file[group].attrs[name]
        if seal:
            put_seal(file)


def put_seal(file: h5py.File) -> None:
    """Write the hash of the attributes as they have become."""
    digest = seal_of(read_root(file), read_summary(file), read_provenance(file))
    put_text(file["provenance"], HASH, digest)


def put_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Write a text attribute, in place of an older one, as the program does."""
    raw = text.encode()
    owner.attrs.create(name, np.bytes_(raw), dtype=h5py.string_dtype("utf-8", max(2, len(raw))))

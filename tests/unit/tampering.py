"""Result files of every kind and of given lives, and values changed behind the back of their hashes."""

import json
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xxhash
from numpy.typing import NDArray

import rubnoise
from rubnoise.scenario import Scenario, build
from rubnoise.simulation.state import LiveRows, junction_columns
from rubnoise.storage.format import seal_of
from rubnoise.storage.objects import read_attributes
from rubnoise.storage.reader import RunFile, open_run, read_provenance, read_summary
from rubnoise.storage.schema import HASH, ROOT, Feature
from tests.files.runs import BARE, describe, random_rows, write_run
from tests.files.runs import EVERYTHING as EVERY_FEATURE
from tests.models import model

# Result files of every kind, and values in them changed behind the back of their hashes.
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
    digest = seal_of(read_attributes(file, ROOT), read_summary(file), read_provenance(file))
    put_text(file["provenance"], HASH, digest)


def put_text(owner: h5py.HLObject, name: str, text: str) -> None:
    """Write a text attribute, in place of an older one, as the program does."""
    raw = text.encode()
    owner.attrs.create(name, np.bytes_(raw), dtype=h5py.string_dtype("utf-8", max(2, len(raw))))


# A small result file whose lives are given row by row, for the commands on single junctions.
SPEED = 1000.0
RECORD_END = 30.0
BIRTH = np.array([-9.0, -3.0, 2.0, 4.0, 6.0, 6.0, 20.0, 28.0])
DIAMETER = np.array([5.0, 4.0, 6.0, 5.0, 4.0, 5.0, 5.0, 7.0])
STRENGTH = np.array([250.0, 250.0, 100.0, 300.0, 250.0, 250.0, 250.0, 250.0])
DEPARTURE = np.array([np.inf, np.inf, np.inf, 8.0, 12.0, 11.0, np.inf, np.inf])
"""Row 3 is ended before mid-life, row 4 after it, row 5 at mid-life; 0 peaks before the record and 7 after it."""


def lives_file(path: Path, features: frozenset[Feature] = EVERY_FEATURE, compression: Any = "none") -> RunFile:
    """Write the file and open it; the caller closes it."""
    description = describe(BIRTH.size, 5, features=features, compression=compression)
    interface = {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20}
    resolved = json.dumps({"format": 1, "interface": interface, "sliding": {"distance": f"{RECORD_END} um"}})
    description = replace(description, provenance={**description.provenance, "scenario_resolved": resolved})
    rows: dict[str, Mapping[str, NDArray[Any]]] = dict(random_rows(description))
    contact = model(
        slider=None,
        distance=RECORD_END,
        strength=250.0 if "strength" in features else None,
        speed=SPEED if "speed" in features else None,
    )
    rows["junctions"] = junction_columns(
        contact,
        LiveRows(
            junction=np.arange(BIRTH.size),
            birth=BIRTH,
            diameter=DIAMETER,
            strength=STRENGTH,
            departure=DEPARTURE,
        ),
    )
    write_run(path, description, {name: dict(columns) for name, columns in rows.items()})
    return open_run(path)


def bare_file(path: Path) -> RunFile:
    """Write the same without times and forces."""
    return lives_file(path, BARE)


# Contacts and sliders of every kind, as changes of one small scenario: for tests that ask something of each.
Kind = tuple[tuple[str, ...], dict[str, dict[str, Any]]]
"""Tables to leave out of the scenario of this file, and what to change in others."""


def _kinds(title: str, **everywhere: dict[str, Any]) -> dict[str, Kind]:
    """Return the kinds of one part of kinds.toml, with changes that all of them have."""
    found: dict[str, Kind] = {}
    for name, told in tomllib.loads(Path(__file__).with_name("kinds.toml").read_text(encoding="utf-8"))[title].items():
        changes = {table: {key: None if value == "" else value for key, value in keys.items()}
                   for table, keys in told.items() if table != "without"}  # fmt: skip
        common = {table: keys | changes.get(table, {}) for table, keys in everywhere.items()}
        found[name] = tuple(told.get("without", ())), changes | common
    return found


ONE_WAY, LOADED = _kinds("one-way"), _kinds("under a load")
TWO_WAY = _kinds("two-way", slider={"coupling": "two-way"})

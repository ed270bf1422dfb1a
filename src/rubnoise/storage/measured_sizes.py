"""Measured diameters in files of other programs: a column of text, or a dataset of HDF5. They need no even steps."""

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import NoColumn, Refused
from rubnoise.regular_file import is_hdf5
from rubnoise.scenario.fields import MOST
from rubnoise.storage.foreign_dataset import pieces_of_dataset
from rubnoise.storage.measured import refusing_files
from rubnoise.storage.measured_text import TextTable
from rubnoise.storage.samples import check_values, chosen_column
from rubnoise.units import LENGTH, QuantityError, parse_unit

SMALLEST: Final = 1e-12
LARGEST: Final = 1e12
"""Diameters in um that are possible."""


def read_sizes(path: str, column: str | None) -> tuple[float, ...]:
    """Return the diameters of a column, whose unit is um if it names none; raises Refused, with the line, for others.

    A column is a name or a number from 1 on, of HDF5 the path of a dataset; a table of one column needs none.
    """
    with refusing_files(path):
        pieces = _of_dataset(Path(path), column) if is_hdf5(path) else _of_text(Path(path), column)
        found: list[Doubles] = []
        for piece in pieces:
            found.append(piece)
            if sum(map(len, found)) > MOST:
                raise Refused(f"{path}: has more than {MOST:,} values, which a result keeps at most; take fewer of it")
    if not found:
        raise Refused(f"{path}: has no values")
    return tuple(np.concatenate(found).tolist())


def _of_text(path: Path, column: str | None) -> Iterator[Doubles]:
    table = TextTable(path)
    chosen = chosen_column(path, [head.name for head in table.heads], column, None)
    head = table.heads[chosen]
    size = _size_of(head.unit, f"{table.where}: {head.name}")
    for piece in table.pieces():
        yield _diameters(piece.column(chosen), size, f"{path}: {head.name}", [f"line {at}" for at in piece.numbers])


def _of_dataset(path: Path, name: str | None) -> Iterator[Doubles]:
    if not name:
        raise NoColumn(f'{path}: which dataset? column = "/junctions/diameter" names one')
    what, before = f"{path}: {name}", 0
    for head, values, _ in pieces_of_dataset(path, name):
        places = [f"value {at:,}" for at in range(before + 1, before + 1 + values.size)]
        yield _diameters(values, _size_of(head.unit, what), what, places)
        before += values.size


def _size_of(unit: str, what: str) -> float:
    """Return the size of a unit in um; 1 if there is none."""
    if not unit:
        return 1.0
    try:
        found = parse_unit(unit)
    except QuantityError as problem:
        raise Refused(f"{what}: {problem}") from None
    if found.dimension != LENGTH.dimension:
        raise Refused(f"{what}: has the unit {unit}; diameters are lengths")
    return float(found.size)


def _diameters(values: Doubles, size: float, what: str, places: list[str]) -> Doubles:
    """Return values in um; raises Refused with the first one that is not a diameter."""
    check_values(values, what, places.__getitem__)
    wrong = ~((values * size >= SMALLEST) & (values * size <= LARGEST))
    if wrong.any():
        row = int(np.argmax(wrong))
        why = "must be above 0" if values[row] <= 0.0 else f"possible: {SMALLEST:g} to {LARGEST:g} um"
        path, _, name = what.rpartition(": ")
        raise Refused(f"{path}: {places[row]}: {name} is {values[row]:g}; {why}")
    return values * size

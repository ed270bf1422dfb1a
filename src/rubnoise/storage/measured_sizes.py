"""Measured diameters in files of other programs: a column of text, or a dataset of HDF5. They need no even steps."""

from typing import Final

import numpy as np

from rubnoise.errors import NoColumn, Refused, refusing_files
from rubnoise.regular_file import is_hdf5
from rubnoise.scenario.fields import MOST
from rubnoise.storage.foreign import opened
from rubnoise.storage.measured import check_values, column_of
from rubnoise.unit_spelling import check_unit
from rubnoise.units import LENGTH, unit_or_one

SMALLEST: Final = 1e-12
LARGEST: Final = 1e12
"""Diameters in um that are possible."""


def read_sizes(path: str, column: str | None) -> tuple[float, ...]:
    """Return the diameters of a column, whose unit is um if it names none; raises Refused, with the line, for others.

    A column is a name or a number from 1 on, of HDF5 the path of a dataset; a table of one column needs none.
    """
    with refusing_files(path):
        if is_hdf5(path) and not column:
            raise NoColumn(f'{path}: which dataset? column = "/junctions/diameter" names one')
        source = opened(f"{path}:{column}" if is_hdf5(path) else path)
        number = 0
        if not is_hdf5(path) and (column is not None or len(source.heads) > 1):
            number = column_of(source, column or "", "column")
        head = source.heads[number]
        check_unit(head.unit, f"{source.where}: {head.name}")
        if head.unit and unit_or_one(head.unit).dimension != LENGTH.dimension:
            raise Refused(f"{source.where}: {head.name}: has the unit {head.unit}; diameters are lengths")
        size = float(unit_or_one(head.unit).size)
        values = source.arrays[number]
    if values.size > MOST:
        raise Refused(f"{path}: has more than {MOST:,} values, which a result keeps at most; take fewer of it")
    check_values(source, number)
    wrong = ~((values * size >= SMALLEST) & (values * size <= LARGEST))
    if wrong.any():
        row = int(np.argmax(wrong))
        why = "must be above 0" if values[row] <= 0.0 else f"possible: {SMALLEST:g} to {LARGEST:g} um"
        raise Refused(f"{path}: {source.place(row)}: {head.name} is {values[row]:g}; {why}")
    return tuple((values * size).tolist())

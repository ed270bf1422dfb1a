"""A small result file whose lives are given row by row, for the commands on single junctions."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.record.rows import junction_columns
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.schema import Feature
from tests.format.runs import BARE, EVERYTHING, describe, random_rows, write_run

SPEED = 1000.0
RECORD_END = 30.0
BIRTH = np.array([-9.0, -3.0, 2.0, 4.0, 6.0, 6.0, 20.0, 28.0])
DIAMETER = np.array([5.0, 4.0, 6.0, 5.0, 4.0, 5.0, 5.0, 7.0])
STRENGTH = np.array([250.0, 250.0, 100.0, 300.0, 250.0, 250.0, 250.0, 250.0])
DEPARTURE = np.array([np.inf, np.inf, np.inf, 8.0, 12.0, 11.0, np.inf, np.inf])
STATE = np.array([1, 1, 0, 4, 4, 4, 0, 2], dtype=np.uint8)
"""Row 3 is ended before mid-life, row 4 after it, row 5 at mid-life; 0 peaks before the record and 7 after it."""


def lives_file(path: Path, features: frozenset[Feature] = EVERYTHING, compression: Any = "none") -> RunFile:
    """Write the file and open it; the caller closes it."""
    description = describe(BIRTH.size, 5, features=features, compression=compression)
    description = replace(description, scenario_resolved={"sliding": {"distance": f"{RECORD_END} um"}})
    rows: dict[str, Mapping[str, NDArray[Any]]] = dict(random_rows(description))
    rows["junctions"] = junction_columns(
        first_row=0,
        birth=BIRTH,
        diameter=DIAMETER,
        strength=STRENGTH if "strength" in features else None,
        natural=BIRTH + 2.0 * DIAMETER,
        departure=DEPARTURE,
        state=STATE,
        speed=SPEED if "speed" in features else None,
    )
    write_run(path, description, {name: dict(columns) for name, columns in rows.items()})
    return open_run(path)


def bare_file(path: Path) -> RunFile:
    """Write the same without times and forces."""
    return lives_file(path, BARE)

"""How peers make and keep a run: the tables of rubnoise's result file, written with h5py in the plainest way."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from bench.case import SPEED, STRENGTH, Case, Doubles, Draws

Superpose = Callable[[Case, Doubles, Doubles], tuple[Doubles, Doubles]]
"""Area (um^2) and number of junctions at the ticks, from births and diameters."""

Move = Callable[[Case, Doubles], tuple[Doubles, Doubles]]
"""Displacement (um) and velocity (um/s) at the ticks, from the area."""


def write(
    path: Path,
    case: Case,
    birth: Doubles,
    diameter: Doubles,
    area: Doubles,
    count: Doubles,
    displacement: Doubles,
    velocity: Doubles,
) -> None:
    """Write junctions, trace and slider of a run."""
    tables: dict[str, dict[str, NDArray[Any]]] = {
        "junctions": {"birth_distance": birth, "death_distance": birth + 2.0 * diameter, "diameter": diameter},
        "trace": {"distance": case.ticks, "real_contact_area": area, "junction_count": count.astype(np.uint32)},
        "slider": {
            "time": case.ticks / SPEED,
            "friction_force": STRENGTH * area,
            "displacement": displacement,
            "velocity": velocity,
        },
    }
    with h5py.File(path, "w") as file:
        for group, columns in tables.items():
            for name, values in columns.items():
                file[f"{group}/{name}"] = values


def maker(superpose: Superpose, move: Move) -> Callable[[Case, Draws, Path], None]:
    """Return what makes births, area and motion, and writes them."""

    def run(case: Case, draws: Draws, path: Path) -> None:
        birth, diameter = draws.rows()
        area, count = superpose(case, birth, diameter)
        write(path, case, birth, diameter, area, count, *move(case, area))

    return run

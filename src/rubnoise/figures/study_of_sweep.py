"""A study made of the folder of a sweep."""

from collections.abc import Mapping
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.api.sweep_result import SweepResult
from rubnoise.errors import Refused
from rubnoise.figures.study import Study
from rubnoise.figures.study_of import PointRuns, study_of
from rubnoise.figures.sweep_words import ALL


def quantities_of(sweep: SweepResult) -> tuple[str, ...]:
    """Return the quantities of a sweep that can be drawn, in the order of a summary."""
    return tuple(name for name in ALL if name in sweep.runs)


def study_of_sweep(sweep: SweepResult, quantity: str) -> Study:
    """Return a quantity of a sweep against what is swept, from the runs that are done.

    Raises Refused for a quantity that the sweep does not have, and as `study_of`.
    """
    known = quantities_of(sweep)
    if quantity not in known:
        raise Refused(f'"{quantity[:40]}": no quantity of this sweep; there are {", ".join(known) or "none yet"}')
    return study_of(
        _points(sweep, quantity),
        quantity,
        title=sweep.title,
        units={key: _unit(sweep, key) for key in sweep.keys},
        side_by_side=sweep.side_by_side,
    )


def _points(sweep: SweepResult, quantity: str) -> list[PointRuns]:
    """Return every point with the quantity in its runs; those that are not done have none."""
    point = sweep.runs["point"][:]
    figures, error = sweep.runs[quantity][:], f"{quantity}_standard_error"
    errors = sweep.runs[error][:] if error in sweep.runs else np.full(figures.size, nan)
    columns = {key: sweep.runs[key][:] for key in sweep.keys}
    found = []
    for number, values in enumerate(sweep.values):
        rows = np.flatnonzero(point == number)
        told = errors[rows][np.isfinite(errors[rows])]
        found.append(
            PointRuns(
                values=values,
                numbers=_numbers(columns, int(rows[0])),
                scenario=sweep.scenario(number),
                figures=figures[rows].tolist(),
                standard_error=float(told[0]) if told.size else nan,
            )
        )
    return found


def _numbers(columns: Mapping[str, NDArray[Any]], row: int) -> dict[str, float]:
    return {key: float(values[row]) for key, values in columns.items() if np.issubdtype(values.dtype, np.number)}


def _unit(sweep: SweepResult, key: str) -> str:
    return sweep.runs[key].units

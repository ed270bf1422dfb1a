"""The stored columns of a run, read in panels, so that a longer run needs no more memory."""

from collections.abc import Iterator, Sequence
from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.reader import Rows
from rubnoise.theory.lags import longest_life

PANEL_ROWS: Final = 1 << 18


def panels(rows: Rows, group: str, names: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """Yield the named columns of a group from its first row to its last, a panel at a time; those that it has.

    Raises RunFileRefused for a number that is not finite and a diameter that is not positive.
    """
    there = [name for name in names if name in rows.columns[group]]
    total = rows.rows(group)
    for first in range(0, total, PANEL_ROWS):
        last = min(first + PANEL_ROWS, total)
        panel = {name: rows.column(group, name, first, last) for name in there}
        for name, values in panel.items():
            _check(group, name, first, values)
        yield panel


def _check(group: str, name: str, first: int, values: NDArray[Any]) -> None:
    right = np.isfinite(values) if name != "diameter" else np.isfinite(values) & (values > 0.0)
    if not right.all():
        row = int(np.argmin(right))
        raise RunFileRefused(f"/{group} is damaged: row {first + row} has the {name} {values[row]:g}")


def settled_tick(model: Model) -> int:
    """Return the first tick from which the contact is stationary: after a longest life where the start was empty."""
    return 0 if model.start == "stationary" else ceil(longest_life(model) / model.tick)

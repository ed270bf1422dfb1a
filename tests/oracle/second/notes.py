"""Notes of what second formulas find in the rows of a run: equal bits, values near others, sentences that hold."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Doubles
from rubnoise.runs.verification import Check


class Notes(Check):
    """A check that allows deviations, too."""

    def equal(self, place: str, first_row: int, found: NDArray[Any], expected: ArrayLike) -> None:
        """Compare rows of a column bit for bit with others or with one value."""
        super().equal(place, first_row, found, np.broadcast_to(np.asarray(expected), found.shape))

    def near(self, place: str, first_row: int, found: Doubles, expected: Doubles, allowed: ArrayLike) -> None:
        """Note rows of a column that are farther than allowed from their right values."""
        limit = np.broadcast_to(np.asarray(allowed, dtype=np.float64), found.shape)
        with np.errstate(invalid="ignore", over="ignore"):
            right = np.abs(found - expected) <= limit
        self.note(place, first_row, found, right, lambda row: f"{expected[row]!r}, give or take {limit[row]:.2g}")

    def true(self, place: str, first_row: int, found: NDArray[Any], right: NDArray[np.bool_], expected: str) -> None:
        """Note rows of a column for which a sentence is not true."""
        self.note(place, first_row, found, right, lambda _: expected)

"""Sticks and slips of a two-way slider, from its landmarks: when and how long it stands, and how far it then slides."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from rubnoise.analysis.landmarks import Landmarks
from rubnoise.arrays import Doubles
from rubnoise.record.reader import Rows
from rubnoise.record.rows import LandmarkKind


@dataclass(frozen=True, slots=True, kw_only=True)
class StickSlip:
    """Sticks and slips between two times of a run.

    stick_begin, stick_end: every stick in s, cut off at the two times; stick_times: how long those last that begin and
    end between them, in s; slip_lengths: how far those slips go, in um, from a breakaway to the next stick or turn.
    """

    stick_begin: Doubles
    stick_end: Doubles
    stick_times: Doubles
    slip_lengths: Doubles

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the sticks and slips of a two-way run between two times in s, of ``most`` landmarks at most."""
        found = Landmarks.of(rows, begin, end, most)
        begins, ends, times = found.lasting(LandmarkKind.STICK, LandmarkKind.SLIP)
        breakaways, distance = np.flatnonzero(found.kind == LandmarkKind.SLIP), found.column("distance")
        slipped = breakaways[breakaways + 1 < distance.size]
        return cls(
            stick_begin=begins,
            stick_end=ends,
            stick_times=times,
            slip_lengths=distance[slipped + 1] - distance[slipped],
        )

"""Sticks and slips, read off landmarks that were written by hand."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from rubnoise.analysis.stick_slip import StickSlip
from rubnoise.record.rows import LandmarkKind


@dataclass(frozen=True, kw_only=True)
class Held:
    """Rows of a made-up slider."""

    groups: dict[str, dict[str, Any]]
    columns: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def rows(self, group: str) -> int:
        return len(next(iter(self.groups[group].values())))

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> np.ndarray:
        return np.asarray(self.groups[group][name])[start:stop]


def _held(*landmarks: tuple[float, float, LandmarkKind]) -> Held:
    time, distance, kind = zip(*landmarks, strict=True)
    return Held(groups={"landmarks": {"time": time, "distance": distance, "kind": kind}})


def test_sticks_and_slips_are_those_of_the_landmarks() -> None:
    stick, slip, back, forward = LandmarkKind
    rows = _held(
        (1.0, 5.0, stick), (1.5, 5.0, slip), (1.8, 9.0, back), (2.0, 7.0, forward), (2.5, 8.0, stick), (4.0, 8.0, slip)
    )
    found = StickSlip.of(rows, 0.0, 5.0)
    assert found.stick_begin.tolist() == [1.0, 2.5]
    assert found.stick_end.tolist() == [1.5, 4.0]
    assert found.stick_times.tolist() == [0.5, 1.5]
    assert found.slip_lengths.tolist() == [4.0]  # up to where it turns; the last slip never ends


@pytest.mark.parametrize(
    ("begin", "end", "sticks", "times"),
    [
        (1.2, 5.0, [(1.2, 1.5), (2.5, 4.0)], [1.5]),
        (0.0, 3.0, [(1.0, 1.5), (2.5, 3.0)], [0.5]),
        (2.6, 3.0, [(2.6, 3.0)], []),
        (1.6, 2.0, [], []),
        (0.0, 0.5, [], []),
        (4.5, 5.0, [], []),
    ],
)
def test_sticks_are_cut_off_where_one_stops_looking(
    begin: float, end: float, sticks: list[tuple[float, float]], times: list[float]
) -> None:
    stick, slip, *_ = LandmarkKind
    rows = _held((1.0, 5.0, stick), (1.5, 5.0, slip), (2.5, 8.0, stick), (4.0, 8.0, slip))
    found = StickSlip.of(rows, begin, end)
    assert list(zip(found.stick_begin.tolist(), found.stick_end.tolist(), strict=True)) == sticks
    assert found.stick_times.tolist() == times


def test_of_very_many_landmarks_the_first_are_taken() -> None:
    stick, slip, *_ = LandmarkKind
    rows = _held((1.0, 5.0, stick), (1.5, 5.0, slip), (2.5, 8.0, stick), (4.0, 8.0, slip))
    found = StickSlip.of(rows, 0.0, 9.0, most=3)
    assert (found.stick_begin.tolist(), found.stick_end.tolist()) == ([1.0, 2.5], [1.5, 4.0])
    assert found.stick_times.tolist() == [0.5]

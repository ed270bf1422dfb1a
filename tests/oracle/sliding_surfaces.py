"""Two surfaces slid over each other by brute force: every point at every step, joined in (x, y, s) at once.

A junction is a component of contact in (x, y, s), so nothing has to be decided where patches merge or part. It
shares no code with rubnoise.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

# In one step patches are joined at corners; from one step to the next where they overlap, or do so after a move by a
# point. Each neighbour stands here for one side: (step, x, y).
IN_ONE_STEP = ((0, 0, 1), (0, 1, -1), (0, 1, 0), (0, 1, 1))
TO_THE_NEXT = ((1, -1, 0), (1, 0, 0), (1, 1, 0))

Heights = NDArray[np.float64]


@dataclass(frozen=True)
class Slid:
    """Areas in points of every junction at every step, and which junctions the ends of the run cut."""

    areas: NDArray[np.int64]
    cut: NDArray[np.bool_]

    @property
    def total(self) -> NDArray[np.int64]:
        return np.asarray(self.areas.sum(0))

    @property
    def count(self) -> NDArray[np.int64]:
        """Junctions alive at each step; one whose patch is in two parts counts once."""
        return np.asarray((self.areas > 0).sum(0))

    @property
    def births(self) -> int:
        """Junctions that began after the first step."""
        return int((self.areas[:, 0] == 0).sum())

    @property
    def lives(self) -> NDArray[np.int64]:
        """Steps that each junction lived which no end cuts."""
        return np.asarray((self.areas[~self.cut] > 0).sum(1))


def heights_at(track: Heights, slider: Heights, step: int) -> Heights:
    """The sum of both surfaces, the track moved by so many points against the slider."""
    return np.asarray(np.roll(track, -step, axis=0) + slider)


def slid(track: Heights, slider: Heights, gap: Any, steps: int) -> Slid:
    """Slide by whole points over periodic maps at one gap, or at the gap of each step."""
    contact = touching(track, slider, gap, range(steps))
    count, junction = joined(contact, IN_ONE_STEP + TO_THE_NEXT)
    step = np.flatnonzero(contact) // track.size
    areas = np.bincount(junction * steps + step, minlength=count * steps).reshape(count, steps)
    return Slid(areas, (areas[:, 0] > 0) | (areas[:, -1] > 0))


def patch_counts(track: Heights, slider: Heights, gap: float, steps: Iterable[int]) -> NDArray[np.int64]:
    """Patches at each of some steps, joined at corners and over the edges of periodic maps."""
    return np.array([joined(touching(track, slider, gap, [step]), IN_ONE_STEP)[0] for step in steps])


def areas_at(track: Heights, slider: Heights, gap: float, steps: Sequence[int]) -> NDArray[np.int64]:
    """Points in contact at each of some steps."""
    return np.array([np.count_nonzero(each) for each in touching(track, slider, gap, steps)])


def touching(track: Heights, slider: Heights, gap: Any, steps: Sequence[int]) -> NDArray[np.bool_]:
    """Where `heights_at` exceeds the gap, at each of some steps."""
    points, twice = track.shape[0], np.concatenate([track, track])
    found = np.empty((len(steps), *track.shape), dtype=np.bool_)
    for place, (step, each) in enumerate(zip(steps, np.broadcast_to(gap, len(steps)), strict=True)):
        np.greater(twice[step % points :][:points] + slider, each, out=found[place])
    return found


@njit()
def joined(contact: NDArray[np.bool_], neighbours: tuple[tuple[int, int, int], ...]) -> tuple[int, NDArray[np.int64]]:
    """Return how many components there are, and in which each point in contact is, in their order.

    Maps repeat themselves, steps do not. Of two components that meet the one with the first point takes in the other.
    """
    steps, wide, long = contact.shape
    first = np.arange(contact.sum())
    number = np.empty((2, wide, long), dtype=np.int64)
    told = _numbered(contact[0], number[0], 0)
    for step in range(steps):
        if step + 1 < steps:
            told = _numbered(contact[step + 1], number[(step + 1) % 2], told)
        for x, y in zip(*np.nonzero(contact[step])):  # noqa: B905  (numba has no strict one)
            for on, right, up in neighbours:
                beside = (x + right) % wide, (y + up) % long
                if step + on < steps and contact[step + on][beside]:
                    one, other = _first(first, number[step % 2, x, y]), _first(first, number[(step + on) % 2][beside])
                    first[max(one, other)] = min(one, other)
    count = 0
    for point in range(first.size):  # what it belongs to stands before it, and has its component already
        alone = first[point] == point
        first[point] = count if alone else first[first[point]]
        count += alone
    return count, first


@njit()
def _numbered(contact: NDArray[np.bool_], number: NDArray[np.int64], told: int) -> int:
    """Number the points in contact, and return how many have been told by then."""
    for place, touches in np.ndenumerate(contact):
        if touches:
            number[place] = told
            told += 1
    return told


@njit()
def _first(first: NDArray[np.int64], point: int) -> int:
    """Return the first point of a component, and shorten the way to it."""
    while first[point] != point:
        first[point] = first[first[point]]
        point = first[point]
    return point

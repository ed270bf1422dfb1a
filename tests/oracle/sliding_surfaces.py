"""Two surfaces slid over each other by brute force: every point at every step, labelled in (x, y, s) at once.

A junction is a component of contact in (x, y, s), so nothing has to be decided where patches merge or part. It
shares no code with rubnoise.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

# In one step patches are joined at corners; from one step to the next where they overlap, or do so after a move by a
# point.
NEIGHBOURS = np.zeros((3, 3, 3), dtype=bool)
NEIGHBOURS[1] = True
NEIGHBOURS[::2, :, 1] = True

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
    gaps = np.broadcast_to(gap, steps)
    contact = np.stack([heights_at(track, slider, s) > gaps[s] for s in range(steps)])
    labels, count = ndimage.label(contact, NEIGHBOURS)
    here, there = [], []
    for axis in (1, 2):  # the map repeats itself: patches go on over its edges
        first, last = labels.take(0, axis), labels.take(-1, axis)
        for shift in (-1, 0, 1):
            moved = np.roll(last, shift, axis=1)
            both = (first > 0) & (moved > 0)
            here.append(first[both])
            there.append(moved[both])
    pairs = (np.concatenate(here), np.concatenate(there))
    graph = coo_array((np.ones(pairs[0].size), pairs), shape=(count + 1, count + 1))
    _, component = connected_components(graph, directed=False)
    junction = component[labels[contact]]
    _, junction = np.unique(junction, return_inverse=True)
    step = np.nonzero(contact)[0]
    number = int(junction.max(initial=-1)) + 1
    areas = np.bincount(junction * steps + step, minlength=number * steps).reshape(number, steps)
    return Slid(areas, (areas[:, 0] > 0) | (areas[:, -1] > 0))


def patch_counts(track: Heights, slider: Heights, gap: float, steps: Iterable[int]) -> NDArray[np.int64]:
    """Patches at each of some steps, joined at corners and over the edges of periodic maps."""
    counts = []
    for step in steps:
        contact = heights_at(track, slider, step) > gap
        labels, count = ndimage.label(contact, np.ones((3, 3)))
        pairs = [
            (labels[0][:, None], np.stack([np.roll(labels[-1], k) for k in (-1, 0, 1)], 1)),
            (labels[:, 0][:, None], np.stack([np.roll(labels[:, -1], k) for k in (-1, 0, 1)], 1)),
        ]
        a = np.concatenate([np.broadcast_to(x, y.shape).ravel() for x, y in pairs])
        b = np.concatenate([y.ravel() for _, y in pairs])
        both = (a > 0) & (b > 0)
        graph = coo_array((np.ones(both.sum()), (a[both], b[both])), shape=(count + 1, count + 1))
        counts.append(connected_components(graph, directed=False)[0] - 1)
    return np.array(counts)

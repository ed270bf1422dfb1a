"""Patches counted on the maps: what theory of Gaussian surfaces is compared with."""

from dataclasses import dataclass, field
from math import pi
from typing import Final

import numpy as np
from scipy import ndimage

from rubnoise.arrays import Doubles

FEWEST_PATCHES: Final = 20
LARGEST_SHARE: Final = 0.3
LARGEST_AREA: Final = 0.05
"""Limits of an answer: fewer patches have no statistics, one patch with more of the area carries all, and with more
of the nominal area in contact lives merge (at 3 % births are 20 % off)."""

_TOUCHING: Final = np.ones((3, 3), dtype=np.int8)
"""Points that touch at a corner are of one patch: of the 2 % in contact few would be parted there otherwise."""


@dataclass(frozen=True, slots=True)
class Patches:
    """Patches of contact on a map, by their areas in um^2 from the largest on, of so large a map."""

    areas: Doubles = field(repr=False)
    map_area: float

    @property
    def patch_count(self) -> int:
        """How many patches there are."""
        return int(self.areas.size)

    @property
    def real_contact_area(self) -> float:
        """Their sum in um^2."""
        return float(self.areas.sum())

    @property
    def largest_share(self) -> float:
        """The area of the largest patch over that of all."""
        return float(self.areas[0]) / self.real_contact_area

    @property
    def mean_diameter(self) -> float:
        """The mean of sqrt(4 A/pi) in um."""
        return float(np.sqrt(self.areas * (4.0 / pi)).mean())

    @property
    def relative_spread(self) -> float:
        """Standard deviation of the areas over their mean; that of exponential areas is 1."""
        return float(self.areas.std() / self.areas.mean())


def patches(heights: Doubles, share: float, spacing: tuple[float, float]) -> Patches:
    """Return the patches of a map above the height that the given share of its points exceeds, spacings in um."""
    count = max(1, round(share * heights.size))
    threshold = np.partition(heights, heights.size - count, axis=None)[heights.size - count]
    labels, _ = ndimage.label(heights >= threshold, _TOUCHING)
    points = np.sort(np.bincount(labels.ravel())[1:])[::-1].astype(np.float64)
    return Patches(points * (spacing[0] * spacing[1]), heights.size * spacing[0] * spacing[1])

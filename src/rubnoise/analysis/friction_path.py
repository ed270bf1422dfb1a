"""What the friction force does along a path, from the rows of /junctions: int G ds up to any places, life by life."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse


class FrictionIntegral:
    """Gathers P(s) = int_0^s G ds in uN um at places s >= 0 in um, G = sum psi A, while rows of /junctions pass by."""

    def __init__(self, pulse: Pulse, places: Doubles) -> None:
        """Begin with no row; ``places`` may come in any order, and more than once."""
        self._pulse = pulse
        self._places, self._order = np.unique(places, return_inverse=True)
        self._found = np.zeros(self._places.size)
        self.largest = 0.0

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Take in rows of /junctions, whose lives are 2d long."""
        birth, diameter = columns["birth_distance"], columns["diameter"]
        weight = columns["shear_strength"] * diameter**3
        before = self._so_far(np.maximum(-birth, 0.0) / diameter)
        first = np.searchsorted(self._places, birth, side="right")
        last = np.searchsorted(self._places, birth + 2.0 * diameter, side="left")
        # Places inside a life, one pair of row and place each.
        count = np.maximum(last - first, 0)
        row = np.repeat(np.arange(birth.size), count)
        place = np.arange(row.size) - np.repeat(np.cumsum(count) - count, count) + first[row]
        part = self._so_far((self._places[place] - birth[row]) / diameter[row]) - before[row]
        self._found += np.bincount(place, weight[row] * part, self._places.size)
        whole = weight * (self._pulse.life_integral(1) - before)
        self._found += np.cumsum(np.bincount(last, whole, self._places.size + 1))[:-1]
        self.largest = max(self.largest, float(diameter.max(initial=0.0)))

    def at_places(self) -> Doubles:
        """Return P at the places as they were given."""
        found: Doubles = self._found[self._order]
        return found

    def _so_far(self, half_lives: Doubles) -> Doubles:
        """Return the integral of the area over d^2 up to an age over d, over d."""
        rising = self._pulse.area_so_far(np.clip(np.minimum(half_lives, 2.0 - half_lives), 0.0, 1.0))
        return np.where(half_lives <= 1.0, rising, self._pulse.life_integral(1) - rising)

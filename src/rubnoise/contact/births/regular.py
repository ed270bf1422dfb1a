"""Births at one spacing."""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.births.law import BirthLawEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class RegularBirths:
    """Births at one spacing s_jm = L_jm / N_jm, in um, about a place chosen at random: Rabinowicz's births.

    Moments of a gap: mean s_jm, variance 0. Source: Rabinowicz (1956), as in the paper ("at precisely regular
    moments in time").
    """

    mean_spacing: float

    @property
    def mean(self) -> float:
        """The gap in um."""
        return self.mean_spacing

    @property
    def variance(self) -> float:
        """0: every gap is the same."""
        return 0.0

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return the gap in um for each uniform."""
        return np.full(uniform.shape, self.mean_spacing)

    def around(self, uniform: Doubles) -> tuple[float, float]:
        """Return the distances in um from a random place to the births before and after it: their phase is uniform."""
        after = float(self.mean_spacing * uniform[0])
        return self.mean_spacing - after, after

    def places(self, first: float, number: NDArray[np.int64]) -> Doubles:
        """Return the places in um of births by their number after the first one, negative before it.

        Each is computed from the first: if spacings were added one by one, their rounding errors would add up.
        """
        return first + number.astype(np.float64) * self.mean_spacing

    @property
    def dispersion(self) -> float:
        """0: the number of births in a distance is fixed to within one."""
        return 0.0

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return -1: the spectrum of regular births is zero between its lines."""
        return np.full_like(wavenumber, -1.0)

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return 1: all power lies in the lines."""
        return np.ones_like(wavenumber)

    @property
    def memory(self) -> float:
        """Infinite: the phase is never forgotten."""
        return inf


ENTRY = BirthLawEntry(name="regular", about="equal gaps", make=RegularBirths)

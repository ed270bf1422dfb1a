"""When junctions are born: the laws of the sliding distance between one birth and the next."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.deviates import exponential


class BirthLaw(Protocol):
    """A stationary law of births along the sliding distance, each gap with its exact moments."""

    @property
    def mean(self) -> float:
        """Mean gap in um."""
        ...

    @property
    def variance(self) -> float:
        """Variance of a gap in um^2."""
        ...

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform on [0, 1)."""
        ...

    def first_gap(self, uniform: Doubles) -> Doubles:
        """Return the distance in um from a place chosen at random to the next birth, for each uniform on [0, 1)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class PoissonBirths:
    """Births at random: independent exponential gaps of mean s_jm = L_jm / N_jm, in um (paper, second Eq. 12).

    Moments of a gap: mean s_jm, variance s_jm^2; the number of births in a distance s is Poisson(s / s_jm).
    """

    mean_spacing: float

    @property
    def mean(self) -> float:
        """Mean gap in um."""
        return self.mean_spacing

    @property
    def variance(self) -> float:
        """Variance of a gap in um^2."""
        return self.mean_spacing**2

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform on [0, 1)."""
        gaps = exponential(uniform)
        gaps *= self.mean_spacing
        return gaps

    def first_gap(self, uniform: Doubles) -> Doubles:
        """Return the distance in um from a random place to the next birth: the law of a gap, which has no memory."""
        return self.gaps(uniform)


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

    def first_gap(self, uniform: Doubles) -> Doubles:
        """Return distances in um uniform on [0, s_jm): a place at random knows nothing of the births' phase."""
        return self.mean_spacing * uniform

    def places(self, first: float, number: NDArray[np.int64]) -> Doubles:
        """Return where births lie in um that are so many after the first one, or before it where negative.

        Each from the first alone: spacings added up one by one would drift by their rounding, all the same way.
        """
        return first + number.astype(np.float64) * self.mean_spacing

"""When junctions are born: the laws of the sliding distance between one birth and the next."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import exponential


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

    def gaps(self, uniform: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return one gap in um for each uniform on [0, 1)."""
        return self.mean_spacing * exponential(uniform)

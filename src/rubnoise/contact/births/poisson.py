"""Births at random."""

from dataclasses import dataclass

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births.law import BirthLawEntry
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

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform on [0, 1)."""
        gaps = exponential(uniform)
        gaps *= self.mean_spacing
        return gaps

    def around(self, uniform: Doubles) -> tuple[float, float]:
        """Return 0, and the distance in um from a random place to the next birth: the law of a gap has no memory."""
        return 0.0, float(self.gaps(uniform[:1])[0])

    @property
    def dispersion(self) -> float:
        """1: the number of births is Poisson."""
        return 1.0

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return 0: births at random are white."""
        return np.zeros_like(wavenumber)

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return 0: there are no lines."""
        return np.zeros_like(wavenumber)

    @property
    def memory(self) -> float:
        """0 um: births are independent."""
        return 0.0


ENTRY = BirthLawEntry(name="poisson", about="independent exponential gaps of sliding distance", make=PoissonBirths)

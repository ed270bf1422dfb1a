"""Real contact area where at most two junctions are alive: an atom, a singular birth, and cusps."""

from dataclasses import dataclass
from math import exp

import numpy as np
from numpy.typing import NDArray

from rubnoise.theory.live_area import LiveArea
from rubnoise.theory.pair_area import pair_area
from rubnoise.theory.piecewise import Piecewise

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class FewLive:
    """What none, one and two live junctions contribute, their number Poisson of mean ``mean_count``."""

    mean_count: float
    live: LiveArea
    pair_cdf: Piecewise
    pair_density: Piecewise

    def cdf(self, area: Doubles) -> Doubles:
        """Return P(A_r <= a, N <= 2) at areas in um^2."""
        n, a = self.mean_count, np.maximum(area, 0.0)
        known = 1.0 + n * (self.live.cdf(a) + 0.5 * n * self.pair_cdf(np.cbrt(a)))
        return np.where(area < 0.0, 0.0, exp(-n) * known)

    def density(self, area: Doubles) -> Doubles:
        """Return the derivative of it in 1/um^2 at a > 0, and 0 for a <= 0."""
        n, a = self.mean_count, np.clip(area, 0.0, 2.0 * self.live.largest)
        pair = np.where(a == area, self.pair_density(np.cbrt(a)), 0.0)
        return np.where(area > 0.0, exp(-n) * n * (self.live.density(area) + 0.5 * n * pair), 0.0)


def few_live(live: LiveArea, mean_count: float) -> FewLive:
    """Return the contributions of up to two junctions, for one junction's area and a mean count."""
    cdf, density = pair_area(live)
    return FewLive(mean_count=mean_count, live=live, pair_cdf=cdf, pair_density=density)

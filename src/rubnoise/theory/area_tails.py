"""How far real contact area reaches: exponential bounds on both tails of its distribution."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rubnoise.theory.live_area import LiveArea

Doubles = NDArray[np.float64]

_SLOWEST, _FASTEST_UP, _FASTEST_DOWN = 1e-8, 600.0, 1e6
_RATES = 500
_UNLIKELY = 1e-17


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaTails:
    """Bounds ln P(A_r >= a) <= K(q) - q a and ln P(A_r <= a) <= K(-q) + q a, each at its best rate q (1/um^2).

    K(q) = N (E[exp(q b)] - 1), N the mean count and b the area of one live junction. ``furthest`` is an area in um^2
    that no junction exceeds but with probability 1e-17. Source: Chernoff (1952), doi:10.1214/aoms/1177729330.
    """

    furthest: float
    up: tuple[Doubles, Doubles]
    down: tuple[Doubles, Doubles]

    def upper(self, nats: float) -> float:
        """Return an area in um^2 that is exceeded with probability below exp(-nats)."""
        rates, growth = self.up
        return float(np.min((growth + nats) / rates))

    def lower(self, nats: float) -> float:
        """Return an area in um^2 not reached with probability below exp(-nats); 0 if there is none."""
        rates, growth = self.down
        return max(0.0, float(np.max(-(growth + nats) / rates)))

    def nats_above(self, area: float) -> float:
        """Return what -ln P(A_r >= area) is at least."""
        rates, growth = self.up
        return float(np.max(rates * area - growth))


def area_tails(live: LiveArea, mean_count: float) -> AreaTails:
    """Return the bounds for a Poisson number of live areas of so many on average."""
    area, probability = live.rule()
    likely = mean_count * np.cumsum(probability[::-1])[::-1] > _UNLIKELY
    area, probability = area[likely], probability[likely]

    def bounds(fastest: float, sign: float) -> tuple[Doubles, Doubles]:
        rates = np.geomspace(_SLOWEST, fastest, _RATES) / area[-1]
        return rates, mean_count * (np.expm1(sign * np.multiply.outer(rates, area)) @ probability)

    return AreaTails(furthest=float(area[-1]), up=bounds(_FASTEST_UP, 1.0), down=bounds(_FASTEST_DOWN, -1.0))

"""The units of free motion for a model, c, s_0, 1/omega_c and W, and the parameters of a run in them; no compiling."""

from dataclasses import dataclass
from math import sqrt
from typing import Final, Self

from rubnoise.model import FreeSeparation, Model
from rubnoise.simulation.free.encounters import RoughSurface

_FOUR_PER_PI: Final = float.fromhex("0x1.45f306dc9c883p+0")
"""4/pi, rounded once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scales:
    """c and s_0 in um, omega_c in 1/s, W in uN; N; and, in these units, the tick and the speed v = V/(c omega_c)."""

    length: float
    height: float
    rate: float
    load: float
    live: float
    tick: float
    speed: float

    @classmethod
    def of(cls, model: Model, free: FreeSeparation) -> Self:
        """Return the scales: c^2 = 4 A_rm/(pi N), omega_c^2 = W/(m s_0)."""
        held, live = free.held, model.mean_junction_count
        length = sqrt(_FOUR_PER_PI * model.mean_real_contact_area / live)
        rate = sqrt(held.load / held.height_scale / held.mass)
        return cls(
            length=length,
            height=held.height_scale,
            rate=rate,
            load=held.load,
            live=live,
            tick=model.tick / length,
            speed=(model.sliding_speed or 0.0) / (length * rate),
        )

    def surface(self, seed: int) -> RoughSurface:
        """Return the surface over which the slider moves."""
        return RoughSurface.of(self.live, seed, self.tick)

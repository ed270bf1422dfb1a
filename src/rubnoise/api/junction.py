"""One junction of a result."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.record.rows import JunctionState


@dataclass(frozen=True, slots=True, kw_only=True)
class Junction:
    """One junction's row: distances in um, area in um^2; times in s and strength in MPa where the run has them.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     junction = run.junction(17)
    >>> middle = junction.birth_distance + junction.diameter
    >>> bool(np.isclose(junction.area(middle), junction.max_area))
    True
    """

    number: int
    birth_distance: float
    death_distance: float
    life_distance: float
    diameter: float
    max_area: float
    state: JunctionState
    shear_strength: float | None = None
    birth_time: float | None = None
    death_time: float | None = None
    pulse: Pulse = field(default=LENS, repr=False)

    def area(self, distance: ArrayLike) -> NDArray[np.float64]:
        """Return its area in um^2 at sliding distances in um (any shape); 0 before birth and from death on.

        With x = |d - (s - birth_distance)| the lens has A(s) = d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2) (paper Eq. 2), the
        triangle (pi/4) d (d - x): whichever the run has.
        """
        s = np.asarray(distance, dtype=np.float64)
        alive = (self.birth_distance <= s) & (s < self.death_distance)
        return np.where(alive, self.pulse.area(s - self.birth_distance, self.diameter), 0.0)

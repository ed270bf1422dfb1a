"""One junction of a run."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.analysis.life import JunctionRow
from rubnoise.figures import Axes, Figure
from rubnoise.real_numbers import at_each
from rubnoise.storage import schema
from rubnoise.tables import as_html


@dataclass(frozen=True, slots=True, kw_only=True)
class Junction(JunctionRow):
    """One junction's row: distances in um, area in um^2; times in s and strength in MPa if the run has them.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     junction = run.junction(17)
    >>> middle = junction.birth_distance + junction.diameter
    >>> bool(np.isclose(junction.area(middle), junction.max_area))
    True
    """

    def area(self, distance: ArrayLike) -> NDArray[np.float64]:
        """Return its area in um^2 at sliding distances in um (any shape); 0 before birth and from death on.

        With x = |d - (s - birth_distance)| the lens has A(s) = d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2) (paper Eq. 2), the
        triangle (pi/4) d (d - x) and the parabola (pi/4) (d^2 - x^2). A pass that misses the centre line by
        b = lateral_offset has sqrt(x^2 + b^2) for x, with x = 0 at birth_distance + sqrt(d^2 - b^2).
        """
        return at_each(self._area, distance, "distance", "um", (0.0, 0.0))

    def _area(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        alive = (self.birth_distance <= distance) & (distance < self.death_distance)
        return np.where(alive, self.area_at_age(distance - self.birth_distance), 0.0)

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the area over the sliding distance, from birth to death, and return the figure, that of ``ax``."""
        from rubnoise.api.pictures import drawn_columns

        place = np.linspace(self.birth_distance, self.death_distance, 401)
        along = (place, "sliding distance (um)")
        return drawn_columns(along, [(self.area(place), f"area of junction {self.number} (um^2)")], ax)

    def _repr_html_(self) -> str:
        units = {column.name: column.units for column in schema.JUNCTIONS.columns}
        values = {name: getattr(self, name, None) for name in units if name != "junction"}
        rows = [(name, value, units[name]) for name, value in values.items() if value is not None]
        return as_html(f"junction {self.number}", ("", "value", "unit"), rows)

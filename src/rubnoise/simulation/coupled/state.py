"""The state of a two-way slider between two ranges of ticks."""

from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.model import Model
from rubnoise.simulation.coupled.layout import (
    CELL,
    DISPLACEMENT,
    DRIVE,
    FRICTION_WORK,
    NUMBERS,
    OFFSET,
    OVER,
    PHASE,
    RELATIVE,
    REVERSE_WORK,
    ROW,
    ROW_TIME,
    SPACING,
    STEP,
    TIME_STUCK,
    VV_TIME,
    WHOLE,
    X_TIME,
    XX_TIME,
)
from rubnoise.simulation.state import LiveRows

_INTEGRALS: Final = {
    "time_stuck": TIME_STUCK,
    "displacement_integral": X_TIME,
    "displacement_squared_integral": XX_TIME,
    "velocity_squared_integral": VV_TIME,
    "friction_work": FRICTION_WORK,
    "reverse_work": REVERSE_WORK,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledState:
    """The state of a two-way slider and the junctions near it.

    whole and numbers: the values that `motion.advance` changes, at the places in `layout`; rows: junctions that the
    slider may still meet, forward or back, in order of birth; birth_time, death_time (s): when it first passed a birth
    or death, nan before that, -inf for the birth of a junction alive at the start; covered (um): rows include every
    junction that lives beyond this distance.
    """

    whole: Integers
    numbers: Doubles
    rows: LiveRows
    birth_time: Doubles
    death_time: Doubles
    covered: float

    @classmethod
    def start(cls, model: Model, constants: Doubles, alive: LiveRows) -> Self:
        """Return the state at t = 0: s = 0, at rest at the model's displacement, with the junctions alive at the start.

        The row of t = 0 has not been written: the state is one row after the last written one.
        """
        whole, numbers = np.zeros(WHOLE, np.int64), np.zeros(NUMBERS)
        whole[ROW] = -1
        numbers[OVER] = constants[ROW_TIME]
        numbers[DISPLACEMENT] = model.equilibrium_displacement
        numbers[RELATIVE] = model.sliding_speed
        numbers[STEP] = 0.1 / model.slider.natural_angular_frequency if model.slider is not None else 0.0
        return cls(
            whole=whole,
            numbers=numbers,
            rows=alive,
            birth_time=np.where(np.signbit(alive.birth), -np.inf, np.nan),
            death_time=np.full(len(alive), np.nan),
            # An empty contact has no past; in a stationary one, the junctions that died before the start are missing.
            covered=0.0 if model.start == "stationary" else -np.inf,
        )

    def time(self, constants: Doubles) -> float:
        """Return the time in s."""
        return float(self.whole[ROW]) * float(constants[ROW_TIME]) + float(self.numbers[OVER])

    def distance(self, constants: Doubles) -> float:
        """Return the relative sliding distance s in um."""
        return float(self.whole[CELL]) * float(constants[SPACING]) + float(self.numbers[OFFSET])

    @property
    def displacement(self) -> float:
        """Displacement x in um."""
        return float(self.numbers[DISPLACEMENT])

    def velocity(self, constants: Doubles) -> float:
        """Return the velocity x' in um/s."""
        return float(constants[DRIVE] - self.numbers[RELATIVE])

    @property
    def phase(self) -> int:
        """0 in slip, 1 stuck, 2 in reversal."""
        return int(self.whole[PHASE])

    @property
    def integrals(self) -> dict[str, float]:
        """Integrals since t = 0, summed step by step.

        Names and units are those of /balance: time_stuck; int x dt; int x^2 dt; int x'^2 dt; friction_work, which is
        int G |ds| over slip; and reverse_work, its part in reversal.
        """
        return {name: float(self.numbers[place]) for name, place in _INTEGRALS.items()}

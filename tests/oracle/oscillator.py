"""What both slider references are given: a mass on a spring and a damper, and the motion they answer with."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Oscillator:
    """m x'' + c x' + k x = F: mass kg, stiffness N/m, damping N s/m."""

    mass: float
    stiffness: float
    damping: float

    @property
    def natural_rate(self) -> float:
        """Return the undamped rate sqrt(k/m) in rad/s."""
        return math.sqrt(self.stiffness / self.mass)

    @property
    def fastest_rate(self) -> float:
        """Return the larger |root| of m L^2 + c L + k = 0, per second."""
        decay = self.damping / (2 * self.mass)
        if decay <= self.natural_rate:
            return self.natural_rate
        return decay + math.sqrt(decay**2 - self.natural_rate**2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Displacement (um) and velocity (um/s) at given distances, the first of them the start."""

    displacement: Doubles
    velocity: Doubles

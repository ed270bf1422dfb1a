"""The slider's motion from one tick to the next, from the tick itself and the force over what lies between."""

from dataclasses import dataclass
from math import ceil, log2

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.model import Slider
from rubnoise.theory.motion_cumulants import free_motion
from rubnoise.theory.quadrature import panels

_NODES = 20
_HALVINGS = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class CellMotion:
    """What becomes of displacement and velocity over a cell: free (2, 2) of them, gains (2, 3) of the force's moments.

    ``fastest`` is the modulus of the faster exponent of the free motion in 1/s.
    """

    free: Doubles
    gains: Doubles
    fastest: float

    def through(self, moments: Doubles, displacement: Doubles, velocity: Doubles) -> tuple[Doubles, Doubles]:
        """Return displacement (um) and velocity (um/s) where ticks end that begin with those given.

        moments (3, ticks, cells) of the force in each cell of each tick, in uN um.
        """
        for cell in range(moments.shape[2]):
            pushed = self.gains @ moments[:, :, cell]
            displacement, velocity = (
                self.free[row, 0] * displacement + self.free[row, 1] * velocity + pushed[row] for row in (0, 1)
            )
        return displacement, velocity


def cell_motion(slider: Slider, speed: float, width: float) -> CellMotion:
    """Return the motion over a cell of a width in um at a sliding speed in um/s.

    x(h) = (even + a odd) x + odd x' and its derivative, and the i-th gain is (2i + 1)/(m V) int_0^1 g(h (1 - y))
    P_i(2y - 1) dy with g = odd for x and its derivative for x': see `rubnoise.theory.motion_cumulants`.
    """
    free, duration = free_motion(slider), width / speed
    even, odd = (float(value[0]) for value in free(np.array([duration])))
    moved = [
        [even + free.rate * odd, odd],
        [-(free.natural**2) * odd, even - free.rate * odd],
    ]
    # Finer and finer towards the end of the cell, where the answer of an over-damped slider is steep.
    steps = max(_HALVINGS, ceil(log2(max(free.fastest * duration, 1.0))) + _HALVINGS)
    edges = np.concatenate([[0.0], 2.0 ** np.arange(-steps, 1.0)])
    rest, weights = panels(edges, _NODES)
    even_then, odd_then = free(duration * rest)
    answers = np.stack([odd_then, even_then - free.rate * odd_then])
    place = 1.0 - 2.0 * rest
    shapes = np.stack([np.ones_like(place), 3.0 * place, 5.0 * (1.5 * place * place - 0.5)])
    gains = np.einsum("an,in,n->ai", answers, shapes, weights) / (slider.mass * speed)
    return CellMotion(free=np.array(moved), gains=gains, fastest=free.fastest)

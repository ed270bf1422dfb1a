"""The slider's exact motion over one cell of sliding: free motion, and what each moment of the force adds."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Slider

_DIGITS = 150
_DOUBLE_ROOT_SPLIT = "1e-60"
_MOMENTS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Propagator:
    """Constants of one step of the slider: (x, x') gains transition @ (x, x') + gains @ (force moments of the cell).

    transition (2, 2): free motion over a cell less the identity, so that rounding does not turn the phase of a lightly
    damped slider; gains (2, 3): what Legendre moments of the force over distance, int F P_i(2y - 1) ds (uN um), add.
    """

    transition: NDArray[np.float64]
    gains: NDArray[np.float64]
    cells_per_tick: int

    def named(self) -> dict[str, float]:
        """Return every constant by the name that it has in a result: `transition_01` is that in row 0, column 1."""
        named = {"cells_per_tick": float(self.cells_per_tick)}
        for name, matrix in (("transition", self.transition), ("gain", self.gains)):
            for (row, column), value in np.ndenumerate(matrix):
                named[f"{name}_{row}{column}"] = float(value)
        return named


def propagator(slider: Slider, speed: float, tick: float, cells_per_tick: int = 1) -> Propagator:
    """Return the constants of a one-way slider at a sliding speed (um/s) for ticks (um) of so many cells each.

    With the roots L of m L^2 + c L + k = 0, the impulse response g(t) = (e^(L1 t) - e^(L2 t)) / (L1 - L2) and h the
    time of a cell: x(h) = x (L1 e2 - L2 e1)/(L1 - L2) + x' g(h), and the i-th gain of x is
    (2i + 1)/(m V) int_0^1 g(h (1 - y)) P_i(2y - 1) dy; for x' the same with g'.
    At 150 digits, since near critical damping and for short ticks these differences cancel, and rounded once.
    """
    import mpmath

    with mpmath.workdps(_DIGITS):
        step = mpmath.mpf(tick) / mpmath.mpf(speed) / cells_per_tick
        one, two = _roots(slider)
        first, second = mpmath.exp(one * step), mpmath.exp(two * step)
        impulse = (first - second) / (one - two)
        transition = [
            [(one * second - two * first) / (one - two) - 1, impulse],
            [-one * two * impulse, (one * first - two * second) / (one - two) - 1],
        ]
        gains: list[list[Any]] = [[], []]
        for i, (a, b) in enumerate(zip(_legendre(one * step), _legendre(two * step), strict=True)):
            weight = (2 * i + 1) / (mpmath.mpf(slider.mass) * mpmath.mpf(speed) * (one - two))
            gains[0].append(weight * (a - b))
            gains[1].append(weight * (one * a - two * b))
        return Propagator(
            transition=_real(transition),
            gains=_real(gains),
            cells_per_tick=cells_per_tick,
        )


def _roots(slider: Slider) -> tuple[Any, Any]:
    """Return the two roots of m L^2 + c L + k = 0; a double one is split by a relative 1e-60, far below rounding."""
    import mpmath

    decay = mpmath.mpf(slider.damping) / (2 * mpmath.mpf(slider.mass))
    square = decay**2 - mpmath.mpf(slider.stiffness) / mpmath.mpf(slider.mass)
    spread = mpmath.sqrt(square) if square != 0 else decay * mpmath.mpf(_DOUBLE_ROOT_SPLIT)
    return -decay + spread, -decay - spread


def _legendre(z: Any) -> list[Any]:
    """Return int_0^1 e^(z (1 - y)) P_i(2y - 1) dy for i = 0, 1, 2, from powers of y: m_n = (n m_(n-1) - 1) / z."""
    import mpmath

    powers = [(mpmath.exp(z) - 1) / z]
    for n in range(1, _MOMENTS):
        powers.append((n * powers[-1] - 1) / z)
    return [powers[0], 2 * powers[1] - powers[0], 6 * powers[2] - 6 * powers[1] + powers[0]]


def _real(rows: list[list[Any]]) -> NDArray[np.float64]:
    return np.array([[float(value.real) for value in row] for row in rows])

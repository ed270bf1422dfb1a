"""The pulses: how the area of one junction rises and falls over its life.

Two asperities of one diameter d pass each other; their centres are r d apart. The area is d^2 L(r), by shape:

    lens        two circles slide over each other      (acos r - r sqrt(1 - r^2))/2      paper Eq. 2
    triangle    a straight rise and a straight fall    (pi/4) (1 - r)                    Rabinowicz (1956)
    parabola    two paraboloids at a constant gap      (pi/4) (1 - r^2)                  Greenwood and Williamson (1966)

A pass through both centres has r = |d - s|/d at a sliding distance s after its birth, and a life of 2d. A pass at a
lateral offset b has r = sqrt(x^2 + b^2)/d, x being the distance from the closest place: a life of 2 sqrt(d^2 - b^2).
With b uniform on (-d, d), each place of one centre in the disc of radius d about the other is as likely as any, and
averages over lives are integrals over that disc. To add a shape, give its L, its pulse below, and its number in
`simulation.kernel`; a test checks each.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from math import pi
from typing import Final, Literal

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles

Shape = Literal["lens", "triangle", "parabola"]
Offset = Literal["none", "uniform"]


def _lens(r: Doubles) -> Doubles:
    return np.asarray(0.5 * (np.arccos(r) - r * np.sqrt((1.0 - r) * (1.0 + r))), dtype=np.float64)


_OVERLAPS: Final[Mapping[Shape, Callable[[Doubles], Doubles]]] = {
    "lens": _lens,
    "triangle": lambda r: 0.25 * pi * (1.0 - r),
    "parabola": lambda r: 0.25 * pi * (1.0 - r) * (1.0 + r),
}
"""L(r) for 0 <= r <= 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulse:
    """A shape of the area, for passes through both centres or at lateral offsets uniform on (-d, d).

    Averages are over offsets. The mean integral of A^n over a life is c_n d^(2n+1).
    formula: the area as text, x = |d - s|, as result files have it; off the centre x = |s - life/2|, r^2 = x^2 + b^2.
    mean_integral: c_1, rounded once. squared_slope: the mean integral of a'^2 over a life of unit diameter; that of
    A'^2 is d^3 times it. tail: c and p of the level c / (k d)^p about which the mean |A^(k)|^2 over d^6 falls off.
    """

    shape: Shape
    offset: Offset = "none"
    formula: str
    mean_integral: float
    squared_slope: float
    tail: tuple[float, int]

    @property
    def name(self) -> str:
        """The name in tables by pulse: the shape, or "off-centre" and the shape."""
        return self.shape if self.offset == "none" else f"off-centre {self.shape}"

    @property
    def mean_life(self) -> float:
        """The mean life of unit diameter: 2, or pi/2, the mean chord of a disc of radius 1."""
        return 2.0 if self.offset == "none" else 0.5 * pi

    def integral_moment(self, power: int) -> float:
        """Return the mean of (int A ds)^n over a life of unit diameter: 4/9 and 8/27 of the lens for n = 2 and 3."""
        return _integral_moment(self, power)

    def life_integral(self, power: int) -> float:
        """Return c_n: 2 int_0^1 L^n dr, or pi int_0^1 r L^n dr over offsets; of the lens 2/3, pi/3 - 32/45."""
        return self.mean_integral if power == 1 else _life_integral(self, power)

    def life_mean(self) -> float:
        """Return the mean area over lives in units of d^2, c_1 over the mean life: 1/3 of the lens."""
        return self.life_integral(1) / self.mean_life

    def overlap(self, apart: ArrayLike) -> Doubles:
        """Return L(r) for r >= 0 of any shape, and 0 from 1 on: the area of unit diameter whose centres are r apart."""
        return _OVERLAPS[self.shape](np.minimum(np.asarray(apart, dtype=np.float64), 1.0))

    def area(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return A(s; d) of a pass through both centres, in um^2 for s and d in um (they broadcast); 0 outside of it.

        Paper Eq. (2) with segments of height s/2; Eq. (3) as printed adds a length^2 to a length^3 under its root and
        cannot be used.
        """
        d, s = np.asarray(diameter, dtype=np.float64), np.asarray(distance_since_birth, dtype=np.float64)
        return np.asarray(d * d * self.overlap(np.abs(d - s) / d), dtype=np.float64)

    def lives_left(self, lag: Doubles) -> Doubles:
        """Return E[(life - t)+] of unit diameter at lags t >= 0: (2 - t)+, or acos x - x sqrt(1 - x^2), x = t/2."""
        if self.offset == "none":
            return np.maximum(2.0 - lag, 0.0)
        return 2.0 * _lens(np.minimum(0.5 * lag, 1.0))


LENS: Final = Pulse(
    shape="lens",
    formula="d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2)",
    mean_integral=2.0 / 3.0,
    squared_slope=4.0 / 3.0,
    tail=(4.0, 4),  # the slope jumps by -2 at mid-life
)
TRIANGLE: Final = Pulse(
    shape="triangle",
    formula="pi/4 d (d - x)",
    mean_integral=0.25 * pi,
    squared_slope=0.125 * pi**2,
    tail=(0.375 * pi**2, 4),  # by pi/4 at both ends and -pi/2 at mid-life; squares add up
)
PARABOLA: Final = Pulse(
    shape="parabola",
    formula="pi/4 (d^2 - x^2)",
    mean_integral=pi / 3.0,
    squared_slope=pi**2 / 6.0,
    tail=(0.5 * pi**2, 4),  # by pi/2 at both ends
)
OFF_CENTRE_LENS: Final = Pulse(
    shape="lens",
    offset="uniform",
    formula="d^2/2 acos(r/d) - r/2 sqrt(d^2 - r^2)",
    mean_integral=pi**2 / 32.0,
    squared_slope=0.125 * pi,
    tail=(0.5625 * pi**2, 5),  # no pass but the centred one, which never comes, has a kink
)
OFF_CENTRE_PARABOLA: Final = Pulse(
    shape="parabola",
    offset="uniform",
    formula="pi/4 (d^2 - r^2)",
    mean_integral=pi**2 / 16.0,
    squared_slope=pi**3 / 32.0,
    tail=(pi**2 / 3.0, 4),  # two thirds of the parabola's, E[1 - b^2]
)

PULSES: Final[Mapping[str, Pulse]] = {pulse.shape: pulse for pulse in (LENS, TRIANGLE, PARABOLA)}
"""Every pulse through both centres by the name of its shape in a scenario."""

OFF_CENTRE: Final[Mapping[str, Pulse]] = {pulse.shape: pulse for pulse in (OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA)}
"""Every pulse with lateral offsets by the name of its shape."""


def pulse_of(shape: str, offset: str) -> Pulse:
    """Return the pulse of a shape, through both centres or at lateral offsets; raises KeyError if there is none."""
    return PULSES[shape] if offset == "none" else OFF_CENTRE[shape]


def max_area(diameter: Doubles) -> Doubles:
    """Return A_jmax = pi d^2 / 4, the area at full overlap, in um^2 (paper Eq. 4)."""
    return np.asarray(0.25 * np.pi * diameter * diameter, dtype=np.float64)


def half_life(diameter: Doubles, offset: Doubles | None) -> Doubles:
    """Return the sliding distance from birth to mid-life, sqrt(d^2 - b^2) in um; d if there are no offsets."""
    return diameter if offset is None else np.sqrt((diameter - offset) * (diameter + offset))


def area_of(pulse: Pulse, age: ArrayLike, diameter: ArrayLike, offset: ArrayLike | None) -> Doubles:
    """Return areas of junctions in um^2 at sliding distances after birth, in um; 0 outside of lives."""
    if offset is None:
        return pulse.area(age, diameter)
    d, b = np.asarray(diameter, dtype=np.float64), np.asarray(offset, dtype=np.float64)
    x = np.asarray(age, dtype=np.float64) - half_life(d, b)
    return np.asarray(d * d * pulse.overlap(np.hypot(x, b) / d), dtype=np.float64)


def _lens_series(terms: int) -> tuple[float, ...]:
    """Return c_n of the lens at u = 1 - r <= 1, u^1.5 (c_0 + c_1 u + ...); 15 are right to 2e-15, 12 to 8e-13.

    Its slope sqrt(2u - u^2), integrated term by term, at Chebyshev points: there acos and sqrt would cancel.
    """
    n = np.arange(64)
    binomial = np.cumprod(np.concatenate([[1.0], (1.5 - n[1:]) / n[1:]]))
    taylor = Polynomial(np.sqrt(2.0) * binomial * (-0.5) ** n / (n + 1.5))
    fitted = Chebyshev.interpolate(taylor, terms - 1, [0.0, 1.0])
    plain = fitted.convert(kind=Polynomial, domain=[-1.0, 1.0], window=[-1.0, 1.0])
    return tuple(float(each) for each in plain.coef)


LENS_SERIES: Final = _lens_series(12)  # L of the lens over u^1.5, as powers of u = 1 - r, for compiled code

_LONG_SERIES: Final = _lens_series(15)


def peak_areas(shape: Shape, diameter: Doubles, offset: Doubles) -> Doubles:
    """Return the areas at mid-life in um^2 of passes off the centre line, of diameters and offsets in um."""
    if shape == "parabola":
        return max_area(half_life(diameter, offset))
    u = 1.0 - np.abs(offset) / diameter
    return diameter * diameter * (u * np.sqrt(u) * np.polynomial.polynomial.polyval(u, _LONG_SERIES))


@cache
def _life_integral(pulse: Pulse, power: int) -> float:
    """Return 2 int L^n dr or pi int r L^n dr with r = cos y, in which every L is smooth."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    y = 0.25 * pi * (nodes + 1.0)
    r, powers = np.cos(y), np.sin(y) * pulse.overlap(np.cos(y)) ** power
    return float(0.25 * pi * weights @ (2.0 * powers if pulse.offset == "none" else pi * r * powers))


@cache
def _integral_moment(pulse: Pulse, power: int) -> float:
    """Return the mean of (int A ds)^n over offsets of unit diameter; at b it is 2 int_0^sqrt(1 - b^2) L(r) dx."""
    if pulse.offset == "none":
        return pulse.mean_integral**power
    from scipy.integrate import quad  # takes long to load, and few pulses need it

    def over_life(b: float) -> float:
        whole = quad(lambda x: float(pulse.overlap(np.hypot(x, b))), 0.0, (1.0 - b * b) ** 0.5, epsabs=1e-13)
        return float((2.0 * whole[0]) ** power)

    return float(quad(over_life, 0.0, 1.0, epsabs=1e-12, epsrel=1e-12)[0])

"""The pulse shapes: how the area of one junction rises and falls over its life.

This file has the properties of each shape. Its compiled kernel (`simulation`), its Fourier transform and the law of its
live area (`theory`), and the formulas that judge it (`tests/oracle/second`) are tables by shape with an entry for each
of `PULSES`; a test checks every one.
"""

from dataclasses import dataclass
from math import pi, prod
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact import overlap

Shape = Literal["lens", "triangle", "parabola"]
Offset = Literal["none", "uniform"]


class Pulse(Protocol):
    """A shape of the junction's area over a life of 2d; every one reaches pi d^2/4 at s = d, its mirror.

    A(s; d) = d^2 a(s/d), so that the integral of A^n over a life is c_n d^(2n+1).
    """

    def __hash__(self) -> int:
        """Pulses of equal parameters are one: tables are kept by pulse."""
        ...

    @property
    def shape(self) -> Shape:
        """The name of the shape in a scenario."""
        ...

    @property
    def formula(self) -> str:
        """The formula of the area as text, with x = |d - s|, as result files contain it."""
        ...

    @property
    def offset(self) -> Offset:
        """Lateral offsets of passes: "none", or "uniform" up to the diameter on either side."""
        ...

    @property
    def name(self) -> str:
        """The name in tables by pulse: the shape, or "off-centre" and the shape."""
        ...

    @property
    def mean_life(self) -> float:
        """The mean life of unit diameter: 2 for a pass through both centres."""
        ...

    @property
    def tail(self) -> tuple[float, int]:
        """The factor c and the power p of the level c / (k d)^p about which the mean |A^(k)|^2 over d^6 falls off."""
        ...

    @property
    def squared_integral(self) -> float:
        """The mean square of int A ds over a life of unit diameter."""
        ...

    @property
    def cubed_integral(self) -> float:
        """The mean cube of int A ds over a life of unit diameter."""
        ...

    @property
    def squared_slope(self) -> float:
        """The integral of a'^2 over a life of unit diameter; that of A'^2 is d^3 times it."""
        ...

    def area(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return A(s; d) in um^2 for s and d in um (they broadcast), and 0 outside 0 <= s <= 2d."""
        ...

    def slope(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return A'(s; d) = dA/ds in um for s and d in um (they broadcast), and 0 outside 0 <= s <= 2d."""
        ...

    def life_integral(self, power: int) -> float:
        """Return c_n, where the integral of A^n over a life is c_n d^(2n+1) on average."""
        ...

    def lives_left(self, lag: Doubles) -> Doubles:
        """Return E[(life - t)+] of unit diameter at lags t >= 0: (2 - t)+ for a pass through both centres."""
        ...

    def rising_area(self, half_life: Any) -> Any:
        """Return a(u) for 0 <= u = s/d <= 1, an mpmath number at its working precision."""
        ...

    def area_so_far(self, half_life: Doubles) -> Doubles:
        """Return the integral of a(u') from 0 to u, for 0 <= u = s/d <= 1."""
        ...

    def life_mean(self) -> Any:
        """Return the mean area over a life in units of d^2, c_1 / 2, as an mpmath number at its working precision."""
        ...


class _Centred:
    """The properties that all pulses through both centres share."""

    __slots__ = ()

    @property
    def offset(self) -> Offset:
        """None: passes go through both centres."""
        return "none"

    @property
    def mean_life(self) -> float:
        """2."""
        return 2.0

    def lives_left(self, lag: Doubles) -> Doubles:
        """Return (2 - t)+."""
        return np.maximum(2.0 - lag, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class LensPulse(_Centred):
    """The overlap of two circles that slide over each other (paper Eq. 2): life mean d^2/3."""

    @property
    def shape(self) -> Shape:
        """The name of the shape in a scenario."""
        return "lens"

    @property
    def name(self) -> str:
        """The name in tables by pulse."""
        return "lens"

    @property
    def formula(self) -> str:
        """The area in words (paper Eq. 2)."""
        return "d^2/2 acos(x/d) - x/2 sqrt(d^2 - x^2)"

    @property
    def tail(self) -> tuple[float, int]:
        """4 and 4: the slope jumps by -2 at mid-life, and its square is the factor."""
        return 4.0, 4

    @property
    def squared_integral(self) -> float:
        """4/9."""
        return 4.0 / 9.0

    @property
    def cubed_integral(self) -> float:
        """8/27."""
        return 8.0 / 27.0

    @property
    def squared_slope(self) -> float:
        """4/3."""
        return 4.0 / 3.0

    def area(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return the area of the lens in um^2, as `rubnoise.contact.overlap.junction_area` has it."""
        return overlap.junction_area(distance_since_birth, diameter)

    def slope(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return sqrt(s (2d - s)) in um, negative for s > d: the height of the lens."""
        d = np.asarray(diameter, dtype=np.float64)
        s = np.asarray(distance_since_birth, dtype=np.float64)
        return np.asarray(np.sqrt(np.maximum(s * (2.0 * d - s), 0.0)) * np.sign(d - s), dtype=np.float64)

    def life_integral(self, power: int) -> float:
        """Return c_n of the lens: c_1 = 2/3, c_2 = pi/3 - 32/45."""
        return overlap.life_integral(power)

    def rising_area(self, half_life: Any) -> Any:
        """Return (acos x - x sqrt(1 - x^2))/2, x = 1 - u (paper Eq. 2, area over d^2)."""
        import mpmath

        x = 1 - half_life
        return (mpmath.acos(x) - x * mpmath.sqrt((1 - x) * (1 + x))) / 2

    def area_so_far(self, half_life: Doubles) -> Doubles:
        """Return J1 = (y - x acos x - y^3/3)/2, x = 1 - u, y = sqrt(1 - x^2)."""
        x = 1.0 - half_life
        y = np.sqrt((1.0 - x) * (1.0 + x))
        return np.asarray(0.5 * (y - x * np.arccos(x) - y**3 / 3.0), dtype=np.float64)

    def life_mean(self) -> Any:
        """Return 1/3."""
        import mpmath

        return mpmath.mpf(1) / 3


@dataclass(frozen=True, slots=True, kw_only=True)
class TrianglePulse(_Centred):
    """A straight rise to pi d^2/4 and a straight fall: Rabinowicz's approximation of the life; life mean (pi/8) d^2.

    Source: Rabinowicz (1956), as in the paper ("uses a triangular pulse to approximate the life of a junction").
    """

    @property
    def shape(self) -> Shape:
        """The name of the shape in a scenario."""
        return "triangle"

    @property
    def name(self) -> str:
        """The name in tables by pulse."""
        return "triangle"

    @property
    def formula(self) -> str:
        """The area in words."""
        return "pi/4 d (d - x)"

    @property
    def tail(self) -> tuple[float, int]:
        """3 pi^2 / 8 and 4: the slope jumps by pi/4 at both ends and by -pi/2 at mid-life; squares add up."""
        return 0.375 * pi**2, 4

    @property
    def squared_integral(self) -> float:
        """(pi/4)^2."""
        return 0.0625 * pi**2

    @property
    def cubed_integral(self) -> float:
        """(pi/4)^3."""
        return 0.015625 * pi**3

    @property
    def squared_slope(self) -> float:
        """pi^2 / 8."""
        return 0.125 * pi * pi

    def area(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return (pi/4) d (d - |d - s|) in um^2, and 0 outside 0 <= s <= 2d."""
        d = np.asarray(diameter, dtype=np.float64)
        s = np.asarray(distance_since_birth, dtype=np.float64)
        return 0.25 * np.pi * d * np.maximum(np.minimum(s, 2.0 * d - s), 0.0)

    def slope(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return (pi/4) d in um, negative for s > d; 0 at birth, at mid-life and at death, where it jumps."""
        d = np.asarray(diameter, dtype=np.float64)
        s = np.asarray(distance_since_birth, dtype=np.float64)
        return 0.25 * np.pi * d * np.sign(d - s) * ((s > 0.0) & (s < 2.0 * d))

    def life_integral(self, power: int) -> float:
        """Return c_n = 2 (pi/4)^n / (n + 1)."""
        return 2.0 * (0.25 * pi) ** power / (power + 1.0)

    def rising_area(self, half_life: Any) -> Any:
        """Return (pi/4) u."""
        import mpmath

        return mpmath.pi / 4 * half_life

    def area_so_far(self, half_life: Doubles) -> Doubles:
        """Return (pi/8) u^2."""
        return 0.125 * np.pi * np.square(half_life)

    def life_mean(self) -> Any:
        """Return pi/8."""
        import mpmath

        return mpmath.pi / 8


@dataclass(frozen=True, slots=True, kw_only=True)
class ParabolaPulse(_Centred):
    """The overlap of two paraboloids of combined height d^2/(4R) above the gap: life mean (pi/6) d^2.

    R is the radius of one of two equal asperities, which the gap cuts in circles of diameter d. Two rough surfaces that
    slide at constant separation have such lives. Source: Greenwood and Williamson (1966), doi:10.1098/rspa.1966.0242,
    for one asperity; the life follows from the height of two paraboloids whose axes are a distance apart.
    """

    @property
    def shape(self) -> Shape:
        """The name of the shape in a scenario."""
        return "parabola"

    @property
    def name(self) -> str:
        """The name in tables by pulse."""
        return "parabola"

    @property
    def formula(self) -> str:
        """The area in words."""
        return "pi/4 (d^2 - x^2)"

    @property
    def tail(self) -> tuple[float, int]:
        """pi^2 / 2 and 4: the slope jumps by pi/2 at both ends, and nowhere between; squares add up."""
        return 0.5 * pi**2, 4

    @property
    def squared_integral(self) -> float:
        """(pi/3)^2."""
        return pi**2 / 9.0

    @property
    def cubed_integral(self) -> float:
        """(pi/3)^3."""
        return pi**3 / 27.0

    @property
    def squared_slope(self) -> float:
        """pi^2 / 6."""
        return pi * pi / 6.0

    def area(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return (pi/4) s (2d - s) in um^2, and 0 outside 0 <= s <= 2d."""
        d = np.asarray(diameter, dtype=np.float64)
        s = np.asarray(distance_since_birth, dtype=np.float64)
        return 0.25 * np.pi * np.maximum(s * (2.0 * d - s), 0.0)

    def slope(self, distance_since_birth: ArrayLike, diameter: ArrayLike) -> Doubles:
        """Return (pi/2) (d - s) in um; 0 at birth and at death, where it jumps."""
        d = np.asarray(diameter, dtype=np.float64)
        s = np.asarray(distance_since_birth, dtype=np.float64)
        return 0.5 * np.pi * (d - s) * ((s > 0.0) & (s < 2.0 * d))

    def life_integral(self, power: int) -> float:
        """Return c_n = (pi/4)^n sqrt(pi) Gamma(n + 1) / Gamma(n + 3/2), 2 (pi/4)^n times 2j/(2j + 1), j = 1 ... n."""
        return 2.0 * (0.25 * pi) ** power * prod(2.0 * j / (2.0 * j + 1.0) for j in range(1, power + 1))

    def rising_area(self, half_life: Any) -> Any:
        """Return (pi/4) u (2 - u)."""
        import mpmath

        return mpmath.pi / 4 * half_life * (2 - half_life)

    def area_so_far(self, half_life: Doubles) -> Doubles:
        """Return (pi/4) u^2 (1 - u/3)."""
        return 0.25 * np.pi * np.square(half_life) * (1.0 - half_life / 3.0)

    def life_mean(self) -> Any:
        """Return pi/6."""
        import mpmath

        return mpmath.pi / 6


LENS = LensPulse()
TRIANGLE = TrianglePulse()
PARABOLA = ParabolaPulse()
PULSES: dict[str, Pulse] = {pulse.shape: pulse for pulse in (LENS, TRIANGLE, PARABOLA)}
"""Every pulse shape by its name in a scenario."""

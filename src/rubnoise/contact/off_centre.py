"""Junctions that miss each other's centre line: two asperities of one diameter that pass at a lateral offset b.

The area is d^2 L(r) with r = sqrt(x^2 + b^2)/d, x the distance along the line of motion from the closest place and L
the overlap of two circles of unit diameter whose centres are r apart, or (pi/4) (1 - r^2) for two paraboloids. With b
uniform on (-d, d), each place of one centre in the disc of radius d about the other is as likely as any: averages over
lives are integrals over that disc.
"""

from dataclasses import dataclass
from functools import cache
from math import pi
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import PULSES, LensPulse, Offset, ParabolaPulse, Pulse

_NODES = 48


class _OffCentre:
    """The properties that all pulses with lateral offsets uniform on (-d, d) share."""

    __slots__ = ()

    @property
    def offset(self) -> Offset:
        """The lateral offsets of passes, as a scenario names them."""
        return "uniform"

    @property
    def mean_life(self) -> float:
        """pi/2: the mean chord of a disc of radius 1, of uniform offset."""
        return np.pi / 2.0

    def lives_left(self, lag: Doubles) -> Doubles:
        """Return E_b[(life - t)+] of unit diameter at lags t >= 0: acos x - x sqrt(1 - x^2), x = min(t/2, 1)."""
        x = np.minimum(0.5 * lag, 1.0)
        return np.asarray(np.arccos(x) - x * np.sqrt((1.0 - x) * (1.0 + x)), dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class OffCentreLens(_OffCentre, LensPulse):
    """The lens with lateral offsets uniform on (-d, d): mean life (pi/2) d, mean area over a life (pi/16) d^2.

    Averages are over offsets. Functions of the age alone are those of a pass through both centres, as for the lens.
    """

    @property
    def name(self) -> str:
        """The name in tables by pulse."""
        return "off-centre lens"

    @property
    def formula(self) -> str:
        """The area in words, with x = |s - life/2| and r = sqrt(x^2 + b^2)."""
        return "d^2/2 acos(r/d) - r/2 sqrt(d^2 - r^2)"

    @property
    def tail(self) -> tuple[float, int]:
        """(9/16) pi^2 and 5: no pass but the centred one, which never comes, has a kink at mid-life."""
        return 0.5625 * np.pi**2, 5

    @property
    def squared_slope(self) -> float:
        """pi/8."""
        return 0.125 * np.pi

    @property
    def squared_integral(self) -> float:
        """E_b[(int A ds)^2] over d^6, 0.14698975."""
        return _integral_moment(2)

    @property
    def cubed_integral(self) -> float:
        """E_b[(int A ds)^3] over d^9."""
        return _integral_moment(3)

    def life_integral(self, power: int) -> float:
        """Return c_n = pi int_0^1 r L(r)^n dr, where E_b[int A^n ds] = c_n d^(2n+1); c_1 = pi^2/32."""
        return _life_integral(power)

    def life_mean(self) -> Any:
        """Return pi/16, c_1 over the mean life."""
        import mpmath

        return mpmath.pi / 16


@dataclass(frozen=True, slots=True, kw_only=True)
class OffCentreParabola(_OffCentre, ParabolaPulse):
    """The parabola with lateral offsets uniform on (-d, d): mean life (pi/2) d, mean area over a life (pi/8) d^2.

    A pass at an offset b is the parabola of the diameter sqrt(d^2 - b^2). Averages are over offsets. Functions of
    the age alone are those of a pass through both centres, as for the parabola.
    """

    @property
    def name(self) -> str:
        """The name in tables by pulse."""
        return "off-centre parabola"

    @property
    def formula(self) -> str:
        """The area in words, with x = |s - life/2| and r = sqrt(x^2 + b^2)."""
        return "pi/4 (d^2 - r^2)"

    @property
    def tail(self) -> tuple[float, int]:
        """pi^2 / 3 and 4: two thirds of the parabola's, E[1 - b^2]."""
        return pi**2 / 3.0, 4

    @property
    def squared_slope(self) -> float:
        """pi^3 / 32."""
        return pi**3 / 32.0

    @property
    def squared_integral(self) -> float:
        """(16/35) (pi/3)^2, E[(1 - b^2)^3] being 16/35."""
        return 16.0 * pi**2 / 315.0

    @property
    def cubed_integral(self) -> float:
        """(63/512) pi (pi/3)^3, E[(1 - b^2)^(9/2)] being 63 pi / 512."""
        return 63.0 * pi**4 / 13_824.0

    def life_integral(self, power: int) -> float:
        """Return c_n = (pi/2) (pi/4)^n / (n + 1): the area of a live junction is as likely anywhere up to its peak."""
        return 0.5 * pi * (0.25 * pi) ** power / (power + 1.0)

    def life_mean(self) -> Any:
        """Return pi/8, c_1 over the mean life."""
        import mpmath

        return mpmath.pi / 8


def half_life(diameter: Doubles, offset: Doubles | None) -> Doubles:
    """Return the sliding distance from birth to mid-life, sqrt(d^2 - b^2) in um; d if there are no offsets."""
    return diameter if offset is None else np.sqrt((diameter - offset) * (diameter + offset))


def area_of(pulse: Pulse, age: ArrayLike, diameter: ArrayLike, offset: ArrayLike | None) -> Doubles:
    """Return areas of junctions in um^2 at sliding distances s after birth, in um; 0 outside of lives.

    d^2 L(sqrt(x^2 + b^2)/d) with x = s - sqrt(d^2 - b^2); those of the pulse itself if there are no offsets b.
    """
    if offset is None:
        return pulse.area(age, diameter)
    d, b = np.asarray(diameter, dtype=np.float64), np.asarray(offset, dtype=np.float64)
    x = np.asarray(age, dtype=np.float64) - half_life(d, b)
    return np.asarray(d * d * overlap(np.hypot(x, b) / d, pulse), dtype=np.float64)


def overlap(apart: ArrayLike, pulse: Pulse) -> Doubles:
    """Return L(r) for r >= 0 of any shape, and 0 from 1 on: the area of unit diameter whose centres are r apart.

    (acos r - r sqrt(1 - r^2))/2 for the lens and (pi/4) (1 - r^2) for the parabola.
    """
    r = np.minimum(np.asarray(apart, dtype=np.float64), 1.0)
    if pulse.shape == "parabola":
        return np.asarray(0.25 * np.pi * (1.0 - r) * (1.0 + r), dtype=np.float64)
    return np.asarray(0.5 * (np.arccos(r) - r * np.sqrt((1.0 - r) * (1.0 + r))), dtype=np.float64)


@cache
def _life_integral(power: int) -> float:
    """Return pi int r L^n dr with r = cos y, L = (y - sin y cos y)/2, which is smooth in y."""
    x, w = np.polynomial.legendre.leggauss(_NODES)
    y, weights = 0.25 * np.pi * (x + 1.0), 0.25 * np.pi * w
    overlaps = 0.5 * (y - np.sin(y) * np.cos(y))
    return float(np.pi * np.sum(weights * np.sin(y) * np.cos(y) * overlaps**power))


@cache
def _integral_moment(power: int) -> float:
    """Return E_b[(int A ds)^n] over d^(3n) for b = sin(phi) d, whose lives end at x = cos(phi) d.

    A life's integral is 2 int_0^cos(phi) L dx. About phi = 0 it has a term phi^2 ln(phi), so panels come closer there.
    """
    edges = 0.5 * np.pi * np.append(0.0, 0.25 ** np.arange(16.0, -1.0, -1.0))
    x, w = np.polynomial.legendre.leggauss(16)
    half = 0.5 * np.diff(edges)[:, None]
    phi = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * x).ravel()
    weights = (half * w).ravel()
    whole = np.array([_life(float(each)) for each in phi])
    return float(np.sum(weights * np.cos(phi) * whole**power))


def _life(phi: float) -> float:
    """Return 2 int_0^cos(phi) L(sqrt(x^2 + sin(phi)^2)) dx; x = sin(phi) sinh(v) takes the turn at x = 0 away."""
    sine, cosine = np.sin(phi), np.cos(phi)
    highest = float(np.arcsinh(cosine / sine))
    edges = np.linspace(0.0, 1.0, 2 + int(highest))
    t, w = np.polynomial.legendre.leggauss(24)
    # The end of a life is a root: v = highest (1 - (1 - u)^2) makes it smooth.
    u = (0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * t).ravel()
    weights = (0.5 * np.diff(edges)[:, None] * w).ravel() * 2.0 * highest * (1.0 - u)
    v = highest * (1.0 - (1.0 - u) ** 2)
    return 2.0 * float(np.sum(weights * sine * np.cosh(v) * overlap(sine * np.cosh(v), OFF_CENTRE_LENS)))


OFF_CENTRE_LENS = OffCentreLens()
OFF_CENTRE_PARABOLA = OffCentreParabola()
OFF_CENTRE: dict[str, Pulse] = {pulse.shape: pulse for pulse in (OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA)}
"""Every pulse with lateral offsets by the name of its shape."""


def pulse_of(shape: str, offset: str) -> Pulse:
    """Return the pulse of a shape, through both centres or at lateral offsets; raises KeyError if there is none."""
    return PULSES[shape] if offset == "none" else OFF_CENTRE[shape]

"""The life of unit diameter: its overlap with itself, its energy spectrum, and its means by age.

A(s; d) = d^2 a(s/d), so averages over sizes need these functions of one variable alone. Of passes off the centre line
they are means over offsets: as each place of one centre in the unit disc about the other is as likely as any, these
are integrals over that disc, and transforms over lines through its own (Bracewell 1956, doi:10.1071/PH560198).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.off_centre import overlap
from rubnoise.contact.pulses import Pulse
from rubnoise.theory.sizes import panels

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

Function = Callable[[Doubles], Doubles]

SETTLED: float = 160.0
"""Phase z = k d from which `settled_energy` has no swing left."""

_STEP_FROM, _STEP_CENTRE, _STEP_WIDTH = 20.0, 90.0, 8.5
_AMPLITUDE_STEP = 1.0 / 64.0
_OFF_CENTRE_END = 256.0
_NODES = 32
_BIRTH_TERMS = 5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnitLife:
    """What lives are counted with, d^power a(s/d): area (power 2) or presence (power 0), as functions of t >= 0.

    overlap: E[int a(s) a(s + t) ds]; mean: E[a(t)]; so_far: E[int_0^t a ds]. A life ends at t = 2 at the latest.
    """

    power: int
    overlap: Function
    mean: Function
    so_far: Function


@cache
def area_life(pulse: Pulse) -> UnitLife:
    """Return the area of a pulse; relative error of each function about 1e-9 of its largest value."""
    if pulse.offset == "none":
        return UnitLife(power=2, overlap=overlaps(pulse, 1, 1), mean=lambda t: pulse.area(t, 1.0), so_far=_grown(pulse))
    mean = cubic_spline(_lags(1024), _off_centre_mean(pulse, _lags(1024)))
    grown = mean.antiderivative()
    return UnitLife(
        power=2, overlap=overlaps(pulse, 1, 1), mean=_within(mean), so_far=lambda t: grown(np.minimum(t, 2.0))
    )


@cache
def count_life(pulse: Pulse) -> UnitLife:
    """Return the count of a life: 1 until it ends."""

    def mean(t: Doubles) -> Doubles:
        if pulse.offset == "none":
            return (t < 2.0).astype(np.float64)
        return np.asarray(np.sqrt(np.maximum(1.0 - 0.25 * t * t, 0.0)), dtype=np.float64)

    return UnitLife(
        power=0, overlap=pulse.lives_left, mean=mean, so_far=lambda t: pulse.mean_life - pulse.lives_left(t)
    )


def _grown(pulse: Pulse) -> Function:
    def so_far(t: Doubles) -> Doubles:
        rising = pulse.area_so_far(1.0 - np.abs(1.0 - np.minimum(t, 2.0)))
        return np.where(t < 1.0, rising, pulse.life_integral(1) - rising)

    return so_far


def _lags(count: int) -> Doubles:
    """Return places from 0 to 2 that lie closer at 0, 1 and 2, where lives and overlaps are least smooth."""
    turned = 0.5 * (1.0 - np.cos(np.pi * np.arange(count + 1) / count))
    return np.concatenate([turned, 1.0 + turned[1:]])


def cubic_spline(places: ArrayLike, values: ArrayLike) -> "CubicSpline":
    """Return the cubic spline through values; scipy is loaded only where something is calculated."""
    from scipy.interpolate import CubicSpline

    return CubicSpline(places, values)


def _within(spline: "CubicSpline") -> Function:
    return lambda t: np.where(t < 2.0, spline(np.minimum(t, 2.0)), 0.0)


@lru_cache(maxsize=64)
def overlaps(pulse: Pulse, i: int, j: int) -> Function:
    """Return q_ij(t) = E[int a(s)^i a(s + t)^j ds] of unit diameter, zero from t = 2 on.

    Relative error of q_11 some 1e-10 of its largest value; of higher powers 1e-6, which errors of errors need.
    """
    if pulse.offset == "none":
        lag = _lags(1024 if i == j == 1 else 128)
        return _within(cubic_spline(lag, _overlap(pulse, lag, i, j)))
    if i == j == 1:
        return _within(cubic_spline(_lags(256), _hankel_overlap(pulse, _lags(256))))
    lag = _lags(32)
    return _within(cubic_spline(lag, np.array([_off_centre_overlap(pulse, each, i, j) for each in lag.tolist()])))


def _overlap(pulse: Pulse, lag: Doubles, i: int, j: int) -> Doubles:
    """Return q_ij by quadrature, cut where either life begins, turns or ends."""
    ends = np.stack([0.0 * lag, np.clip(1.0 - lag, 0.0, None), np.minimum(1.0, 2.0 - lag), 2.0 - lag], axis=-1)
    age, weight = panels(np.sort(ends, axis=-1), _NODES, rooted=True)
    return np.asarray(
        np.sum(weight * pulse.area(age, 1.0) ** i * pulse.area(age + lag[:, None], 1.0) ** j, axis=-1), dtype=np.float64
    )


def amplitude(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return the transform a^(z) about mid-life, z = k d > 0, of a pass through both centres.

    pi H_1(z)/z^2 of the lens (H_1 Struve's), (pi/4) (sin(z/2)/(z/2))^2 of the triangle, pi (sin z - z cos z)/z^3 of
    the parabola.
    """
    from scipy.special import spherical_jn, struve

    z = np.maximum(phase, 1e-6)
    if pulse.shape == "lens":
        return np.asarray(np.pi * struve(1.0, z) / z**2, dtype=np.float64)
    if pulse.shape == "triangle":
        return 0.25 * np.pi * np.sinc(0.5 * z / np.pi) ** 2
    return np.asarray(np.pi * spherical_jn(1, z) / z, dtype=np.float64)


@cache
def _near_amplitude(pulse: Pulse) -> "CubicSpline":
    z = np.arange(0.0, SETTLED + 2.0 * _AMPLITUDE_STEP, _AMPLITUDE_STEP)
    return cubic_spline(z, amplitude(pulse, z))


def _followed_amplitude(pulse: Pulse, phase: Doubles) -> Doubles:
    found = np.asarray(_near_amplitude(pulse)(np.minimum(phase, SETTLED)), dtype=np.float64)
    far = phase > SETTLED
    found[far] = amplitude(pulse, phase[far])
    return found


def energy(pulse: Pulse, phase: ArrayLike) -> Doubles:
    """Return E[|a^(z)|^2] of a life of unit diameter at z = k d >= 0; |A^(k)|^2 is d^6 times it.

    Error below 1e-8 of its value up to z = 16; of passes off the centre line it has no swing from z = 256 on.
    """
    z = np.asarray(phase, dtype=np.float64)
    if pulse.offset != "none":
        near = _off_centre_energy(pulse)(np.minimum(z, _OFF_CENTRE_END)) / (1.0 + np.minimum(z, _OFF_CENTRE_END) ** 5)
        return np.where(z < _OFF_CENTRE_END - 1.0, near, level(pulse, np.maximum(z, 1.0)))
    return np.square(_followed_amplitude(pulse, z))


def level(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return the energy about which the swing of the tail turns, for z from 20 on; error some z^-6 of it."""
    if pulse.offset != "none" or pulse.shape == "triangle":
        factor, power = pulse.tail
        return np.asarray(factor / phase**power, dtype=np.float64)
    inverse = 1.0 / np.square(phase)
    if pulse.shape == "parabola":
        return np.asarray(0.5 * np.pi**2 * inverse**2 * (1.0 + inverse), dtype=np.float64)
    kink = 2.0 * inverse * (1.0 + inverse - 3.0 * inverse**2)
    return np.asarray(kink**2 + np.pi * inverse**2 / phase * (1.0 + 0.375 * inverse), dtype=np.float64)


def settled_energy(pulse: Pulse, phase: ArrayLike) -> Doubles:
    """Return the energy below z = 20, its level above 160, and a smooth blend between.

    Its integral against anything smooth on the scale z = 10 is that of the energy: the blend, an error function of
    width 8.5, holds no component of the swing above exp(-8.5^2/2).
    """
    from scipy.special import erfc

    z = np.asarray(phase, dtype=np.float64)
    kept = 0.5 * erfc((z - _STEP_CENTRE) / (np.sqrt(2.0) * _STEP_WIDTH))
    followed = energy(pulse, np.minimum(z, SETTLED))
    return np.asarray(kept * followed + (1.0 - kept) * level(pulse, np.maximum(z, _STEP_FROM)), dtype=np.float64)


def from_birth(pulse: Pulse, phase: Doubles, *, exact: bool) -> Complexes:
    """Return the transform of the mean life E[a(t)] about its birth, E[int a(t) exp(-i z t) dt], at z = k d >= 0.

    Not ``exact``, only what begins at birth is left of it from z = 160 on, which averages over sizes need.
    """
    from scipy.special import erfc

    if pulse.offset == "none" and exact:
        return np.asarray(np.exp(-1j * phase) * _followed_amplitude(pulse, phase), dtype=np.complex128)
    within = np.minimum(phase, SETTLED)
    if pulse.offset == "none":
        near = np.exp(-1j * within) * _near_amplitude(pulse)(within)
    else:
        near = _from_birth(pulse)(within)
    kept = 0.5 * erfc((phase - _STEP_CENTRE) / (np.sqrt(2.0) * _STEP_WIDTH))
    return np.asarray(kept * near + (1.0 - kept) * _beginning(pulse, np.maximum(phase, _STEP_FROM)))


@cache
def _from_birth(pulse: Pulse) -> "CubicSpline":
    age, weight = panels(np.linspace(0.0, 2.0, 9), 48, rooted=True)
    z = np.arange(0.0, SETTLED + 2.0 * _AMPLITUDE_STEP, _AMPLITUDE_STEP)
    mass = weight * area_life(pulse).mean(age)
    rows = [np.exp(-1j * np.multiply.outer(some, age)) @ mass for some in np.array_split(z, 16)]
    return cubic_spline(z, np.concatenate(rows))


def _beginning(pulse: Pulse, phase: Doubles) -> Complexes:
    """Return the transform of what begins at birth, by the series of a(t) there; off the centre line it is negligible.

    a' = sqrt(t (2 - t)) of the lens, pi/4 of the triangle, (pi/2) (1 - t) of the parabola.
    """
    from scipy.special import binom, gamma

    turn = np.asarray(1j * phase, dtype=np.complex128)
    if pulse.offset != "none":
        return 0.0 * turn
    if pulse.shape == "triangle":
        return np.asarray(0.25 * np.pi / turn**2)
    if pulse.shape == "parabola":
        return np.asarray(0.5 * np.pi * (1.0 - 1.0 / turn) / turn**2)
    order = np.arange(_BIRTH_TERMS)
    series = np.polynomial.Polynomial(np.sqrt(2.0) * binom(0.5, order) * (-0.5) ** order * gamma(order + 1.5))
    return np.asarray(series(1.0 / turn) / (turn**2 * np.sqrt(turn)), dtype=np.complex128)


def _disc_energy(pulse: Pulse, q: Doubles) -> Doubles:
    """Return the square of the transform of the overlap over the disc of offsets, at q > 0 in any direction.

    (pi J_1(q/2)/q)^2 of circles, and pi^2 J_2(q)/q^2 of paraboloids, J_2 = 2 J_1/q - J_0.
    """
    from scipy.special import j0, j1

    if pulse.shape == "parabola":
        return np.asarray(np.square(np.pi**2 * (2.0 * j1(q) / q - j0(q)) / q**2), dtype=np.float64)
    return np.asarray((np.pi * j1(0.5 * q) / q) ** 4, dtype=np.float64)


def _hankel_overlap(pulse: Pulse, lag: Doubles) -> Doubles:
    from scipy.special import j0

    q, weight = panels(np.arange(0.0, 1201.0 if pulse.shape == "lens" else 3001.0, 4.0), 12)
    mass = _disc_energy(pulse, q) * q * weight / (4.0 * np.pi)
    return np.array([float(j0(each * q) @ mass) for each in lag.tolist()])


@cache
def _off_centre_energy(pulse: Pulse) -> "CubicSpline":
    """Return (1 + z^5) E[|a^|^2] up to z = 256, the integral of the energy of the disc over lines across z.

    Polynomials through 20 places on each panel of 4 follow it, and are sampled closely.
    """
    edges, (x, _) = np.arange(0.0, _OFF_CENTRE_END + 1.0, 4.0), panels([-1.0, 1.0], 20)
    across, weight = panels(np.concatenate([np.arange(0.0, 401.0, 2.0), np.geomspace(402.0, 1e4, 60)]), 10)
    z = panels(edges, x.size)[0]
    found = np.array([_disc_energy(pulse, np.hypot(each, across)) @ weight for each in z.tolist()])
    rows = (found / (2.0 * np.pi) * (1.0 + z**5)).reshape(-1, x.size)
    series = np.linalg.solve(np.polynomial.legendre.legvander(x, x.size - 1), rows.T)
    fine = np.linspace(-1.0, 1.0, 513)[:-1]
    values = (np.polynomial.legendre.legvander(fine, x.size - 1) @ series).T
    places = (edges[:-1, None] + 2.0 * (fine + 1.0)).ravel()
    return cubic_spline(places, values.ravel())


def _off_centre_mean(pulse: Pulse, age: Doubles) -> Doubles:
    """Return E_b[a(t)] = int_(t/2)^1 L(r) w/sqrt(1 - w^2) dw, r^2 = 1 + t^2 - 2 t w, w = cos(phi) half the life."""
    last = np.arccos(np.minimum(0.5 * age, 1.0))[:, None]
    phi, weight = panels(last * np.array([0.0, 0.01, 0.1, 1.0]), 24, rooted=True)
    apart = np.hypot((1.0 - age)[:, None], 2.0 * np.sqrt(age)[:, None] * np.sin(0.5 * phi))
    return np.asarray(np.sum(weight * overlap(apart, pulse) * np.cos(phi), axis=-1), dtype=np.float64)


def _off_centre_overlap(pulse: Pulse, lag: float, i: int, j: int) -> float:
    """Return q_ij by quadrature over offsets, closer near the centre line, and places, cut where a centre passes."""
    widest = np.sqrt(max(1.0 - 0.25 * lag * lag, 0.0))
    offset, share = panels(widest * np.array([0.0, 0.02, 0.15, 1.0]), 12, rooted=True)
    half, last = np.full_like(offset, -0.5 * lag), np.sqrt(1.0 - offset * offset) - lag
    place, weight = panels(np.stack([half, np.clip(0.0, half, last), last], axis=-1), 24, rooted=True)
    earlier = overlap(np.hypot(place, offset[:, None]), pulse)
    later = overlap(np.hypot(place + lag, offset[:, None]), pulse)
    return float(share @ np.sum(weight * (earlier**i * later**j + earlier**j * later**i), axis=-1))


_OFFSET_EDGES = 0.5 * np.pi * np.array([0.0, 0.001, 0.01, 0.1, 1.0])
_FAR = 32.0


@cache
def _offsets() -> tuple[Doubles, Doubles]:
    """Return angles phi of offsets b = sin(phi), closer where the tips of areas are sharp, and probabilities."""
    phi, weight = panels(_OFFSET_EDGES, 8)
    return phi, weight * np.cos(phi)


def pass_energies(pulse: Pulse, phase: Doubles) -> tuple[Doubles, Doubles]:
    """Return |a^(z; b)|^2 of passes of unit diameter at some offsets b, a row each, and their probabilities.

    Within 1e-3 and without a swing from z = 32 on, which is plenty for errors of errors. A parabola is one of the
    diameter sqrt(1 - b^2). Of lenses 4 (b/z)^2 K_1(z b)^2 comes from the turn at mid-life, and pi (1 - b^2)^(3/2)/z^5
    from both ends. Passes through both centres have one row, with its swing.
    """
    from scipy.special import k1

    if pulse.offset == "none":
        return energy(pulse, phase)[None], np.ones(1)
    phi, share = _offsets()
    along = (-1, *(1 for _ in phase.shape))
    chord, offset = np.cos(phi).reshape(along), np.sin(phi).reshape(along)
    if pulse.shape == "parabola":
        centred = level(pulse, np.maximum(phase * chord, 1.0))
        return chord**6 * np.where(phase * chord < _FAR, _squared_parabola(phase * chord), 1.5 * centred), share
    near = np.stack([np.interp(phase, _pass_table()[0], row) for row in _pass_table()[1]])
    z = np.maximum(phase, _FAR)
    turn = 2.0 * offset / z * k1(z * offset)
    return np.where(phase < _FAR, near, turn * turn + np.pi * (1.0 - offset**2) ** 1.5 / z**5), share


def _squared_parabola(phase: Doubles) -> Doubles:
    from scipy.special import spherical_jn

    return np.asarray(np.square(np.pi * spherical_jn(1, np.maximum(phase, 1e-6)) / np.maximum(phase, 1e-6)))


@cache
def _pass_table() -> tuple[Doubles, Doubles]:
    """Return phases up to 32, and the squared transform of a lens at every offset there."""
    place, weight = panels([0.0, 0.02, 0.15, 1.0], 32, rooted=True)
    z = np.arange(0.0, _FAR + 0.04, 0.02)
    rows = []
    for angle in _offsets()[0].tolist():
        x = np.cos(angle) * place
        r = np.minimum(np.hypot(x, np.sin(angle)), 1.0)
        area = np.cos(angle) * weight * (np.arccos(r) - r * np.sqrt((1.0 - r) * (1.0 + r)))
        rows.append(np.square(np.cos(np.multiply.outer(z, x)) @ area))
    return z, np.stack(rows)

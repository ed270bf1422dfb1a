"""The life of unit diameter: its overlap with itself, its energy spectrum, and its means by age.

A(s; d) = d^2 a(s/d), so averages over sizes need these functions alone. Off the centre line they are means over
offsets, which are even over a pass's half width.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from math import inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.off_centre import overlap
from rubnoise.contact.pulses import Pulse
from rubnoise.theory.sizes import SETTLED, Function, Spline, panels

_LEVEL_FROM, _PARTED, _END = 20.0, 256.0, 328.0
_TABLE = np.arange(328 * 64 + 1) / 64.0
_STEP_BEFORE, _STEP_WIDTH = 70.0, 12.02  # phases within which a swing that is followed no longer fades
_HANKEL_TERMS = 16
Transform = Callable[[Doubles], Any]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnitLife:
    """What lives are counted with, d^power a(s/d): area (power 2) or presence (power 0), as functions of t >= 0.

    overlap: E[int a(s) a(s + t) ds]; mean: E[a(t)]; so_far: E[int_0^t a ds]; amplitude: the transform about mid-life of
    a pass through both centres, of z = k d. A life ends at t = 2 at the latest.
    """

    power: int
    overlap: Function
    mean: Function
    so_far: Function
    amplitude: Function


@cache
def area_life(pulse: Pulse) -> UnitLife:
    """Return the area of a pulse; relative error of each function about 1e-9 of its largest value."""
    age = _lags(1024)
    centred = pulse.offset == "none"
    mean = Spline(age, pulse.area(age, 1.0) if centred else _off_centre_mean(pulse, age))
    return UnitLife(
        power=2,
        overlap=overlaps(pulse, 1, 1),
        mean=(lambda t: pulse.area(t, 1.0)) if centred else mean,
        so_far=mean.antiderivative(),
        amplitude=partial(amplitude, pulse),
    )


@cache
def count_life(pulse: Pulse) -> UnitLife:
    """Return the count of a life: 1 until it ends."""
    return UnitLife(
        power=0,
        overlap=pulse.lives_left,
        mean=(lambda t: np.heaviside(2.0 - t, 0.0))
        if pulse.offset == "none"
        else (lambda t: np.sqrt(np.maximum(1.0 - 0.25 * t * t, 0.0))),
        so_far=lambda t: pulse.mean_life - pulse.lives_left(t),
        amplitude=lambda z: 2.0 * np.sin(z) / z,
    )


def _lags(count: int) -> Doubles:
    """Return places from 0 to 2 that lie closer at 0, 1 and 2, where lives and overlaps are least smooth."""
    turned = 0.5 * (1.0 - np.cos(np.pi * np.arange(count + 1) / count))
    return np.concatenate([turned, 1.0 + turned[1:]])


@lru_cache(maxsize=64)
def overlaps(pulse: Pulse, i: int, j: int) -> Function:
    """Return q_ij(t) = E[int a(s)^i a(s + t)^j ds] of unit diameter as a spline.

    Error some 1e-9 of the largest value of q_11, and 1e-6 of higher powers, which errors of errors need.
    """
    lags = _lags((1024 if pulse.offset == "none" else 256) if i == j == 1 else 128)
    return Spline(lags, _overlaps_at(pulse, lags, i, j))


def _overlaps_at(pulse: Pulse, lags: Doubles, i: int, j: int, nodes: tuple[int, int] = (12, 24)) -> Doubles:
    """Return q_ij at some lags by quadrature over offsets and places, with some nodes on each panel."""
    lag, offset, share = lags[:, None], np.zeros((lags.size, 1)), np.ones((lags.size, 1))
    if pulse.offset != "none":
        widest = np.sqrt(np.maximum(1.0 - 0.25 * lag * lag, 0.0))
        offset, share = panels(widest * np.array([0.0, 0.02, 0.15, 1.0]), nodes[0], rooted=True)
    first = np.broadcast_to(-0.5 * lag, offset.shape)
    last = np.maximum(np.sqrt(1.0 - offset * offset) - lag, first)
    place, weight = panels(np.stack([first, np.clip(0.0, first, last), last], axis=-1), nodes[1], rooted=True)
    earlier, later = place, place + lag[..., None]
    if pulse.offset == "none":
        earlier, later = (pulse.area(1.0 + each, 1.0) for each in (earlier, later))
    else:
        earlier, later = (overlap(np.hypot(each, offset[..., None]), pulse) for each in (earlier, later))
    both = weight * (earlier**i * later**j + earlier**j * later**i)
    return np.asarray(np.sum(share * np.sum(both, axis=-1), axis=-1), dtype=np.float64)


def _off_centre_mean(pulse: Pulse, age: Doubles) -> Doubles:
    """Return E_b[a(t)] = int L(r) cos(phi) dphi, r^2 = 1 + t^2 - 2 t cos(phi), cos(phi) >= t/2 half the life."""
    last = np.arccos(np.minimum(0.5 * age, 1.0))[:, None]
    phi, weight = panels(last * np.array([0.0, 0.01, 0.1, 1.0]), 24, rooted=True)
    apart = np.hypot((1.0 - age)[:, None], 2.0 * np.sqrt(age)[:, None] * np.sin(0.5 * phi))
    return np.asarray(np.sum(weight * overlap(apart, pulse) * np.cos(phi), axis=-1), dtype=np.float64)


def amplitude(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return the transform a^(z) about mid-life, z = k d > 0, of a pass through both centres, to all digits.

    Lens: pi H_1(z)/z^2 (Struve); triangle: (pi/4) (sin(z/2)/(z/2))^2; parabola: pi (sin z - z cos z)/z^3.
    """
    from scipy.special import spherical_jn, struve

    z = np.maximum(phase, 1e-6)
    if pulse.shape == "lens":
        return np.asarray(np.pi * struve(1.0, z) / z**2, dtype=np.float64)
    if pulse.shape == "triangle":
        return 0.25 * np.pi * np.sinc(0.5 * z / np.pi) ** 2
    return np.asarray(np.pi * spherical_jn(1, z) / z, dtype=np.float64)


def _amplitude(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return `amplitude` to 1e-10 of its largest value and 2e-6 of its own: Struve's function takes long."""
    if pulse.shape == "triangle":
        return amplitude(pulse, phase)
    found, far = np.asarray(_near(pulse)(phase), dtype=np.float64), phase > _PARTED
    if far.any():
        middle, ends = _parts(pulse, phase[far])
        found[far] = middle + 2.0 * (ends * np.exp(1j * phase[far])).real
    return found


def _parts(pulse: Pulse, phase: Doubles) -> tuple[Doubles, Complexes]:
    """Return m and b of a^(z) = m + b e^(i z) + b* e^(-i z), z >= 20: of mid-life, and of birth and death.

    Of lenses b is that of Y_1, and m of H_1 - Y_1 = (2/pi)(1 + 1/z^2 - 3/z^4 + ...).
    """
    inverse = 1.0 / np.square(phase)
    if pulse.shape == "lens":
        middle = 2.0 * inverse * (1.0 + inverse * (1.0 - 3.0 * inverse))
        orders = np.arange(1.0, _HANKEL_TERMS)
        terms = np.cumprod(np.append(1.0, 1j * (4.0 - (2.0 * orders - 1.0) ** 2) / (8.0 * orders)))
        ends = np.exp(-1.25j * np.pi) / np.sqrt(2.0 * np.pi * phase) * np.polynomial.Polynomial(terms)(1.0 / phase)
    elif pulse.shape == "triangle":
        middle, ends = 0.5 * np.pi * inverse, np.full_like(phase, -0.25)
    else:
        middle, ends = np.zeros_like(phase), -0.5 - 0.5j / phase
    return middle, np.asarray(np.pi * inverse * ends, dtype=np.complex128)


@cache
def _near(pulse: Pulse) -> Spline:
    """Return a^(z) up to z = 328, or off the centre line (9 + z^2)^2.5 times the energy, 2 int q_11 cos(z t) dt."""
    if pulse.offset == "none":
        return Spline(_TABLE, amplitude(pulse, _TABLE))
    lag, weight = panels(np.linspace(0.0, 2.0, 21), 32, rooted=True)
    mass = 2.0 * weight * _overlaps_at(pulse, lag, 1, 1, nodes=(24, 32))
    return Spline(_TABLE, _transform(_TABLE, lag, mass).real * (9.0 + _TABLE**2) ** 2.5)


def _transform(phase: Doubles, place: Doubles, mass: Doubles) -> Complexes:
    """Return the sum of mass times exp(-i z place) at phases z."""
    rows = [np.exp(-1j * np.multiply.outer(some, place)) @ mass for some in np.array_split(phase, 64)]
    return np.concatenate(rows)


def energy(pulse: Pulse, phase: ArrayLike, settled: float | Doubles = inf) -> Doubles:
    """Return E[|a^(z)|^2] of a life of unit diameter at z = k d >= 0; |A^(k)|^2 is d^6 times it.

    Error below 1e-7 of its value up to z = 16. From the phase ``settled`` on, at least 160, the swing of the tail is
    left out: the integral against what is smooth over z = 10 stays the same. Off the centre line that is 328 at most.
    """

    def followed(z: Doubles) -> Doubles:
        if pulse.offset == "none":
            return np.square(_amplitude(pulse, z))
        return np.asarray(_near(pulse)(z) / (9.0 + z * z) ** 2.5, dtype=np.float64)

    last = settled if pulse.offset == "none" else np.minimum(settled, _END)
    return _faded(np.asarray(phase, dtype=np.float64), last, followed, partial(_level, pulse)).real


def _level(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return the energy about which the swing of the tail turns, for z from 20 on; error some z^-6 of it."""
    if pulse.offset != "none":
        factor, power = pulse.tail
        return np.asarray(factor / phase**power, dtype=np.float64)
    middle, birth = _parts(pulse, phase)
    return np.asarray(np.square(middle) + 2.0 * np.square(np.abs(birth)), dtype=np.float64)


def _faded(z: Doubles, settled: float | Doubles, followed: Transform, rest: Transform) -> Complexes:
    """Return one function up to some phases and another from 70 before ``settled`` on, by an error function."""
    from scipy.special import erfc

    kept = np.broadcast_to(0.5 * erfc((z - settled + _STEP_BEFORE) / _STEP_WIDTH), z.shape)
    found = np.zeros(z.shape, dtype=np.complex128)
    inside, beyond = kept > 0.0, kept < 1.0
    found[inside] = followed(z[inside])
    share = kept[beyond]
    found[beyond] = share * found[beyond] + (1.0 - share) * rest(np.maximum(z[beyond], _LEVEL_FROM))
    return found


def from_birth(pulse: Pulse, phase: Doubles, settled: float | Doubles = inf) -> Complexes:
    """Return the transform of the mean life about its birth, E[int a(t) exp(-i z t) dt], at z = k d >= 0.

    From ``settled`` on only what begins at birth is left of it; off the centre line that is negligible from z = 160 on.
    """
    if pulse.offset != "none":
        return _faded(phase, SETTLED, _mean_from_birth(pulse), np.zeros_like)
    return _faded(phase, settled, lambda z: np.exp(-1j * z) * _amplitude(pulse, z), lambda z: _parts(pulse, z)[1])


@cache
def _mean_from_birth(pulse: Pulse) -> Spline:
    """Return the transform of the mean life off the centre line up to z = 161, by quadrature over ages."""
    age, weight = panels(np.linspace(0.0, 2.0, 9), 48, rooted=True)
    mass, z = weight * area_life(pulse).mean(age), _TABLE[_TABLE < SETTLED + 1.0]
    return Spline(z, _transform(z, age, mass))


def pass_energies(pulse: Pulse, phase: Doubles) -> tuple[Doubles, Doubles]:
    """Return |a^(z; b)|^2 of passes of unit diameter at some offsets b, a row each, and their probabilities.

    Within 1e-3, which is plenty for errors of errors; from z = 32 on, where it is small, the mean of all offsets.
    """
    if pulse.offset == "none":
        return energy(pulse, phase)[None], np.ones(1)
    z, rows, shares = _passes(pulse)
    near = np.stack([np.interp(phase, z, row) for row in rows])
    return np.where(phase < z[-1], near, energy(pulse, phase, SETTLED)), shares


@cache
def _passes(pulse: Pulse) -> tuple[Doubles, list[Doubles], Doubles]:
    """Return phases up to 32, squared transforms there of passes at offsets sin(phi), and their probabilities."""
    phi, weight = panels(0.5 * np.pi * np.array([0.0, 0.001, 0.01, 0.1, 1.0]), 8)
    place, mass = panels([0.0, 0.02, 0.15, 1.0], 32, rooted=True)
    z, halves = np.arange(0.0, 32.01, 0.02), np.cos(phi)
    areas = [
        2.0 * half * mass * overlap(np.hypot(half * place, np.sin(turn)), pulse)
        for half, turn in zip(halves, phi, strict=True)
    ]
    rows = [np.square(_transform(z, half * place, area).real) for half, area in zip(halves, areas, strict=True)]
    return z, rows, weight * halves

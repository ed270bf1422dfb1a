"""The life of unit diameter: its overlap with itself, its energy spectrum, and its means by age.

A(s; d) = d^2 a(s/d), so averages over sizes need these functions alone. Off the centre line they are means over
offsets, which are even over a pass's half width.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from math import erfc, inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.theory.sizes import SETTLED, Function, Table, panels

_FAR, _END, _TERMS = 200.0, 328.0, 6
_STEP_BEFORE, _STEP_WIDTH, _NONE = 70.0, 12.02, 1e-11  # of the step from a swing that is followed to none
_CLOSE = 0.5 * 2.0 ** -np.arange(20.0)
_AGES = np.unique([0.0, 1.0, 2.0, *_CLOSE, *(1.0 - _CLOSE), *(1.0 + _CLOSE), *(2.0 - _CLOSE)])
_PHASES = np.arange(0.0, 1.001 + 2.0 * _END) / 2.0
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

    def mean(age: Doubles) -> Doubles:
        return pulse.area(age, 1.0) if pulse.offset == "none" else _off_centre_mean(pulse, age)

    def so_far(age: Doubles) -> Doubles:
        place, weight = panels(np.minimum(np.array([0.0, 1.0, 2.0]), age[:, None]), 24, rooted=True)
        return np.asarray(np.sum(weight * known(place), axis=-1), dtype=np.float64)

    known = mean if pulse.offset == "none" else Table(_AGES, mean)
    shape = partial(amplitude, pulse)
    return UnitLife(power=2, overlap=overlaps(pulse, 1, 1), mean=known, so_far=Table(_AGES, so_far), amplitude=shape)


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


@lru_cache(maxsize=64)
def overlaps(pulse: Pulse, i: int, j: int) -> Function:
    """Return q_ij(t) = E[int a(s)^i a(s + t)^j ds] of unit diameter, to some 1e-9 of its largest value."""
    return Table(_AGES, partial(_overlaps_at, pulse, i=i, j=j), 14)


def _overlaps_at(pulse: Pulse, lags: Doubles, i: int = 1, j: int = 1, nodes: tuple[int, int] = (12, 24)) -> Doubles:
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
        earlier, later = (pulse.overlap(np.hypot(each, offset[..., None])) for each in (earlier, later))
    both = weight * (earlier**i * later**j + earlier**j * later**i)
    return np.asarray(np.sum(share * np.sum(both, axis=-1), axis=-1), dtype=np.float64)


def _off_centre_mean(pulse: Pulse, age: Doubles) -> Doubles:
    """Return E_b[a(t)] = int L(r) cos(phi) dphi, r^2 = 1 + t^2 - 2 t cos(phi), cos(phi) >= t/2 half the life."""
    last = np.arccos(np.minimum(0.5 * age, 1.0))[:, None]
    phi, weight = panels(last * np.array([0.0, 0.01, 0.1, 1.0]), 24, rooted=True)
    apart = np.hypot((1.0 - age)[:, None], 2.0 * np.sqrt(age)[:, None] * np.sin(0.5 * phi))
    return np.asarray(np.sum(weight * pulse.overlap(apart) * np.cos(phi), axis=-1), dtype=np.float64)


def amplitude(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return the transform a^(z) about mid-life, z = k d >= 0, of a pass through both centres, to 1e-11 of its largest.

    Lens: pi H_1(z)/z^2 (Struve); triangle: (pi/4) (sin(z/2)/(z/2))^2; parabola: pi (sin z - z cos z)/z^3.
    """
    z = np.asarray(phase, dtype=np.float64)
    found, far = np.asarray(_near(pulse)(z), dtype=np.float64), z > _FAR
    middle, ends = _parts(pulse, z[far])
    found[far] = middle + 2.0 * (ends.real * np.cos(z[far]) - ends.imag * np.sin(z[far]))
    return found


@cache
def _near(pulse: Pulse) -> Table:
    """Return `amplitude` up to z = 200, twice the integral of a(1 - x) cos(z x) over half a life."""
    place, weight = panels(np.linspace(0.0, 1.0, 5), 48, rooted=True)
    mass = 2.0 * weight * pulse.area(1.0 - place, 1.0)
    return Table(_PHASES[_PHASES <= _FAR], lambda z: _transform(z, place, mass).real)


def _parts(pulse: Pulse, phase: Doubles) -> tuple[Doubles, Complexes]:
    """Return m and b of a^(z) = m + b e^(i z) + b* e^(-i z), z >= 20: of mid-life, and of birth and death.

    Of lenses b is that of Y_1, and m that of H_1 - Y_1 = (2/pi)(1 + 1/z^2 - 3/z^4 + ...).
    """
    inverse, middle = 1.0 / np.square(phase), np.zeros_like(phase)
    if pulse.shape == "lens":
        series, orders = np.ones_like(phase), np.arange(1.0, _TERMS)
        for n in range(_TERMS - 1, 0, -1):
            series = 1.0 - (2 * n - 1) * (2 * n - 3) * inverse * series
        middle = 2.0 * inverse * series
        terms = np.cumprod(np.append(1.0, 1j * (4.0 - (2.0 * orders - 1.0) ** 2) / (8.0 * orders)))
        ends = np.exp(-1.25j * np.pi) / np.sqrt(2.0 * np.pi * phase) * np.polynomial.Polynomial(terms)(1.0 / phase)
    elif pulse.shape == "triangle":
        middle, ends = 0.5 * np.pi * inverse, np.full_like(phase, -0.25)
    else:
        ends = -0.5 - 0.5j / phase
    return middle, np.asarray(np.pi * inverse * ends, dtype=np.complex128)


@cache
def _off_centre_energy(pulse: Pulse) -> Table:
    """Return (9 + z^2)^2.5 times the energy off the centre line up to z = 328, 2 int q_11 cos(z t) dt."""
    lag, weight = panels(np.linspace(0.0, 2.0, 21), 32, rooted=True)
    mass = 2.0 * weight * _overlaps_at(pulse, lag, nodes=(24, 32))
    return Table(_PHASES, lambda z: _transform(z, lag, mass).real * (9.0 + z**2) ** 2.5)


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
            return np.square(amplitude(pulse, z))
        return np.asarray(_off_centre_energy(pulse)(z) / (9.0 + z * z) ** 2.5, dtype=np.float64)

    def level(z: Doubles) -> Doubles:
        if pulse.offset != "none":
            return np.asarray(pulse.tail[0] / z ** pulse.tail[1], dtype=np.float64)
        middle, birth = _parts(pulse, z)
        return np.asarray(np.square(middle) + 2.0 * np.square(np.abs(birth)), dtype=np.float64)

    last = settled if pulse.offset == "none" else np.minimum(settled, _END)
    return _faded(np.asarray(phase, dtype=np.float64), last, followed, level).real


def _faded(z: Doubles, settled: float | Doubles, followed: Transform, rest: Transform) -> Complexes:
    """Return one function up to some phases and another from 70 before ``settled`` on, by an error function.

    Its transform is Gaussian: at the swings e^(iz) and e^(2iz) nothing is left of it.
    """
    place = np.clip(z - settled + _STEP_BEFORE, -_STEP_BEFORE, _STEP_BEFORE)
    kept = np.broadcast_to(_step()(place), z.shape)
    found = np.zeros(z.shape, dtype=np.complex128)
    inside, beyond = kept > _NONE, kept < 1.0 - _NONE
    found[inside] = followed(z[inside])
    share = kept[beyond]
    found[beyond] = share * found[beyond] + (1.0 - share) * rest(np.maximum(z[beyond], 20.0))
    return found


@cache
def _step() -> Table:
    """Return half the complementary error function about 0; scipy's takes longer to load than a spectrum to make."""
    edges = np.linspace(-_STEP_BEFORE, _STEP_BEFORE, 57)
    return Table(edges, lambda z: np.array([0.5 * erfc(each / _STEP_WIDTH) for each in z.tolist()]), 12)


def from_birth(pulse: Pulse, phase: Doubles, settled: float | Doubles = inf) -> Complexes:
    """Return the transform of the mean life about its birth, E[int a(t) exp(-i z t) dt], at z = k d >= 0.

    From ``settled`` on only what begins at birth is left of it; off the centre line that is negligible from z = 160 on.
    """
    if pulse.offset != "none":
        return np.where(phase < SETTLED, _mean_from_birth(pulse)(phase), 0.0)
    return _faded(phase, settled, lambda z: np.exp(-1j * z) * amplitude(pulse, z), lambda z: _parts(pulse, z)[1])


@cache
def _mean_from_birth(pulse: Pulse) -> Table:
    """Return the transform of the mean life off the centre line up to z = 161, by quadrature over ages."""
    age, weight = panels(np.linspace(0.0, 2.0, 9), 48, rooted=True)
    mass = weight * area_life(pulse).mean(age)
    return Table(_PHASES[_PHASES <= SETTLED + 1.0], lambda z: _transform(z, age, mass))


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
        2.0 * half * mass * pulse.overlap(np.hypot(half * place, np.sin(turn)))
        for half, turn in zip(halves, phi, strict=True)
    ]
    rows = [np.square(_transform(z, half * place, area).real) for half, area in zip(halves, areas, strict=True)]
    return z, rows, weight * halves

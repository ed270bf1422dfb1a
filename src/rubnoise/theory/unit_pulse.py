"""The life of unit diameter: its overlap with itself, its energy spectrum, and its means by age.

A(s; d) = d^2 a(s/d), so averages over sizes need these functions alone. Off the centre line they are means over
offsets sin(phi), with a life of 2 cos(phi); a place r from the closest possible one has the area a(1 + r).
"""

from dataclasses import dataclass
from functools import cache, lru_cache, partial
from math import erfc, inf
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.theory.sizes import SETTLED, Function, Table, panels

_FAR, _END, _TERMS = 48.0, 328.0, 10
_STEP_BEFORE, _STEP_WIDTH, _NONE = 70.0, 12.02, 1e-11  # of the step from a swing that is followed to none
_CLOSE = 0.5 * 2.0 ** -np.arange(20.0)
_AGES = np.unique([0.0, 1.0, 2.0, *_CLOSE, *(1.0 - _CLOSE), *(1.0 + _CLOSE), *(2.0 - _CLOSE)])
_PHASES = np.arange(0.0, 1.001 + 2.0 * _END) / 2.0
_ANGLES = np.array([0.0, 0.02, 0.15, 1.0])  # edges over the largest angle: most of a mean is where passes nearly meet


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnitLife:
    """What lives are counted with, d^power a(s/d): area (power 2) or presence (power 0), as functions of t >= 0.

    overlap: E[int a(s) a(s + t) ds]; mean: E[a(t)]; so_far: E[int_0^t a ds]; energy: E[|a^(z)|^2] of z = k d.
    """

    power: int
    overlap: Function
    mean: Function
    so_far: Function
    energy: Function


@cache
def area_life(pulse: Pulse) -> UnitLife:
    """Return the area of a pulse; relative error of each function about 1e-9 of its largest value."""

    def averaged(age: Doubles) -> Doubles:
        phi, weight = _passes_at(pulse, age, 24)
        # The distance from the closest place, sqrt(1 + t^2 - 2 t cos(phi)).
        apart = np.hypot((1.0 - age)[:, None], 2.0 * np.sqrt(age)[:, None] * np.sin(0.5 * phi))
        return np.asarray(np.sum(weight * pulse.area(1.0 + apart, 1.0), axis=-1), dtype=np.float64)

    def so_far(age: Doubles) -> Doubles:
        place, weight = panels(np.minimum(np.array([0.0, 1.0, 2.0]), age[:, None]), 24, rooted=True)
        return np.asarray(np.sum(weight * mean(place), axis=-1), dtype=np.float64)

    mean = (lambda age: pulse.area(age, 1.0)) if pulse.offset == "none" else Table(_AGES, averaged)
    own = partial(energy, pulse)
    return UnitLife(power=2, overlap=overlaps(pulse, 1, 1), mean=mean, so_far=Table(_AGES, so_far), energy=own)


@cache
def count_life(pulse: Pulse) -> UnitLife:
    """Return the count of a life: 1 until it ends."""
    off_centre = 0.25 if pulse.offset != "none" else 0.0
    return UnitLife(
        power=0,
        overlap=pulse.lives_left,
        mean=lambda t: np.heaviside(2.0 - t, 0.0) * np.sqrt(np.maximum(1.0 - off_centre * t * t, 0.0)),
        so_far=lambda t: pulse.mean_life - pulse.lives_left(t),
        energy=lambda z: np.square(2.0 * np.sin(z) / z),
    )


def _passes_at(pulse: Pulse, age: Doubles, count: int) -> tuple[Doubles, Doubles]:
    """Return angles of passes that live at some ages or lags, a row each, and weights cos(phi) dphi."""
    if pulse.offset == "none":
        return np.zeros((age.size, 1)), np.ones((age.size, 1))
    last = np.arccos(np.minimum(0.5 * age, 1.0))[:, None]
    phi, weight = panels(last * _ANGLES, count, rooted=True)
    return phi, weight * np.cos(phi)


@lru_cache(maxsize=64)
def overlaps(pulse: Pulse, i: int, j: int) -> Function:
    """Return q_ij(t) = E[int a(s)^i a(s + t)^j ds] of unit diameter, to some 1e-9 of its largest value."""
    return Table(_AGES, partial(_overlaps_at, pulse, i=i, j=j), 14)


def _overlaps_at(pulse: Pulse, lags: Doubles, i: int = 1, j: int = 1, nodes: tuple[int, int] = (16, 24)) -> Doubles:
    """Return q_ij at some lags by quadrature over passes and places, with some nodes on each panel."""
    lag, (phi, share) = lags[:, None], _passes_at(pulse, lags, nodes[0])
    first = np.broadcast_to(-0.5 * lag, phi.shape)
    last = np.maximum(np.cos(phi) - lag, first)
    place, weight = panels(np.stack([first, np.clip(0.0, first, last), last], axis=-1), nodes[1], rooted=True)
    earlier, later = (
        pulse.area(1.0 + np.hypot(each, np.sin(phi)[..., None]), 1.0) for each in (place, place + lag[..., None])
    )
    both = weight * (earlier**i * later**j + earlier**j * later**i)
    return np.asarray(np.sum(share * np.sum(both, axis=-1), axis=-1), dtype=np.float64)


def _parts(pulse: Pulse, phase: Doubles) -> tuple[Doubles, Complexes]:
    """Return m and b of a^(z) = m + b e^(i z) + b* e^(-i z) about mid-life, z >= 20: of it, and of birth and death."""
    inverse, middle = 1.0 / np.square(phase), np.zeros_like(phase)
    if pulse.shape == "lens":  # m is that of H_1 - Y_1 = (2/pi)(1 + 1/z^2 - 3/z^4 + ...), b that of Y_1
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


def amplitude(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return the transform a^(z) about mid-life, z = k d >= 0, of a pass through both centres, to 1e-11 of its top."""
    # Lens: pi H_1(z)/z^2 (Struve); triangle: (pi/4) (sin(z/2)/(z/2))^2; parabola: pi (sin z - z cos z)/z^3.
    z = np.asarray(phase, dtype=np.float64)
    found, far = np.asarray(_near(pulse, "pass")(z), dtype=np.float64), z > _FAR
    middle, ends = _parts(pulse, z[far])
    found[far] = middle + 2.0 * (ends.real * np.cos(z[far]) - ends.imag * np.sin(z[far]))
    return found


@cache
def _near(pulse: Pulse, kind: Literal["pass", "birth", "energy"]) -> Table:
    """Return `amplitude` to z = 48, or off the centre line to 328 `from_birth` or (9 + z^2)^2.5 times `energy`."""
    t, weight = panels(np.linspace(0.0, 2.0, 21), 32, rooted=True)
    if kind == "energy":  # 2 int q_11 cos(z t) dt
        mass = 2.0 * weight * _overlaps_at(pulse, t, nodes=(24, 32))
        return Table(_PHASES, lambda z: _transform(z, t, mass).real * (9.0 + z**2) ** 2.5)
    mean = weight * area_life(pulse).mean(t)
    if kind == "birth":
        return Table(_PHASES, lambda z: _transform(z, t, mean))
    return Table(_PHASES[_PHASES <= _FAR], lambda z: _transform(z, t - 1.0, mean).real)


def _transform(phase: Doubles, place: Doubles, mass: Doubles) -> Complexes:
    """Return the sum of mass times exp(-i z place) at phases z."""
    rows = [np.sum(np.exp(-1j * np.multiply.outer(some, place)) * mass, axis=-1) for some in np.array_split(phase, 64)]
    return np.concatenate(rows)


def energy(pulse: Pulse, phase: ArrayLike, settled: float | Doubles = inf) -> Doubles:
    """Return E[|a^(z)|^2] of a life of unit diameter at z = k d >= 0; |A^(k)|^2 is d^6 times it.

    Error below 1e-7 of its value up to z = 16. From the phase ``settled`` on, at least 160, the swing of the tail is
    left out: the integral against what is smooth over z = 10 stays the same. Off the centre line that is 328 at most.
    """

    def followed(z: Doubles) -> Doubles:
        if pulse.offset == "none":
            return np.square(amplitude(pulse, z))
        return np.asarray(_near(pulse, "energy")(z) / (9.0 + z * z) ** 2.5, dtype=np.float64)

    def level(z: Doubles) -> Doubles:
        if pulse.offset != "none":
            return np.asarray(pulse.tail[0] / z ** pulse.tail[1], dtype=np.float64)
        middle, birth = _parts(pulse, z)
        return np.asarray(np.square(middle) + 2.0 * np.square(np.abs(birth)), dtype=np.float64)

    last = settled if pulse.offset == "none" else np.minimum(settled, _END)
    return _faded(np.asarray(phase, dtype=np.float64), last, followed, level).real


def _faded(z: Doubles, settled: float | Doubles, followed: Function, rest: Function) -> Complexes:
    """Return one function up to some phases and another from 70 before ``settled`` on, by an error function."""
    # Whose transform is Gaussian: at the swings e^(iz) and e^(2iz) nothing is left of it.
    kept = np.interp(z - settled + _STEP_BEFORE, *_step())
    found = np.zeros(z.shape, dtype=np.complex128)
    inside, beyond = kept > _NONE, kept < 1.0 - _NONE
    if not beyond.any():
        return followed(z)
    found[inside] = followed(z[inside])
    share = kept[beyond]
    found[beyond] = share * found[beyond] + (1.0 - share) * rest(np.maximum(z[beyond], 20.0))
    return found


@cache
def _step() -> tuple[Doubles, list[float]]:
    """Return places about 0 and half the complementary error function there; scipy's takes long to load."""
    places = np.linspace(-_STEP_BEFORE, _STEP_BEFORE, 1 << 16)
    return places, [0.5 * erfc(place / _STEP_WIDTH) for place in places.tolist()]


def from_birth(pulse: Pulse, phase: Doubles, settled: float | Doubles = inf) -> Complexes:
    """Return E[int a(t) exp(-i z t) dt] about the birth, z = k d >= 0; from ``settled`` on what begins there alone."""
    if pulse.offset != "none":  # negligible from z = 160 on
        return np.where(phase < SETTLED, _near(pulse, "birth")(phase), 0.0)
    return _faded(phase, settled, lambda z: np.exp(-1j * z) * amplitude(pulse, z), lambda z: _parts(pulse, z)[1])


def pass_energies(pulse: Pulse, phase: Doubles) -> tuple[Doubles, Doubles]:
    """Return |a^(z; b)|^2 of passes at some offsets b, a row each, within 1e-3, and their probabilities."""
    if pulse.offset == "none":
        return energy(pulse, phase)[None], np.ones(1)
    z, rows, shares = _passes(pulse)
    near = np.stack([np.interp(phase, z, row) for row in rows])  # and beyond, where it is small, the mean of all
    return np.where(phase < z[-1], near, energy(pulse, phase, SETTLED)), shares


@cache
def _passes(pulse: Pulse) -> tuple[Doubles, list[Doubles], Doubles]:
    """Return phases up to 32, squared transforms there of passes at some offsets, and their probabilities."""
    (phi,), (shares,) = _passes_at(pulse, np.zeros(1), 8)
    u, weight = panels([0.0, 0.02, 0.15, 1.0], 32, rooted=True)
    z, place = np.arange(0.0, 32.01, 0.02), np.multiply.outer(np.cos(phi), u)
    areas = 2.0 * np.cos(phi)[:, None] * weight * pulse.area(1.0 + np.hypot(place, np.sin(phi)[:, None]), 1.0)
    return z, [np.square(_transform(z, *one).real) for one in zip(place, areas, strict=True)], shares

"""Passes at a lateral offset uniform on (-d, d): spectrum, autocovariance and growth, averaged over offsets.

The area of unit diameter is L(r), r the distance of the two centres. As L is the autocorrelation of a disc, it has the
two-dimensional transform F(q) = (pi J_1(q/2)/q)^2. An average over offsets of something along a line is half an
integral over the plane, so that one function F^2 = (pi J_1(q/2)/q)^4 holds all that is of second order:

    E_b |a^(z; b)|^2                = (1/2 pi) int_0^inf F(sqrt(z^2 + p^2))^2 dp
    E_b int a(s) a(s + t) ds        = (1/4 pi) int_0^inf F(q)^2 J_0(q t) q dq

This holds for lenses. A pass of parabolas is a parabola of the diameter sqrt(d^2 - b^2), so its averages are closed
(`rubnoise.theory.transform_parabola`) or come from the quadrature that higher powers take.

Source: the projection-slice theorem (Bracewell 1956, doi:10.1071/PH560198) and Hankel transforms.
"""

from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.off_centre import OFF_CENTRE_LENS, overlap
from rubnoise.contact.pulses import Pulse
from rubnoise.theory.live_area import Piecewise, series
from rubnoise.theory.quadrature import panels
from rubnoise.theory.transform_lens import chebyshev_series, hankel_modulus, hankel_without_swing
from rubnoise.theory.transform_parabola import settled_square

Powers = tuple[int, int]

_FAR = 32.0
_SEGMENTS = ((0.0, 8.0), (8.0, 16.0), (16.0, 24.0), (24.0, _FAR))
_DEGREE = 32
_HIGHEST = 2048.0  # of q: what the swing has beyond it is below 1e-11 of any value here
_PANEL = 4.0
_NODES = 16
_LEVEL_NODES = 24
_SWING_NODES = 24
_FAR_DEGREE = 16


def mean_square(phase: ArrayLike) -> Doubles:
    """Return E_b |a^(z; b)|^2 of a pass of unit diameter, z = k d >= 0 of any shape; |A^(k)|^2 is d^6 times it.

    Relative error below 1e-9. Below z = 32 it is interpolated between quadratures. Beyond, J_1^4 = (3 + 4 cos + cos)/8
    of its phase gives a level and two swings, exp(i z) and exp(2 i z) times what polynomials in 1/z follow.
    """
    z = np.asarray(phase, dtype=np.float64)
    result = np.empty_like(z)
    far = z >= _FAR
    beyond = z[far]
    once, twice = (chebyshev(_FAR / beyond) for chebyshev in _swings())
    turn = np.exp(1j * beyond)
    swing = (turn * (once + turn * twice)).real / np.sqrt(beyond)
    result[far] = (_level()(_FAR / beyond) + swing) / beyond**5
    for segment, (low, high) in enumerate(_SEGMENTS):
        inside = (z >= low) & (z < high)
        x = (z[inside] - 0.5 * (high + low)) / (0.5 * (high - low))
        result[inside] = np.polynomial.chebyshev.chebval(x, _chebyshev(segment)) * _scale(z[inside])
    return result


def level(phase: Doubles) -> Doubles:
    """Return `mean_square` without its oscillation, for z >= 32 of any shape: about (9/16) pi^2 / z^5."""
    return np.asarray(_level()(_FAR / phase) / phase**5, dtype=np.float64)


@cache
def _level() -> Chebyshev:
    """Interpolate z^5 times the level over 32/z: 3/8 of (J_1^2 + Y_1^2)^2, smooth in p = z tan(theta)."""
    z = _FAR / _places()
    theta, weights = panels([0.0, 0.5 * np.pi], _LEVEL_NODES)
    q = z[:, None] / np.cos(theta)
    lines = np.square(hankel_modulus(0.5 * q)) / q**4 / np.square(np.cos(theta))
    return _fitted(0.1875 * np.pi**3 * z**6 * np.sum(weights * lines, axis=-1))


@cache
def _swings() -> tuple[Chebyshev, Chebyshev]:
    """Interpolate what z^(11/2) times the swing has of exp(i z) and of exp(2 i z), over 32/z.

    J_1 = Re H, and H turns as exp(i q/2), so that |H|^2 H^2 and H^4 decay along q = z + i s, their path of steepest
    descent from p = 0: with s = tau^2/n for exp(i n q), and dp = q dq / sqrt(q^2 - z^2).
    """
    tau, weights = np.polynomial.hermite.hermgauss(_SWING_NODES)
    z = (_FAR / _places())[:, None]
    found = []
    for turns, factor in ((1, 0.5), (2, 0.125)):
        s = np.square(tau) / turns
        q = z + 1j * s
        forward, backward = _hankel(0.5 * q)
        fourth = forward**4 if turns == 2 else forward**3 * backward
        jacobian = q * 1j / (turns * np.sqrt(1j * (2.0 * z + 1j * s) / turns))
        along = np.sum(weights * fourth / q**4 * jacobian, axis=-1, keepdims=True)
        found.append(_fitted((0.5 * np.pi**3 * factor * z**5.5 * along)[:, 0]))
    return found[0], found[1]


def _places() -> Doubles:
    """Return the nodes of an interpolation over 32/z in (0, 1)."""
    return np.asarray(0.5 * (np.polynomial.chebyshev.chebpts1(_FAR_DEGREE + 1) + 1.0), dtype=np.float64)


def _fitted(values: NDArray[Any]) -> Chebyshev:
    return Chebyshev(chebyshev_series(values), domain=[0.0, 1.0])


def _hankel(place: NDArray[Any]) -> tuple[Complexes, Complexes]:
    """Return exp(-i y) H_1^(1)(y) and exp(i y) H_1^(2)(y) at complex places, |y| >= 16, neither of which swings."""
    # hankel_without_swing is exp(i y) (Y_1 + i J_1) = i exp(i y) H^(2), and its mirror image belongs to H^(1).
    backward = -1j * hankel_without_swing(place)
    forward = np.conj(-1j * hankel_without_swing(np.conj(place)))
    return forward, backward


def _scale(phase: Doubles) -> Doubles:
    """Return (1 + z^2)^(-5/2), which falls off as the mean square does."""
    return (1.0 + phase * phase) ** -2.5


def _fourth_power(wavenumber: Doubles) -> Doubles:
    """Return F(q)^2 = (pi J_1(q/2)/q)^4, pi^4/256 at 0."""
    from scipy.special import j1

    q = np.where(wavenumber > 0.0, wavenumber, 1.0)
    return np.where(wavenumber > 0.0, np.square(np.square(np.pi * j1(0.5 * q) / q)), (0.25 * np.pi) ** 4)


@cache
def _chebyshev(segment: int) -> Doubles:
    """Interpolate the mean square on a segment: panels over p, and beyond them the level alone."""
    low, high = _SEGMENTS[segment]
    nodes = np.polynomial.chebyshev.chebpts1(_DEGREE + 1)
    z = 0.5 * (high + low) + 0.5 * (high - low) * nodes
    p, weights = panels(np.arange(0.0, _HIGHEST + 0.5 * _PANEL, _PANEL), _NODES)
    values = np.array([float(weights @ _fourth_power(np.hypot(each, p))) for each in z]) / (2.0 * np.pi)
    theta, weights = panels([float(np.arctan(_HIGHEST)), 0.5 * np.pi], _LEVEL_NODES)
    beyond = np.tan(theta)
    q = np.hypot(z[:, None], beyond)
    lines = np.square(hankel_modulus(0.5 * q)) / q**4 / np.square(np.cos(theta))
    whole = values + 0.1875 * np.pi**3 * np.sum(weights * lines, axis=-1)
    coefficients: Doubles = np.polynomial.chebyshev.chebfit(nodes, whole / _scale(z), _DEGREE)
    return coefficients


_TURNS = np.array([0.0, 0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.99, 1.0, 1.01, 1.05, 1.2, 1.5, 1.8, 1.95, 2.0])
"""Lags and ages between which polynomials follow: at 0, 1 and 2 the functions have weak singularities."""
_TABLE_NODES = 20


def overlaps(pulse: Pulse, lag: Doubles, powers: tuple[Powers, ...]) -> dict[Powers, Doubles]:
    """Return q_ij(t) = E_b int a(s)^i a(s + t)^j ds for passes of unit diameter, t >= 0 of any shape; zero for t >= 2.

    q_11 within 1e-11 of its largest value, others within 1e-6, which is plenty for errors of errors.
    """
    found = {}
    for i, j in powers:
        hankel = (i, j) == (1, 1) and pulse.shape == "lens"
        table = _second_order() if hankel else _higher_order(pulse, min(i, j), max(i, j))
        found[i, j] = np.where(lag < 2.0, table(np.minimum(lag, 2.0)), 0.0)
    return found


@cache
def _second_order() -> Piecewise:
    """Return q_11 by its Hankel transform; beyond the highest q it holds less than 1e-13."""
    from scipy.special import j0

    t, _ = panels(_TURNS, _TABLE_NODES)
    q, weights = panels(np.arange(0.0, _HIGHEST + 0.5 * _PANEL, _PANEL), _NODES)
    transform = weights * _fourth_power(q) * q / (4.0 * np.pi)
    return _piecewise(np.array([float(transform @ j0(q * each)) for each in t]))


@lru_cache(maxsize=32)
def _higher_order(pulse: Pulse, i: int, j: int) -> Piecewise:
    """Return q_ij by quadrature over offsets and places, cut where either centre passes; symmetric in i and j."""
    t, _ = panels(_TURNS, _TABLE_NODES)
    return _piecewise(np.array([_overlap_of_powers(pulse, float(each), i, j) for each in t]))


def _overlap_of_powers(pulse: Pulse, lag: float, i: int, j: int) -> float:
    widest = np.sqrt(max(1.0 - 0.25 * lag * lag, 0.0))
    # Near the centre line areas turn sharply at x = 0 and x = -t: offsets come closer there.
    offset, shares = panels(widest * np.array([0.0, 0.02, 0.15, 1.0]), 12, rooted=True)
    end = np.sqrt(1.0 - offset * offset)
    half, last = np.full_like(end, -0.5 * lag), end - lag
    cuts = np.stack([half, np.clip(0.0, half, last), last], axis=-1)
    place, weights = panels(cuts, 24, rooted=True)
    earlier = overlap(np.hypot(place, offset[:, None]), pulse)
    later = overlap(np.hypot(place + lag, offset[:, None]), pulse)
    both = earlier**i * later**j + earlier**j * later**i
    return float(shares @ np.sum(weights * both, axis=-1))


_OFFSETS = 8
_OFFSET_EDGES = 0.5 * np.pi * np.array([0.0, 0.001, 0.01, 0.1, 1.0])
_STEP = 0.02


def pass_energies(pulse: Pulse, phase: Doubles) -> Doubles:
    """Return |a^(z; b)|^2 of passes of unit diameter at some offsets b, a row each, z = k d >= 0 of any shape.

    The offsets have the probabilities `offset_probabilities`. Of parabolas it is D^6 |a^(z D)|^2, D = sqrt(1 - b^2),
    without the swing of its tail. Of lenses it is within 1e-3 of each value up to z = 32, and without its
    swing beyond, which is plenty for errors of errors: 4 (b/z)^2 K_1(z b)^2 comes from the turn at mid-life, where the
    area is -sqrt(x^2 + b^2) but for what is smoother, and pi (1 - b^2)^(3/2) / z^5 from the two ends, powers 3/2.
    """
    from scipy.special import k1

    if pulse.shape == "parabola":
        chords = np.cos(_offset_rule()[0]).reshape(-1, *(1 for _ in phase.shape))
        return np.asarray(chords**6 * settled_square(phase * chords), dtype=np.float64)
    grid, rows = _energy_table()
    offsets = np.sin(_offset_rule()[0]).reshape(-1, *(1 for _ in phase.shape))
    near = np.stack([np.interp(phase, grid, row) for row in rows])
    z = np.maximum(phase, _FAR)
    turn, ends = 2.0 * offsets / z * k1(z * offsets), np.pi * (1.0 - offsets**2) ** 1.5 / z**5
    return np.where(phase < _FAR, near, turn * turn + ends)


def offset_probabilities() -> Doubles:
    """Return the probabilities of the offsets of `pass_energies`."""
    phi, weights = _offset_rule()
    return weights * np.cos(phi)


def _offset_rule() -> tuple[Doubles, Doubles]:
    """Return angles phi of offsets sin(phi) and weights: close where the tips of areas are sharp."""
    return panels(_OFFSET_EDGES, _OFFSETS)


@cache
def _energy_table() -> tuple[Doubles, Doubles]:
    """Return phases, and the squared transform of a pass at every offset b = sin(phi), a row each."""
    along, weights = panels([0.0, 0.02, 0.15, 1.0], 32, rooted=True)
    z = np.arange(0.0, _FAR + 2.0 * _STEP, _STEP)
    rows = []
    for angle in _offset_rule()[0].tolist():
        x = np.cos(angle) * along
        area = 2.0 * np.cos(angle) * weights * overlap(np.hypot(x, np.sin(angle)), OFF_CENTRE_LENS)
        rows.append(np.square(np.cos(np.multiply.outer(z, x)) @ area))
    return z, np.stack(rows)


def area_so_far(pulse: Pulse, age: Doubles) -> Doubles:
    """Return E_b int_0^t a(s) ds of a pass of unit diameter at ages t >= 0 of any shape; c_1 from t = 2 on."""
    whole = pulse.life_integral(1)
    return np.where(age < 2.0, _growth(pulse)(np.clip(age, 0.0, 2.0)), whole)


@cache
def _growth(pulse: Pulse) -> Piecewise:
    """Integrate E_b a(t) = int_(t/2)^1 L(r) w / sqrt(1 - w^2) dw, r^2 = 1 + t^2 - 2 t w, w = cos(phi) half the life."""
    t, _ = panels(_TURNS, _TABLE_NODES)
    last = np.arccos(np.minimum(0.5 * t, 1.0))[:, None]
    phi, weights = panels(last * np.array([0.0, 0.01, 0.1, 1.0]), 24, rooted=True)
    r = np.hypot((1.0 - t)[:, None], 2.0 * np.sqrt(t)[:, None] * np.sin(0.5 * phi))
    return _piecewise(np.sum(weights * overlap(r, pulse) * np.cos(phi), axis=-1)).integral()


def _piecewise(values: Doubles) -> Piecewise:
    return Piecewise(edges=_TURNS, coefficients=series(values.reshape(_TURNS.size - 1, _TABLE_NODES)))

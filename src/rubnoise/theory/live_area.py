"""The law of the area of one live junction at a random place, as polynomials on panels.

Read it from above: smooth functions as polynomials, how long a pulse of unit diameter has about each area, and the law
for junctions of all sizes.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Doubles, slices
from rubnoise.contact.laws import Law
from rubnoise.contact.laws.discrete import has_single_values, parts_of
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.theory.quadrature import hard_ends, panels, size_edges

NODES = 20
_AT_ONCE = 32_768


@dataclass(frozen=True, slots=True, kw_only=True)
class Piecewise:
    """A function on [edges[0], edges[-1]] as Legendre series, one column of coefficients for each panel.

    The series of a ``rooted`` panel runs in 1 - 2r, r = sqrt((high - x)/(high - low)): it follows what ends like a
    root there. If ``infinite``, the function is the series over r on such panels.
    """

    edges: Doubles
    coefficients: Doubles
    rooted: NDArray[np.bool_] | None = None
    infinite: bool = False

    def __call__(self, x: Doubles) -> Doubles:
        """Return the values at places of any shape; places outside have the value of the nearest end."""
        places = np.clip(x, self.edges[0], self.edges[-1]).ravel()
        result = np.empty_like(places)
        for part in slices(0, places.size, _AT_ONCE):
            result[part] = self._values(places[part])
        return result.reshape(np.shape(x))

    def _values(self, x: Doubles) -> Doubles:
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.edges.size - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        local = (2.0 * x - low - high) / (high - low)
        if self.rooted is None:
            return np.asarray(legendre.legval(local, self.coefficients[:, panel], tensor=False), dtype=np.float64)
        at_root = self.rooted[panel]
        root = np.sqrt(np.maximum(0.5 * (1.0 - local), _NEAREST if self.infinite else 0.0))
        values = legendre.legval(np.where(at_root, 1.0 - 2.0 * root, local), self.coefficients[:, panel], tensor=False)
        return np.asarray(np.where(at_root, values / root, values) if self.infinite else values, dtype=np.float64)

    def integral(self) -> "Piecewise":
        """Return the antiderivative that is 0 at the first edge; of a function with rooted panels if it is infinite."""
        steps = 0.5 * np.diff(self.edges)
        if self.rooted is not None:
            steps = np.where(self.rooted, 2.0 * steps, steps)  # dx = 2 (high - low) r dr, and the series is over r
        parts = steps * legendre.legint(self.coefficients, lbnd=-1, axis=0)
        parts[0, 1:] += np.cumsum(legendre.legval(1.0, parts))[:-1]
        return Piecewise(edges=self.edges, coefficients=parts, rooted=self.rooted)

    def scaled(self, factor: float) -> "Piecewise":
        """Return the function times a number."""
        return replace(self, coefficients=factor * self.coefficients)


_NEAREST = 1e-16
"""Least distance, as a part of a panel, to an end at which a function is infinite and so not evaluated."""


def series(values: Doubles) -> Doubles:
    """Return Legendre coefficients, a new first axis, of functions given at Gauss-Legendre nodes, their last axis."""
    x, w = legendre.leggauss(values.shape[-1])
    projection = legendre.legvander(x, x.size - 1).T * w * (np.arange(x.size) + 0.5)[:, None]
    return np.tensordot(projection, values, axes=(1, -1))


UnitDensity = Callable[[Doubles], Doubles]

_PEAK = 0.25 * np.pi
_DEGREE = 28


def unit_density(pulse: Pulse) -> UnitDensity:
    """Return the density du/da of the area a in (0, pi/4] of a live junction of unit diameter.

    u in [0, 1] is the half-life so far, as likely at every place; the falling half is the mirror image. Off the centre
    line, u = 1 - r^2 is: the place of one centre is uniform in the disc of radius d about the other.
    """
    return _DENSITIES[pulse.name]


def _lens(area: Doubles) -> Doubles:
    """Return 1/sqrt(u (2 - u)), the area of a lens growing by sqrt(1 - (1 - u)^2) du."""
    u = _lens_age(area)
    return np.asarray(1.0 / np.sqrt(u * (2.0 - u)), dtype=np.float64)


def _off_centre_lens(area: Doubles) -> Doubles:
    """Return 2 r / sqrt(1 - r^2) with L(r) = a, L falling by sqrt(1 - r^2) dr and d(r^2) being 2 r dr."""
    u = _lens_age(area)
    return np.asarray(2.0 * (1.0 - u) / np.sqrt(u * (2.0 - u)), dtype=np.float64)


def _lens_age(area: Doubles) -> Doubles:
    """Return u = 1 - r at which a lens of unit diameter has an area."""
    scaled = np.minimum(area / _PEAK, 1.0) ** (2.0 / 3.0)
    return np.asarray(scaled * np.polynomial.chebyshev.chebval(2.0 * scaled - 1.0, _lens_ages()), dtype=np.float64)


def _triangle(area: Doubles) -> Doubles:
    """Return 4/pi, the rise being straight; (pi/4) u is the area of parabolas off the centre line, too."""
    return np.full_like(area, 1.0 / _PEAK)


def _parabola(area: Doubles) -> Doubles:
    """Return 1/sqrt(pi (pi/4 - a)), the area growing by (pi/2) (1 - u) du; without bound at the peak."""
    return np.asarray(1.0 / np.sqrt(np.pi * np.maximum(_PEAK - area, _NEAREST)), dtype=np.float64)


_DENSITIES: dict[str, UnitDensity] = {
    "lens": _lens,
    "off-centre lens": _off_centre_lens,
    "off-centre parabola": _triangle,
    "triangle": _triangle,
    "parabola": _parabola,
}
_INFINITE_AT_PEAK = ("parabola",)
"""Pulses whose slope is 0 at mid-life: their areas are likeliest there."""


@cache
def _lens_ages() -> Doubles:
    """Interpolate u/w over w = (4 a/pi)^(2/3) in [0, 1], where a lens of unit diameter has area a at the half-life u.

    With u = 1 - cos(y), a = (y - sin(y) cos(y))/2; analytic up to w = 2^(2/3), where y = pi.
    """
    import mpmath

    nodes = np.polynomial.chebyshev.chebpts1(_DEGREE + 1)
    with mpmath.workdps(30):
        scaled = [(1 + mpmath.mpf(x)) / 2 for x in nodes.tolist()]
        values = np.array([float((1 - mpmath.cos(_lens_angle(w))) / w) for w in scaled])
    return np.polynomial.chebyshev.chebfit(nodes, values, _DEGREE)


def _lens_angle(scaled: Any) -> Any:
    """Return y in [0, pi/2] with y - sin(y) cos(y) = (pi/2) w^(3/2), an mpmath number."""
    import mpmath

    double_area = mpmath.pi / 2 * scaled**1.5
    return mpmath.findroot(
        lambda y: y - mpmath.sin(y) * mpmath.cos(y) - double_area, mpmath.pi / 2 * mpmath.sqrt(scaled)
    )


_PANELS_TO_ZERO = 20
_RADIANS, _RULE_NODES = 32.0, 24


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LiveArea:
    """The law of the area a of one live junction, in t = a^(1/3), where both pulses are smooth at birth.

    If the density grows without bound at a peak area, as for the parabola, the panel below it is rooted.
    ``rise`` is dG/dt and ``level`` the distribution function G; ``breaks`` are areas in um^2 between which both are
    smooth, the peak areas pi d^2/4 of the law's sizes; the last is the largest area there is.
    """

    rise: Piecewise
    level: Piecewise
    breaks: Doubles

    @property
    def largest(self) -> float:
        """The largest area in um^2."""
        return float(self.breaks[-1])

    @property
    def median(self) -> float:
        """An area in um^2 about which half of the live junctions have; for scale."""
        return float(np.interp(0.5, self.level(self.level.edges), self.level.edges)) ** 3

    def cdf(self, area: ArrayLike) -> Doubles:
        """Return G(a) = P(area <= a) at areas in um^2, of any shape."""
        a = np.asarray(area, dtype=np.float64)
        return np.where(a < self.largest, self.level(np.cbrt(np.maximum(a, 0.0))), 1.0)

    def density(self, area: ArrayLike) -> Doubles:
        """Return G'(a) in 1/um^2, which grows as a^(-1/3) towards 0 for the lens; 0 for a <= 0 and far out."""
        a = np.asarray(area, dtype=np.float64)
        inside = (a > 0.0) & (a <= self.largest)
        t = np.cbrt(np.where(inside, a, self.largest))
        return np.where(inside, self.rise(t) / (3.0 * t * t), 0.0)

    def rule(self, wavenumber: float = 0.0, reach: float = np.inf) -> tuple[Doubles, Doubles]:
        """Return areas in um^2 and probabilities, so that E[g(a)] = sum of probability times g(area).

        Exact to rounding for smooth g, and for exp(i th a) up to |th| = ``wavenumber`` in 1/um^2; areas beyond
        ``reach`` may be left out.
        """
        edges = self.rise.edges[: 1 + np.searchsorted(self.rise.edges, np.cbrt(min(reach, self.largest)))]
        pieces = 1 + np.floor(wavenumber * np.diff(edges**3) / _RADIANS).astype(np.int64)
        if self.rise.rooted is None:
            t, weights = panels(np.interp(_split(pieces), np.arange(edges.size), edges), _RULE_NODES)
        else:
            t, weights = self._rooted_panels(edges, pieces)
        return t**3, weights * np.maximum(self.rise(t), 0.0)

    def _rooted_panels(self, edges: Doubles, pieces: NDArray[np.int64]) -> tuple[Doubles, Doubles]:
        """Return nodes and weights of the rule; on rooted panels in the root, where areas are twice as far apart."""
        rooted = np.asarray(self.rise.rooted)[: pieces.size]
        places, weights = panels(_split(np.where(rooted, 2 * pieces, pieces)), _RULE_NODES)
        panel = np.minimum(places.astype(np.int64), pieces.size - 1)
        fraction, width = places - panel, np.diff(edges)[panel]
        left = np.where(rooted[panel], np.square(1.0 - fraction), 1.0 - fraction)
        stretch = np.where(rooted[panel], 2.0 * (1.0 - fraction), 1.0)
        return edges[panel + 1] - width * left, weights * width * stretch


def _split(pieces: NDArray[np.int64]) -> Doubles:
    """Return panel numbers and fractions of them: 0, 1/2, 1, 4/3, 5/3, 2 for pieces 2, 3."""
    ends = np.cumsum(pieces)
    within = np.arange(ends[-1]) - np.repeat(ends - pieces, pieces)
    places = np.repeat(np.arange(pieces.size), pieces) + within / np.repeat(pieces, pieces)
    return np.append(places, float(pieces.size))


@lru_cache(maxsize=32)
def live_area(sizes: Law, pulse: Pulse) -> LiveArea:
    """Return the law of the area of a junction found alive: diameter of density d f(d) / m_1, age uniform on its life.

    G'(a) = E[g(a/d^2) / d] / m_1 over diameters whose peak is above a, g the density of the area of a live junction of
    unit diameter. Source: length-biased sampling (Cox 1962, Renewal Theory, section 5.4), for the pulse of Eq. (2).
    """
    if parts_of(sizes) and has_single_values(sizes):
        raise Refused("the distribution of area is not known for several single diameters (diameter.law)")
    cuts, edges = _cuts_and_edges(sizes)
    unit, infinite = unit_density(pulse), pulse.name in _INFINITE_AT_PEAK
    edges = _closer_to_peaks(edges, cuts) if infinite else edges
    rooted = np.isin(np.arange(edges.size - 1), _below_peaks(sizes, edges)) if infinite else None
    t, _ = panels(edges, NODES)
    if rooted is not None:
        width, low = np.diff(edges), edges[:-1, None]
        root = 1.0 - (t.reshape(width.size, NODES) - low) / width[:, None]
        t = np.where(rooted[:, None], edges[1:, None] - width[:, None] * root**2, t.reshape(root.shape)).ravel()
    rise = 3.0 * t * t * _density(unit, t**3, sizes, cuts, rooted=infinite)
    if rooted is not None:
        rise = np.where(rooted[:, None], rise.reshape(root.shape) * root, rise.reshape(root.shape)).ravel()
    pieces = Piecewise(
        edges=edges, coefficients=series(rise.reshape(edges.size - 1, NODES)), rooted=rooted, infinite=infinite
    )
    # The density of a law of little spread has few digits; its shape has them all, so the mass is made 1.
    pieces = pieces.scaled(1.0 / float(pieces.integral()(edges[-1:])[0]))
    return LiveArea(rise=pieces, level=pieces.integral(), breaks=_PEAK * np.square(cuts))


def _cuts_and_edges(sizes: Law) -> tuple[Doubles, Doubles]:
    """Return diameters in um between which the law is smooth, and edges in t that hold their peak areas.

    Both come closer to 0 by sqrt(2) in t, far below the mean diameter.
    """
    cuts, logarithmic = size_edges(sizes)
    middles = np.sqrt(cuts[1:] * cuts[:-1]) if logarithmic else 0.5 * (cuts[1:] + cuts[:-1])
    cuts = np.union1d(cuts, middles)  # what is smooth enough to integrate is not yet to interpolate
    top, mean = np.cbrt(_PEAK * np.array([cuts[-1], min(sizes.moment(1), cuts[-1])]) ** 2)
    falling = top * 2.0 ** (-0.5 * np.arange(_PANELS_TO_ZERO + 2.0 * np.log2(top / mean)))
    diameters = np.sqrt(falling**3 / _PEAK)
    cuts = np.union1d(cuts, diameters[(diameters > cuts[0]) & (diameters < cuts[-1])])
    edges = np.union1d(np.cbrt(_PEAK * cuts**2), falling[diameters < cuts[0]])
    return cuts, np.append(0.0, edges)


def _closer_to_peaks(edges: Doubles, cuts: Doubles) -> Doubles:
    """Return edges that approach the least peak area from below by factors of 2, up to the range of all peaks."""
    low, high = np.cbrt(_PEAK * np.square(cuts[[0, -1]]))
    if low == high:
        return edges
    last = low - edges[edges < low * (1.0 - 1e-12)][-1]
    steps = np.arange(1.0, max(np.ceil(np.log2(last / (high - low))), 0.0) + 1.0)
    return np.union1d(edges, low - last * 0.5**steps)


def _below_peaks(sizes: Law, edges: Doubles) -> NDArray[np.int64]:
    """Return the panels that end at the peak area of a diameter at which the law begins or ends abruptly."""
    ends = [end for end in hard_ends(sizes) if end is not None] or (
        [size_edges(sizes)[0][-1]] if size_edges(sizes)[0].size == 1 else []
    )
    return np.searchsorted(edges, np.cbrt(_PEAK * np.square(ends)) * (1.0 - 1e-12)) - 1


def _density(unit: UnitDensity, area: Doubles, sizes: Law, cuts: Doubles, *, rooted: bool) -> Doubles:
    """Return m_1 G'(a), each integral over diameters from the one whose peak area is a; G'(a) itself for one size."""
    if cuts.size == 1:
        return unit(area / cuts**2) / cuts**2
    least = np.sqrt(area / _PEAK)[:, None]
    ends = np.clip(least, cuts, cuts[-1])
    if rooted:  # with v = sqrt(d^2 - least^2) what grows as 1/v is smooth, and dd = v dv / d
        roots, weights = panels(np.sqrt((ends - least) * (ends + least)), NODES)
        diameters = np.hypot(least, roots)
        weights = weights * roots / diameters
    else:
        diameters, weights = panels(ends, NODES)
    return np.sum(weights * sizes.density(diameters) / diameters * unit(area[:, None] / diameters**2), axis=-1)

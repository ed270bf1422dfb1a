"""From characteristic function to distribution: the law of the sum of a Poisson number of live areas.

Exponential bounds say how far both tails reach; sums over points that lie anywhere take one fast transform.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import exp, expm1, pi, sqrt
from typing import Any

import numpy as np

from rubnoise.arrays import Complexes, Doubles, slices
from rubnoise.theory.live_area import LiveArea
from rubnoise.theory.quadrature import complementary_error, panels

_SLOWEST, _FASTEST_UP, _FASTEST_DOWN = 1e-8, 600.0, 1e6
_RATES = 500
_UNLIKELY = 1e-17


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaTails:
    """Bounds ln P(A_r >= a) <= K(q) - q a and ln P(A_r <= a) <= K(-q) + q a, each at its best rate q (1/um^2).

    K(q) = N (E[exp(q b)] - 1), N the mean count and b the area of one live junction. ``furthest`` is an area in um^2
    that no junction exceeds but with probability 1e-17. Source: Chernoff (1952), doi:10.1214/aoms/1177729330.
    """

    furthest: float
    up: tuple[Doubles, Doubles]
    down: tuple[Doubles, Doubles]

    def upper(self, nats: float) -> float:
        """Return an area in um^2 that is exceeded with probability below exp(-nats)."""
        rates, growth = self.up
        return float(np.min((growth + nats) / rates))

    def lower(self, nats: float) -> float:
        """Return an area in um^2 not reached with probability below exp(-nats); 0 if there is none."""
        rates, growth = self.down
        return max(0.0, float(np.max(-(growth + nats) / rates)))

    def nats_above(self, area: float) -> float:
        """Return a lower bound of -ln P(A_r >= area)."""
        rates, growth = self.up
        return float(np.max(rates * area - growth))


def area_tails(live: LiveArea, mean_count: float) -> AreaTails:
    """Return the bounds for a Poisson number of live areas with a mean count."""
    area, probability = live.rule()
    likely = mean_count * np.cumsum(probability[::-1])[::-1] > _UNLIKELY
    area, probability = area[likely], probability[likely]

    def bounds(fastest: float, sign: float) -> tuple[Doubles, Doubles]:
        rates = np.geomspace(_SLOWEST, fastest, _RATES) / area[-1]
        return rates, mean_count * (np.expm1(sign * np.multiply.outer(rates, area)) @ probability)

    return AreaTails(furthest=float(area[-1]), up=bounds(_FASTEST_UP, 1.0), down=bounds(_FASTEST_DOWN, -1.0))


_WIDTH = 16
_SHAPE = 2.3 * _WIDTH
_NODES = 22
_POINTS_AT_ONCE = 16_384


def point_transform(places: Doubles, weights: Doubles, count: int) -> Complexes:
    """Return sum_j w_j exp(2 pi i n x_j) for n = 0 ... count - 1, of points x (in periods) and real weights w.

    Within 1e-14 of the sum of |w|. The points are smeared over a grid of 4 count places by a narrow window, whose own
    transform is divided out again. Source: Barnett, Magland and af Klinteberg (2019), doi:10.1137/18M120885X.
    """
    grid = np.zeros(4 * count)
    for part in slices(0, places.size, _POINTS_AT_ONCE):
        _smear(grid, grid.size * (places[part] - np.floor(places[part])), weights[part])
    sums: Complexes = np.conj(np.fft.rfft(grid)[:count])
    return sums / _kernel_transform(count)


def _smear(grid: Doubles, positions: Doubles, weights: Doubles) -> None:
    """Add each weight, times the window, to the places around its position."""
    first = np.ceil(positions - 0.5 * _WIDTH)
    for step in range(_WIDTH):
        window = _kernel((first + step - positions) / (0.5 * _WIDTH))
        np.add.at(grid, (first + step).astype(np.int64) % grid.size, weights * window)


def _kernel(offset: Doubles) -> Doubles:
    """Return exp(b (sqrt(1 - z^2) - 1)) at offsets z of half its width."""
    root: Doubles = np.sqrt(np.maximum(1.0 - offset * offset, 0.0))
    return np.exp(_SHAPE * (root - 1.0))


@lru_cache(maxsize=8)
def _kernel_transform(count: int) -> Doubles:
    """Return the sum over the grid of the window times exp(2 pi i f x), its integral, for ``count`` f up to 1/4."""
    offsets, weights = panels([0.0, 1.0], _NODES)
    phases = np.multiply.outer(np.pi * _WIDTH * (np.arange(count) / (4 * count)), offsets)
    return _WIDTH * np.cos(phases) @ (weights * _kernel(offsets))


NOTHING = 39.0
"""-ln of a probability that rounding swallows."""

_MANY_JUNCTIONS = 100.0
_FEWEST, _MOST, _FOR_MANY = 2**13, 2**17, 2**11
_LEAST_REACH, _WIDENING = 32.0, 16.0
_LOST = 1e-10
_WEAKEST, _STRONGEST = 1.0, 20.0
_TAPER_CENTRE, _TAPER_WIDTH = 0.65, 0.042
_STENCIL = np.arange(-4.0, 6.0)
_PADDING = 8
_FEW_TERMS, _AT_ONCE = 2**21, 2**20


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """Density (1/um^2) and distribution function every ``step`` um^2 from ``start`` on, and a little on both sides."""

    start: float
    reach: float
    step: float
    density: Doubles
    cdf: Doubles

    @property
    def end(self) -> float:
        """Where the window ends, in um^2."""
        return self.start + self.reach

    def at(self, area: Doubles, values: Doubles) -> Doubles:
        """Return ``density`` or ``cdf`` at areas inside, by the polynomial through the ten nearest places."""
        place = (area - self.start) / self.step + _PADDING
        nearest = np.floor(place)
        fraction, rows = place - nearest, nearest.astype(np.int64)
        total = np.zeros_like(area)
        for point in _STENCIL:
            others = _STENCIL[point != _STENCIL]
            weight = np.prod(fraction[:, None] - others, axis=1) / np.prod(point - others)
            total += weight * values[rows + int(point)]
        return total


def windows(live: LiveArea, mean_count: float, tails: AreaTails, *, above_two: bool) -> tuple[Window, ...]:
    """Return windows from the first area that occurs, each reaching 16 times further, until nothing is left beyond.

    One is enough unless sizes are spread so widely that a step for the smallest does not reach the largest.
    ``above_two`` leaves out the contributions of two junctions and fewer.
    """
    start, top = tails.lower(NOTHING), tails.upper(NOTHING)
    cutoff = _cutoff(live, mean_count)
    most = _FOR_MANY if mean_count > _MANY_JUNCTIONS else _MOST
    reach = min(top - start, max(pi * most / cutoff, _LEAST_REACH * live.median))
    found = []
    while True:
        # The density is damped by exp(-damping a / period), so that what lies beyond comes back that much smaller.
        damping = min(max(NOTHING - tails.nats_above(start + 2.0 * reach), _WEAKEST), _STRONGEST)
        count = most if mean_count > _MANY_JUNCTIONS else _count(reach * cutoff / pi)
        rates = np.asarray((2j * pi * np.arange(count) - damping) / (2.0 * reach), dtype=np.complex128)
        exponent = mean_count * _transform_less_one(live, rates, tails.furthest)
        found.append(_window(exponent, rates, mean_count if above_two else None, start, reach))
        if reach >= top - start:
            return tuple(found)
        reach = min(_WIDENING * reach, top - start)


def _count(wanted: float) -> int:
    """Return the least power of 2 with enough frequencies, within bounds."""
    return int(2 ** np.ceil(np.log2(np.clip(wanted, _FEWEST, _MOST))))


def _cutoff(live: LiveArea, mean_count: float) -> float:
    """Return the wavenumber in 1/um^2 beyond which three and more junctions add nothing to the characteristic function.

    For N live junctions each |phi(th)| <= y in practice, y twice the
    probability of the lowest or highest 1/|th| of a live area; with
    many of them it falls as exp(-N E[1 - cos(th a)]) at once, and 1 - cos(x) >= 2 x^2/pi^2 up to pi.
    """
    if mean_count > _MANY_JUNCTIONS:
        area, probability = live.rule()
        square = float(np.square(np.minimum(area, live.median)) @ probability)
        return pi * sqrt(-0.5 * np.log(_LOST) / (mean_count * square))
    wavenumbers = np.geomspace(1e-2, 1e8, 1000) / live.median
    at_an_end = np.maximum(live.cdf(1.0 / wavenumbers), 1.0 - live.cdf(live.largest - 1.0 / wavenumbers))
    y = mean_count * np.minimum(1.0, 2.0 * at_an_end)
    left = np.exp(y - mean_count) - exp(-mean_count) * _up_to_two(y)
    return float(wavenumbers[np.argmax(left < _LOST)])


def _window(exponent: Complexes, rates: Complexes, above_two_of: float | None, start: float, reach: float) -> Window:
    """Return a window from the logarithm of the damped characteristic function, its highest frequencies tapered off.

    A Fourier series of period 2 reach. Source: Abate and Whitt (1992), doi:10.1007/BF01158520, section 5.
    """
    transform, mass, count, period = np.exp(exponent - rates * start), 1.0, rates.size, 2.0 * reach
    if above_two_of is not None:
        transform -= exp(-above_two_of) * _up_to_two(exponent + above_two_of)
        mass -= exp(-above_two_of) * _up_to_two(above_two_of)
    transform *= _taper(count)
    damping = -period * float(rates[0].real)
    # Each earlier period adds the whole mass to the distribution function, damped.
    cdf = _series(-transform / rates, damping) / period - mass / expm1(damping)
    density = _series(transform, damping) / period
    return Window(start=start, reach=reach, step=period / (4 * count), density=density, cdf=cdf)


@lru_cache(maxsize=8)
def _taper(count: int) -> Doubles:
    """Return the factor by which each frequency is kept."""
    return 0.5 * complementary_error((np.arange(count) / count - _TAPER_CENTRE) / (sqrt(2.0) * _TAPER_WIDTH))


def _up_to_two(y: Any) -> Any:
    return 1.0 + y + 0.5 * y * y


def _transform_less_one(live: LiveArea, rates: Complexes, furthest: float) -> Complexes:
    """Return E[exp(r a)] - 1 of one live area at evenly spaced complex rates r = i th - q."""
    highest, damping = float(rates[-1].imag), -float(rates[0].real)
    if rates.size * highest * furthest > _FEW_TERMS:
        area, probability = live.rule(highest, min(furthest, NOTHING / damping))
        places = area * (float(rates[1].imag) / (2.0 * pi))
        return point_transform(places, probability * np.exp(-damping * area), rates.size) - 1.0
    # A large mean count multiplies rounding errors: expm1 keeps the digits where the exponent is small.
    area, probability = live.rule(highest, furthest)
    parts = np.array_split(rates, 1 + rates.size * area.size // _AT_ONCE)
    return np.concatenate([np.expm1(np.multiply.outer(part, area)) @ probability for part in parts])


def _series(transform: Complexes, damping: float) -> Doubles:
    """Return period times the function with this transform over half a period, the damping undone."""
    size = 4 * transform.size
    rows = np.arange(-_PADDING, size // 2 + _PADDING)
    return size * np.fft.irfft(np.conj(transform), size)[rows] * np.exp(damping / size * rows)

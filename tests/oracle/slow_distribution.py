"""The distribution of real contact area by slow routes, from the lens and a table of the diameters found alive.

Panjer's recursion (1981, doi:10.1017/S0515036100006796) on areas rounded up and rounded down brackets it for certain,
singular or not; Davies' sum (1973, doi:10.1093/biomet/60.2.415) over the characteristic function is sharp where many
junctions make it smooth. ``sizes`` are diameters in um and the shares of the live junctions that have them.
"""

import numpy as np
from numpy.typing import NDArray

Doubles = NDArray[np.float64]
Sizes = tuple[Doubles, Doubles]


def lens_age(area: Doubles) -> Doubles:
    """Return the half-life u at which a lens of unit diameter has an area: 60 bisections of (y - sin y cos y)/2."""
    low, high = np.zeros_like(area), np.full_like(area, 0.5 * np.pi)
    for _ in range(60):
        y = 0.5 * (low + high)
        less = y - np.sin(y) * np.cos(y) < 2.0 * area
        low, high = np.where(less, y, low), np.where(less, high, y)
    return 1.0 - np.cos(high)


def level(sizes: Sizes, area: Doubles) -> Doubles:
    """Return P(area of a live junction <= a)."""
    diameters, shares = sizes
    return np.array([shares @ lens_age(np.minimum(a / diameters**2, 0.25 * np.pi)) for a in area])


def brackets(sizes: Sizes, mean_count: float, step: float, count: int) -> tuple[Doubles, Doubles]:
    """Return bounds below and above P(A_r <= i step) for i = 0 ... count - 1."""
    largest = min(count, int(np.ceil(0.25 * np.pi * np.max(sizes[0]) ** 2 / step)))
    steps = np.diff(level(sizes, step * np.arange(largest + 1.0)))
    return panjer(np.append(0.0, steps), mean_count, count), panjer(steps, mean_count, count)


def panjer(steps: Doubles, mean_count: float, count: int) -> Doubles:
    """Return the distribution function of a Poisson number of whole numbers that have these probabilities."""
    weighted = steps[1:] * np.arange(1, steps.size)
    found = np.zeros(count)
    found[0] = np.exp(-mean_count * (1.0 - steps[0]))
    for i in range(1, count):
        reach = min(i, weighted.size)
        found[i] = mean_count / i * (weighted[:reach] @ found[i - reach : i][::-1])
    return np.cumsum(found)


def davies(sizes: Sizes, mean_count: float, area: Doubles, period: float, terms: int) -> Doubles:
    """Return P(A_r <= a) by a sum over wavenumbers 2 pi (i + 1/2) / period, which wraps around a period in um^2."""
    diameters, shares = sizes
    x, w = np.polynomial.legendre.leggauss(80)
    y = 0.25 * np.pi * (1.0 + x)
    live = np.multiply.outer(diameters**2, 0.5 * (y - np.sin(y) * np.cos(y))).ravel()
    chance = np.multiply.outer(shares, 0.25 * np.pi * w * np.sin(y)).ravel()
    places = np.arange(terms) + 0.5
    theta = 2.0 * np.pi / period * places
    transform = np.array([np.exp(mean_count * (chance @ np.exp(1j * live * th) - 1.0)) for th in theta])
    return 0.5 - np.imag(np.exp(-1j * np.multiply.outer(area, theta)) * transform) @ (1.0 / (np.pi * places))

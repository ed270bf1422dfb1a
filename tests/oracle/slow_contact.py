"""The contact as the paper tells it, one junction and one tick at a time, and its distribution by slow routes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

# The contact as the paper tells it, one junction and one tick at a time.
Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rows:
    """Junctions by birth: birth, diameter and death in um, strength in MPa; death is birth + 2 d or earlier."""

    birth: Doubles
    diameter: Doubles
    strength: Doubles
    death: Doubles

    def ending_early(self, row: int, death: float) -> Rows:
        """Return the same junctions with one death moved."""
        deaths = self.death.copy()
        deaths[row] = death
        return replace(self, death=deaths)


def segment_area(height: float, d: float) -> float:
    """Return the area (um^2) of a segment of given height (um) of a circle of diameter d (um)."""
    radius = d / 2
    return radius**2 * math.acos(1 - height / radius) - (radius - height) * math.sqrt(height * (d - height))


def junction_area(s: float, d: float) -> float:
    """Return A_j (um^2) at a distance s (um) since birth, Eqs. (2) and (4)."""
    if s <= 0 or s >= 2 * d:
        return 0.0
    if s <= d:
        return 2 * segment_area(s / 2, d)
    return 2 * (math.pi * d**2 / 4 - segment_area(s / 2, d))


def lens_area(s: float, d: float) -> float:
    """Return the lens common to two circles of diameter d (um) whose centres are |d - s| (um) apart."""
    x = abs(d - s)
    if x >= d:
        return 0.0
    return d**2 / 2 * math.acos(x / d) - x / 2 * math.sqrt(d**2 - x**2)


def triangle_area(s: float, d: float) -> float:
    """Return the area (um^2) of Rabinowicz's triangle over a life of 2 d (um), as high as the lens at mid-life."""
    full = math.pi * d**2 / 4
    return full * max(0.0, s / d if s <= d else (2 * d - s) / d)


def traces(
    rows: Rows, distances: Iterable[float], area_of: Callable[[float, float], float] = lens_area
) -> tuple[Doubles, NDArray[np.int64], Doubles]:
    """Return real contact area (um^2), number of junctions and friction force (uN, Eq. 1) at given distances (um).

    A junction counts while birth <= s < death; ``area_of`` says how large it is at a distance since its birth.
    """
    areas, counts, forces = [], [], []
    junctions = list(zip(rows.birth, rows.diameter, rows.strength, rows.death, strict=True))
    for s in distances:
        area, count, force = 0.0, 0, 0.0
        for birth, diameter, strength, death in junctions:
            if birth <= s < death:
                junction = area_of(s - birth, diameter)
                area += junction
                count += 1
                force += strength * junction
        areas.append(area)
        counts.append(count)
        forces.append(force)
    return np.array(areas), np.array(counts, dtype=np.int64), np.array(forces)


def naive_rows(
    *,
    mean_area: float,
    mean_count: float,
    diameter_std: float,
    strength: float,
    distance: float,
    generator: np.random.Generator,
    life_mean: float = 0.327,
) -> Rows:
    """Return the junctions of one run, Eqs. (6) to (13), drawn one by one.

    d_m = sqrt(A_rm / N_jm / life_mean), gaps exponential with mean 2 d_m / N_jm, diameters normal and redrawn while
    they are not positive. The sliding begins so far before 0 that the contact at 0 is stationary (no diameter reaches
    twelve standard deviations above the mean); junctions that are dead by then are left out. Areas um^2, lengths um.
    """
    mean_diameter = math.sqrt(mean_area / mean_count / life_mean)
    mean_gap = 2 * mean_diameter / mean_count
    births, diameters = [], []
    s = -2 * (mean_diameter + 12 * diameter_std)
    while True:
        s += generator.exponential(mean_gap)
        if s >= distance:
            break
        d = 0.0
        while d <= 0:
            d = generator.normal(mean_diameter, diameter_std)
        if s + 2 * d > 0:
            births.append(s)
            diameters.append(d)
    birth, diameter = np.array(births), np.array(diameters)
    return Rows(birth=birth, diameter=diameter, strength=np.full(len(birth), strength), death=birth + 2 * diameter)


# The distribution of real contact area by slow routes, from the lens and a table of the diameters found alive.
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

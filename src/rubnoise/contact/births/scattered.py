"""Births scattered about centres: in clusters about random ones, or jittered about regular ones.

Centres lie in cells along the sliding distance, and a cell's numbers come from its own place in the streams: any
stretch is drawn from its cells alone and then sorted, so that nothing is carried from one block to the next.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor
from typing import Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.births.law import BirthLawEntry, Key
from rubnoise.contact.deviates import exponential, normal_quantile
from rubnoise.streams import Stream, generator, uniforms, uniforms_from

_CENTRES = 1024
_WIDTHS = 4.0  # of a cell at least: if scatter is wide, a stretch would need many cells
_FARTHEST = 8.3  # widths that the least and the largest uniform move a birth
_KEPT = 2**18  # births of a cell that are drawn all at once and kept for the next stretch
_REMEMBERED = 11.0  # sqrt 2 widths, as e-folds of a normal law: exp(-11^2/4) = 7e-14


@dataclass(frozen=True, slots=True, kw_only=True)
class Families:
    """The centres of a cell in um, in order, and how many births come ``before`` each, and in all at the end."""

    centres: Doubles
    before: NDArray[np.int64]

    @classmethod
    def of(cls, centres: Doubles, sizes: NDArray[np.int64]) -> Self:
        """Return centres with the given number of births each."""
        return cls(centres=centres, before=np.concatenate([[0], np.cumsum(sizes)]))


@dataclass(frozen=True, slots=True, kw_only=True)
class ScatteredBirths(ABC):
    """Births at normal offsets from centres, in um."""

    mean_spacing: float

    @property
    def mean(self) -> float:
        """Mean gap in um."""
        return self.mean_spacing

    @property
    @abstractmethod
    def width(self) -> float:
        """Standard deviation in um of each offset."""

    @property
    @abstractmethod
    def cell(self) -> float:
        """Length in um of a cell of centres."""

    @abstractmethod
    def families(self, seed: int, number: int) -> Families:
        """Return the centres of a cell, in order, and how many births each has."""

    @property
    def memory(self) -> float:
        """Distance in um: two births of one centre lie sqrt 2 widths apart."""
        return _REMEMBERED * self.width

    def between(self, seed: int, begin: float, end: float) -> Doubles:
        """Return the births of a run that lie from ``begin`` to ``end`` um, in order."""
        reach = _FARTHEST * self.width + 8.0 * float(np.spacing(max(abs(begin), abs(end))))
        cells = range(floor((begin - reach) / self.cell) - 1, ceil((end + reach) / self.cell) + 1)
        found = np.concatenate([self._of_cell(seed, number, begin - reach, end + reach) for number in cells])
        return np.sort(found[(begin <= found) & (found <= end)])

    def _of_cell(self, seed: int, number: int, begin: float, end: float) -> Doubles:
        """Return the births of a cell: all of a small cell, those with centres in a stretch (um) of a large one."""
        families = _families(self, seed, number)
        if families.before[-1] <= _KEPT:
            return _births_of(self, seed, number)
        first, last = np.searchsorted(families.centres, [begin, end]).tolist()
        return _scattered(self, seed, number, first, last)

    def following(self, seed: int, begin: float, count: int) -> Doubles:
        """Return the first births of a run from ``begin`` um on."""
        reach = (count + 100) * self.mean_spacing
        while (found := self.between(seed, begin, begin + reach)).size < count:
            reach *= 1.25
        return found[:count]


@lru_cache(maxsize=32)
def _families(births: ScatteredBirths, seed: int, number: int) -> Families:
    return births.families(seed, number)


@lru_cache(maxsize=32)
def _births_of(births: ScatteredBirths, seed: int, number: int) -> Doubles:
    families = _families(births, seed, number)
    return _scattered(births, seed, number, 0, families.centres.size)


def _scattered(births: ScatteredBirths, seed: int, number: int, first: int, last: int) -> Doubles:
    """Return the places in um of the births of some centres of a cell, in any order; no offset exceeds 8.3 widths."""
    families = _families(births, seed, number)
    before, until = int(families.before[first]), int(families.before[last])
    shares = uniforms_from(seed, Stream.CHILDREN, number % 2**64, before, until - before)
    offsets = normal_quantile(np.maximum(shares, 2.0**-54))
    return np.repeat(families.centres[first:last], np.diff(families.before[first : last + 1])) + births.width * offsets


@dataclass(frozen=True, slots=True, kw_only=True)
class ClusteredBirths(ScatteredBirths):
    """Poisson(mu) births about each centre of a Poisson process of rate lam/mu, at normal offsets of standard dev. w.

    mu is cluster_size, w (um) cluster_width, lam = 1/s_jm. S_N(k)/lam = 1 + mu exp(-(k w)^2).
    Source: Neyman and Scott (1958), doi:10.1111/j.2517-6161.1958.tb00272.x.
    """

    cluster_size: float
    cluster_width: float

    @property
    def width(self) -> float:
        """Standard deviation in um of each offset."""
        return self.cluster_width

    @property
    def cell(self) -> float:
        """Length in um of a cell: of 1024 centres, or 4 widths."""
        return max(_CENTRES * self.cluster_size * self.mean_spacing, _WIDTHS * self.cluster_width)

    @property
    def dispersion(self) -> float:
        """1 + mu."""
        return 1.0 + self.cluster_size

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return mu exp(-(k w)^2)."""
        return self.cluster_size * np.exp(-np.square(wavenumber * self.cluster_width))

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return 0: there are no lines."""
        return np.zeros_like(wavenumber)

    def families(self, seed: int, number: int) -> Families:
        """Return the centres of a cell, and the size of each cluster."""
        centres = number * self.cell + self._centres(seed, number)
        shares = uniforms(seed, Stream.FAMILIES, number % 2**64, centres.size)
        return Families.of(centres, np.searchsorted(_poisson_table(self.cluster_size), shares, side="right"))

    def _centres(self, seed: int, number: int) -> Doubles:
        """Return the centres of a cell in um from its begin: exponential gaps, independent of other cells."""
        source = generator(seed, Stream.CENTRES, number % 2**64)
        places, last, spacing = [np.empty(0)], 0.0, self.cluster_size * self.mean_spacing
        while last < self.cell:
            gaps = spacing * exponential(source.random(_CENTRES))
            places.append(np.add.accumulate(np.concatenate([[last], gaps]))[1:])
            last = float(places[-1][-1])
        found = np.concatenate(places)
        return found[found < self.cell]


@lru_cache(maxsize=16)
def _poisson_table(mean: float) -> Doubles:
    """Return P(n <= 0), P(n <= 1), ... of a Poisson number up to the largest uniform, rounded once."""
    import mpmath

    table: list[float] = []
    with mpmath.workdps(40):
        term = total = mpmath.exp(-mpmath.mpf(mean))
        while not table or table[-1] < 1.0:
            table.append(float(total))
            term *= mpmath.mpf(mean) / len(table)
            total += term
    return np.array(table)


@dataclass(frozen=True, slots=True, kw_only=True)
class JitteredBirths(ScatteredBirths):
    """Births at one spacing s_jm about a place at random, each moved by a normal offset of standard deviation j s_jm.

    S_N(k)/lam = 1 - q, and lines at k = 2 pi n lam of q times those of regular births, q = exp(-(k j s_jm)^2).
    Source: Daley and Vere-Jones, An Introduction to the Theory of Point Processes I (2003), section 8.2.
    """

    jitter: float

    @property
    def width(self) -> float:
        """Standard deviation in um of each offset."""
        return self.jitter * self.mean_spacing

    @property
    def cell(self) -> float:
        """Length in um of a cell of 1024 centres."""
        return _CENTRES * self.mean_spacing

    @property
    def dispersion(self) -> float:
        """0: the number of births in a long distance varies only at its two ends."""
        return 0.0

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return -exp(-(k j s_jm)^2)."""
        return -np.exp(-np.square(wavenumber * self.width))

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return exp(-(k j s_jm)^2)."""
        return np.exp(-np.square(wavenumber * self.width))

    def families(self, seed: int, number: int) -> Families:
        """Return the places of a cell, with one birth each."""
        phase = float(uniforms(seed, Stream.FIRST_BIRTH, 0, 1)[0])
        centres = (number * _CENTRES + np.arange(_CENTRES, dtype=np.float64) + phase) * self.mean_spacing
        return Families.of(centres, np.ones(_CENTRES, dtype=np.int64))


CLUSTERED_ENTRY = BirthLawEntry(
    name="clustered",
    about="clusters about random places (Neyman and Scott)",
    make=ClusteredBirths,
    keys=(
        Key(name="cluster_size", about="Mean number of births in a cluster", sample=3.0),
        Key(
            name="cluster_width", about="Standard deviation of births about the centre of their cluster", sample="2 um"
        ),
    ),
)
JITTERED_ENTRY = BirthLawEntry(
    name="jittered",
    about="equal gaps whose births are moved at random",
    make=JitteredBirths,
    keys=(
        Key(
            name="jitter", about="Standard deviation of a birth about its place, as a percentage of s_jm", sample="30 %"
        ),
    ),
)

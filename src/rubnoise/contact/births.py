"""The laws of births along the sliding distance, with the exact second moments of their number.

S_N(k) is the spectral density of births per um, lam = 1/s_jm their rate; S_N = lam for births at random. A law draws
the births beyond a place block by block, those before the start in blocks of their own. To add one, write its class and
its entry in `BIRTHS`, from which scenario keys, schema and docs read.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, inf
from typing import ClassVar, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import special
from rubnoise.contact.laws import LawEntry, Parameter
from rubnoise.streams import Stream, uniforms

_FORGOTTEN: Final = 30.0  # e-folds after which nothing is remembered of a gap
_REMEMBERED: Final = 11.0  # sqrt 2 widths, as e-folds of a normal law: exp(-11^2/4) = 7e-14
_FARTHEST: Final = 8.3  # widths that the least and the largest uniform move a birth
_IN_A_CELL: Final = 4096.0  # births of a cell, about; it is at least four widths long, or a stretch would need many


@dataclass(frozen=True, slots=True, kw_only=True)
class BirthLaw(ABC):
    """A stationary law of births of a mean spacing s_jm = L_jm / N_jm in um (paper, second Eq. 12).

    Laws of equal parameters are one: tables are kept by law.
    """

    mean_spacing: float
    has_lines: ClassVar[bool] = False
    """Whether births keep to places at one spacing, so that their spectrum has lines."""

    @property
    def dispersion(self) -> float:
        """S_N(0)/lam: variance over mean of the number of births in a long distance."""
        return 1.0 + float(self.excess(np.zeros(1))[0])

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return S_N(k)/lam - 1 between lines, for k >= 0 in rad/um."""
        return np.zeros_like(wavenumber)

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return the power of a line at k = 2 pi n lam as a part of that of regular births: it is missing between."""
        return -self.excess(wavenumber) if self.has_lines else np.zeros_like(wavenumber)

    @property
    def memory(self) -> float:
        """Distance in um beyond which births are independent to 1e-13; spectral lines are not counted."""
        return 0.0

    @abstractmethod
    def around(self, seed: int) -> tuple[float, float]:
        """Return the places (um) of the last birth before the start, below 0, and of the first one after it."""

    @abstractmethod
    def places(self, seed: int, block: int, place: float, count: int, way: int) -> Doubles:
        """Return the places (um) of a block's births, the first of them at ``place``, and of the next block's first.

        way: 1 to go forward; -1 backward, in the blocks before the start.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class GapLaw(BirthLaw):
    """A law of births whose gaps are independent: read backward, they have the same law."""

    @abstractmethod
    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform on (0, 1)."""

    def places(self, seed: int, block: int, place: float, count: int, way: int) -> Doubles:
        """Return each as the one before it plus its gap, as an event clock adds."""
        stream = Stream.GAPS if way > 0 else Stream.PAST_GAPS
        gaps = self.gaps(uniforms(seed, stream, block, count))
        return np.add.accumulate(np.concatenate([[place], way * gaps]))


@dataclass(frozen=True, slots=True, kw_only=True)
class PoissonBirths(GapLaw):
    """Births at random: independent exponential gaps, whose variance is s_jm^2.

    The number of births in a distance s is Poisson(s / s_jm).
    """

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform."""
        return -self.mean_spacing * np.log1p(-uniform)

    def around(self, seed: int) -> tuple[float, float]:
        """Return the ends of two gaps: the law has no memory."""
        after, before = self.gaps(uniforms(seed, Stream.FIRST_BIRTH, 0, 2)).tolist()
        return -before, after


@dataclass(frozen=True, slots=True, kw_only=True)
class RegularBirths(BirthLaw):
    """Births at one spacing about a place chosen at random: Rabinowicz's births.

    Source: Rabinowicz (1956), as in the paper ("at precisely regular moments in time"). Each place is computed from the
    first: if spacings were added one by one, their rounding errors would add up.
    """

    has_lines: ClassVar[bool] = True

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return -1: all power lies in the lines."""
        return np.full_like(wavenumber, -1.0)

    @property
    def memory(self) -> float:
        """Infinite: the phase is never forgotten."""
        return inf

    def around(self, seed: int) -> tuple[float, float]:
        """Return places about a uniform phase."""
        after = self.mean_spacing * float(uniforms(seed, Stream.FIRST_BIRTH, 0, 1)[0])
        return after - self.mean_spacing, after

    def places(self, seed: int, block: int, place: float, count: int, way: int) -> Doubles:
        """Return places by their number from the first birth on, which is one spacing after the last before it."""
        del place
        number = block * count + np.arange(count + 1.0) + (way < 0)
        return self.around(seed)[1] + way * number * self.mean_spacing


@dataclass(frozen=True, slots=True, kw_only=True)
class GammaBirths(GapLaw):
    """Independent gamma gaps of shape a and variance s_jm^2 / a: Poisson for a = 1, regular as a grows.

    S_N(k)/lam = Re[(1 + f)/(1 - f)], f = (1 - i k s_jm / a)^-a. Source: Cox, Renewal Theory (1962).
    """

    shape: float

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return 2 Re[f/(1 - f)], 1/a - 1 at k = 0."""
        turns = wavenumber * self.mean_spacing
        x = np.maximum(turns, 1e-5) / self.shape
        power = self.shape * (0.5 * np.log1p(x * x) - 1j * np.arctan(x))  # ln(1 - i x), where x is small too
        found = 2.0 * (np.exp(-power) / -np.expm1(-power)).real
        return np.where(turns < 1e-5, 1.0 / self.shape - 1.0, found)

    @property
    def memory(self) -> float:
        """Distance in um: by 1/(a lam) an e-fold at the cut of f, by a/(2 pi^2 lam) at the pole of 1/(1 - f)."""
        return _FORGOTTEN * self.mean_spacing * max(1.0 / self.shape, 1.0, self.shape / 19.0)

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform; a gap of 0, which a small shape makes of a small one, is left."""
        return np.asarray(special().gammaincinv(self.shape, uniform) * (self.mean_spacing / self.shape))

    def around(self, seed: int) -> tuple[float, float]:
        """Return a gap about the start: a place at random lies in one of density x f(x)/s_jm, gamma of shape a + 1."""
        chance, share = uniforms(seed, Stream.FIRST_BIRTH, 0, 2).tolist()
        gap = float(special().gammaincinv(self.shape + 1.0, chance)) * self.mean_spacing / self.shape
        return -gap * (1.0 - share), gap * share


@dataclass(frozen=True, slots=True, kw_only=True)
class ScatteredBirths(BirthLaw):
    """Births at normal offsets from centres, which lie in cells along the sliding distance.

    A cell's numbers come from its own place in the streams. So any stretch is drawn from its cells alone and then
    sorted, and nothing is carried from one block to the next.
    """

    @property
    @abstractmethod
    def width(self) -> float:
        """Standard deviation in um of each offset."""

    @property
    @abstractmethod
    def cell(self) -> float:
        """Length in um of a cell of centres."""

    @abstractmethod
    def parents(self, seed: int, number: int) -> Doubles:
        """Return for each birth of a cell the centre (um) that it belongs to, in order."""

    @property
    def memory(self) -> float:
        """Distance in um: two births of one centre lie sqrt 2 widths apart."""
        return _REMEMBERED * self.width

    def between(self, seed: int, begin: float, end: float) -> Doubles:
        """Return the births of a run that lie from ``begin`` to ``end`` um, in order."""
        reach = _FARTHEST * self.width + 8.0 * float(np.spacing(max(abs(begin), abs(end))))
        cells = range(floor((begin - reach) / self.cell), ceil((end + reach) / self.cell) + 1)
        found = np.concatenate([_of_cell(self, seed, number) for number in cells])
        return np.sort(found[(begin <= found) & (found <= end)])

    def around(self, seed: int) -> tuple[float, float]:
        """Return the nearest births on either side of the start."""
        return float(self.places(seed, 0, 0.0, 1, -1)[1]), float(self.places(seed, 0, 0.0, 1, 1)[1])

    def places(self, seed: int, block: int, place: float, count: int, way: int) -> Doubles:
        """Return a place and the nearest births beyond it, whichever block it is."""
        del block
        nearest, reach = float(np.nextafter(place, way * inf)), (count + 100) * self.mean_spacing
        while True:
            begin, end = sorted((nearest, place + way * reach))
            found = self.between(seed, begin, end)[::way]
            if found.size >= count:
                return np.concatenate([[place], found[:count]])
            reach *= 1.25


@lru_cache(maxsize=32)
def _of_cell(births: ScatteredBirths, seed: int, number: int) -> Doubles:
    """Return the places in um of the births of a cell, in any order."""
    centres = births.parents(seed, number)
    return centres + births.width * special().ndtri(uniforms(seed, Stream.CHILDREN, number % 2**64, centres.size))


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
        """Length in um of a cell: of some births, of a centre or more, and of four widths or more."""
        return max(_IN_A_CELL, self.cluster_size) * self.mean_spacing + 4.0 * self.cluster_width

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return mu exp(-(k w)^2)."""
        return self.cluster_size * np.exp(-np.square(wavenumber * self.cluster_width))

    def parents(self, seed: int, number: int) -> Doubles:
        """Return the centres, a Poisson number of them at uniform places of the cell, each for all of its births."""
        mean = self.cell / (self.cluster_size * self.mean_spacing)
        chance = uniforms(seed, Stream.FAMILIES, number % 2**64, 1)
        places = uniforms(seed, Stream.CENTRES, number % 2**64, int(_poisson(mean, chance)[0]))
        sizes = _poisson(self.cluster_size, uniforms(seed, Stream.SIZES, number % 2**64, places.size))
        return np.repeat((number + np.sort(places)) * self.cell, sizes)


def _poisson(mean: float, chance: Doubles) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return a Poisson number for each uniform: the least n with P(N <= n) above it."""
    most = ceil(mean + 10.0 * mean**0.5 + 60.0)
    return np.searchsorted(special().pdtr(np.arange(most), mean), chance, side="right")


@dataclass(frozen=True, slots=True, kw_only=True)
class JitteredBirths(ScatteredBirths):
    """Births at one spacing s_jm about a place at random, each moved by a normal offset of standard deviation j s_jm.

    S_N(k)/lam = 1 - q, and lines at k = 2 pi n lam of q times those of regular births, q = exp(-(k j s_jm)^2).
    Source: Daley and Vere-Jones, An Introduction to the Theory of Point Processes I (2003), section 8.2.
    """

    has_lines: ClassVar[bool] = True
    jitter: float

    @property
    def width(self) -> float:
        """Standard deviation in um of each offset."""
        return self.jitter * self.mean_spacing

    @property
    def cell(self) -> float:
        """Length in um of a cell."""
        return max(_IN_A_CELL, ceil(4.0 * self.jitter)) * self.mean_spacing

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return -exp(-(k j s_jm)^2)."""
        return -np.exp(-np.square(wavenumber * self.width))

    def parents(self, seed: int, number: int) -> Doubles:
        """Return the places of a cell, with one birth each."""
        count = round(self.cell / self.mean_spacing)
        phase = float(uniforms(seed, Stream.FIRST_BIRTH, 0, 1)[0])
        return (number * count + np.arange(float(count)) + phase) * self.mean_spacing


_CLUSTERS: Final = (
    Parameter(name="cluster_size", about="Mean number of births in a cluster", sample=3.0),
    Parameter(
        name="cluster_width", about="Standard deviation of births about the centre of their cluster", sample="2 um"
    ),
)
_JITTER: Final = "Standard deviation of a birth about its place, as a percentage of s_jm"
_SHAPE: Final = "Shape a of the gaps, whose variance is the squared mean over a"
_GAMMA: Final = "independent gamma gaps of a shape: 1 is poisson, large is regular, below 1 comes in bunches"
_ENTRIES: Final = (
    LawEntry("poisson", "independent exponential gaps of sliding distance", PoissonBirths),
    LawEntry("regular", "equal gaps", RegularBirths),
    LawEntry("gamma", _GAMMA, GammaBirths, (Parameter(name="shape", about=_SHAPE, sample=4.0),)),
    LawEntry("clustered", "clusters about random places (Neyman and Scott)", ClusteredBirths, _CLUSTERS),
    LawEntry(
        "jittered",
        "equal gaps whose births are moved at random",
        JitteredBirths,
        (Parameter(name="jitter", about=_JITTER, sample="30 %"),),
    ),
)

BIRTHS: Final[dict[str, LawEntry]] = {entry.name: entry for entry in _ENTRIES}
"""Every law of births by its name in a scenario; ``make`` takes mean_spacing (um) and the law's own parameters."""

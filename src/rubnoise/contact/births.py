"""The laws of births along the sliding distance, with the exact second moments of their number.

S_N(k) is the spectral density of births per um, lam = 1/s_jm their rate; S_N = lam for births at random. A law draws
the births after a place block by block, and those before the start in blocks of their own. To add one, write its class
and name its entry in `BIRTHS`, from which scenario keys, schema and docs read.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, inf
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import special
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

    @property
    def mean(self) -> float:
        """Mean gap in um."""
        return self.mean_spacing

    @property
    @abstractmethod
    def dispersion(self) -> float:
        """S_N(0)/lam: variance over mean of the number of births in a long distance."""

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return S_N(k)/lam - 1 between lines, for k >= 0 in rad/um."""
        return np.zeros_like(wavenumber)

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return the power of a line at k = 2 pi n lam as a part of that of regular births."""
        return np.zeros_like(wavenumber)

    @property
    def memory(self) -> float:
        """Distance in um beyond which births are independent to 1e-13; spectral lines are not counted."""
        return 0.0

    @abstractmethod
    def around(self, seed: int) -> tuple[float, float]:
        """Return the places (um) of the last birth before the start, below 0, and of the first one after it."""

    @abstractmethod
    def following(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return the places (um) of a block's births after its first one, which is at ``place``, and the next first."""

    @abstractmethod
    def preceding(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return likewise the places before one that lies before the start, latest first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GapLaw(BirthLaw):
    """A law of births whose gaps are independent: read backward, they have the same law."""

    @abstractmethod
    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform on (0, 1)."""

    def following(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return each as the one before plus its gap, as an event clock adds."""
        gaps = self.gaps(uniforms(seed, Stream.GAPS, block, count))
        return np.add.accumulate(np.concatenate([[place], gaps]))[1:]

    def preceding(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return each as the one after it less its gap."""
        gaps = self.gaps(uniforms(seed, Stream.PAST_GAPS, block, count))
        return np.subtract.accumulate(np.concatenate([[place], gaps]))[1:]


@dataclass(frozen=True, slots=True, kw_only=True)
class PoissonBirths(GapLaw):
    """Births at random: independent exponential gaps, whose variance is s_jm^2.

    The number of births in a distance s is Poisson(s / s_jm).
    """

    @property
    def dispersion(self) -> float:
        """1: the number of births is Poisson."""
        return 1.0

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

    @property
    def dispersion(self) -> float:
        """0: the number of births in a distance is fixed to within one."""
        return 0.0

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return -1: the spectrum of regular births is zero between its lines."""
        return np.full_like(wavenumber, -1.0)

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return 1: all power lies in the lines."""
        return np.ones_like(wavenumber)

    @property
    def memory(self) -> float:
        """Infinite: the phase is never forgotten."""
        return inf

    def around(self, seed: int) -> tuple[float, float]:
        """Return places about a uniform phase."""
        after = self.mean_spacing * float(uniforms(seed, Stream.FIRST_BIRTH, 0, 1)[0])
        return after - self.mean_spacing, after

    def following(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return places by their number."""
        del place
        return self.around(seed)[1] + (block * count + np.arange(1.0, count + 1.0)) * self.mean_spacing

    def preceding(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return places by their number before the first one."""
        del place
        return self.around(seed)[1] - (block * count + np.arange(2.0, count + 2.0)) * self.mean_spacing


@dataclass(frozen=True, slots=True, kw_only=True)
class GammaBirths(GapLaw):
    """Independent gamma gaps of shape a and variance s_jm^2 / a: Poisson for a = 1, regular as a grows.

    S_N(k)/lam = Re[(1 + f)/(1 - f)], f = (1 - i k s_jm / a)^-a. Source: Cox, Renewal Theory (1962).
    """

    shape: float

    @property
    def dispersion(self) -> float:
        """1/a."""
        return 1.0 / self.shape

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return 2 Re[f/(1 - f)], 1/a - 1 at k = 0."""
        turns = wavenumber * self.mean_spacing
        x = np.maximum(turns, 1e-5) / self.shape
        power = self.shape * (0.5 * np.log1p(x * x) - 1j * np.arctan(x))  # ln(1 - i x), where x is small too
        found = 2.0 * (np.exp(-power) / -np.expm1(-power)).real
        return np.where(turns < 1e-5, self.dispersion - 1.0, found)

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
        return float(self._beyond(seed, 0.0, 1, -1)[0]), float(self._beyond(seed, 0.0, 1, 1)[0])

    def following(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return the next births after a place, whichever block it is."""
        del block
        return self._beyond(seed, place, count, 1)

    def preceding(self, seed: int, block: int, place: float, count: int) -> Doubles:
        """Return the births before a place, latest first."""
        del block
        return self._beyond(seed, place, count, -1)

    def _beyond(self, seed: int, place: float, count: int, way: int) -> Doubles:
        """Return the nearest births beyond a place: way 1 after it, -1 before it."""
        nearest, reach = float(np.nextafter(place, way * inf)), (count + 100) * self.mean_spacing
        while True:
            begin, end = sorted((nearest, place + way * reach))
            found = self.between(seed, begin, end)[::way]
            if found.size >= count:
                return found[:count]
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

    @property
    def dispersion(self) -> float:
        """1 + mu: Poisson numbers of clusters, each of a Poisson number."""
        return 1.0 + self.cluster_size

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

    jitter: float

    @property
    def width(self) -> float:
        """Standard deviation in um of each offset."""
        return self.jitter * self.mean_spacing

    @property
    def cell(self) -> float:
        """Length in um of a cell."""
        return max(_IN_A_CELL, ceil(4.0 * self.jitter)) * self.mean_spacing

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

    def parents(self, seed: int, number: int) -> Doubles:
        """Return the places of a cell, with one birth each."""
        count = round(self.cell / self.mean_spacing)
        phase = float(uniforms(seed, Stream.FIRST_BIRTH, 0, 1)[0])
        return (number * count + np.arange(float(count)) + phase) * self.mean_spacing


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """A key of its own that a law of births takes beside `law`: what a page says of it, and an ordinary value."""

    name: str
    about: str
    sample: str | float


@dataclass(frozen=True, slots=True, kw_only=True)
class BirthLawEntry:
    """A law of births: its name in scenarios, what a page says of it, the keys it takes, and how it is made.

    ``make`` takes mean_spacing (um) and the keys by name: lengths in um, ratios as parts of 1.
    """

    name: str
    about: str
    make: Callable[..., Any]
    keys: tuple[Key, ...] = ()


_CLUSTERS = (
    Key(name="cluster_size", about="Mean number of births in a cluster", sample=3.0),
    Key(name="cluster_width", about="Standard deviation of births about the centre of their cluster", sample="2 um"),
)
_JITTER = "Standard deviation of a birth about its place, as a percentage of s_jm"
_SHAPE = "Shape a of the gaps, whose variance is the squared mean over a"
_ENTRIES = (
    BirthLawEntry(name="poisson", about="independent exponential gaps of sliding distance", make=PoissonBirths),
    BirthLawEntry(name="regular", about="equal gaps", make=RegularBirths),
    BirthLawEntry(
        name="gamma",
        about="independent gamma gaps of a shape: 1 is poisson, large is regular, below 1 comes in bunches",
        make=GammaBirths,
        keys=(Key(name="shape", about=_SHAPE, sample=4.0),),
    ),
    BirthLawEntry(
        name="clustered",
        about="clusters about random places (Neyman and Scott)",
        make=ClusteredBirths,
        keys=_CLUSTERS,
    ),
    BirthLawEntry(
        name="jittered",
        about="equal gaps whose births are moved at random",
        make=JitteredBirths,
        keys=(Key(name="jitter", about=_JITTER, sample="30 %"),),
    ),
)

BIRTHS: Final[dict[str, BirthLawEntry]] = {entry.name: entry for entry in _ENTRIES}
"""Every law of births by its name in a scenario."""

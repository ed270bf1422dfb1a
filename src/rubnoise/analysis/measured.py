"""What is measured of a run: one sink that sums up the rows of a run, of a record or of a file.

Every figure of a summary and of a comparison reads it, and memory does not grow with the run. Moments are over the part
of each group in which the start is forgotten.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import ceil
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.balance import Balance
from rubnoise.analysis.findings import UniformSample
from rubnoise.analysis.moments import forgetting, settled
from rubnoise.analysis.records import CovarianceSum
from rubnoise.analysis.selection import checked_chunks
from rubnoise.analysis.spectra import WelchSum
from rubnoise.arrays import Doubles
from rubnoise.contact.births import GammaBirths, PoissonBirths
from rubnoise.contact.distributions import Fixed
from rubnoise.contact.pulses import area_of
from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.moments import WATCHED, Moments, Slips
from rubnoise.record.reader import Rows
from rubnoise.record.rows import JunctionState, LandmarkKind
from rubnoise.record.sink import Columns
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.sizes import longest_life

STRETCHES: Final = 32
"""Stretches of a run, by whose scatter an error of sampling is known where theory gives none."""

WINDOWS: Final = (0.6180339887498949, 2.618033988749895, 11.090169943749475)
"""Windows in which births are counted, in mean spacings; none keeps step with births that do."""

_LAGS: Final = (0.125, 0.25, 0.5, 0.75)
_LIVES_A_SEGMENT, _MOST_TICKS_A_LIFE, _FEWEST_TICKS = 16.0, 4096, 16
_QUANTILES: Final = 1 << 17


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampling:
    """How noise is taken, and how many ticks ``apart`` share no junction.

    Spectrum and autocovariance take every ``stride``-th tick, so that fine ticks cost no more than they are worth;
    ``segment`` and ``lags`` count those.
    """

    apart: int
    stride: int
    segment: int
    lags: tuple[int, ...]

    @classmethod
    @lru_cache(maxsize=8)
    def of(cls, model: Model) -> "Sampling":
        """Return the layout that suits a model; no part of it grows with its runs."""
        life, longest = model.mean_life_distance, longest_life(model)
        stride = max(1, int(longest / model.tick) // _MOST_TICKS_A_LIFE)
        ticks = life / (stride * model.tick)
        return cls(
            apart=int(longest / model.tick) + 2,
            stride=stride,
            segment=max(_FEWEST_TICKS, 2 ** ceil(np.log2(max(_LIVES_A_SEGMENT * ticks, 1.0)))),
            lags=tuple(sorted({max(1, round(share * ticks)) for share in _LAGS})),
        )


class Stretches:
    """Sums of a column over STRETCHES stretches of equally many ticks, and its values at their begins and ends."""

    def __init__(self, length: int) -> None:
        self.length, self.sums, self.ends = length, np.zeros(STRETCHES), np.zeros(STRETCHES + 1)

    def add(self, first: int, values: Doubles) -> None:
        """Add the ticks from ``first`` on."""
        within = values[: max(STRETCHES * self.length - first, 0)]
        number = np.arange(first, first + within.size) // self.length
        self.sums += np.bincount(number, within, minlength=STRETCHES)
        begun = np.arange(-(-first // self.length), min((first + values.size - 1) // self.length, STRETCHES) + 1)
        self.ends[begun] = values[begun * self.length - first]

    @property
    def means(self) -> Doubles:
        """Means over the stretches, with half of the value at each end."""
        return np.asarray((self.sums + 0.5 * np.diff(self.ends)) / self.length, dtype=np.float64)

    @property
    def gained(self) -> Doubles:
        """Increase of the column in each stretch, per tick."""
        return np.asarray(np.diff(self.ends) / self.length, dtype=np.float64)


class Windows:
    """Mean squares of the number of births in windows of one length, less the expected number, by stretch of a run."""

    def __init__(self, model: Model, spacings: float) -> None:
        self.length, self.expected = spacings * model.mean_birth_spacing, spacings
        self.each = int(model.distance / self.length) // STRETCHES
        self._sums = np.zeros((2, STRETCHES))
        self._number, self._count = 0, 0

    def add(self, birth: Doubles) -> None:
        """Add births in order."""
        number, counts = np.unique(np.append(self._number, np.floor(birth / self.length)), return_counts=True)
        counts[0] += self._count - 1
        self._take(number[:-1].astype(np.int64), counts[:-1].astype(np.float64))
        self._number, self._count = int(number[-1]), int(counts[-1])

    def _take(self, number: NDArray[np.int64], counts: Doubles) -> None:
        within = number < self.each * STRETCHES
        stretch = number[within] // max(self.each, 1)
        for row, power in enumerate((1, 2)):
            self._sums[row] += np.bincount(stretch, counts[within] ** power, STRETCHES)

    def squares(self) -> Doubles:
        """Return the mean over each stretch; call it once, at the end."""
        self._take(np.array([self._number]), np.array([float(self._count)]))
        return np.asarray((self._sums[1] - 2.0 * self.expected * self._sums[0]) / self.each + self.expected**2)


class Births:
    """The junctions that are born along a run: gaps, places, sizes, strengths; and who is there at the start."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self.count, self.last, self.squares = 0, 0.0, 0.0
        self.shortest, self.longest = np.inf, 0.0
        self.gaps, self.places, self.sizes, self.offsets = (UniformSample() for _ in range(4))
        alike = {"diameter": model.sizes.moment(1)}
        if model.strengths is not None:
            alike["shear_strength"] = model.strengths.moment(1)
        self._alike, self.deviations = alike, dict.fromkeys(alike, 0.0)
        self.moments = {name: Moments(powers=2) for name in alike}
        self.windows = [] if isinstance(model.births, PoissonBirths) else [Windows(model, n) for n in WINDOWS]
        self.law = np.sort(model.sizes.quantile((np.arange(_QUANTILES) + 0.5) / _QUANTILES))
        self._start: list[Doubles] = [np.empty((3, 0))]

    @property
    def start(self) -> Doubles:
        """Ages as a share of their lives, diameters (um) and offsets (um) of the junctions alive at the start."""
        return np.concatenate(self._start, axis=1)

    def add(self, columns: Columns) -> None:
        """Add rows of /junctions."""
        birth, diameter, life = (columns[name] for name in ("birth_distance", "diameter", "life_distance"))
        offset = columns.get("lateral_offset", np.zeros(birth.size))
        there = (columns["state"] & JunctionState.ALIVE_AT_START) != 0
        self._start.append(np.stack([-birth[there] / life[there], diameter[there], offset[there]]))
        born = ~np.signbit(birth)
        if not born.any():
            return
        self._add_places(birth[born])
        self.sizes.add(np.searchsorted(self.law, diameter[born]) / _QUANTILES)
        self.offsets.add(0.5 + 0.5 * offset[born] / diameter[born])
        for name, value in self._alike.items():
            self.moments[name].add(columns[name][born])
            away = float(np.abs(columns[name][born] - value).max())
            self.deviations[name] = max(self.deviations[name], away)

    def _add_places(self, birth: Doubles) -> None:
        gaps = np.diff(birth, prepend=self.last)
        whole = gaps[1:] if self.count == 0 else gaps  # the first one may have begun before the run
        if whole.size:
            self.shortest = min(self.shortest, float(whole.min()))
            self.longest = max(self.longest, float(whole.max()))
        law = self._model.births
        if isinstance(law, GammaBirths):
            from scipy.special import gammainc

            self.gaps.add(gammainc(law.shape, law.shape * whole / law.mean_spacing))
        else:
            self.gaps.add(-np.expm1(-gaps / law.mean_spacing))
        for windows in self.windows:
            windows.add(birth)
        self.squares += float(np.square(gaps).sum())
        self.places.add(birth / self._model.distance)
        self.last, self.count = float(birth[-1]), self.count + birth.size


class Measured:
    """A sink: moments of columns from the ``first`` tick of their groups on, the landmarks, and the last balance.

    ``slips`` are those of a two-way slider that are longer than its diameter d_m, ``kinds`` the numbers of landmarks of
    each kind.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.moments: dict[tuple[str, str], Moments] = {}
        self.last: dict[str, float] = {}
        self.kinds = np.zeros(len(LandmarkKind), dtype=np.int64)
        self.slips = Slips(longer_than=model.calibrated_diameter)

    @cached_property
    def first(self) -> Mapping[str, int]:
        """Where the start of a run is forgotten, by group; 0 in a run that is too short for that."""
        return {group: tick or 0 for group, tick in settled(self.model).items()}

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Add rows of a group (see Sink)."""
        for name, powers in WATCHED.get(group, {}).items():
            if name in columns:
                # Under a load the force is judged with the load, from where the start is forgotten.
                of = "load" if name == "friction_force" and self.model.held is not None else group
                seen = self.moments.setdefault((of, name), Moments(powers=powers))
                seen.add(columns[name][self.skipped(of, first_row, columns) :])
        if group == "landmarks":
            self.kinds += np.bincount(columns["kind"], minlength=len(LandmarkKind))[: len(LandmarkKind)]
            self.slips.add(columns["kind"], columns["distance"])
        if group == "balance":
            self.last.update({name: float(values[-1]) for name, values in columns.items() if values.size})

    def skipped(self, group: str, first_row: int, columns: Columns) -> int:
        """Return how many of some rows come before the first tick of their group."""
        first = self.first.get(group, 0)
        if group == "slider":  # whose rows need not be those of ticks
            return int(np.argmax(np.append(columns["distance"] >= first * self.model.tick, True)))
        return max(first - first_row, 0)


class MeasuredRun(Measured):
    """Beside moments the area as noise, the births, sums of lives, and deviations from exact relations.

    ``off`` holds the largest deviation of each relation between columns, by its name; ``sums`` what the rows of
    /junctions make of area, count and force at the ticks of ``sampled``.
    """

    def __init__(self, model: Model) -> None:
        self.layout, self.births = Sampling.of(model), Births(model)
        super().__init__(model)
        self.first = forgetting(model)
        self.off: dict[str, float] = {}
        self.stretches: dict[str, Stretches] = {}
        self.zero_ticks, self.largest = 0, 0.0
        self.spectrum = WelchSum(self.layout.segment, self.layout.stride * model.tick)
        centre = area_cumulants(model).mean if model.free is None else 0.0
        self.products = CovarianceSum(np.array(self.layout.lags), centre)
        self._sampled: list[Doubles] = [np.empty((3, 0))]
        self._first = self.first["trace"] % self.layout.apart
        self._ticks = model.tick * np.arange(self._first, model.tick_count + 1, self.layout.apart)
        self.sums = np.zeros((3, self._ticks.size))

    def ticks(self) -> int:
        """Return the number of ticks that figures of the trace are over."""
        return next((seen.count for (group, _), seen in self.moments.items() if group == "trace"), 0)

    @property
    def sampled(self) -> Doubles:
        """Areas (um^2), counts and forces (uN) at ticks that share no junction, from the first one on."""
        return np.concatenate(self._sampled, axis=1)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Add rows of a group (see Sink); those of /slider over a base and of /load come with the trace beside them."""
        super().write(group, first_row, columns)
        if group == "junctions" and self.model.free is None:
            self.births.add(columns)
            self._sum_up(columns)
        elif group == "trace" and self.model.free is None:
            self._add_noise(first_row, self.skipped(group, first_row, columns), columns)
        elif group == "load":
            self._bear(first_row, columns)
        if "base_displacement" in columns:
            lift = self.model.base_per_area * columns["real_contact_area"]
            self._relate("base_displacement", columns["base_displacement"], lift)

    def _relate(self, name: str, values: Doubles, right: Doubles) -> None:
        self.off[name] = max(self.off.get(name, 0.0), float(np.abs(values - right).max(initial=0.0)))

    def _add_noise(self, first_row: int, first: int, columns: Columns) -> None:
        area, count = columns["real_contact_area"], columns["junction_count"]
        self.zero_ticks += int((count[first:] == 0).sum())
        since = first_row + first - self.first["trace"]
        thinned = area[first + -since % self.layout.stride :: self.layout.stride]
        self.products.add(thinned)
        self.spectrum.add(thinned)
        force = columns.get("friction_force", np.zeros(area.size))
        if isinstance(self.model.strengths, Fixed) and self.model.held is None:
            self._relate("friction_force", force, self.model.strengths.mean * area)
        places = slice((self._first - first_row) % self.layout.apart, None, self.layout.apart)
        self._sampled.append(np.stack([area[places], count[places].astype(np.float64), force[places]]))

    def _sum_up(self, columns: Columns) -> None:
        """Add the lives at ticks so far apart that each is alive at one of them at most."""
        birth, death, diameter = (columns[name] for name in ("birth_distance", "death_distance", "diameter"))
        tick = np.searchsorted(self._ticks, birth)
        there = np.flatnonzero(tick < self._ticks.size)
        there = there[self._ticks[tick[there]] < death[there]]
        aside = columns["lateral_offset"][there] if "lateral_offset" in columns else None
        area = area_of(self.model.pulse, self._ticks[tick[there]] - birth[there], diameter[there], aside)
        strength = columns["shear_strength"][there] if "shear_strength" in columns else 0.0
        for line, values in enumerate((area, np.ones(there.size), strength * area)):
            self.sums[line] += np.bincount(tick[there], values, self._ticks.size)
        self.largest = max(self.largest, float(diameter.max(initial=0.0)))

    def _bear(self, first_row: int, columns: Columns) -> None:
        """Add rows of /load with the trace beside them: what the contact bears, and the force of friction."""
        held, free, load, area = self.model.held, self.model.free, columns["load"], columns["real_contact_area"]
        if held is None:
            return
        elastic = held.hardness * area
        bears = elastic if free else elastic - held.stiffness * columns["separation"]
        if free is None:
            self._relate("load", load, bears)
        elif free.restitution is not None:
            self._relate("load", load, np.clip(load, free.restitution**2 * elastic, elastic))
        self.largest = max(self.largest, float(elastic.max(initial=held.load))) if free else self.largest
        if "friction_force" in columns and isinstance(self.model.strengths, Fixed):
            right = self.model.strengths.mean / held.hardness * (elastic if free else load)
            self._relate("friction_force", columns["friction_force"], right)
        length = self.model.tick_count // STRETCHES
        for name in ("load", "velocity", "separation", "real_contact_area"):
            if free and length:
                self.stretches.setdefault(name, Stretches(length)).add(first_row, columns[name])


READ: Final = {
    "junctions": (
        "birth_distance",
        "death_distance",
        "life_distance",
        "diameter",
        "lateral_offset",
        "shear_strength",
        "state",
    ),
    "trace": ("real_contact_area", "junction_count", "friction_force"),
    "slider": ("distance", "displacement", "velocity", "base_displacement"),
    "load": ("separation", "velocity", "load"),
    "balance": Balance.columns(),
}
"""Columns that are read of a file, by group."""


def measured_run(model: Model, rows: Rows) -> MeasuredRun:
    """Return what is measured of a file or a record; raises RunFileRefused for damaged rows."""
    seen = MeasuredRun(model)
    for group in (each for each in READ if each in rows.columns):
        first = 0
        for columns in checked_chunks(rows, group, READ[group]):
            size = next(iter(columns.values())).size
            if group == "load" or "base_displacement" in columns:
                beside = ("real_contact_area", "friction_force")
                columns |= {
                    name: rows.column("trace", name, first, first + size)
                    for name in beside
                    if name in rows.columns["trace"]
                }
            seen.write(group, first, columns)
            first += size
    if seen.last and not seen.last["time"] > 0.0:
        raise RunFileRefused("/balance is damaged: it has one row of finite numbers, and a time above 0")
    return seen

"""What is measured of a run: one sink that sums up the rows of a run, of a record or of a file.

Every figure of a summary and of a comparison reads it, and memory does not grow with the run. Moments are over the part
of each group in which the start is forgotten.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from math import ceil
from typing import Final

import numpy as np

from rubnoise.analysis.findings import UniformSample
from rubnoise.analysis.junctions import checked_chunks
from rubnoise.analysis.moments import forgetting, settled
from rubnoise.analysis.motion import Balance
from rubnoise.analysis.records import CovarianceSum
from rubnoise.analysis.spectra import WelchSum
from rubnoise.arrays import Doubles, Integers
from rubnoise.contact.births import GammaBirths, PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, has_single_values
from rubnoise.contact.pulses import area_of, half_life
from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.moments import WATCHED, Moments, Slips
from rubnoise.record.rows import Columns, JunctionState, LandmarkKind, Rows
from rubnoise.storage.schema import GROUPS
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.sizes import longest_life

STRETCHES: Final = 32  # stretches of a run, by whose scatter an error of sampling is known where theory gives none

WINDOWS: Final = (0.6180339887498949, 2.618033988749895, 11.090169943749475)
"""Windows in which births are counted, in mean spacings; none keeps step with births that do."""

_LAGS: Final = (0.125, 0.25, 0.5, 0.75)
_LIVES_A_SEGMENT, _MOST_TICKS_A_LIFE, _FEWEST_TICKS = 16.0, 4096, 16
_QUANTILES: Final = 1 << 17


class AreaNoise:
    """Spectrum and autocovariance of real contact area, from every ``stride``-th tick on from the ``first``.

    Fine ticks so cost no more than they are worth; a ``segment`` and ``lags`` count strides, of ``step`` um. The
    attribute ``lags`` is in um.
    """

    def __init__(self, model: Model, first: int, stride: int, segment: int, lags: Integers) -> None:
        self.step = stride * model.tick
        self.lags = self.step * lags.astype(np.float64)
        self.spectrum, self.products = WelchSum(segment, self.step), CovarianceSum(lags, area_cumulants(model).mean)
        self._first, self._stride = first, stride

    def add(self, first_row: int, area: Doubles) -> None:
        """Add the areas of rows of /trace."""
        before = self._first - first_row
        thinned = area[before if before > 0 else before % self._stride :: self._stride]
        self.products.add(thinned)
        self.spectrum.add(thinned)


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
    """Squares of the number of births in windows of one length, less the expected number, by stretch of a run."""

    def __init__(self, model: Model, spacings: float) -> None:
        self.length, self._expected, self._end = spacings * model.mean_birth_spacing, spacings, model.distance
        self.stretches = Stretches(int(model.distance / self.length) // STRETCHES)
        self._first, self._open = 0, np.empty(0)

    def add(self, birth: Doubles) -> None:
        """Add births in order; their last window stays open."""
        row = np.append(self._open, birth)
        window = np.floor(row / self.length).astype(np.int64)
        last = int(window[-1])
        closed = window < last
        counts = np.bincount(window[closed] - self._first, minlength=last - self._first)
        self.stretches.add(self._first, np.square(counts - self._expected))
        self._first, self._open = last, row[~closed]

    def squares(self) -> Doubles:
        """Return the mean over each stretch; call it once, at the end."""
        self.add(np.array([self._end + self.length]))
        return self.stretches.sums / self.stretches.length


class Births:
    """The junctions that are born along a run: gaps, places, sizes, strengths; and who is there at the start.

    ``samples`` holds, by what they are of, shares of independent values below which their laws say that values lie.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self.count, self.at_start, self.last, self.squares = 0, 0, 0.0, 0.0
        self.samples: defaultdict[str, UniformSample] = defaultdict(UniformSample)
        self.moments = {name: Moments(powers=2) for name in ("diameter", "shear_strength")}
        self.windows = [] if isinstance(model.births, PoissonBirths) else [Windows(model, n) for n in WINDOWS]
        self._law = np.sort(model.sizes.quantile((np.arange(_QUANTILES) + 0.5) / _QUANTILES))
        self._by_life = np.append(0.0, np.cumsum(self._law)) / self._law.sum()

    def add(self, columns: Columns) -> None:
        """Add rows of /junctions."""
        born = ~np.signbit(columns["birth_distance"])
        there = (columns["state"] & JunctionState.ALIVE_AT_START) != 0
        if born.any():
            self._add_born({name: values[born] for name, values in columns.items()})
        if there.any():
            self._add_start({name: values[there] for name, values in columns.items()})

    def _add_born(self, columns: Columns) -> None:
        self._add_places(columns["birth_distance"])
        for name in self.moments.keys() & columns.keys():
            self.moments[name].add(columns[name])
        if not has_single_values(self._model.sizes):
            self.samples["diameter"].add(np.searchsorted(self._law, columns["diameter"]) / _QUANTILES)
        if "lateral_offset" in columns:
            self.samples["offset"].add(0.5 + 0.5 * columns["lateral_offset"] / columns["diameter"])

    def _add_start(self, columns: Columns) -> None:
        """Add who is alive at the start: ages are uniform over lives, and sizes and offsets weigh by their lives."""
        self.at_start += columns["diameter"].size
        self.samples["start_age"].add(-columns["birth_distance"] / columns["life_distance"])
        if not has_single_values(self._model.sizes):
            self.samples["start_diameter"].add(self._by_life[np.searchsorted(self._law, columns["diameter"])])
        if "lateral_offset" in columns:
            aside = columns["lateral_offset"] / columns["diameter"]
            below = aside * half_life(np.ones(aside.size), aside) + np.arcsin(aside)
            self.samples["start_offset"].add(0.5 + below / np.pi)

    def _add_places(self, birth: Doubles) -> None:
        gaps, law = np.diff(birth, prepend=self.last), self._model.births
        if isinstance(law, GammaBirths):
            from scipy.special import gammainc

            whole = gaps[1:] if self.count == 0 else gaps  # the first one may have begun before the run
            self.samples["birth_gap"].add(gammainc(law.shape, law.shape * whole / law.mean_spacing))
        if isinstance(law, PoissonBirths):
            self.samples["birth_gap"].add(-np.expm1(-gaps / law.mean_spacing))
            self.samples["birth_place"].add(birth / self._model.distance)
        for windows in self.windows:
            windows.add(birth)
        self.squares += float(np.square(gaps).sum())
        self.last, self.count = float(birth[-1]), self.count + birth.size


class Measured:
    """A sink: moments of columns from the ``first`` tick of their groups on, the landmarks, and the last balance.

    That is where the start of a run is forgotten; 0 in a run that is too short for that.
    ``slips`` are those of a two-way slider that are longer than its diameter d_m, ``kinds`` the numbers of landmarks of
    each kind.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.moments: dict[tuple[str, str], Moments] = {}
        self.last: dict[str, float] = {}
        self.kinds = np.zeros(len(LandmarkKind), dtype=np.int64)
        self.slips = Slips(longer_than=model.calibrated_diameter)
        self.first: Mapping[str, int] = {group: tick or 0 for group, tick in settled(model).items()}

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

    ``off`` holds the largest deviation from each of `relations` and the largest value, by name. ``sampled`` are areas
    (um^2), counts and forces (uN) at ticks that share no junction, ``apart`` ticks from each other; ``sums`` what the
    rows of /junctions make of them.
    """

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self.first = forgetting(model)
        self.births = Births(model)
        self.off: dict[str, tuple[float, float]] = {}
        self.stretches: dict[str, Stretches] = {}
        self.zero_ticks, self.largest = 0, 0.0
        longest = longest_life(model) / model.tick
        stride = max(1, int(longest) // _MOST_TICKS_A_LIFE)
        life = model.mean_life_distance / (stride * model.tick)
        segment = max(_FEWEST_TICKS, 2 ** ceil(np.log2(max(_LIVES_A_SEGMENT * life, 1.0))))
        lags = np.unique([max(1, round(share * life)) for share in _LAGS])
        self.noise = AreaNoise(model, self.first["trace"], stride, segment, lags)
        self.apart = int(longest) + 2
        self._first = self.first["trace"] % self.apart
        self._ticks = model.tick * np.arange(self._first, model.tick_count + 1, self.apart)
        self.sums, self.sampled = np.zeros((2, 3, self._ticks.size))

    def ticks(self) -> int:
        """Return the number of ticks that figures of the trace are over."""
        return next((seen.count for (group, _), seen in self.moments.items() if group == "trace"), 0)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Add rows of a group (see Sink); those of /slider over a base and of /load come with the trace beside them."""
        super().write(group, first_row, columns)
        for name, values, right in relations(self.model, group, columns):
            away, largest = self.off.get(name, (0.0, 0.0))
            seen = float(np.abs(values - right).max(initial=0.0)), float(np.max(right, initial=0.0))
            self.off[name] = max(away, seen[0]), max(largest, seen[1])
        if self.model.free is not None:
            self._add_stretches(group, first_row, columns)
        elif group == "junctions":
            self.births.add(columns)
            self._sum_up(columns)
        elif group == "trace":
            self._add_trace(first_row, columns)

    def _add_trace(self, first_row: int, columns: Columns) -> None:
        area, count = columns["real_contact_area"], columns["junction_count"]
        self.zero_ticks += int((count[self.skipped("trace", first_row, columns) :] == 0).sum())
        self.noise.add(first_row, area)
        force = columns.get("friction_force", np.zeros(area.size))
        place = (self._first - first_row) % self.apart
        seen = np.stack([area, count, force])[:, place :: self.apart]
        begin = (first_row + place) // self.apart
        self.sampled[:, begin : begin + seen.shape[1]] = seen

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

    def _add_stretches(self, group: str, first_row: int, columns: Columns) -> None:
        """Add rows of /load in free motion, with the area beside them."""
        length = self.model.tick_count // STRETCHES
        for name in ("load", "velocity", "separation", "real_contact_area"):
            if group == "load" and length:
                self.stretches.setdefault(name, Stretches(length)).add(first_row, columns[name])


UNITS: Final = {column.name: column.units for group in GROUPS for column in group.columns} | {"birth_gap": "um"}
"""Units of the relations by name: those of the columns, and of the gaps between births."""


def relations(model: Model, group: str, columns: Columns) -> Iterator[tuple[str, Doubles, Doubles | float]]:
    """Yield the name of each exact relation that rows of a group obey, a column, and what other columns make of it.

    Rows of /load and of /slider over a base have the area and the force of the trace beside them.
    """
    held, free, area = model.held, model.free, columns.get("real_contact_area", np.empty(0))
    strength = model.strengths.mean if isinstance(model.strengths, Fixed) else None
    if group == "junctions" and isinstance(model.sizes, Fixed):
        yield "diameter", columns["diameter"], model.sizes.mean
    if group == "junctions" and free is None and isinstance(model.births, RegularBirths):
        birth = columns["birth_distance"][~np.signbit(columns["birth_distance"])]
        yield "birth_gap", birth[1:], birth[:-1] + model.mean_birth_spacing
    if strength is not None and "shear_strength" in columns:
        yield "shear_strength", columns["shear_strength"], strength
    if "base_displacement" in columns:
        yield "base_displacement", columns["base_displacement"], model.base_per_area * area
    if group == "trace" and held is None and strength is not None:
        yield "friction_force", columns["friction_force"], strength * area
    if group == "load" and held is not None:
        load, elastic = columns["load"], held.hardness * area
        bears = elastic if free else elastic - held.stiffness * columns["separation"]
        if free is None:
            yield "load", load, bears
        elif free.restitution is not None:
            yield "load", load, np.clip(load, free.restitution**2 * elastic, elastic)
        if strength is not None:
            yield "friction_force", columns["friction_force"], strength / held.hardness * (elastic if free else load)


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
                beside = {"real_contact_area", "friction_force"}.intersection(rows.columns["trace"])
                columns |= {name: rows.column("trace", name, first, first + size) for name in beside}
            seen.write(group, first, columns)
            first += size
    if seen.last and not seen.last["time"] > 0.0:
        raise RunFileRefused("/balance is damaged: it has one row of finite numbers, and a time above 0")
    return seen

"""What a picture draws along a run: a stretch of it, and the rows of a quantity with what theory says of them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, inf, isnan
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.figures import expected_figure
from rubnoise.analysis.junctions import first_row
from rubnoise.analysis.motion import Flights, Sticks
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused, naming
from rubnoise.figures.style import shortened
from rubnoise.model import Model, Slider
from rubnoise.record.rows import Reader, chunks, column_chunks
from rubnoise.scenario.reading import stored
from rubnoise.theory.ancestors import white_spectrum
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.motion import FORCE, density_of, motion_spectrum, need_friction
from rubnoise.theory.sampling import expected_periodogram, hann, through_window
from rubnoise.theory.second_order import spectral_density

MOST_POINTS: Final = 3000
"""Points of a curve that a picture of this size can show apart; of more only the extremes are drawn."""

MOST_READ: Final = 4_194_304
"""Rows that are read at once if a picture needs them together; more of them change the picture little."""

SLACK: Final = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """A result, the physics of its run, and the sliding distances in um between which it is shown.

    ``chosen``: whether the user chose this stretch; otherwise it is the default.
    """

    file: Reader
    model: Model
    start: float
    stop: float
    chosen: bool

    @classmethod
    def of(cls, file: Reader, start: float | None = None, stop: float | None = None) -> Self:
        """Return a stretch of an open result, all of it by default; raises Refused if it has fewer than two ticks."""
        model, chosen = stored(file.provenance["scenario_resolved"]).model(), not (start is None and stop is None)
        end = model.distance if stop is None else min(stop, model.distance)
        found = cls(file=file, model=model, start=start or 0.0, stop=end, chosen=chosen)
        ends = f"{found.start:g} to {found.stop:g} um"
        if not 0.0 <= found.start < found.stop:
            raise Refused(f"nothing lies in {ends}; the run goes from 0 to {model.distance:g} um")
        first, last = found.rows("trace")
        if last - first < 2:
            raise Refused(f"{ends} is too short to draw; the run has a tick every {model.tick:g} um")
        return found

    @property
    def name(self) -> str:
        """The name of the result as a picture has room for."""
        return shortened(self.file.path.name)

    @property
    def has_theory(self) -> bool:
        """Whether theory knows the statistics of the contact: not of a slider that may leave it."""
        return self.model.free is None

    def first_born(self, distance: float) -> int:
        """Return the first row of /junctions that is born at a distance or later."""
        return first_row(self.file, "junctions", "birth_distance", distance)

    def narrowed(self, width: float) -> Self:
        """Return the stretch itself if the user chose it, else its beginning of a width in um."""
        return self if self.chosen else replace(self, stop=min(self.stop, self.start + width))

    def about(self, begin: float, end: float, margin: float) -> Self:
        """Return as much of the run as lies between two distances in um, and a part of their difference beyond."""
        beyond = margin * (end - begin)
        return replace(self, start=max(begin - beyond, 0.0), stop=min(end + beyond, self.model.distance), chosen=True)

    def whole(self) -> Self:
        """Return the whole run."""
        return replace(self, start=0.0, stop=self.model.distance)

    def rows(self, group: str) -> tuple[int, int]:
        """Return the rows of /trace or /slider in the stretch, as the first and the one after the last.

        Those of /trace are a tick apart. Those of a one-way /slider are, too; a two-way slider passes the two distances
        when it first reaches them.
        """
        if group == "slider" and self.model.is_two_way:
            beyond = inf if self.stop >= self.model.distance else float(np.nextafter(self.stop, inf))
            return self._passage(self.start), self._passage(beyond)
        first = ceil(self.start / self.model.tick - SLACK)
        last = floor(self.stop / self.model.tick + SLACK) + 1
        return first, min(last, self.file.rows(group))

    def _passage(self, distance: float) -> int:
        """Return the first row at which a two-way slider, which may run back, is at a distance in um or beyond it."""
        passed = ((chunk.first, chunk["distance"] >= distance) for chunk in chunks(self.file, "slider"))
        return next((first + int(np.argmax(there)) for first, there in passed if there.any()), self.file.rows("slider"))


def lowest_and_highest(values: NDArray[Any], step: int) -> tuple[Doubles, Doubles]:
    """Return the lowest and the highest values of each ``step`` rows."""
    starts = np.arange(0, values.size, step)
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    return low.astype(np.float64), high.astype(np.float64)


LIVES, PERIODS, STICKS = 40.0, 20.0, 20
"""Mean lives, natural periods of what swings, and sticks with two-way coupling that are shown by default."""


@dataclass(frozen=True, slots=True)
class DrawnColumn:
    """A column along a run: its group, and its unit on an axis; the names of its figures begin with ``stem``."""

    words: str
    group: str
    column: str
    unit: str
    stem: str

    @property
    def scale(self) -> float:
        """Factor from the unit of the column to that of the axis."""
        return 1e-3 if self.unit.startswith("m") else 1.0

    @property
    def label(self) -> str:
        """Label of an axis."""
        return f"{self.words} ({self.unit})" if self.unit else self.words


BASE: Final = "base_displacement"
QUANTITIES: Final[Mapping[str, DrawnColumn]] = {
    "area": DrawnColumn("real contact area", "trace", "real_contact_area", "µm²", "real_contact_area"),
    "count": DrawnColumn("live junctions", "trace", "junction_count", "", "junction_count"),
    "force": DrawnColumn("friction force", "slider", FORCE, "mN", FORCE),
    "base": DrawnColumn("height of the base", "slider", BASE, "µm", BASE),
    "displacement": DrawnColumn("displacement", "slider", "displacement", "µm", "displacement"),
    "velocity": DrawnColumn("velocity", "slider", "velocity", "mm/s", "velocity"),
    "load": DrawnColumn("load", "load", "load", "mN", "load"),
    "separation": DrawnColumn("separation", "load", "separation", "µm", "separation"),
    "normal-velocity": DrawnColumn("normal velocity", "load", "velocity", "mm/s", "normal_velocity"),
}
"""Everything that is drawn along a run, by name."""


def exact_spectrum(model: Model, quantity: str, place: Doubles, *, timed: bool) -> Doubles:
    """Return the exact two-sided density of a quantity over rad/um, or ``timed`` over rad/s, in its unit squared.

    Over frequency it is S(w/V)/V of a force or a motion. Raises Refused if theory has none.
    """
    if not timed and quantity == "real_contact_area":
        return spectral_density(model, place)
    if not timed and quantity == FORCE:
        return density_of(model, FORCE, place)
    if quantity != FORCE:
        return motion_spectrum(quantity, model, place)
    need_friction(model)
    if model.strengths is None or model.sliding_speed is None:
        raise Refused("the spectrum of the force over frequency needs [strength] and sliding.speed")
    return density_of(model, FORCE, place / model.sliding_speed) / model.sliding_speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """Rows ``first`` to before ``last`` of a quantity in a group of a stretch, evenly apart in distance or in time."""

    stretch: Stretch
    quantity: DrawnColumn
    group: str
    first: int
    last: int

    @classmethod
    def of(cls, stretch: Stretch, name: str) -> Self:
        """Return a quantity in a stretch; raises Refused for a run without it, and for fewer than two rows.

        The friction force of a run without a slider is the one that would drive a slider.
        """
        quantity, model, columns = QUANTITIES[name], stretch.model, stretch.file.columns
        group = quantity.group
        if name == "force" and model.slider is None and quantity.column in columns["trace"]:
            group = "trace"
        if group == "trace" != quantity.group and model.sliding_speed is None:
            raise Refused("the run has no times; sliding.speed in its scenario would give them")
        if group not in columns:
            what = "slider" if group == "slider" else "load that weighs"
            raise Refused(f"the run has no {what} to draw; [{group}] in its scenario would give it one")
        if quantity.column not in columns[group]:
            words = quantity.column.replace("_", " ")
            raise Refused(f"the run has no {words} to draw; [strength] in its scenario would give it one")
        first, last = stretch.rows(group)
        return cls(stretch=stretch, quantity=quantity, group=group, first=first, last=last)

    def __post_init__(self) -> None:
        if self.last - self.first < 2:
            begin = f"{self.step * self.first:.4g} {'s' if self.timed else 'um'}"
            raise Refused(f"{self.stretch.name}: fewer than two rows of /{self.group} are to be drawn from {begin} on")

    @property
    def model(self) -> Model:
        """The physics of the run."""
        return self.stretch.model

    @property
    def timed(self) -> bool:
        """Whether the quantity is drawn over time in s, and not over distance in um."""
        return self.quantity.group != "trace"

    @property
    def step(self) -> float:
        """Distance or time from one row to the next."""
        return (self.timed and self.model.tick_duration) or self.model.tick

    @property
    def swings(self) -> Slider | None:
        """The mass on its spring, or under a load the mass on its contact; None for a contact."""
        if self.group == "load" and self.model.held is not None:
            return self.model.held.oscillator
        return self.model.slider if self.group == "slider" else None

    @property
    def natural(self) -> float:
        """The natural frequency in Hz of what swings; for a contact one per mean life, in 1/um or Hz."""
        if self.swings is not None:
            return self.swings.natural_frequency
        return ((self.timed and self.model.sliding_speed) or 1.0) / self.model.mean_life_distance

    @property
    def ends(self) -> tuple[float, float]:
        """Places of the first and the last row in um, or their times in s."""
        return self.step * self.first, self.step * (self.last - 1)

    def shown(self) -> Self:
        """Return what a curve shows: a stretch that the user chose, else some lives, periods or sticks."""
        if self.stretch.chosen:
            return self
        (begin, end), length = self.ends, (LIVES if self.swings is None else PERIODS) / self.natural
        if self.group == "slider" and isinstance(found := self.landmarks(), Sticks) and found.end.size:
            length = max(length, (float(found.end[STICKS - 1]) if found.end.size >= STICKS else end) - begin)
        return self.between(begin, begin + length)

    def between(self, begin: float, end: float) -> Self:
        """Return the rows between two places or times, up to the end of the run; raises Refused for fewer than two."""
        rows, first = self.stretch.file.rows(self.group), round(begin / self.step)
        return replace(self, first=first, last=min(max(round(end / self.step) + 1, first + 2), rows))

    def curve(self) -> tuple[Doubles, Doubles]:
        """Return places or times and values as on the axes; of many rows only the extremes of each few."""
        values = self.stretch.file.column(self.group, self.quantity.column, self.first, self.last)
        row, few = np.arange(self.first, self.last, dtype=np.float64), ceil(values.size / MOST_POINTS)
        if few > 2:
            few *= 2  # the lowest and the highest of twice as many rows make as many points
            row = np.repeat(row[::few] + 0.5 * (few - 1), 2)
            values = np.stack(lowest_and_highest(values, few), axis=-1).ravel()
        return self.step * row, self.quantity.scale * values

    def chunks(self) -> Iterator[Doubles]:
        """Yield the values as on the axis in arrays of some rows."""
        for chunk in column_chunks(self.stretch.file, self.group, self.quantity.column, self.first, self.last):
            yield self.quantity.scale * chunk

    def record(self) -> Doubles:
        """Return the values as on the axis, or their beginning if there are more than a picture needs."""
        return np.concatenate([*replace(self, last=min(self.last, self.first + MOST_READ)).chunks()])

    @property
    def has_theory(self) -> bool:
        """Whether theory may know the quantity: not for free motion, and of the contact alone with two-way coupling."""
        return self.stretch.has_theory and not (self.group == "slider" and self.model.is_two_way)

    def moments(self) -> tuple[float, float]:
        """Return the exact mean and standard deviation as on the axis; raises Refused if theory has none."""
        stem, model, scale = self.quantity.stem, self.model, self.quantity.scale
        if stem == BASE:
            area = area_cumulants(model)
            return model.base_per_area * area.mean, model.base_per_area * area.std
        mean, std = (expected_figure(model, f"{stem}_{moment}") for moment in ("mean", "std"))
        return scale * (0.0 if isnan(mean) else mean), scale * std

    def density(self, place: Doubles) -> Doubles:
        """Return the exact two-sided density per rad/um, or rad/s of what has times, in the square of the axis's unit.

        Raises Refused if theory has none.
        """
        return self.quantity.scale**2 * exact_spectrum(self.model, self.quantity.stem, place, timed=self.timed)

    def expected(self, ticks: int, last: int) -> Doubles:
        """Return what theory expects of Welch's estimate of that density at bins 0 ... ``last`` of segments of ticks.

        Raises Refused if theory has none.
        """
        if not self.timed:
            return expected_periodogram(self.model, self.step, hann(ticks))[1]
        return through_window(self.density, self.step, hann(ticks), last)

    def white(self, angular_frequency: Doubles) -> Doubles | None:
        """Return the density of white noise of the same level at low frequency (Kilburn); None if it is of no use."""
        model, slider = self.model, self.swings
        if self.group != "slider" or slider is None or slider.excitation == "base" or model.separation is not None:
            return None
        return self.quantity.scale**2 * white_spectrum(self.quantity.stem, model, angular_frequency)

    def landmarks(self) -> Sticks | Flights | None:
        """Return sticks and slips, or flights and impacts; None for what does neither. Of very many the first."""
        if self.timed and self.model.free is not None:
            return Flights.of(self.stretch.file, *self.ends, MOST_READ)
        return Sticks.of(self.stretch.file, *self.ends, MOST_READ) if self.timed and self.model.is_two_way else None


def tracks_of(stretch: Stretch, beside: Stretch | None, name: str) -> list[Track]:
    """Return a quantity in a stretch, and in that of a run drawn over it; raises Refused for runs without it."""
    found = [Track.of(stretch, name)]
    if beside is not None:
        with naming(f'beside="{beside.file.path}"'):
            found.append(Track.of(beside, name))
    return found


def at_the_same(tracks: Sequence[Track]) -> list[Track]:
    """Return the shown part of the first track, and the same times of the others; raises Refused if one ends before."""
    first = tracks[0].shown()
    return [first, *(other.between(*first.ends) for other in tracks[1:])]

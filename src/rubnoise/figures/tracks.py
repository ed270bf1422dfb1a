"""What a picture draws along a run: a stretch of it, quantities with what theory says of them, and the rows of one."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import ceil, floor
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.figures import FIGURES
from rubnoise.analysis.landmarks import Flights, Sticks
from rubnoise.analysis.selection import first_row
from rubnoise.analysis.spectra import force_spectrum
from rubnoise.arrays import Doubles, chunk_of_steps
from rubnoise.errors import Refused
from rubnoise.figures.style import shortened
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Reader, chunks, column_chunks
from rubnoise.scenario.reading import stored
from rubnoise.theory.ancestors import white_spectrum
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.motion import FORCE, motion_spectrum
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
    title: str
    start: float
    stop: float
    chosen: bool

    @classmethod
    def of(cls, file: Reader, start: float | None = None, stop: float | None = None) -> Self:
        """Return a stretch of an open result, all of it by default; raises Refused if it has fewer than two ticks."""
        model = stored(file.provenance["scenario_resolved"]).model()
        found = cls(
            file=file,
            model=model,
            title=str(file.attributes["title"]),
            start=0.0 if start is None else start,
            stop=model.distance if stop is None else min(stop, model.distance),
            chosen=not (start is None and stop is None),
        )
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
        if self.chosen or self.stop - self.start <= width:
            return self
        return replace(self, stop=self.start + width)

    def whole(self) -> Self:
        """Return the whole run."""
        return replace(self, start=0.0, stop=self.model.distance)

    def rows(self, group: str) -> tuple[int, int]:
        """Return the rows of /trace or /slider in the stretch, as the first and the one after the last.

        Those of /trace are a tick apart. Those of a one-way /slider are, too; a two-way slider passes the two distances
        when it first reaches them.
        """
        if group == "slider" and self.model.is_two_way:
            return self._passages()
        first = ceil(self.start / self.model.tick - SLACK)
        last = floor(self.stop / self.model.tick + SLACK) + 1
        return first, min(last, self.file.rows(group))

    def _passages(self) -> tuple[int, int]:
        """Return the rows of a two-way /slider from its first at the start to the last before it passes the stop.

        It may run back, so that its distances are in no order.
        """
        rows, first = self.file.rows("slider"), 0 if self.start == 0.0 else None
        if first == 0 and self.stop >= self.model.distance:
            return 0, rows
        for chunk in chunks(self.file, "slider"):
            if first is None and (reached := np.flatnonzero(chunk["distance"] >= self.start)).size:
                first = chunk.first + int(reached[0])
            if (passed := np.flatnonzero(chunk["distance"] > self.stop)).size:
                last = chunk.first + int(passed[0])
                return last if first is None else first, last
        return rows if first is None else first, rows


def lowest_and_highest(chunks: Iterable[NDArray[Any]], step: int) -> tuple[Doubles, Doubles]:
    """Return the lowest and the highest values of each ``step`` rows; chunks hold a whole number of steps."""
    low, high = [], []
    for chunk in chunks:
        starts = np.arange(0, chunk.size, step)
        low.append(np.minimum.reduceat(chunk, starts))
        high.append(np.maximum.reduceat(chunk, starts))
    return np.concatenate(low).astype(np.float64), np.concatenate(high).astype(np.float64)


LIVES, PERIODS, STICKS = 40.0, 20.0, 20
"""Mean lives, natural periods of what swings, and sticks with two-way coupling that are shown by default."""


@dataclass(frozen=True, slots=True)
class DrawnColumn:
    """A column along a run: its group, its unit on an axis, and what theory says of it; ``stem`` begins its figures."""

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

    def moments(self, model: Model) -> tuple[float, float]:
        """Return the exact mean and standard deviation in the unit of the axis; raises Refused if theory has none."""
        if self.stem == BASE:
            area = area_cumulants(model)
            return self.scale * model.base_per_area * area.mean, self.scale * model.base_per_area * area.std
        mean = EXACT.get(f"{self.stem}_mean")
        return self.scale * (mean(model) if mean else 0.0), self.scale * EXACT[f"{self.stem}_std"](model)

    def density(self, model: Model, place: Doubles) -> Doubles:
        """Return the exact two-sided density per rad/um, or per rad/s of what moves, in the square of the axis's unit.

        Raises Refused if theory has none.
        """
        if self.group == "trace":
            return self.scale**2 * spectral_density(model, place)
        found = force_spectrum(model, place) if self.stem == FORCE else motion_spectrum(self.stem, model, place)
        return self.scale**2 * found

    def white(self, model: Model, angular_frequency: Doubles) -> Doubles | None:
        """Return the density of white noise of the same level at low frequency (Kilburn); None if it is of no use."""
        slider = model.slider
        if self.group != "slider" or slider is None or model.separation is not None or slider.excitation == "base":
            return None
        return self.scale**2 * white_spectrum(self.stem, model, angular_frequency)


EXACT: Final = {figure.name: figure.exact for figure in FIGURES}
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """Rows ``first`` to before ``last`` of a quantity in a stretch, ``step`` um or, with ``timed``, s apart.

    ``swings`` is the oscillator: the mass on its spring, or under a load the mass on its contact; None for a contact.
    """

    stretch: Stretch
    quantity: DrawnColumn
    group: str
    first: int
    last: int
    step: float
    timed: bool
    swings: Slider | None

    @classmethod
    def of(cls, stretch: Stretch, name: str) -> Self:
        """Return a quantity in a stretch; raises Refused for a run without it, and for fewer than two rows.

        The friction force of a run without a slider is the one that would drive a slider.
        """
        quantity, model, columns = QUANTITIES[name], stretch.model, stretch.file.columns
        group, timed = quantity.group, quantity.group != "trace"
        if name == "force" and model.slider is None and quantity.column in columns["trace"]:
            group = "trace"
        held = None if model.held is None else model.held.oscillator
        swings = {"slider": model.slider, "load": held}.get(group)
        if group == "trace" and timed and model.sliding_speed is None:
            raise Refused("the run has no times; sliding.speed in its scenario would give them")
        if group not in columns or (group != "trace" and (swings is None or model.sliding_speed is None)):
            what = "slider" if group == "slider" else "load that weighs"
            raise Refused(f"the run has no {what} to draw; [{group}] in its scenario would give it one")
        if quantity.column not in columns[group]:
            words = quantity.column.replace("_", " ")
            raise Refused(f"the run has no {words} to draw; [strength] in its scenario would give it one")
        (first, last), step = stretch.rows(group), model.tick / ((timed and model.sliding_speed) or 1.0)
        if last - first < 2:
            ends = f"{stretch.start:g} to {stretch.stop:g} um"
            raise Refused(f"the slider passes {ends} in less than the {step:.3g} s between two rows of /{group}")
        return cls(
            stretch=stretch,
            quantity=quantity,
            group=group,
            first=first,
            last=last,
            step=step,
            timed=timed,
            swings=swings,
        )

    @property
    def model(self) -> Model:
        """The physics of the run."""
        return self.stretch.model

    @property
    def natural(self) -> float:
        """The natural frequency in Hz of what swings; for a contact one per mean life, in 1/um or Hz."""
        speed = self.model.sliding_speed if self.timed else None
        return (speed or 1.0) / self.model.mean_life_distance if self.swings is None else self.swings.natural_frequency

    @property
    def begin(self) -> float:
        """Place of the first row in um, or its time in s."""
        return self.step * self.first

    @property
    def end(self) -> float:
        """Place of the last row in um, or its time in s."""
        return self.step * (self.last - 1)

    def shown(self) -> Self:
        """Return what a curve shows: a stretch that the user chose, else some lives, periods or sticks."""
        if self.stretch.chosen:
            return self
        length = (LIVES if self.swings is None else PERIODS) / self.natural
        if self.group == "slider" and self.model.is_two_way:
            length = max(length, self._until_some_stuck())
        return self.between(self.begin, self.begin + length)

    def _until_some_stuck(self) -> float:
        """Return the time in s until some sticks are over; of fewer all, and 0 if nothing sticks."""
        file = self.stretch.file
        wanted, there = first_row(file, "landmarks", "time", self.begin) + 2 * STICKS, file.rows("landmarks")
        if wanted >= there:
            return self.end - self.begin if there else 0.0
        return float(file.column("landmarks", "time", wanted, wanted + 1)[0]) - self.begin

    def between(self, begin: float, end: float) -> Self:
        """Return the rows between two places or times, up to the end of the run; raises Refused for fewer than two."""
        rows = self.stretch.file.rows(self.group)
        first = min(round(begin / self.step), rows)
        last = min(max(round(end / self.step) + 1, first + 2), rows)
        if last - first < 2:
            raise Refused(f"the run is over before {begin:g} {'s' if self.timed else 'um'}")
        return replace(self, first=first, last=last)

    def curve(self) -> tuple[Doubles, Doubles]:
        """Return places or times and values as on the axes; of many rows only the extremes of each few."""
        file, column, ends = self.stretch.file, self.quantity.column, (self.first, self.last)
        few = ceil((self.last - self.first) / MOST_POINTS)
        if few <= 2:
            row, value = np.arange(*ends, dtype=np.float64), file.column(self.group, column, *ends).astype(np.float64)
        else:
            # The lowest and the highest of twice as many rows make as many points.
            few *= 2
            row = np.repeat(np.arange(*ends, few) + 0.5 * (few - 1), 2)
            chunks = column_chunks(file, self.group, column, *ends, size=chunk_of_steps(few))
            value = np.stack(lowest_and_highest(chunks, few), axis=-1).ravel()
        return self.step * row, self.quantity.scale * value

    def chunks(self) -> Iterator[NDArray[Any]]:
        """Yield the values as on the axis in arrays of some rows."""
        for chunk in column_chunks(self.stretch.file, self.group, self.quantity.column, self.first, self.last):
            yield self.quantity.scale * chunk

    def record(self) -> Doubles:
        """Return the values as on the axis, or their beginning if there are more than a picture needs."""
        last = min(self.last, self.first + MOST_READ)
        values = self.stretch.file.column(self.group, self.quantity.column, self.first, last)
        return self.quantity.scale * values.astype(np.float64)

    @property
    def has_theory(self) -> bool:
        """Whether theory may know the quantity: not for free motion, and of the contact alone with two-way coupling."""
        return self.stretch.has_theory and not (self.group == "slider" and self.model.is_two_way)

    def landmarks(self) -> Sticks | Flights | None:
        """Return sticks and slips, or flights and impacts; None for what does neither. Of very many the first."""
        file, ends = self.stretch.file, (self.begin, self.end)
        if self.timed and self.model.free is not None:
            return Flights.of(file, *ends, MOST_READ)
        return Sticks.of(file, *ends, MOST_READ) if self.timed and self.model.is_two_way else None


def tracks_of(stretch: Stretch, beside: Stretch | None, name: str) -> list[Track]:
    """Return a quantity in a stretch, and in that of a run drawn over it; raises Refused for runs without it."""
    first = Track.of(stretch, name)
    if beside is None:
        return [first]
    with prefix_refusals(f"--with {beside.file.path}"):
        return [first, Track.of(beside, name)]


def at_the_same(tracks: Sequence[Track]) -> list[Track]:
    """Return the shown part of the first track, and the same times of the others.

    Raises Refused if one of them is over before the first begins.
    """
    first = tracks[0].shown()
    shown = [first]
    for other in tracks[1:]:
        with prefix_refusals(f"--with {other.stretch.file.path}"):
            shown.append(other.between(first.begin, first.end))
    return shown


@contextmanager
def prefix_refusals(what: str) -> Iterator[None]:
    """Put a prefix in front of the message of a refusal."""
    try:
        yield
    except Refused as refusal:
        raise type(refusal)(f"{what}: {refusal}") from refusal

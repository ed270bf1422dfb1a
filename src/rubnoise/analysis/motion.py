"""The motion of a run: its landmarks with the sticks, slips and flights, and its mean force and energy."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import ClassVar, Self

import numpy as np

from rubnoise.analysis.junctions import first_row
from rubnoise.arrays import Doubles
from rubnoise.model import Model, Slider
from rubnoise.record.rows import Columns, ContactKind, LandmarkKind, Rows
from rubnoise.theory.motion import drive_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Spells:
    """What a slider does for a while, again and again, between two times of a run.

    begin, end: of each spell in s, cut off at the two times; times: the durations in s of those that begin and end
    between them; rows: the landmarks between them by column, of those that ``columns`` names.
    """

    begins: ClassVar[int]
    ends: ClassVar[int]
    columns: ClassVar[tuple[str, ...]]
    begin: Doubles
    end: Doubles
    times: Doubles
    rows: Columns

    @classmethod
    def of(cls, rows: Rows, begin: float, end: float, most: int | None = None) -> Self:
        """Return the spells between two times in s; of more than ``most`` landmarks, up to the time of the next one.

        If the first landmark of a run ends a spell, this began with the run.
        """
        first, last = (first_row(rows, "landmarks", "time", each) for each in (begin, end))
        if most is not None and last - first > most:
            last = first + most
            end = float(rows.column("landmarks", "time", last, last + 1)[0])
        kind, time = (rows.column("landmarks", name, max(first - 1, 0), last) for name in ("kind", "time"))
        if first == 0:
            before = cls.begins if kind.size and kind[0] == cls.ends else -1
            kind, time = np.append(before, kind), np.append(begin, time)
        at = np.flatnonzero(kind == cls.begins)
        whole = at[(at > 0) & (at + 1 < kind.size)]
        return cls(
            begin=np.maximum(time[at], begin),
            end=np.append(time, end)[at + 1],
            times=time[whole + 1] - time[whole],
            rows={name: rows.column("landmarks", name, first, last) for name in cls.columns},
        )


class Flights(Spells):
    """Flights of a slider that may leave its contact, from contact lost to contact made, and its impacts."""

    __slots__ = ()
    begins, ends = ContactKind.CONTACT_LOST, ContactKind.CONTACT_MADE
    columns = ("kind", "time", "impact_speed")

    @property
    def impacts(self) -> Doubles:
        """The times in s when contact is made."""
        return np.asarray(self.rows["time"][self.rows["kind"] == self.ends])

    @property
    def speeds(self) -> Doubles:
        """The speeds in um/s at which the overlap then grows, by sliding and by falling."""
        return np.asarray(self.rows["impact_speed"][self.rows["kind"] == self.ends])

    def share(self, begin: float, end: float) -> float:
        """Return the share of the time from one to the other, in s, that the slider is off the surface."""
        return float((self.end - self.begin).sum()) / (end - begin)


class Sticks(Spells):
    """Sticks of a two-way slider, and the slips between them."""

    __slots__ = ()
    begins, ends = LandmarkKind.STICK, LandmarkKind.SLIP
    columns = ("kind", "time", "distance", "displacement")

    @property
    def slip_lengths(self) -> Doubles:
        """The distances in um from a breakaway to the next stick or turn."""
        slipped = np.flatnonzero(self.rows["kind"][:-1] == self.ends)
        return np.diff(self.rows["distance"])[slipped]


# Balance.
@dataclass(frozen=True, slots=True, kw_only=True)
class Balance:
    """The row of /balance in its units (um, s, uN), with the slider, the speed (um/s) and the start (um) that it needs.

    Every run begins at rest: x' = 0.
    """

    slider: Slider
    speed: float
    start: float
    time: float
    distance: float
    displacement: float
    velocity: float
    time_stuck: float
    displacement_integral: float
    displacement_squared_integral: float
    velocity_squared_integral: float
    friction_work: float
    reverse_work: float

    @classmethod
    def columns(cls) -> tuple[str, ...]:
        """Return the columns of /balance."""
        return tuple(each.name for each in fields(cls) if each.name not in {"slider", "speed", "start"})

    @classmethod
    def of(cls, model: Model, row: Mapping[str, float]) -> Self:
        """Return the balance of a run of a model; raises Refused without slider, strength or speed."""
        drive = drive_of(model)
        kept = {name: row[name] for name in cls.columns()}
        return cls(slider=drive.slider, speed=drive.speed, start=model.equilibrium_displacement, **kept)

    @property
    def impulse(self) -> float:
        """Impulse of the friction force, int F dt, in uN s."""
        slider = self.slider
        held = slider.mass * self.velocity + slider.damping * (self.displacement - self.start)
        return held + slider.stiffness * self.displacement_integral

    @property
    def dissipated(self) -> float:
        """Energy dissipated by the dashpot, c int x'^2 dt, in uN um."""
        return self.slider.damping * self.velocity_squared_integral

    @property
    def stored(self) -> float:
        """Energy gained over the run, [E], in uN um."""
        slider = self.slider
        moved = slider.stiffness * (self.displacement - self.start) * (self.displacement + self.start)
        return 0.5 * (slider.mass * self.velocity * self.velocity + moved)

    @property
    def scale(self) -> float:
        """Largest of the works in uN um, the scale of residuals."""
        slider = self.slider
        held = 0.5 * slider.stiffness * max(self.displacement * self.displacement, self.start * self.start)
        return max(abs(self.speed * self.impulse), self.friction_work, self.dissipated, held)

    @property
    def energy_residual(self) -> float:
        """Residual of the energy balance over its largest term: 0 except for the errors of the steps."""
        missing = self.speed * self.impulse - (self.friction_work + self.dissipated + self.stored)
        return missing / self.scale if self.scale > 0.0 else 0.0

    @property
    def friction_along(self) -> float:
        """Signed int G ds in uN um over the whole path: a reversal and the way back cancel."""
        return self.friction_work - 2.0 * self.reverse_work

    @property
    def mean_force(self) -> float:
        """Mean of F over time in uN."""
        return self.impulse / self.time

    def expected_excess(self) -> float:
        """Return the excess in uN of <F> over int G ds/(V T): (c int x'^2 dt + 2 int_(w < 0) G |ds| + [E])/(V T)."""
        return (self.dissipated + 2.0 * self.reverse_work + self.stored) / (self.speed * self.time)

    def excess_over(self, friction_along: float) -> float:
        """Return <F> less an int G ds (uN um) over V T, in uN."""
        return self.mean_force - friction_along / (self.speed * self.time)

"""The motion of a slider in a stretch of a run: along the surface, or up and down under its load.

Its rows are uniform in time. It may stick, and it may leave the surface.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.landmarks import Flights, StickSlip, first_landmark
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.stretch import MOST_READ, Stretch, thinned
from rubnoise.figures.style import STUCK, one_line, shortened
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Reader, column_chunks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PERIODS: Final = 20.0
STICKS: Final = 20
"""Natural periods and, with two-way coupling, the number of sticks shown at least, by default."""

MOST_SPANS: Final = 1500
"""Sticks that are shaded one by one; of more each column of the picture is as dark as its share of sticks."""


Group = Literal["slider", "load", "trace"]
"""Which motion: along the surface, or up and down; of a run without a slider the force that would drive one."""

FORCE: Final = "friction_force"


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Rows ``first`` to before ``last`` of a group, ``apart`` s from one to the next, and the physics of the run.

    ``swings`` is the oscillator: the mass on its spring, or under a load the mass on its contact; None for the force of
    a run without a slider.
    """

    group: Group
    file: Reader
    model: Model
    swings: Slider | None
    speed: float
    apart: float
    first: int
    last: int

    @classmethod
    def of(cls, stretch: Stretch, group: Group = "slider", column: str | None = None) -> Self:
        """Return the motion in a stretch; raises Refused for a run without it, and for fewer than two rows.

        For the friction force alone (``column``) a run needs no slider.
        """
        model, file = stretch.model, stretch.file
        if column == FORCE and model.slider is None and column in file.columns["trace"]:
            group = "trace"
        if group == "trace" and model.sliding_speed is None:
            raise Refused("the run has no times; sliding.speed in its scenario would give them")
        swinging = {"slider": model.slider, "load": None if model.held is None else model.held.oscillator}
        swings = swinging.get(group)
        missing = swings is None and group != "trace"
        if missing or model.sliding_speed is None or group not in file.columns:
            what = "slider" if group == "slider" else "load that weighs"
            raise Refused(f"the run has no {what} to draw; [{group}] in its scenario would give it one")
        first, last = stretch.rows(group)
        if last - first < 2:
            raise Refused(
                f"the slider passes {stretch.start:g} to {stretch.stop:g} um in less than the"
                f" {model.tick / model.sliding_speed:.3g} s between two rows of /{group}"
            )
        apart = model.tick / model.sliding_speed
        return cls(
            group=group,
            file=file,
            model=model,
            swings=swings,
            speed=model.sliding_speed,
            apart=apart,
            first=first,
            last=last,
        )

    @property
    def slider(self) -> Slider:
        """The oscillator."""
        if self.swings is None:
            raise AssertionError("a run without a slider has nothing that swings")
        return self.swings

    @property
    def frequency(self) -> float:
        """The natural frequency in Hz; for a force without a slider, the number of mean lives per second."""
        return self.speed / self.model.mean_life_distance if self.swings is None else self.swings.natural_frequency

    @property
    def begin(self) -> float:
        """Time of the first row in s."""
        return self.apart * self.first

    @property
    def end(self) -> float:
        """Time of the last row in s."""
        return self.apart * (self.last - 1)

    def beginning(self) -> Self:
        """Return the first natural periods, with the first sticks of a two-way slider, or all if there are fewer."""
        duration = PERIODS / self.slider.natural_frequency
        if self.model.is_two_way:
            wanted = first_landmark(self.file, self.begin) + 2 * STICKS
            if wanted >= self.file.rows("landmarks"):
                duration = max(duration, self.end - self.begin if self.file.rows("landmarks") else 0.0)
            else:
                time = float(self.file.column("landmarks", "time", wanted, wanted + 1)[0])
                duration = max(duration, time - self.begin)
        return self.between(self.begin, self.begin + duration)

    def between(self, begin: float, end: float) -> Self:
        """Return the rows between two times in s, up to the end of the run; raises Refused for fewer than two."""
        rows = self.file.rows(self.group)
        first = min(round(begin / self.apart), rows)
        last = min(max(round(end / self.apart) + 1, first + 2), rows)
        if last - first < 2:
            raise Refused(f"the run is over before {begin:g} s")
        return replace(self, first=first, last=last)

    @property
    def driven_by_base(self) -> bool:
        """Whether asperities lift the slider's base, in place of a friction force."""
        return self.group == "slider" and self.slider.excitation == "base"

    @property
    def driven_by(self) -> str:
        """What drives the slider, in words."""
        return "base" if self.driven_by_base else "friction force"

    def curve(self, name: str) -> tuple[Doubles, Doubles]:
        """Return times in s and values of a column; of many rows only the extremes of each few."""
        place, value = thinned(self.file, self.group, name, self.first, self.last)
        return self.apart * place, value

    def present(self, name: str) -> str:
        """Return the name of a column; raises Refused if the run does not have it."""
        if name in self.file.columns[self.group]:
            return name
        raise Refused(f"the run has no {name.replace('_', ' ')} to draw; [strength] in its scenario would give it one")

    def chunks(self, name: str) -> Iterator[NDArray[Any]]:
        """Return a column as arrays of some rows; raises Refused for a force that the run does not have."""
        return column_chunks(self.file, self.group, self.present(name), self.first, self.last)

    def record(self, name: str) -> Doubles:
        """Return a column as doubles, or its beginning if there is more than a picture needs; refused as `chunks`."""
        last = min(self.last, self.first + MOST_READ)
        return self.file.column(self.group, self.present(name), self.first, last).astype(np.float64)

    def stick_slip(self) -> StickSlip:
        """Return the sticks and slips of a two-way slider; for a very long stretch, those of its beginning."""
        return StickSlip.of(self.file, self.begin, self.end, MOST_READ)

    def flights(self) -> Flights | None:
        """Return the flights of a free slider, of a very long stretch those of its beginning; None for others."""
        return None if self.model.free is None else Flights.of(self.file, self.begin, self.end, MOST_READ)


def motions_of(
    stretch: Stretch, beside: Stretch | None, group: Group = "slider", column: str | None = None
) -> list[Motion]:
    """Return the motion in a stretch, and in that of a run drawn over it; raises Refused for runs without motion."""
    first = Motion.of(stretch, group, column)
    if beside is None:
        return [first]
    with prefix_refusals(f"--with {beside.file.path}"):
        return [first, Motion.of(beside, group, column)]


def labels_of(motions: Sequence[Motion]) -> list[str]:
    """Return labels that distinguish motions: their coupling, or else the names of their files; one needs none."""
    if len(motions) == 1:
        return ["simulated"]
    couplings = [f"{motion.swings.coupling} coupling" for motion in motions if motion.swings is not None]
    if len(set(couplings)) == len(motions):
        return couplings
    return [shortened(one_line(motion.file.path.name)) for motion in motions]


@contextmanager
def prefix_refusals(what: str) -> Iterator[None]:
    """Put a prefix in front of the message of a refusal."""
    try:
        yield
    except Refused as refusal:
        raise type(refusal)(f"{what}: {refusal}") from refusal


def shade_sticks(axes: "Axes", motion: Motion) -> None:
    """Shade where a two-way slider sticks; a one-way slider never does."""
    if motion.model.is_two_way:
        found = motion.stick_slip()
        _shade(axes, motion, found.stick_begin, found.stick_end, "stick")


def shade_flights(axes: "Axes", motion: Motion) -> None:
    """Shade where a slider that may leave its contact is off the surface."""
    found = motion.flights()
    if found is not None:
        _shade(axes, motion, found.begin, found.end, "off the surface")


def _shade(axes: "Axes", motion: Motion, begins: Doubles, ends: Doubles, label: str) -> None:
    """Shade intervals of time in s.

    A picture has a limited number of columns: with more intervals, each column is as dark as their share of it.
    """
    begin, width, share = spans(begins, ends, motion.begin, motion.end)
    if begin.size:
        colours = [(*STUCK, float(each)) for each in share]
        axes.broken_barh(
            list(zip(begin.tolist(), width.tolist(), strict=True)),
            (0.0, 1.0),
            transform=axes.get_xaxis_transform(),
            facecolors=colours,
            lw=0.0,
            zorder=0,
            label=label,
        )


def spans(begin: Doubles, end: Doubles, first: float, last: float) -> tuple[Doubles, Doubles, Doubles]:
    """Return the spans to shade: begins and widths in s, and the share of each that the intervals take."""
    if begin.size <= MOST_SPANS:
        return begin, end - begin, np.ones(begin.size)
    edges = np.linspace(first, last, MOST_SPANS + 1)
    # The time taken up to each edge is piecewise linear, with kinks where an interval begins or ends.
    kinks = np.stack([begin, end], axis=-1).ravel()
    taken = np.stack([np.cumsum(end - begin) - (end - begin), np.cumsum(end - begin)], axis=-1).ravel()
    share = np.diff(np.interp(edges, kinks, taken)) / np.diff(edges)
    return edges[:-1], np.diff(edges), np.clip(share, 0.0, 1.0)

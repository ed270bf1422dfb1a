"""The motion of a slider in a stretch of a run: its rows, which are uniform in time, and where it sticks."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.stick_slip import StickSlip, first_landmark
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.stretch import CHUNK_ROWS, MOST_READ, Stretch, thinned
from rubnoise.figures.style import STUCK, one_line, shortened
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Reader

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PERIODS: Final = 20.0
STICKS: Final = 20
"""Natural periods and, with two-way coupling, the number of sticks shown at least, by default."""

MOST_SPANS: Final = 1500
"""Sticks that are shaded one by one; of more each column of the picture is as dark as its share of sticks."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Rows ``first`` to before ``last`` of /slider, ``apart`` s from one to the next, and the physics of the run."""

    file: Reader
    model: Model
    slider: Slider
    speed: float
    apart: float
    first: int
    last: int

    @classmethod
    def of(cls, stretch: Stretch) -> Self:
        """Return the motion in a stretch; raises Refused for a run without a slider, and for fewer than two rows."""
        model, file = stretch.model, stretch.file
        if model.slider is None or model.sliding_speed is None or "slider" not in file.columns:
            raise Refused("the run has no slider to draw; [slider] in its scenario would give it one")
        first, last = stretch.rows("slider")
        if last - first < 2:
            raise Refused(
                f"the slider passes {stretch.start:g} to {stretch.stop:g} um in less than the"
                f" {model.tick / model.sliding_speed:.3g} s between two rows of /slider"
            )
        apart = model.tick / model.sliding_speed
        return cls(
            file=file,
            model=model,
            slider=model.slider,
            speed=model.sliding_speed,
            apart=apart,
            first=first,
            last=last,
        )

    @property
    def begin(self) -> float:
        """Time of the first row in s."""
        return self.apart * self.first

    @property
    def end(self) -> float:
        """Time of the last row in s."""
        return self.apart * (self.last - 1)

    def beginning(self) -> Self:
        """Return the first natural periods, and of a two-way slider the first sticks too, or all if there are fewer."""
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
        """Return the rows from one time to another, in s, as far as the run goes; raises Refused for fewer than two."""
        rows = self.file.rows("slider")
        first = min(round(begin / self.apart), rows)
        last = min(max(round(end / self.apart) + 1, first + 2), rows)
        if last - first < 2:
            raise Refused(f"the run is over before {begin:g} s")
        return replace(self, first=first, last=last)

    def curve(self, name: str) -> tuple[Doubles, Doubles]:
        """Return times in s and values of a column; of many rows the extremes of each few."""
        place, value = thinned(self.file, "slider", name, self.first, self.last)
        return self.apart * place, value

    def chunks(self, name: str) -> Iterator[NDArray[Any]]:
        """Yield a column as arrays of some rows."""
        for begin in range(self.first, self.last, CHUNK_ROWS):
            yield self.file.column("slider", name, begin, min(begin + CHUNK_ROWS, self.last))

    def stick_slip(self) -> StickSlip:
        """Return the sticks and slips of a two-way slider, of a very long stretch those of its beginning."""
        return StickSlip.of(self.file, self.begin, self.end, MOST_READ)


def motions_of(stretch: Stretch, beside: Stretch | None) -> list[Motion]:
    """Return the motion in a stretch, and in that of a run that is laid over it; raises Refused for runs without."""
    first = Motion.of(stretch)
    if beside is None:
        return [first]
    with prefix_refusals(f"--with {beside.file.path}"):
        return [first, Motion.of(beside)]


def labels_of(motions: Sequence[Motion]) -> list[str]:
    """Return labels that distinguish motions: their coupling, or else the names of their files."""
    couplings = [f"{motion.slider.coupling} coupling" for motion in motions]
    if len(set(couplings)) == len(couplings):
        return couplings
    return [shortened(one_line(motion.file.path.name)) for motion in motions]


@contextmanager
def prefix_refusals(what: str) -> Iterator[None]:
    """Begin what is refused with what it is about."""
    try:
        yield
    except Refused as refusal:
        raise type(refusal)(f"{what}: {refusal}") from refusal


def shade_sticks(axes: "Axes", motion: Motion) -> None:
    """Shade where a two-way slider sticks; a one-way slider never does.

    A picture holds no more columns than so many: of more sticks each is as dark as the share of it that they take.
    """
    if not motion.model.is_two_way:
        return
    found = motion.stick_slip()
    begin, width, share = spans(found.stick_begin, found.stick_end, motion.begin, motion.end)
    if begin.size:
        colours = [(*STUCK, float(each)) for each in share]
        axes.broken_barh(
            list(zip(begin.tolist(), width.tolist(), strict=True)),
            (0.0, 1.0),
            transform=axes.get_xaxis_transform(),
            facecolors=colours,
            lw=0.0,
            zorder=0,
            label="stick",
        )


def spans(begin: Doubles, end: Doubles, first: float, last: float) -> tuple[Doubles, Doubles, Doubles]:
    """Return where to shade: begins and widths in s, and the share of each that the intervals take."""
    if begin.size <= MOST_SPANS:
        return begin, end - begin, np.ones(begin.size)
    edges = np.linspace(first, last, MOST_SPANS + 1)
    # The time taken up to each edge is piecewise linear, with kinks where an interval begins or ends.
    kinks = np.stack([begin, end], axis=-1).ravel()
    taken = np.stack([np.cumsum(end - begin) - (end - begin), np.cumsum(end - begin)], axis=-1).ravel()
    share = np.diff(np.interp(edges, kinks, taken)) / np.diff(edges)
    return edges[:-1], np.diff(edges), np.clip(share, 0.0, 1.0)

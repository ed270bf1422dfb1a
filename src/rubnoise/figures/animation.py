"""A run as a film: junctions sliding over each other above, the real contact area growing below, frame by frame."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import neighbours
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.marks import AREA, DISTANCE, entitle, exact_band, legend_above
from rubnoise.figures.motion import Motion
from rubnoise.figures.stage import Stage, stage_of
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, house_style, new_figure
from rubnoise.record.rows import Phase
from rubnoise.theory.campbell import area_cumulants

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LIVES: Final = 3.0
STICKS: Final = 4
"""Mean lives and, with two-way coupling, the number of sticks shown at least, by default."""

WIDTH, HEIGHT = 8.0, 5.0
DOTS_PER_INCH: Final = 100
ASPECT: Final = 3.6
MOST_FRAMES: Final = 1000
Frame = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True)
class Film:
    """A stretch of a run in frames of ``size`` pixels, ``rate`` of them a second, at sliding distances in um.

    With two-way coupling frames are evenly spaced in time, and ``told`` has time and phase of each.
    """

    stretch: Stretch
    stage: Stage
    distances: Doubles
    told: tuple[str, ...]
    rate: int

    @classmethod
    def of(cls, stretch: Stretch, *, seconds: float, rate: int) -> Self:
        """Return the film of a stretch that lasts so long; of one that nobody chose its first three mean lives.

        With two-way coupling it is longer where these hold fewer than four sticks. Raises Refused for fewer than 2
        frames or more than 1000, and for more junctions at once than a picture shows.
        """
        count = round(seconds * rate)
        if not 2 <= count <= MOST_FRAMES:
            raise Refused(
                f"{seconds:g} s at {rate} frames a second are {count:,} frames; 2 to {MOST_FRAMES:,} can be made"
            )
        shown = stretch.narrowed(max(LIVES * stretch.model.mean_life_distance, _sticks_width(stretch)))
        # A pair is seen a little before its birth and after its death; how long depends on its size.
        margin = stretch.model.mean_life_distance
        near = neighbours(shown.file, -1, shown.start - margin, shown.stop + margin)
        stage = stage_of(near, ASPECT)
        distances, told = _frames_of(shown, count)
        return cls(stretch=shown, stage=stage, distances=distances, told=told, rate=rate)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels, both even, as video wants them."""
        return round(WIDTH * DOTS_PER_INCH), round(HEIGHT * DOTS_PER_INCH)

    def frames(self) -> Generator[Frame]:
        """Yield frames as arrays of height, width and red, green, blue; the same on any day."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        with house_style():
            figure = new_figure(WIDTH, HEIGHT)
            figure.set_dpi(DOTS_PER_INCH)
            canvas: Any = FigureCanvasAgg(figure)
            entitle(figure, self.stretch, "The junctions, and the real contact area that they add up to")
            above, below = figure.subplots(2, 1, height_ratios=[1.65, 1.0])
            trace = _Trace(below, self.stretch)
            _set_scene(above, self.stage)
            drawn = self._draw(above, trace, float(self.distances[0]), self.told[0])
            figure.draw_without_rendering()
            figure.set_layout_engine("none")  # what is laid out once stays where it is
            for distance, told in zip(self.distances.tolist(), self.told, strict=True):
                for each in drawn:
                    each.remove()
                drawn = self._draw(above, trace, distance, told)
                canvas.draw()
                yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()

    def _draw(self, axes: "Axes", trace: "_Trace", distance: float, told: str) -> list[Any]:
        alive = self.stage.junctions.alive(distance)
        area = float(alive.area(distance).sum())
        trace.show(distance, area)
        axes.set_title(f"s = {distance:.1f} µm{told}     {alive.rows.size} alive     {area:.0f} µm² in contact")
        return self.stage.draw(axes, distance)


class _Trace:
    """The real contact area up to a distance, over the exact mean and spread."""

    def __init__(self, axes: "Axes", stretch: Stretch) -> None:
        self._distance, self._area = stretch.curve("trace", "real_contact_area")
        exact = area_cumulants(stretch.model)
        exact_band(axes, exact.mean, exact.std)
        (self._line,) = axes.plot([], [], color=BLUE, lw=1.4, label="simulated")
        (self._dot,) = axes.plot([], [], "o", color=BLUE, ms=5.0, clip_on=False, zorder=5)
        highest = max(float(self._area.max()), exact.mean + exact.std)
        axes.set_xlim(stretch.start, stretch.stop)
        axes.set_ylim(0.0, 1.05 * highest)
        axes.set_xlabel(DISTANCE)
        axes.set_ylabel(AREA)
        legend_above(axes)

    def show(self, distance: float, area: float) -> None:
        """Draw the area up to here."""
        known = int(np.searchsorted(self._distance, distance, side="right"))
        self._line.set_data(np.append(self._distance[:known], distance), np.append(self._area[:known], area))
        self._dot.set_data([distance], [area])


def _sticks_width(stretch: Stretch) -> float:
    """Return how far in um a two-way slider comes until its first sticks are over; 0 with one-way coupling."""
    landmarks = 2 * STICKS
    if not stretch.model.is_two_way or stretch.file.rows("landmarks") <= landmarks:
        return 0.0
    return float(stretch.file.column("landmarks", "distance", landmarks, landmarks + 1)[0]) - stretch.start


def _frames_of(stretch: Stretch, count: int) -> tuple[Doubles, tuple[str, ...]]:
    """Return the distance of each frame in um, and its label: time and phase of a two-way slider."""
    if not stretch.model.is_two_way:
        return np.linspace(stretch.start, stretch.stop, count), ("",) * count
    motion = Motion.of(stretch)
    places = np.linspace(motion.first, motion.last - 1, count)
    rows = np.minimum(places.astype(np.int64), motion.last - 2)
    pairs = [motion.file.column("slider", "distance", row, row + 2) for row in rows.tolist()]
    begin, end = np.array(pairs).T
    phases = [int(motion.file.column("slider", "phase", row, row + 1)[0]) for row in rows.tolist()]
    told = (
        f"     t = {motion.apart * place:.4f} s, {Phase(phase).name.lower()}"
        for place, phase in zip(places.tolist(), phases, strict=True)
    )
    return begin + (places - rows) * (end - begin), tuple(told)


def _set_scene(axes: "Axes", stage: Stage) -> None:
    axes.set_aspect("equal")
    axes.set_xlim(0.0, stage.width)
    axes.set_ylim(0.0, stage.height)
    axes.set_xticks([])
    axes.set_yticks([])
    for side in ("left", "bottom"):
        axes.spines[side].set_visible(False)
    axes.set_title("outlined: the upper surface, sliding \N{RIGHTWARDS ARROW}", loc="right", fontsize=8.5)

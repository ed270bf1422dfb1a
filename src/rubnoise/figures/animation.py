"""A run as a film: junctions sliding over each other above, area and live count growing below, frame by frame."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import neighbours
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.area import COUNT
from rubnoise.figures.motion import Motion
from rubnoise.figures.stage import Stage, stage_of
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import AREA, BLUE, DISTANCE, add_title, exact_band, house_style, legend_above, new_figure
from rubnoise.record.rows import Phase
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.exact import exact

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

LIVES: Final = 3.0
STICKS: Final = 4
"""Mean lives and, with two-way coupling, the number of sticks shown at least, by default."""

WIDTH, HEIGHT = 9.6, 5.4
DOTS_PER_INCH: Final = 100
ASPECT: Final = 3.2
MOST_FRAMES: Final = 1000
Frame = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True)
class Film:
    """A stretch of a run in frames of ``size`` pixels, ``rate`` of them a second, at sliding distances in um.

    With two-way coupling frames are evenly spaced in time, and ``labels`` holds time and phase of each.
    """

    stretch: Stretch
    stage: Stage
    distances: Doubles
    labels: tuple[str, ...]
    rate: int

    @classmethod
    def of(cls, stretch: Stretch, *, seconds: float, rate: int) -> Self:
        """Return the film of a stretch with a duration; by default of its first three mean lives.

        With two-way coupling it is longer if these hold fewer than four sticks. Raises Refused for fewer than 2
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
        distances, labels = _frames_of(shown, count)
        return cls(stretch=shown, stage=stage, distances=distances, labels=labels, rate=rate)

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
            add_title(figure, self.stretch, "The junctions, how many live, and the area that they add up to")
            rows: Any = [["stage", "stage"], ["area", "count"]]
            panes = figure.subplot_mosaic(rows, height_ratios=[2.3, 1.0], width_ratios=[1.6, 1.0])
            traces = _area_trace(panes["area"], self.stretch), _count_trace(panes["count"], self.stretch)
            stage = panes["stage"]
            self.stage.set_up(stage)
            drawn = self._draw(stage, traces, float(self.distances[0]), self.labels[0])
            figure.draw_without_rendering()
            figure.set_layout_engine("none")  # what is laid out once stays where it is
            for each in drawn:
                each.remove()
            changing = [stage.set_title(""), *traces[0].changing, *traces[1].changing]
            for each in changing:
                each.set_animated(True)
            # Most of a figure stays the same: it is drawn once, and each frame over a copy of it.
            canvas.draw()
            background, renderer = canvas.copy_from_bbox(figure.bbox), canvas.get_renderer()
            for distance, label in zip(self.distances.tolist(), self.labels, strict=True):
                drawn = self._draw(stage, traces, distance, label)
                canvas.restore_region(background)
                for each in sorted([*changing, *drawn], key=lambda artist: artist.get_zorder()):
                    each.draw(renderer)
                pixels = np.asarray(canvas.buffer_rgba())
                # Colour by colour, which takes a fifth of the time of all at once.
                yield np.stack([pixels[:, :, colour] for colour in range(3)], axis=-1)
                for each in drawn:
                    each.remove()

    def _draw(self, axes: "Axes", traces: tuple["_Growing", "_Growing"], distance: float, label: str) -> list[Any]:
        alive = self.stage.junctions.alive(distance)
        area, count = float(alive.area(distance).sum()), alive.rows.size
        traces[0].show(distance, area, f"{area:.0f} µm² in contact")
        traces[1].show(distance, float(count), f"{count} alive")
        axes.set_title(f"s = {distance:.1f} µm{label}")
        return self.stage.draw(axes, distance)


class _Growing:
    """A column of the trace up to a distance, over its exact mean and spread."""

    def __init__(self, axes: "Axes", stretch: Stretch, name: str, mean: float, std: float, **look: Any) -> None:
        self._distance, self._value = stretch.curve("trace", name)
        exact_band(axes, mean, std)
        (self._line,) = axes.plot([], [], color=BLUE, lw=1.4, label="simulated", **look)
        (self._dot,) = axes.plot([], [], "o", color=BLUE, ms=5.0, clip_on=False, zorder=5)
        self._dot.set_in_layout(False)  # it moves, and panes do not
        self._words = axes.set_title("")
        axes.set_xlim(stretch.start, stretch.stop)
        axes.set_ylim(0.0, 1.05 * max(float(self._value.max()), mean + std))
        axes.set_xlabel(DISTANCE)

    @property
    def changing(self) -> tuple["Artist", ...]:
        """The artists that change from frame to frame."""
        return self._line, self._dot, self._words

    def show(self, distance: float, value: float, words: str) -> None:
        """Draw the values up to a distance, and write the last one in words."""
        known = int(np.searchsorted(self._distance, distance, side="right"))
        self._line.set_data(np.append(self._distance[:known], distance), np.append(self._value[:known], value))
        self._dot.set_data([distance], [value])
        self._words.set_text(words)


def _area_trace(axes: "Axes", stretch: Stretch) -> _Growing:
    law = area_cumulants(stretch.model)
    trace = _Growing(axes, stretch, "real_contact_area", law.mean, law.std)
    axes.set_ylabel(AREA)
    legend_above(axes)
    return trace


def _count_trace(axes: "Axes", stretch: Stretch) -> _Growing:
    law = exact(stretch.model)
    trace = _Growing(axes, stretch, "junction_count", law.count_mean, law.count_std, drawstyle="steps-post")
    axes.locator_params(axis="y", integer=True)
    axes.set_ylabel(COUNT)
    return trace


def _sticks_width(stretch: Stretch) -> float:
    """Return the distance in um at which a two-way slider has ended its first sticks; 0 with one-way coupling."""
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
    labels = (
        f"     t = {motion.apart * place:.4f} s, {Phase(phase).name.lower()}"
        for place, phase in zip(places.tolist(), phases, strict=True)
    )
    return begin + (places - rows) * (end - begin), tuple(labels)

"""A run at a glance: junctions and their sum, one life, and the excited motion, or the statistics without a slider."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.errors import Refused
from rubnoise.figures.area import COUNT
from rubnoise.figures.motion import Motion
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import AREA, BLUE, DISTANCE, FAINT, INK, exact_band, file_label, legend_above, new_figure
from rubnoise.theory.exact import exact
from rubnoise.theory.moments import area_cumulants

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WINDOW_LIVES: Final = 4.0
"""Width of the window around the junction, in its own lives."""

PERIODS: Final = 16.0
SHOWN_LIVES: Final = 40.0
"""Natural periods of a slider that are shown, and mean lives of a run without."""


def overview_figure(stretch: Stretch) -> "Figure":
    """Draw a run, and the life of one of its junctions: one in its middle, of about the mean diameter.

    With a slider its force and displacement are drawn below, without one area and count beside theory. Raises Refused
    for a run without junctions.
    """
    junction = _chosen(stretch)
    figure = new_figure(9.0, 5.4)
    below = ["force", "x"] if stretch.model.slider is not None else ["area", "count"]
    rows: Any = [["sum", "sum", "life"], *([name] * 3 for name in below)]
    axes: Any = figure.subplot_mosaic(rows)
    figure.suptitle(file_label(stretch), x=0.01, ha="left")
    _draw_sum(axes["sum"], stretch, junction)
    _draw_life(axes["life"], junction)
    if stretch.model.slider is not None:
        _draw_motion(axes["force"], axes["x"], Motion.of(stretch))
    else:
        _draw_statistics(axes["area"], axes["count"], stretch)
    return figure


def _chosen(stretch: Stretch) -> Neighbours:
    """Return the junction of about the mean diameter among those that are born in a life in the middle."""
    rows = stretch.file.rows("junctions")
    if rows == 0:
        raise Refused("no junction lives in this run; there is nothing to draw")
    middle = 0.5 * (stretch.start + stretch.stop)
    first = min(stretch.first_born(middle), rows - 1)
    last = max(stretch.first_born(middle + stretch.model.mean_life_distance), first + 1)
    diameter = stretch.file.column("junctions", "diameter", first, last)
    number = first + int(np.argmin(np.abs(diameter - stretch.model.sizes.moment(1))))
    begin = float(stretch.file.column("junctions", "birth_distance", number, number + 1)[0])
    return neighbours(stretch.file, -1, begin, begin).only(number)


def _draw_sum(axes: "Axes", stretch: Stretch, junction: Neighbours) -> None:
    birth, life = float(junction.birth[0]), float(junction.death[0] - junction.birth[0])
    first = max(birth - 0.5 * (WINDOW_LIVES - 1.0) * life, 0.0)
    window = np.linspace(first, first + WINDOW_LIVES * life, 1200)
    alive = neighbours(stretch.file, -1, float(window[0]), float(window[-1]))
    chosen = alive.rows == junction.rows[0]
    edges = np.cumsum(alive.areas(window)[np.argsort(~chosen, kind="stable")], axis=0)  # the chosen one lies lowest
    axes.plot(window, edges[:-1].T, color=FAINT, lw=0.4)
    axes.plot(window, edges[-1], color=INK, label="real contact area")
    axes.fill_between(window, edges[0], color=BLUE, lw=0.0, zorder=3, label=f"junction {junction.rows[0]}")
    axes.set_xlim(window[0], window[-1])
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(DISTANCE)
    axes.set_ylabel("area (µm²)")
    axes.set_title("The junctions and their sum", pad=20.0)
    legend_above(axes, columns=2)


def _draw_life(axes: "Axes", junction: Neighbours) -> None:
    distance = np.linspace(float(junction.birth[0]), float(junction.death[0]), 400)
    age, area = distance - distance[0], junction.areas(distance)[0]
    axes.fill_between(age, area, color=BLUE, alpha=0.18, lw=0.0)
    axes.plot(age, area, color=BLUE, lw=2.2)
    axes.set_xlim(0.0, age[-1])
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("since its birth (µm)")
    axes.set_ylabel("its area (µm²)")
    axes.set_title(f"The life of junction {junction.rows[0]}")


def _draw_motion(force: "Axes", displacement: "Axes", motion: Motion) -> None:
    shown = motion.between(motion.begin, motion.begin + PERIODS / motion.slider.natural_frequency)
    of_base = shown.driven_by_base
    time, value = shown.curve("base_displacement" if of_base else "friction_force")
    force.plot(time, (1.0 if of_base else 1e-3) * value, color=INK, lw=0.8)
    force.set_ylabel("base (µm)" if of_base else "force (mN)")
    force.set_title(f"The {shown.driven_by}, and the vibration that it excites")
    displacement.plot(*shown.curve("displacement"), color=BLUE)
    displacement.set_ylabel("displacement (µm)")
    displacement.set_xlabel("time (s)")
    force.sharex(displacement)
    force.tick_params(labelbottom=False)
    displacement.set_xlim(time[0], time[-1])


def _draw_statistics(area: "Axes", count: "Axes", stretch: Stretch) -> None:
    """Draw area and count of the beginning, each with its exact mean and standard deviation."""
    shown = stretch.narrowed(SHOWN_LIVES * stretch.model.mean_life_distance)
    law, numbers = area_cumulants(stretch.model), exact(stretch.model)
    exact_band(area, law.mean, law.std)
    area.plot(*shown.curve("trace", "real_contact_area"), color=BLUE, lw=0.9, label="simulated")
    area.set_ylabel(AREA.replace(" contact", "\ncontact"))
    area.set_title("The sum, and how many live")
    legend_above(area)
    exact_band(count, numbers.count_mean, numbers.count_std)
    count.plot(*shown.curve("trace", "junction_count"), color=BLUE, lw=0.9, drawstyle="steps-post")
    count.set_ylabel(COUNT.replace(" live", "\nlive"))
    count.set_xlabel(DISTANCE)
    area.sharex(count)
    area.tick_params(labelbottom=False)
    count.set_xlim(shown.start, shown.stop)

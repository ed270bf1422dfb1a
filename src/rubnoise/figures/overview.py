"""A run at a glance: junctions and their sum, one life, the force and the vibration that it excites."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.figures.style import BLUE, FAINT, INK, as_png, house_style, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rubnoise.api import Junction, Run

WINDOW_LIVES: Final = 4.0
"""Width of the window around the junction, in its own lives."""

SECONDS: Final = 0.4
"""How much of force and vibration is shown: some twenty periods of the slider of Fig. 5."""


def overview_png(run: "Run", number: int) -> bytes:
    """Return a picture of a run with a slider, and of one of its junctions, as a png."""
    junction = run.junction(number)
    with house_style():
        figure = new_figure(9.0, 5.2)
        axes: Any = figure.subplot_mosaic([["sum", "sum", "life"], ["force", "force", "force"], ["x", "x", "x"]])
        _draw_sum(axes["sum"], run, junction)
        _draw_life(axes["life"], junction)
        _draw_motion(axes["force"], axes["x"], run)
        return as_png(figure)


def _draw_sum(axes: "Axes", run: "Run", junction: "Junction") -> None:
    first = max(junction.birth_distance - 0.5 * (WINDOW_LIVES - 1.0) * junction.life_distance, 0.0)
    window = np.linspace(first, first + WINDOW_LIVES * junction.life_distance, 1200)
    distance = run.trace["distance"][:]
    inside = slice(*np.searchsorted(distance, [window[0], window[-1]]))
    axes.plot(distance[inside], run.trace["real_contact_area"][inside], color=INK, label="real contact area")
    rows = (run.junctions["birth_distance"][:] < window[-1]) & (run.junctions["death_distance"][:] > window[0])
    for other in np.flatnonzero(rows).tolist():
        own = other == junction.number
        area = run.junction(other).area(window)
        shown = np.where(area > 0.0, area, np.nan)
        if own:
            axes.plot(window, shown, color=BLUE, lw=2.2, zorder=3, label=f"junction {other}")
        else:
            axes.plot(window, shown, color=FAINT, lw=0.6)
    axes.set_xlim(window[0], window[-1])
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("sliding distance (µm)")
    axes.set_ylabel("area (µm²)")
    axes.set_title("The junctions and their sum")
    axes.legend(loc="upper right", ncols=2, bbox_to_anchor=(1.0, 1.17))


def _draw_life(axes: "Axes", junction: "Junction") -> None:
    distance = np.linspace(junction.birth_distance, junction.death_distance, 400)
    age, area = distance - junction.birth_distance, junction.area(distance)
    axes.fill_between(age, area, color=BLUE, alpha=0.18, lw=0.0)
    axes.plot(age, area, color=BLUE, lw=2.2)
    axes.set_xlim(0.0, age[-1])
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("sliding distance since its birth (µm)")
    axes.set_ylabel("its area (µm²)")
    axes.set_title(f"The life of junction {junction.number}")


def _draw_motion(force: "Axes", displacement: "Axes", run: "Run") -> None:
    time = run.slider["time"][:]
    end = int(np.searchsorted(time, SECONDS))
    force.plot(time[:end], 1e-3 * run.slider["friction_force"][:end], color=INK, lw=0.8)
    force.set_ylabel("force (mN)")
    force.set_title("The friction force, and the vibration that it excites")
    displacement.plot(time[:end], run.slider["displacement"][:end], color=BLUE)
    displacement.set_ylabel("displacement (µm)")
    displacement.set_xlabel("time (s)")
    force.sharex(displacement)
    force.tick_params(labelbottom=False)
    displacement.set_xlim(0.0, time[end - 1])

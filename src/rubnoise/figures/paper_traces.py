"""Figures 4 to 6 of the paper: traces of the real contact area, the force, and the vibration."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.selection import neighbours
from rubnoise.arrays import Doubles
from rubnoise.figures.area import draw_lives
from rubnoise.figures.motion import Motion, shade_sticks
from rubnoise.figures.paper_sources import Sources
from rubnoise.figures.slider import MILLI, draw_in_time
from rubnoise.figures.style import BLUE, FAINT, INK, STUCK, VERMILION, legend_above, new_figure
from rubnoise.theory.distribution import distribution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.model import Model


def draw_fig4(sources: Sources) -> "Figure":
    """Draw A_r over the whole of a short run, below it the area of every junction, and in both one life in black."""
    run = sources.stretch("fig4.toml")
    figure = new_figure(7.2, 4.4)
    draw_lives(figure, run, neighbours(run.file, -1, run.start, run.stop))
    return figure


SECONDS: Final = 1.0
"""How much is shown: some forty periods of the slider."""

NEAR_SECONDS: Final = 0.2
NEAR_SPEEDS: Final = 6.0
"""How much of the velocity is drawn once more, and up to how many sliding speeds."""

COLUMNS: Final = {
    "friction_force": (MILLI, "friction force (mN)"),
    "displacement": (1.0, "displacement (µm)"),
    "velocity": (MILLI, "velocity (mm/s)"),
}


def draw_fig5(sources: Sources) -> "Figure":
    """Draw force, displacement and velocity over the first second, each about its exact mean and spread.

    These are exact for one-way coupling. Of a two-way slider, in a reader's scenario, sticks are shaded instead.
    """
    motion = Motion.of(sources.stretch("fig5.toml"))
    shown = motion.between(0.0, SECONDS)
    figure = new_figure(7.2, 7.0)
    force, displacement, velocity, near = figure.subplots(4, 1)
    for axes, (name, (scale, label)) in zip((force, displacement, velocity), COLUMNS.items(), strict=True):
        draw_in_time(axes, [shown], name, scale)
        axes.set_ylabel(label)
        axes.tick_params(labelbottom=axes is velocity)
    # A two-way slider that runs back feels the force from the other side.
    force.set_ylim(bottom=min(0.0, force.get_ylim()[0]) if force.dataLim.y0 < 0.0 else 0.0)
    velocity.set_xlabel("time (s)")
    _draw_near_zero(near, motion.between(0.0, NEAR_SECONDS))
    legend_above(force)
    figure.align_ylabels()
    return figure


def _draw_near_zero(axes: "Axes", motion: Motion) -> None:
    """Draw the velocity again near zero and the drive's speed, and shade where it is above that, or sticks."""
    (time, velocity), speed = motion.curve("velocity"), MILLI * motion.speed
    velocity = MILLI * velocity
    if motion.model.is_two_way:
        shade_sticks(axes, motion)
    else:
        look: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "color": STUCK, "lw": 0.0, "zorder": 0}
        axes.fill_between(time, 0.0, 1.0, where=velocity > speed, label="slider faster than the drive", **look)
    axes.plot(time, velocity, color=BLUE, lw=1.2)
    axes.axhline(0.0, color=FAINT, lw=0.8)
    axes.axhline(speed, color=INK, lw=1.2, ls=(0, (5, 2)), label=f"sliding speed, {speed:.3g} mm/s")
    axes.set_xlim(0.0, time[-1])
    axes.set_ylim(-NEAR_SPEEDS * speed, NEAR_SPEEDS * speed)
    axes.set_ylabel("velocity near\nzero (mm/s)")
    axes.set_xlabel("time (s), the beginning of the curves above")
    legend_above(axes)


COUNTS: Final = (10, 20, 30, 40, 50)
SHOWN_DISTANCE: Final = 1000.0
"""How much of each trace is drawn, in um; the histograms are of the whole runs."""

HIGHEST: Final = 560.0
BINS: Final = 56
DENSITY_SAMPLES: Final = 600


def draw_fig6(sources: Sources) -> "Figure":
    """Draw a trace and a histogram for each number of junctions, all on one scale of areas."""
    figure = new_figure(7.2, 7.4)
    rows = figure.subplots(len(COUNTS), 2, sharex="col", sharey=True, width_ratios=[2.6, 1.0])
    densities = []
    for (trace, histogram), count in zip(rows, COUNTS, strict=True):
        run = sources.stretch(f"fig6_n{count}.toml", SHOWN_DISTANCE)
        trace.plot(*run.curve("trace", "real_contact_area"), color=BLUE, lw=0.8)
        trace.set_xlim(0.0, SHOWN_DISTANCE)
        trace.set_ylim(0.0, HIGHEST)
        densities.append(_draw_histogram(histogram, run.model, run.whole().record("trace", "real_contact_area")))
        trace.set_title(f"{count} junctions on average")
    rows[-1][1].set_xlim(0.0, 1.05 * max(densities))
    _label_rows(rows)
    figure.supylabel("real contact area (µm²)", fontsize=9.0)
    return figure


def _draw_histogram(axes: "Axes", model: "Model", area: Doubles) -> float:
    """Draw a histogram and the exact density, and return the highest density."""
    edges = np.linspace(0.0, HIGHEST, BINS + 1)
    share = np.histogram(area, edges)[0] / (area.size * np.diff(edges))
    axes.stairs(share, edges, orientation="horizontal", fill=True, color=BLUE, alpha=0.4, lw=0.0, label="simulated")
    areas = np.linspace(0.0, HIGHEST, DENSITY_SAMPLES)[1:]
    density = distribution(model).density(areas)
    axes.plot(density, areas, color=VERMILION, lw=1.3, label="exact")
    return float(max(share.max(), density.max()))


def _label_rows(rows: "NDArray[np.object_]") -> None:
    rows[0][1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1, columnspacing=1.0)
    rows[-1][0].set_xlabel("sliding distance (µm)")
    rows[-1][1].locator_params(axis="x", nbins=3)
    rows[-1][1].xaxis.set_major_formatter("{x:g}")
    rows[-1][1].set_xlabel("density (1/µm²)")

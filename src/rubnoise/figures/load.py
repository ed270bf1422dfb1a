"""The rise and fall of the slider under its load: load, separation, normal velocity, and their histograms."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.sound import Heard
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.motion import Motion, motions_of
from rubnoise.figures.motion_spectrum import QUANTITIES, whose
from rubnoise.figures.slider import MILLI, draw_in_time, same_times
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, INK, NEAREST, VERMILION, add_title, legend_above, logarithmic, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_MARKED: Final = 200
"""Impacts that are marked: with more, the marks would hide one another."""

BINS: Final = 60


def load_figure(stretch: Stretch, beside: Stretch | None = None) -> "Figure":
    """Draw load, separation and normal velocity in time, for first order with their exact means and spreads.

    For free motion the exact mean of the load is drawn, flights are shaded, and impacts are marked. Another run is
    drawn over the first at the same times. Raises Refused for a run without a load that weighs.
    """
    shown = same_times(stretch, motions_of(stretch, beside, "load"))
    figure = new_figure(7.2, 5.4)
    add_title(figure, stretch, "The slider on its load", beside)
    bears, place, speed = figure.subplots(3, 1, sharex=True)
    for axes, name, scale, label in (
        (bears, "load", MILLI, "load (mN)"),
        (place, "separation", 1.0, "separation (µm)"),
        (speed, "velocity", MILLI, "normal velocity\n(mm/s)"),
    ):
        draw_in_time(axes, shown, name, scale)
        axes.set_ylabel(label)
    if beside is None:
        _mark_impacts(bears, speed, shown[0])
    speed.set_xlabel("time (s)")
    legend_above(bears)
    figure.align_ylabels([bears, place, speed])
    return figure


def _mark_impacts(bears: "Axes", speed: "Axes", motion: Motion) -> None:
    """Mark the exact mean load of free motion, and the impacts of the slider, if there is room."""
    found = motion.flights()
    if found is None:
        return
    bears.axhline(MILLI * (motion.model.load or 0.0), color=VERMILION, lw=1.2, zorder=4, label="exact mean")
    if found.impacts.size <= MOST_MARKED:
        times, values = motion.curve("velocity")
        falling = np.interp(found.impacts, times, MILLI * values)
        speed.plot(found.impacts, falling, "o", color=INK, ms=3.2, mfc="white", mew=0.8, label="impact")
        legend_above(speed)


def motion_histogram_figure(stretch: Stretch, heard: Heard) -> "Figure":
    """Draw the histogram of force, motion or load, on a linear and on a logarithmic axis.

    A load of 0 has no bar: a text states the share of the time in which the slider is off the surface. Raises Refused
    if nothing but rounding varies.
    """
    quantity = QUANTITIES[heard]
    motion = Motion.of(stretch, quantity.group, quantity.column)
    values = motion.record(quantity.column)
    if float(np.ptp(values)) <= NEAREST * quantity.still(motion):
        raise Refused(f"the {whose(heard)} does not vary in this stretch, so it has no histogram")
    may_bear_nothing = heard == "load" and motion.model.free is not None
    shown = quantity.scale * (values[values > 0.0] if may_bear_nothing else values)
    figure = new_figure(7.2, 3.6)
    add_title(figure, stretch, _title(heard, quantity.scale * values, motion))
    axes = figure.subplots(1, 2, sharex=True)
    _draw_shares(axes[0], shown, values.size, heard)
    _draw_shares(axes[1], shown, values.size, heard)
    logarithmic(axes[1].yaxis)
    legend_above(axes[0])
    return figure


def _title(heard: Heard, values: Doubles, motion: Motion) -> str:
    unit = QUANTITIES[heard].unit
    title = f"How often each {whose(heard)} occurs: mean {values.mean():.4g} {unit}, std {values.std():.4g} {unit}"
    found = motion.flights()
    if found is None:
        return title
    title += f"\noff the surface for {100.0 * found.share(motion.begin, motion.end):.3g} % of the time"
    return f"{title}, in which the load is 0 and not drawn" if heard == "load" else title


def _draw_shares(axes: "Axes", values: Doubles, all_values: int, heard: Heard) -> None:
    counts, edges = np.histogram(values, BINS)
    axes.stairs(
        counts / (all_values * np.diff(edges)), edges, fill=True, color=BLUE, alpha=0.45, lw=0.0, label="simulated"
    )
    axes.axvline(float(values.sum()) / all_values, color=INK, lw=0.8, ls=(0, (4, 3)), label="mean of all")
    unit = QUANTITIES[heard].unit
    axes.set_xlabel(f"{whose(heard)} ({unit})")
    axes.set_ylabel(f"density (1/({unit}))" if "/" in unit else f"density (1/{unit})")

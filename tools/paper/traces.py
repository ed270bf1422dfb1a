"""Figures 4 to 6 of the paper: traces of the real contact area, the force, and the vibration."""

from dataclasses import replace
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from paper.figures import Sources
from rubnoise.figures.panes import draw_along
from rubnoise.figures.pictures import draw_lives
from rubnoise.figures.style import BLUE, VERMILION, add_legends, new_figure
from rubnoise.figures.tracks import Track
from rubnoise.theory.moments import distribution


def draw_fig4(sources: Sources) -> Figure:
    """Draw A_r over the whole of a short run, below it the area of every junction, and in both one life in black."""
    figure = new_figure(7.2, 4.4)
    draw_lives(figure, replace(sources.stretch("fig4"), chosen=True))
    add_legends(figure.axes)
    return figure


SECONDS: Final = 1.0
"""How much is shown, some forty periods of the slider."""


def draw_fig5(sources: Sources) -> Figure:
    """Draw force, displacement and velocity over the first second, each about its exact mean and spread.

    These are exact for one-way coupling. Of a two-way slider, in a reader's scenario, sticks are shaded instead.
    """
    run = sources.stretch("fig5")
    figure = new_figure(7.2, 5.4)
    panes = figure.subplots(3, 1)
    for axes, name in zip(panes, ("force", "displacement", "velocity"), strict=True):
        draw_along(axes, [Track.of(run, name).between(0.0, SECONDS)], last=name == "velocity")
    # A two-way slider that runs back feels the force from the other side.
    panes[0].set_ylim(bottom=min(0.0, panes[0].get_ylim()[0]) if panes[0].dataLim.y0 < 0.0 else 0.0)
    add_legends(panes)
    figure.align_ylabels()
    return figure


COUNTS: Final = (10, 20, 30, 40, 50)
SHOWN, HIGHEST, BINS = 1000.0, 560.0, 56
"""How much of each trace is drawn, in um; the largest area that is drawn, in um^2; bins of the histograms."""


def draw_fig6(sources: Sources) -> Figure:
    """Draw a trace, and a histogram of the whole run, for each number of junctions, all on one scale of areas."""
    figure = new_figure(7.2, 7.4)
    rows = figure.subplots(len(COUNTS), 2, sharex="col", sharey=True, width_ratios=[2.6, 1.0])
    for (trace, histogram), count in zip(rows, COUNTS, strict=True):
        run = sources.stretch(f"fig6_n{count}", SHOWN)
        trace.plot(*Track.of(run, "area").curve(), color=BLUE, lw=0.8)
        trace.set(xlim=(0.0, SHOWN), ylim=(0.0, HIGHEST), title=f"{count} junctions on average")
        area, edges = Track.of(run.whole(), "area").record(), np.linspace(0.0, HIGHEST, BINS + 1)
        share = np.histogram(area, edges)[0] / (area.size * np.diff(edges))
        look: dict[str, Any] = {"orientation": "horizontal", "fill": True, "color": BLUE, "alpha": 0.4, "lw": 0.0}
        histogram.stairs(share, edges, label="simulated", **look)
        areas = np.linspace(0.0, HIGHEST, 600)[1:]
        histogram.plot(distribution(run.model).density(areas), areas, color=VERMILION, lw=1.3, label="exact")
    rows[0][1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1, columnspacing=1.0)
    rows[-1][0].set_xlabel("sliding distance (µm)")
    rows[-1][1].set(xlabel="density (1/µm²)")
    rows[-1][1].set_xlim(left=0.0)
    rows[-1][1].locator_params(axis="x", nbins=3)
    rows[-1][1].xaxis.set_major_formatter("{x:g}")
    figure.supylabel("real contact area (µm²)", fontsize=9.0)
    return figure

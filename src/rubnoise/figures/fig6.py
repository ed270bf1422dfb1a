"""Figure 6: traces of the real contact area for five numbers of junctions, and how often each area occurs."""

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.api import simulate
from rubnoise.arrays import Doubles
from rubnoise.figures.sources import Sources, envelope
from rubnoise.figures.style import BLUE, VERMILION, new_figure
from rubnoise.theory.distribution import distribution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.model import Model

COUNTS: Final = (10, 20, 30, 40, 50)
SHOWN: Final = 1000.0
"""How much of each trace is drawn, in um; the histograms are of the whole runs."""

HIGHEST: Final = 560.0
BINS: Final = 56
SAMPLES: Final = 600


def draw(sources: Sources) -> "Figure":
    """Draw a trace and a histogram for each number of junctions, all on one scale of areas."""
    figure = new_figure(7.2, 7.4)
    rows = figure.subplots(len(COUNTS), 2, sharex="col", sharey=True, width_ratios=[2.6, 1.0])
    densities = []
    for (trace, histogram), count in zip(rows, COUNTS, strict=True):
        scenario = sources.scenario(f"fig6_n{count}.toml")
        record = simulate(scenario)["trace"]
        _draw_trace(trace, record["distance"], record["real_contact_area"])
        densities.append(_draw_histogram(histogram, scenario.model(), record["real_contact_area"]))
        trace.set_title(f"{count} junctions on average")
    rows[-1][1].set_xlim(0.0, 1.05 * max(densities))
    _label(rows)
    figure.supylabel("real contact area (µm²)", fontsize=9.0)
    return figure


def _draw_trace(axes: "Axes", distance: Doubles, area: Doubles) -> None:
    shown = slice(0, int(np.searchsorted(distance, SHOWN)) + 1)
    axes.plot(*envelope(distance[shown], area[shown]), color=BLUE, lw=0.8)
    axes.set_xlim(0.0, SHOWN)
    axes.set_ylim(0.0, HIGHEST)


def _draw_histogram(axes: "Axes", model: "Model", area: Doubles) -> float:
    """Draw a histogram and the exact density, and return the highest density."""
    edges = np.linspace(0.0, HIGHEST, BINS + 1)
    share = np.histogram(area, edges)[0] / (area.size * np.diff(edges))
    axes.stairs(share, edges, orientation="horizontal", fill=True, color=BLUE, alpha=0.4, lw=0.0, label="simulated")
    areas = np.linspace(0.0, HIGHEST, SAMPLES)[1:]
    density = distribution(model).density(areas)
    axes.plot(density, areas, color=VERMILION, lw=1.3, label="exact")
    return float(max(share.max(), density.max()))


def _label(rows: "NDArray[np.object_]") -> None:
    rows[0][1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1, columnspacing=1.0)
    rows[-1][0].set_xlabel("sliding distance (µm)")
    rows[-1][1].locator_params(axis="x", nbins=3)
    rows[-1][1].xaxis.set_major_formatter("{x:g}")
    rows[-1][1].set_xlabel("density (1/µm²)")

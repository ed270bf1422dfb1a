"""The junctions that were born in a stretch: their sizes, their lives, and the gaps between their births."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.stretch import MOST_READ, Stretch
from rubnoise.figures.style import BLUE, INK, NEAREST, VERMILION, add_title, legend_above, new_figure
from rubnoise.theory.moments import share_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BINS: Final = 40
"""Bins of a histogram."""

LONGEST_GAPS: Final = 6.0
"""Mean gaps that are shown: 0.25 % of gaps at random are longer."""


def sizes_figure(stretch: Stretch) -> "Figure":
    """Draw the histogram of diameters with the law that they are drawn from."""
    values = born(stretch, "diameter")
    edges = _edges(values)
    law = share_of("sizes", stretch.model, edges) if stretch.has_theory else None
    return _figure(stretch, "How large junctions are", "diameter (µm)", values, edges, law)


def life_distances_figure(stretch: Stretch) -> "Figure":
    """Draw the histogram of lives, from birth to death in sliding distance, with their law."""
    values = born(stretch, "death_distance") - born(stretch, "birth_distance")
    edges = _edges(values)
    law = share_of("lives", stretch.model, edges) if stretch.has_theory else None
    return _figure(stretch, "How far junctions slide in their lives", "life distance (µm)", values, edges, law)


def gaps_figure(stretch: Stretch) -> "Figure":
    """Draw the histogram of gaps between births, with their law if it has a closed form."""
    values = np.diff(born(stretch, "birth_distance"))
    mean = stretch.model.births.mean
    edges = _edges(values) if np.ptp(values) < 1e-6 * mean else np.linspace(0.0, LONGEST_GAPS * mean, BINS + 1)
    law = share_of("gaps", stretch.model, edges) if stretch.has_theory else None
    return _figure(stretch, "How far births lie apart", "from a birth to the next (µm)", values, edges, law)


def born(stretch: Stretch, name: str) -> Doubles:
    """Return a column of /junctions for those born in a stretch; if there are very many, the first ones.

    Junctions alive at the start of a run are left out, since longer lives are more probable among them. Raises Refused
    for fewer than three.
    """
    first, last = stretch.first_born(max(stretch.start, 0.0)), stretch.first_born(stretch.stop)
    if last - first < 3:
        raise Refused(f"{last - first} junctions are born in this stretch; a histogram needs three")
    return stretch.file.column("junctions", name, first, min(last, first + MOST_READ)).astype(np.float64)


def _edges(values: Doubles) -> Doubles:
    """Return edges of bins from the least value to the largest; one bin about a constant value."""
    low, high = float(values.min()), float(values.max())
    room = (0.1 if high - low < NEAREST * high else 1e-9) * high
    return np.linspace(low - room, high + room, BINS + 1)


def _figure(stretch: Stretch, shown: str, label: str, values: Doubles, edges: Doubles, law: Doubles | None) -> "Figure":
    """Draw densities of bins, and the exact one with the band that holds two standard errors of a count."""
    counts, width = np.histogram(values, edges)[0], np.diff(edges)
    figure = new_figure(7.2, 3.8)
    add_title(figure, stretch, f"{shown}: {values.size:,} of them, mean {values.mean():.4g} µm")
    axes = figure.subplots()
    axes.stairs(counts / (values.size * width), edges, fill=True, color=BLUE, alpha=0.45, lw=0.0, label="simulated")
    if law is not None:
        exact = law / width
        error = np.sqrt(law * (1.0 - law) / values.size) / width
        axes.stairs(exact, edges, color=VERMILION, lw=1.4, label="exact")
        axes.stairs(
            exact + 2.0 * error,
            edges,
            baseline=np.maximum(exact - 2.0 * error, 0.0),
            fill=True,
            color=VERMILION,
            alpha=0.2,
            lw=0.0,
            label="± 2 std errors of a bin",
        )
    axes.axvline(float(values.mean()), color=INK, lw=0.8, ls=(0, (4, 3)), label="mean")
    axes.set_xlabel(label)
    axes.set_ylabel("density (1/µm)")
    axes.set_xlim(edges[0], edges[-1])
    legend_above(axes)
    return figure

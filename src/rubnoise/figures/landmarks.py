"""How far a two-way slider slips at a time, and how long it sticks."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.marks import entitle, legend_above
from rubnoise.figures.motion import Motion
from rubnoise.figures.stretch import MOST_READ, Stretch
from rubnoise.figures.style import BLUE, INK, VERMILION, logarithmic, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PER_DECADE: Final = 8
"""Bins for each factor of ten."""

MOST_DECADES: Final = 8


def landmarks_figure(stretch: Stretch) -> "Figure":
    """Draw how often slips of each length and sticks of each duration occur, in bins of equal ratio.

    Beside them stand the mean diameter of a junction and the slider's natural period. Raises Refused for a run without
    a two-way slider, and where it never sticks.
    """
    if not stretch.model.is_two_way:
        raise Refused(
            'the slider has no landmarks: only with slider.coupling = "two-way" does it stick and slip;'
            " rubnoise plot RUN.h5 phase shows this one"
        )
    motion = Motion.of(stretch)
    found = motion.stick_slip()
    if not (found.slip_lengths.size or found.stick_times.size):
        raise Refused(f"the slider ends no slip and no stick between {motion.begin:.4g} and {motion.end:.4g} s")
    figure = new_figure(7.2, 3.6)
    entitle(figure, stretch, f"How far the slider slips and how long it sticks{_part(motion)}")
    slips, sticks = figure.subplots(1, 2)
    _draw(slips, found.slip_lengths, "slip", "slip length", "µm", 1.0)
    diameter = stretch.model.calibrated_diameter
    longer = int((found.slip_lengths > diameter).sum())
    _mark(slips, diameter, f"mean diameter: {longer:,} longer")
    _draw(sticks, found.stick_times, "stick", "stick time", "ms", 1e3)
    _mark(sticks, 1e3 / motion.slider.natural_frequency, "natural period")
    return figure


def _part(motion: Motion) -> str:
    """Return that not all landmarks are shown, where they are not."""
    total = motion.file.rows("landmarks")
    return f", of its first {MOST_READ:,} landmarks" if total > MOST_READ else ""


def _draw(axes: "Axes", values: Doubles, what: str, label: str, unit: str, scale: float) -> None:
    """Draw how many of some values lie in each bin; those that are 0 are told in words."""
    shown = scale * values[values > 0.0]
    nothing = values.size - shown.size
    axes.set_xlabel(f"{label} ({unit})")
    axes.set_ylabel(f"number of {what}s")
    if not values.size:
        axes.set_ylim(0.0, 1.0)
        axes.text(0.5, 0.5, f"no {what}s", transform=axes.transAxes, ha="center")
    if shown.size:
        edges = bins(shown)
        name = f"{values.size:,} {what}{'s' * (values.size != 1)}" + (f", {nothing:,} of them 0" if nothing else "")
        axes.hist(np.maximum(shown, edges[0]), bins=edges.tolist(), color=BLUE, alpha=0.55, lw=0.0, label=name)
        median = scale * float(np.median(values))
        axes.axvline(median, color=INK, lw=1.2, label=f"median {median:.3g} {unit}")
        logarithmic(axes.xaxis)
        axes.set_xlim(edges[0], edges[-1])
    axes.locator_params(axis="y", integer=True)


def bins(values: Doubles) -> Doubles:
    """Return the edges of bins of equal ratio, a power of ten among them, that hold the largest of some values > 0."""
    highest = np.ceil(PER_DECADE * np.log10(values.max()) + 1e-9)
    lowest = max(np.floor(PER_DECADE * np.log10(values.min())), highest - PER_DECADE * MOST_DECADES)
    return 10.0 ** (np.arange(lowest, highest + 1.0) / PER_DECADE)


def _mark(axes: "Axes", place: float, label: str) -> None:
    """Mark a length or a time to compare with; where nothing is drawn there is nothing to compare."""
    if axes.get_xscale() != "log":
        return
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, 0.8 * place), max(high, 1.25 * place))
    axes.axvline(place, color=VERMILION, lw=1.2, ls=(0, (5, 3)), label=label)
    legend_above(axes, columns=1)

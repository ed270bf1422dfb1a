"""The real contact area along the sliding distance, about its exact mean."""

from typing import TYPE_CHECKING, Final

from rubnoise.figures.marks import AREA, DISTANCE, entitle, exact_band, from_zero, legend_above
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, FAINT, PALE, new_figure
from rubnoise.theory.campbell import area_cumulants

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LIVES: Final = 40.0
"""Mean lives that are shown by default."""


def trace_figure(stretch: Stretch) -> "Figure":
    """Draw A_r of a stretch, and above it where in the whole record the stretch lies."""
    shown = stretch.narrowed(LIVES * stretch.model.mean_life_distance)
    whole = stretch.whole()
    parted = (shown.start, shown.stop) != (whole.start, whole.stop)
    figure = new_figure(7.2, 4.6 if parted else 3.4)
    entitle(figure, stretch, "The real contact area")
    if parted:
        strip, axes = figure.subplots(2, 1, height_ratios=[1, 2.6])
        _draw_strip(strip, whole, shown)
    else:
        axes = figure.subplots()
    _draw(axes, shown)
    return figure


def _draw(axes: "Axes", stretch: Stretch) -> None:
    area = area_cumulants(stretch.model)
    exact_band(axes, area.mean, area.std)
    axes.plot(*stretch.curve("trace", "real_contact_area"), color=BLUE, lw=0.9, label="simulated")
    axes.set_xlim(stretch.start, stretch.stop)
    from_zero(axes)
    axes.set_xlabel(DISTANCE)
    axes.set_ylabel(AREA)
    legend_above(axes)


def _draw_strip(axes: "Axes", whole: Stretch, shown: Stretch) -> None:
    axes.axvspan(shown.start, shown.stop, color=PALE, lw=0.0, zorder=0)
    axes.plot(*whole.curve("trace", "real_contact_area"), color=FAINT, lw=0.5)
    axes.set_xlim(whole.start, whole.stop)
    from_zero(axes)
    axes.set_ylabel("µm²")
    axes.set_xlabel("sliding distance (µm), the stretch below shaded")

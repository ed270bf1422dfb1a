"""The pictures of a run, by name."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from rubnoise.arrays import Doubles
from rubnoise.figures.area import count_figure, lifelines_figure, lives_figure, trace_figure
from rubnoise.figures.area_statistics import acf_figure, histogram_figure, psd_figure
from rubnoise.figures.motion_spectrum import Heard, motion_spectrum_figure
from rubnoise.figures.slider import landmarks_figure, phase_figure, slider_figure
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import INK, Format, as_bytes, house_style, in_place_of, legend_above, one_line, shortened

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PICTURES: Final[dict[str, Callable[[Stretch], "Figure"]]] = {
    "trace": trace_figure,
    "lives": lives_figure,
    "histogram": histogram_figure,
    "psd": psd_figure,
    "acf": acf_figure,
    "count": count_figure,
    "slider": slider_figure,
    "phase": phase_figure,
    "landmarks": landmarks_figure,
    "lifelines": lifelines_figure,
}

OVERLAID: Final[dict[str, Callable[[Stretch, Stretch], "Figure"]]] = {"slider": slider_figure, "phase": phase_figure}
"""Pictures in which another run can be laid over the first."""


Measured = tuple[str, Doubles, Doubles]
"""A spectrum of the user's own, to lay over that of a run: its name, places and densities in the picture's units."""


def picture(
    name: str,
    stretch: Stretch,
    kind: Format,
    *,
    heard: Heard | None = None,
    beside: Stretch | None = None,
    measured: Measured | None = None,
) -> bytes:
    """Return a picture of a run as the bytes of a file; see `drawing`."""
    with house_style():
        return as_bytes(_figure(name, stretch, heard, beside, measured), kind)


def drawing(
    name: str,
    stretch: Stretch,
    *,
    heard: Heard | None = None,
    beside: Stretch | None = None,
    measured: Measured | None = None,
    ax: "Axes | None" = None,
) -> "Figure":
    """Return a picture of a run as a figure, which a notebook shows, or draw it in the place of ``ax``.

    heard: whose spectrum `psd` shows, in place of the area's; beside: a run that is laid over the first; measured: a
    spectrum of the user's own. Raises Refused if a run has not what is shown.
    """
    with house_style(), in_place_of(ax):
        return _figure(name, stretch, heard, beside, measured)


def _figure(
    name: str, stretch: Stretch, heard: Heard | None, beside: Stretch | None, measured: Measured | None
) -> "Figure":
    if heard is not None:
        figure = motion_spectrum_figure(stretch, heard, beside)
    else:
        figure = PICTURES[name](stretch) if beside is None else OVERLAID[name](stretch, beside)
    if measured is not None:
        label, place, density = measured
        axes = figure.axes[0]
        axes.plot(place, density, color=INK, lw=1.0, label=shortened(one_line(label)))
        legend_above(axes, columns=3)
    return figure

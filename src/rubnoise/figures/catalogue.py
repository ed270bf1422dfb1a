"""The pictures of a run, by name, and those of a sweep."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from rubnoise.analysis.sound import Heard
from rubnoise.api.kinds import Kind, Style
from rubnoise.api.sweep_result import SweepResult
from rubnoise.arrays import Doubles
from rubnoise.figures.area import count_figure, lifelines_figure, lives_figure, trace_figure
from rubnoise.figures.area_statistics import acf_figure, histogram_figure, psd_figure
from rubnoise.figures.contact import contact_figure
from rubnoise.figures.load import load_figure, motion_histogram_figure
from rubnoise.figures.motion_spectrum import motion_spectrum_figure
from rubnoise.figures.narrow import fit_labels
from rubnoise.figures.overview import overview_figure
from rubnoise.figures.population import gaps_figure, life_distances_figure, sizes_figure
from rubnoise.figures.slider import landmarks_figure, phase_figure, slider_figure
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.study import study_of_sweep
from rubnoise.figures.study_picture import draw_study
from rubnoise.figures.style import (
    INK,
    Format,
    as_bytes,
    house_style,
    in_place_of,
    legend_above,
    of_size,
    one_line,
    shortened,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PICTURES: Final[dict[Kind, Callable[[Stretch], "Figure"]]] = {
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
    "overview": overview_figure,
    "sizes": sizes_figure,
    "life_distances": life_distances_figure,
    "gaps": gaps_figure,
    "contact": contact_figure,
    "load": load_figure,
}

HEARD: Final[dict[Kind, Callable[[Stretch, Heard], "Figure"]]] = {
    "psd": motion_spectrum_figure,
    "histogram": motion_histogram_figure,
}
"""Pictures that can be of force, motion or load, in place of the area."""

OVERLAID: Final[dict[Kind, Callable[[Stretch, Stretch], "Figure"]]] = {
    "slider": slider_figure,
    "phase": phase_figure,
    "load": load_figure,
}
"""Pictures in which another run can be laid over the first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Appearance:
    """Appearance of a picture: width and height in inches (its own if None), style, and whether axes have titles."""

    inches: tuple[float, float] | None = None
    style: Style = "screen"
    title: bool = True


AS_IT_IS: Final = Appearance()

Measured = tuple[str, Doubles, Doubles]
"""A spectrum of the user's own, to lay over that of a run: its name, places and densities in the picture's units."""


def picture(
    name: Kind,
    stretch: Stretch,
    kind: Format,
    *,
    heard: Heard | None = None,
    beside: Stretch | None = None,
    measured: Measured | None = None,
    look: Appearance = AS_IT_IS,
) -> bytes:
    """Return a picture of a run as the bytes of a file; see `drawing`."""
    with house_style(look.style):
        return as_bytes(drawing(name, stretch, heard=heard, beside=beside, measured=measured, look=look), kind)


def drawing(
    name: Kind,
    stretch: Stretch,
    *,
    heard: Heard | None = None,
    beside: Stretch | None = None,
    measured: Measured | None = None,
    look: Appearance = AS_IT_IS,
    ax: "Axes | None" = None,
) -> "Figure":
    """Return a picture of a run as a figure, which a notebook shows; with ``ax``, their whole figure.

    heard: the quantity of `psd` and `histogram`, in place of the area; beside: a run that is drawn over
    the first; measured: a spectrum of the user's; look: its size, its style, and whether it has titles. Raises Refused
    if a run does not have what the picture shows.
    """
    with house_style(look.style), in_place_of(ax), of_size(look.inches):
        figure = _figure(name, stretch, heard, beside, measured)
        whole: Figure = _finished(figure, look, fitted=ax is None).figure
    return whole


FIRST_QUANTITIES: Final = ("displacement_std", "real_contact_area_std")
"""The quantity of a sweep that is drawn if none is named: the first of these that it has."""


def first_quantity(sweep: SweepResult) -> str:
    """Return the default quantity of a sweep."""
    return next((name for name in FIRST_QUANTITIES if name in sweep.runs), FIRST_QUANTITIES[-1])


def sweep_drawing(sweep: SweepResult, what: str | None, *, look: Appearance = AS_IT_IS) -> "Figure":
    """Return a quantity of a sweep against the swept key as a figure; look: size, style, and whether there are titles.

    Raises Refused if the sweep does not have the quantity.
    """
    with house_style(look.style), of_size(look.inches):
        return _finished(draw_study(study_of_sweep(sweep, what or first_quantity(sweep))), look)


def _finished(figure: "Figure", look: Appearance, *, fitted: bool = True) -> "Figure":
    """Remove the titles of a figure that has a caption, and fit its labels into its size."""
    if not look.title:
        figure.suptitle("")
        for axes in figure.axes:
            axes.set_title("", loc="left")
            axes.set_title("")
    if look.inches is not None and fitted:
        fit_labels(figure)
    return figure


def _figure(
    name: Kind, stretch: Stretch, heard: Heard | None, beside: Stretch | None, measured: Measured | None
) -> "Figure":
    if heard is not None and beside is not None:
        figure = motion_spectrum_figure(stretch, heard, beside)
    elif heard is not None:
        figure = HEARD[name](stretch, heard)
    else:
        figure = PICTURES[name](stretch) if beside is None else OVERLAID[name](stretch, beside)
    if measured is not None:
        label, place, density = measured
        axes = figure.axes[0]
        axes.plot(place, density, color=INK, lw=1.0, label=shortened(one_line(label)))
        legend_above(axes, columns=3)
    return figure

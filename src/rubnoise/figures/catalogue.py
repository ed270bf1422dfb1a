"""The pictures of a run, by name, and those of a sweep: each a few panes, and how it is shown."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from rubnoise.analysis.junctions import Life
from rubnoise.analysis.sound import Heard
from rubnoise.arrays import Doubles
from rubnoise.figures import Axes, Figure, Kind, Style, pictures, style
from rubnoise.figures.contact import draw_contact, draw_overview
from rubnoise.figures.study import draw_study, study_of_sweep
from rubnoise.figures.tracks import Stretch
from rubnoise.storage.index import Index

PICTURES: Final[dict[Kind, tuple[Callable[..., str], float, float]]] = {
    "trace": (pictures.draw_trace, 7.2, 4.6),
    "lives": (pictures.draw_lives, 7.2, 5.2),
    "histogram": (pictures.draw_values, 7.2, 3.6),
    "psd": (pictures.draw_psd, 7.2, 5.4),
    "acf": (pictures.draw_acf, 7.2, 3.8),
    "count": (pictures.draw_count, 7.2, 3.4),
    "lifelines": (pictures.draw_lifelines, 7.2, 5.2),
    "overview": (draw_overview, 9.0, 5.4),
    "contact": (draw_contact, 7.2, 4.4),
    "slider": (pictures.draw_motion, 7.2, 6.6),
    "phase": (pictures.draw_phase, 7.2, 4.2),
    "landmarks": (pictures.draw_landmarks, 7.2, 3.6),
    "load": (pictures.draw_load, 7.2, 5.4),
    "sizes": (partial(pictures.draw_population, of="sizes"), 7.2, 3.8),
    "life_distances": (partial(pictures.draw_population, of="lives"), 7.2, 3.8),
    "gaps": (partial(pictures.draw_population, of="gaps"), 7.2, 3.8),
}
"""What draws the panes of each picture into a figure and returns its title; its own width and height in inches."""

HEARD: Final = ("psd", "histogram")  # pictures that can be of force, motion or load, in place of the area

OVERLAID: Final = ("slider", "phase", "load", "psd")  # pictures in which another run can be laid over the first


@dataclass(frozen=True, slots=True, kw_only=True)
class Appearance:
    """Appearance of a picture: width and height in inches (its own if None), style, and whether axes have titles."""

    inches: tuple[float, float] | None = None
    style: Style = "screen"
    title: bool = True


AS_IT_IS: Final = Appearance()


def drawing(
    name: Kind,
    stretch: Stretch,
    *,
    heard: Heard | None = None,
    beside: Stretch | None = None,
    measured: tuple[str, Doubles, Doubles] | None = None,
    life: Life | None = None,
    look: Appearance = AS_IT_IS,
    ax: Axes | None = None,
) -> Figure:
    """Return a picture of a run as a figure, which a notebook shows; with ``ax``, their whole figure.

    heard: the quantity of `psd` and `histogram`, in place of the area; beside: a run that is drawn over
    the first; measured: name, places and densities of a spectrum of the user's, in the picture's units; life: the one
    that `lives` is about; look: its size, its style, and whether it has titles. Raises Refused if a run does not have
    what the picture shows.
    """
    draw, *size = PICTURES[name]
    options: dict[str, Any] = {"of": heard, "beside": beside, "life": life}
    with style.house_style(look.style), style.in_place_of(ax) as place:
        figure = style.new_figure(*(look.inches or size)) if place is None else place
        title = draw(figure, stretch, **{option: each for option, each in options.items() if each is not None})
        whose = f": {style.contact_label(stretch.model)}" if beside is None else f", and over it {beside.name}"
        style.put_title(figure, *title.splitlines(), f"{stretch.name}{whose}")
        if measured is not None:
            label, over, density = measured
            figure.axes[0].plot(over, density, color=style.INK, lw=1.0, label=style.shortened(label))
        style.add_legends(figure.axes)
        _finish(figure, look, fitted=ax is None)
    whole: Figure = figure.figure
    return whole


FIRST_QUANTITIES: Final = ("displacement_std", "real_contact_area_std")
"""The quantity of a sweep that is drawn if none is named: the first of these that it has."""


def first_quantity(index: Index) -> str:
    """Return the default quantity of a sweep."""
    return next((name for name in FIRST_QUANTITIES if name in index.runs), FIRST_QUANTITIES[-1])


def sweep_drawing(index: Index, name: str, what: str | None, *, look: Appearance = AS_IT_IS) -> Figure:
    """Return a quantity of a sweep against the swept key as a figure; look: size, style, and whether there are titles.

    Raises Refused if the sweep does not have the quantity.
    """
    with style.house_style(look.style):
        figure = draw_study(study_of_sweep(index, name, what or first_quantity(index)), look.inches)
        _finish(figure, look, fitted=True)
        return figure


def _finish(figure: Figure, look: Appearance, *, fitted: bool) -> None:
    """Remove the titles of a figure that has a caption, and fit its labels into its size."""
    if not look.title:
        figure.suptitle("")
    if look.inches is not None and fitted:
        style.fit_labels(figure)

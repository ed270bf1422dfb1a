"""The picture of a study: simulated values with their intervals, and the exact curves."""

from collections.abc import Callable
from functools import partial
from itertools import cycle
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.figure_names import FIGURE_NAMES
from rubnoise.figures.study import Study, StudyLine, shown_unit
from rubnoise.figures.style import (
    SERIES,
    VERMILION,
    Format,
    as_bytes,
    house_style,
    logarithmic,
    new_figure,
    one_line,
    put_title,
    shortened,
    with_minus,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Place = Callable[[float], float]
LOOK: Final[dict[str, Any]] = {"ms": 4.5, "lw": 0.0, "elinewidth": 1.0, "capsize": 2.0, "zorder": 3}
MOST_LABELS: Final = 10
CLOSE: Final = 0.1
"""Least distance of two labelled values over the length of the axis."""

APART: Final = 0.06
"""How far lines are drawn apart if the key has words for values, which lie 1 apart."""

LONGEST_LABEL: Final = 24
TALL: Final = 10.0
"""Ratio of the highest to the lowest value from which a quantity over a logarithmic axis has one too."""


def study_picture(study: Study, kind: Format) -> bytes:
    """Return the picture of a study as the bytes of a file, the same for the same study."""
    with house_style():
        return as_bytes(draw_study(study), kind)


def draw_study(study: Study, inches: tuple[float, float] | None = None) -> "Figure":
    """Draw the points of every line with their 95 % intervals, and the exact curves. Within ``house_style()``."""
    figure = new_figure(*(inches or (6.4 if len(study.lines) > 1 else 5.4, 4.0)))
    axes = figure.subplots()
    for number, (line, (colour, marker)) in enumerate(zip(study.lines, cycle(SERIES), strict=False)):
        shift = 0.0 if study.numeric else APART * (number - 0.5 * (len(study.lines) - 1))
        at = partial(_place, study.scale, shift)
        draw_points(axes, line, {"color": colour, "fmt": marker, **LOOK}, at, named=number < MOST_LABELS)
        draw_exact(axes, line, at, _dashes(line, study.quantity))
    _label(axes, study)
    _legend(axes, study)
    _add_title(figure, study)
    return figure


def _place(scale: float, shift: float, place: float) -> float:
    """Return where on the axis a place is drawn."""
    return scale * place + shift


def draw_points(axes: "Axes", line: StudyLine, look: dict[str, Any], at: Place, *, named: bool) -> None:
    """Draw points; a point without a known interval is hollow."""
    known = [spot for spot in line.spots if isfinite(spot.seen.value)]
    if not known:
        return
    complete = [spot for spot in known if isfinite(spot.seen.reach)]
    bare = [spot for spot in known if not isfinite(spot.seen.reach)]
    axes.errorbar(
        [at(spot.place) for spot in complete],
        [spot.seen.value for spot in complete],
        [spot.seen.reach for spot in complete],
        label=one_line(line.label) if named and line.label else None,
        **look,
    )
    hollow = {"marker": look["fmt"], "mfc": "none", "mec": look["color"], "ls": "none", "ms": look["ms"]}
    axes.plot([at(spot.place) for spot in bare], [spot.seen.value for spot in bare], **hollow)


def draw_exact(axes: "Axes", line: StudyLine, at: Place, dashes: Any) -> None:
    """Draw the exact curve, or, if between points there is nothing, a dash at each of them."""
    if not _has_exact(line):
        return
    look: dict[str, Any] = {"color": VERMILION, "lw": 1.2, "zorder": 2, "ls": dashes}
    if line.curve is not None:
        across, exact = line.curve
        axes.plot([at(place) for place in across.tolist()], exact, **look)
        return
    for spot in line.spots:
        axes.errorbar([at(spot.place)], [spot.exact], marker="_", ms=14.0, mew=1.4, color=VERMILION, zorder=2)


def _has_exact(line: StudyLine) -> bool:
    """Whether theory knows the quantity anywhere on a line: of a two-way slider's motion it knows nothing."""
    return any(isfinite(spot.exact) for spot in line.spots)


def _dashes(line: StudyLine, quantity: str) -> Any:
    """Return how the curve of a line is dashed: of a two-way motion it is the law of weak coupling, not exact."""
    moving = quantity.startswith(("displacement", "velocity"))
    return (0, (4, 2)) if moving and line.spots[0].scenario.model().is_two_way else "-"


def _label(axes: "Axes", study: Study) -> None:
    axes.set_xlabel(key_label(study.key, study.unit))
    axes.set_ylabel(quantity_label(study.quantity))
    values = np.array([value for line in study.lines for spot in line.spots for value in (spot.seen.value, spot.exact)])
    if study.numeric:
        _scale(axes, study, values)
    else:
        labels = {spot.place: str(spot.values[study.key]) for line in study.lines for spot in line.spots}
        axes.set_xticks(list(labels), [shortened(text, LONGEST_LABEL) for text in labels.values()])
        axes.margins(x=0.15)
    if axes.get_yscale() == "linear" and np.nanmin(values) >= 0.0:
        axes.set_ylim(bottom=0.0)


def _scale(axes: "Axes", study: Study, values: Doubles) -> None:
    """Make axes logarithmic if the points lie so, and then that of a quantity which falls by more than ten.

    The axis of the key labels the values that are swept, if they are few and apart.
    """
    if study.logarithmic:
        logarithmic(axes.xaxis)
        if np.nanmin(values) > 0.0 and np.nanmax(values) > TALL * np.nanmin(values):
            logarithmic(axes.yaxis)
    places = study.scale * np.unique([spot.place for line in study.lines for spot in line.spots])
    along = np.log(places) if study.logarithmic else places
    if places.size > 1 and np.diff(along).min() > CLOSE * np.ptp(along):
        axes.set_xticks(places, [with_minus(f"{place:.4g}") for place in places])
        axes.set_xticks([], minor=True)


def _legend(axes: "Axes", study: Study) -> None:
    """Distinguish lines by the values of the other keys; below them stands the exact curve."""
    points: Any = axes.errorbar([], [], [], **LOOK, color=SERIES[0][0], fmt=SERIES[0][1])
    handles, labels = axes.get_legend_handles_labels()
    title = None
    if study.others:
        title = f"simulated, 95 % interval,\n{one_line(', '.join(map(key_words, study.others)))}:"
    else:
        handles, labels = [points], ["simulated, 95 % interval"]
    known = {_dashes(line, study.quantity) for line in study.lines if _has_exact(line)}
    for dashes in sorted(known, key=str, reverse=True):
        handles += axes.plot([], [], color=VERMILION, lw=1.2, ls=dashes)
        labels.append("exact" if dashes == "-" else "law of weak coupling")
    axes.legend(handles, labels, loc="best", title=title, alignment="left")


def _add_title(figure: "Figure", study: Study) -> None:
    name = shortened(study.title)
    shown = f"{quantity_words(study.quantity)} over {key_words(study.key)}"
    whose = f"sweep {name}" if name else ""
    put_title(figure, shown[0].upper() + shown[1:], whose)


def quantity_label(name: str) -> str:
    """Return the label of a figure's axis."""
    known = FIGURE_NAMES[name]
    return f"{known.words} ({shown_unit(known.unit)})" if known.unit else known.words


def quantity_words(name: str) -> str:
    """Return a figure in words, on one line."""
    return FIGURE_NAMES[name].words.replace("\n", " ")


def key_label(key: str, unit: str) -> str:
    """Return the label of a swept key's axis: its name in words, and the unit that its column has."""
    return f"{key_words(key)} ({shown_unit(unit)})" if unit not in {"", "1"} else key_words(key)


def key_words(key: str) -> str:
    """Return a key in words, with its table if the name needs it."""
    table, _, name = key.rpartition(".")
    words = name.replace("_", " ")
    return f"{table} {words}" if name in {"law", "spread", "mean", "start", "shape", "speed"} else words

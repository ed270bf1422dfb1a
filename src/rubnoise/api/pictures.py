"""Pictures of runs, drawn from Python as by `rubnoise plot`."""

import os
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast, get_args

import numpy as np

from rubnoise.api import keywords
from rubnoise.api.column_group import SHORT
from rubnoise.api.trace import Trace
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused, refusing_files
from rubnoise.inference.inference import InferenceResult
from rubnoise.real_numbers import number_in
from rubnoise.regular_file import is_hdf5
from rubnoise.units import LENGTH, QuantityError, read_quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.analysis.sound import Heard
    from rubnoise.api.run import Run
    from rubnoise.api.sweep_result import SweepResult
    from rubnoise.figures.catalogue import Appearance

AREA: Final = "area"
OTHER_WORDS: Final = {
    "diameter": "sizes",
    "lifetimes": "life_distances",
    "autocovariance": "acf",
    "hist": "histogram",
    "area": "trace",
}
"""Words that other programs have for these pictures."""

THREE_PANES: Final = ("slider", "overview", "load")
HIGH: Final = "84 mm x 110 mm"
WIDTHS: Final = {"single": "84 mm x 60 mm", "double": "174 mm x 124 mm"}
MICROMETRES_PER_INCH: Final = 25_400.0
SMALLEST, LARGEST = 1.0, 40.0


def drawn(
    run: "Run",
    what: Any,
    ax: "Axes | None" = None,
    *,
    start: Any = None,
    stop: Any = None,
    of: str = AREA,
    beside: "Run | Trace | str | os.PathLike[str] | None" = None,
    size: str | None = None,
    title: bool = True,
    style: str | None = None,
) -> "Figure":
    """Draw a picture of a run and return its figure (see Run.plot)."""
    from rubnoise.figures.catalogue import HEARD, OVERLAID, PICTURES, drawing
    from rubnoise.figures.stretch import Stretch

    if what is None:
        what = "overview" if run.model().free is None else "load"
    what = "psd" if what == "spectrum" else what
    if not isinstance(what, str) or what not in PICTURES:
        near = OTHER_WORDS.get(str(what)) or next(iter(get_close_matches(str(what), PICTURES, n=1)), "")
        hint = f'; did you mean "{near}"?' if near else ""
        raise Refused(f"{what!r}: no picture of a run; there are {', '.join(PICTURES)}{hint}")
    heard = heard_of(of)
    if isinstance(beside, str | os.PathLike):
        if what not in {"psd", *OVERLAID}:
            raise Refused('beside: a trace of yours goes with "psd", another run with "slider", "phase" and "load"')
        beside = _measurement(beside, whole=what != "psd" or heard is not None)
    if heard is not None and what not in HEARD:
        raise Refused(f'of={of!r}: is for "psd" and "histogram"')
    if beside is not None and not isinstance(beside, Trace) and what not in OVERLAID and not (what == "psd" and heard):
        raise Refused('beside: another run goes with "slider", "phase", "load", and "psd" of anything but the area')
    if isinstance(beside, Trace) and what != "psd":
        raise Refused('beside: a trace of yours goes with "psd"')
    stretch = Stretch.of(run.reader(), _distance("start", start), _distance("stop", stop))
    other = Stretch.of(beside.reader()) if beside is not None and not isinstance(beside, Trace) else None
    measured = measured_spectrum(beside, heard) if isinstance(beside, Trace) else None
    return drawing(
        what,
        stretch,
        heard=heard,
        beside=other,
        measured=measured,
        look=appearance(size, style, title=title, what=what),
        ax=ax,
    )


def _distance(keyword: str, value: Any) -> float | None:
    return None if value is None else number_in(value, f"{keyword}=", LENGTH)


def _measurement(path: str | os.PathLike[str], *, whole: bool) -> Trace:
    """Read a trace to draw beside a spectrum; raises Refused for a result if the picture needs the ``whole`` run."""
    with refusing_files(path):
        if is_hdf5(path):
            opened = f'rubnoise.open("{os.fspath(path)}")'
            right = opened if whole else f"rubnoise.Trace({opened})"
            raise Refused(f"beside: {os.fspath(path)}: is a result, not a table of text; right form: beside={right}")
    return Trace(path)


def in_inches(size: str) -> tuple[float, float]:
    """Return width and height of a picture in inches, of "84 mm x 60 mm", "single" or "double".

    A name is the width of one column or two of a journal, 84 mm or 174 mm, with a height of five sevenths. Raises
    Refused for anything else.
    """
    try:
        parts = [part.strip() for part in WIDTHS.get(size, size).split(" x ")]
        width, height = (float(read_quantity(part, LENGTH)) / MICROMETRES_PER_INCH for part in parts)
    except (QuantityError, ValueError, TypeError, AttributeError):
        raise Refused(f'size={size!r}: right form: size="84 mm x 60 mm", size="single" or size="double"') from None
    if not (SMALLEST <= width <= LARGEST and SMALLEST <= height <= LARGEST):
        raise Refused(f"size={size!r}: both sides have to be from 1 inch (25.4 mm) to 40 inches")
    return width, height


def appearance(size: str | None, style: str | None, *, title: bool, what: str = "") -> "Appearance":
    """Return the appearance of a picture ``what`` from words; raises Refused for an unknown size or style.

    Without a style a narrow picture has that of paper. Three panes one above the other need a higher column.
    """
    from rubnoise.figures.catalogue import Appearance
    from rubnoise.figures.narrow import NARROW
    from rubnoise.figures.style import STYLES

    size = HIGH if size == "single" and what in THREE_PANES else size
    inches = None if size is None else in_inches(size)
    if style is None:
        style = "paper" if inches and inches[0] < NARROW else "screen"
    if style not in STYLES:
        raise Refused(f"style={style!r}: no style of a picture; there are {', '.join(STYLES)}")
    title = keywords.choice("title", title, (True, False))
    return Appearance(inches=inches, style=style, title=title)


def drawn_fit(found: InferenceResult) -> "Figure":
    """Draw what an inference found and return its figure (see rubnoise.Inference.plot)."""
    from rubnoise.figures.inference import figure

    return figure(found)


def page_of_fit(found: InferenceResult, name: str, text: str) -> str:
    """Return the page of an inference (see rubnoise.Inference.report)."""
    from rubnoise.figures.inference import page

    return page(found, name, text)


def drawn_columns(place: tuple[Any, str], curves: Sequence[tuple[Any, str]], ax: "Axes | None" = None) -> "Figure":
    """Draw columns over their place, one below the other, each with its label, and return the figure.

    With ``ax`` one column is drawn into these axes.
    """
    from rubnoise.figures.style import BLUE, house_style, new_figure

    with house_style():
        if ax is None:
            figure = new_figure(7.0, 1.2 + 1.8 * len(curves))
            panes = figure.subplots(len(curves), 1, sharex=True, squeeze=False)[:, 0]
        else:
            figure, panes = cast("Figure", ax.figure), np.array([ax])
        for axes, (values, label) in zip(panes, curves, strict=True):
            axes.plot(place[0], values, color=BLUE, linewidth=0.8)
            axes.set_ylabel(label)
        panes[-1].set_xlabel(place[1])
        return figure


def drawn_estimate(place: Doubles, curves: Mapping[str, Doubles], labels: tuple[str, str]) -> "Figure":
    """Draw curves over their places by name, "estimated" and "exact", on logarithmic axes, and return the figure."""
    from rubnoise.figures import style

    colours = {"estimated": style.BLUE, "exact": style.VERMILION}
    with style.house_style():
        figure = style.new_figure(7.0, 3.8)
        axes = figure.subplots()
        for name, values in curves.items():
            axes.plot(place, values, color=colours[name], lw=1.0, label=name)
        style.logarithmic(axes.xaxis)
        style.logarithmic(axes.yaxis)
        axes.set_xlabel(labels[0])
        axes.set_ylabel(labels[1])
        style.legend_above(axes)
        return figure


def drawn_sweep(
    sweep: "SweepResult",
    what: Any,
    *,
    size: str | None = None,
    title: bool = True,
    style: str | None = None,
) -> "Figure":
    """Draw a quantity of a sweep, and return the figure (see SweepResult.plot)."""
    from rubnoise.figures.catalogue import sweep_drawing

    if what is not None and not isinstance(what, str):
        raise Refused(f'{what!r}: is no quantity of a sweep; right form: sweep.plot("real_contact_area_std")')
    return sweep_drawing(sweep, what, look=appearance(size, style, title=title))


def heard_of(of: str) -> "Heard | None":
    """Return the quantity of a spectrum, None for the area; raises Refused for an unknown word."""
    from rubnoise.analysis.sound import Heard

    of = next((short for short, whole in SHORT.items() if whole == of), of)
    if of != AREA and of not in get_args(Heard):
        raise Refused(f'of={of!r}: no such spectrum; there are "area", {", ".join(map(repr, get_args(Heard)))}')
    return None if of == AREA else cast("Heard", of)


def measured_spectrum(trace: Trace, heard: str | None) -> Any:
    """Return name, places and densities of a trace to draw beside a spectrum, in the units of the picture.

    Raises Refused for a trace of another quantity.
    """
    wanted, over = ("um^2", "um") if heard is None else (UNITS[heard], "s")
    if trace.units[trace.place] != over:
        raise Refused(f"{trace.name}: is over {trace.place} in {trace.units[trace.place]}; this picture needs {over}")
    name = "real_contact_area" if heard is None else "friction_force" if heard == "force" else heard
    fitting = [each for each in trace if each != trace.place and trace.units[each] == wanted]
    if name not in fitting and len(fitting) != 1:
        present = f"there are {', '.join(fitting)}" if fitting else "it has no such column"
        raise Refused(f"{trace.name}: needs a column {name} in units of {wanted}; {present}")
    seen = trace.psd(name if name in fitting else fitting[0])
    scale = 1.0 if heard is None else PICTURED[heard]
    return Path(trace.name).name, seen.place[1:], scale * seen.density[1:]


UNITS: Final = {"displacement": "um", "velocity": "um/s", "force": "uN", "normal-velocity": "um/s", "load": "uN"}
PICTURED: Final = {"displacement": 1e12, "velocity": 1e6, "force": 1e6, "normal-velocity": 1e6, "load": 1e6}
"""From m^2/Hz, (m/s)^2/Hz and N^2/Hz to the um^2/Hz, (mm/s)^2/Hz and mN^2/Hz of the pictures."""

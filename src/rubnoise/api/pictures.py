"""Pictures of runs, drawn from Python as by `rubnoise plot`."""

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast, get_args

import numpy as np

import rubnoise
from rubnoise.analysis.measured import UNITS
from rubnoise.analysis.sound import Heard
from rubnoise.api import keywords
from rubnoise.api.columns import SHORT
from rubnoise.api.trace import Trace
from rubnoise.arrays import number_in
from rubnoise.errors import Refused, advised, did_you_mean, naming
from rubnoise.figures import Axes, Figure, Kind, style
from rubnoise.figures.catalogue import AS_IT_IS, HEARD, OVERLAID, PICTURES, Appearance, drawing
from rubnoise.figures.style import NARROW, STYLES
from rubnoise.figures.tracks import QUANTITIES, Stretch
from rubnoise.regular_file import is_hdf5
from rubnoise.units import LENGTH, QuantityError, read_quantity

if TYPE_CHECKING:
    from rubnoise.api.run import Run

AREA: Final = "area"
TALL: Final = ("trace", "slider", "overview", "load", "lives", "lifelines", "phase", "psd")
"""Pictures of several panes, which need a column that is higher than wide."""

HIGH: Final = "84 mm x 110 mm"
WIDTHS: Final = {"single": "84 mm x 60 mm", "double": "174 mm x 124 mm"}
MICROMETRES_PER_INCH: Final = 25_400.0
SMALLEST, LARGEST = 1.0, 40.0


def picture_named(what: Any) -> Kind:
    """Return the picture of a run that has a name; raises Refused, with a near name, if there is none."""
    what = "psd" if what == "spectrum" else what
    if isinstance(what, str) and what in PICTURES:
        return what
    known = f"{what!r}: no picture of a run; there are {', '.join(PICTURES)}"
    raise Refused(advised(known, did_you_mean(str(what), PICTURES, quote='"')))


def drawn(
    run: "Run",
    what: Any,
    ax: Axes | None = None,
    *,
    start: Any = None,
    stop: Any = None,
    of: str = AREA,
    beside: "Run | Trace | str | os.PathLike[str] | None" = None,
    look: Appearance = AS_IT_IS,
) -> Figure:
    """Draw a picture of a run and return its figure (see Run.plot); raises Refused for what does not go together."""
    usual = "overview" if run.model().free is None else "load"
    kind, heard, other, measured = picture_named(usual if what is None else what), heard_of(of), None, None
    if heard is not None and kind not in HEARD:
        raise Refused(f"of=: is for psd and histogram, not for {kind}")
    ends = {"start=": start, "stop=": stop}
    first, last = (None if end is None else number_in(end, name, LENGTH) for name, end in ends.items())
    stretch = Stretch.of(run.reader(), first, last)
    with ExitStack() as opened:
        if isinstance(beside, str | os.PathLike) and (is_hdf5(beside) or os.fspath(beside).endswith(".h5")):
            beside = opened.enter_context(rubnoise.open(beside))
        if isinstance(beside, rubnoise.Run):
            with naming(f'beside="{beside.path}"'):
                if kind not in OVERLAID:
                    raise Refused(f"another run is for slider, phase, load and psd, not for {kind}")
                other = Stretch.of(beside.reader())
        elif beside is not None:
            record = beside if isinstance(beside, Trace) else Trace(beside)
            if kind != "psd":
                raise Refused(f"{record.name}: a record of yours is for psd, not for {kind}")
            measured = measured_spectrum(record, heard)
        return drawing(kind, stretch, heard=heard, beside=other, measured=measured, look=look, ax=ax)


def heard_of(of: str) -> Heard | None:
    """Return the quantity of a spectrum, None for the area; raises Refused for an unknown word."""
    of = next((short for short, whole in SHORT.items() if whole == of), of)
    if of != AREA and of not in get_args(Heard):
        raise Refused(f'of={of!r}: no such spectrum; there are "area", {", ".join(map(repr, get_args(Heard)))}')
    return None if of == AREA else cast("Heard", of)


def measured_spectrum(trace: Trace, heard: str | None) -> Any:
    """Return name, places and densities of a trace to draw beside a spectrum, in the units of the picture.

    Raises Refused for a trace of another quantity.
    """
    quantity, over = QUANTITIES[heard or AREA], "um" if heard is None else "s"
    name, wanted = quantity.stem, UNITS[quantity.column]
    if trace.units[trace.place] != over:
        raise Refused(f"{trace.name}: is over {trace.place} in {trace.units[trace.place]}; this picture needs {over}")
    fitting = [each for each in trace if each != trace.place and trace.units[each] == wanted]
    if name not in fitting and len(fitting) != 1:
        present = f"there are {', '.join(fitting)}" if fitting else "it has no such column"
        raise Refused(f"{trace.name}: needs a column {name} in units of {wanted}; {present}")
    seen = trace.psd(name if name in fitting else fitting[0])
    scale = 1.0 if heard is None else (1e6 * quantity.scale) ** 2  # over Hz a `PowerSpectrum` is in m, m/s and N
    return Path(trace.name).name, seen.place[1:], scale * seen.density[1:]


def appearance(what: Any = "", *, size: str | None = None, style: str | None = None, title: bool = True) -> Appearance:
    """Return the appearance of a picture ``what``; raises Refused for an unknown size or style.

    A size is "84 mm x 60 mm", or "single" or "double" for one column or two of a journal, 84 mm or 174 mm, with a
    height of five sevenths; several panes one above the other need a higher column. Without a style a narrow picture
    has that of paper.
    """
    inches = None if size is None else _in_inches(HIGH if size == "single" and what in TALL else size)
    if style is None:
        style = "paper" if inches and inches[0] < NARROW else "screen"
    if style not in STYLES:
        raise Refused(f"style={style!r}: no style of a picture; there are {', '.join(STYLES)}")
    return Appearance(inches=inches, style=style, title=keywords.choice("title", title, (True, False)))


def _in_inches(size: str) -> tuple[float, float]:
    try:
        parts = [part.strip() for part in WIDTHS.get(size, size).split(" x ")]
        width, height = (float(read_quantity(part, LENGTH)) / MICROMETRES_PER_INCH for part in parts)
    except (QuantityError, ValueError, TypeError, AttributeError):
        raise Refused(f'size={size!r}: right form: size="84 mm x 60 mm", size="single" or size="double"') from None
    if not (SMALLEST <= width <= LARGEST and SMALLEST <= height <= LARGEST):
        raise Refused(f"size={size!r}: both sides have to be from 1 inch (25.4 mm) to 40 inches")
    return width, height


def drawn_columns(
    place: tuple[Any, str], curves: Sequence[tuple[Any, str]], ax: Axes | None = None, *, logarithmic: bool = False
) -> Figure:
    """Draw columns over their place, one below the other, each with its label, and return the figure.

    A column may be several by name, "estimated" and "exact". With ``ax`` one is drawn into these axes.
    """
    with style.house_style():
        if ax is None:
            figure = style.new_figure(7.0, 1.2 + 1.8 * len(curves))
            panes = figure.subplots(len(curves), 1, sharex=True, squeeze=False)[:, 0]
        else:
            figure, panes = cast(Figure, ax.figure), np.array([ax])
        for axes, (values, label) in zip(panes, curves, strict=True):
            for name, each in (values if isinstance(values, Mapping) else {"": values}).items():
                colour = style.VERMILION if name == "exact" else style.BLUE
                axes.plot(place[0], each, color=colour, linewidth=0.8, label=name)
            axes.set_ylabel(label)
            if logarithmic:
                style.logarithmic(axes.xaxis, axes.yaxis)
                style.add_legends([axes])
        panes[-1].set_xlabel(place[1])
        return figure

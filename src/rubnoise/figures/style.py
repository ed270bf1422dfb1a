"""How every figure looks: colours, fonts, titles, legends, the marks of theory, and labels that fit its size.

Colour-blind readers can distinguish the colours, also in grey print; every axis has its unit.
"""

import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from io import BytesIO
from math import log10
from textwrap import fill
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from rubnoise.errors import Refused, needing
from rubnoise.figures import Axes, Figure, Style

if TYPE_CHECKING:
    from matplotlib.axis import Axis

    from rubnoise.model import Model

INK: Final = "#000000"
BLUE: Final = "#0072b2"
VERMILION: Final = "#d55e00"
FAINT: Final = "#9a9a9a"
PALE: Final = "#e8e8e8"
"""Okabe and Ito's blue is what a run shows, their vermilion what theory says; they differ in grey print too."""

SERIES: Final[tuple[tuple[str, str], ...]] = (
    ("#04213a", "o"),
    ("#6a1b70", "s"),
    ("#0072b2", "^"),
    ("#1b9e77", "D"),
    ("#c2ab00", "v"),
)
"""Colours and markers of several runs in one picture: five hues from dark to light, which grey print keeps apart."""

Format = Literal["png", "pdf", "svg"]
FORMATS: Final[tuple[Format, ...]] = ("png", "pdf", "svg")
_WITHOUT_ORIGIN: Final[dict[Format, dict[str, None]]] = {
    "png": {"Software": None},
    "pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    "svg": {"Creator": None, "Date": None, "Format": None, "Type": None},
}

_RAISED: Final = str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")
DOTS_PER_INCH: Final = 150
LONGEST_NAME: Final = 32

SETTINGS: Final[dict[str, Any]] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "hatch.linewidth": 0.5,
    "hatch.color": FAINT,
    "savefig.facecolor": "white",
    "svg.hashsalt": "rubnoise",
    "pdf.fonttype": 42,
    "text.parse_math": False,  # a file's name may hold dollars
}


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of a size in inches, laid out so that nothing is cut off; it keeps its style.

    To be called, and drawn on, within ``house_style()``. Raises ExtraMissing without matplotlib.
    """
    # Not through pyplot: it would look for a screen and keep every figure of the process.
    from matplotlib import rcParams
    from matplotlib.figure import Figure

    more = {"_repr_png_": as_bytes, "house": rcParams.copy(), "__doc__": Figure.__doc__}
    shown_in_notebooks: Any = type("Figure", (Figure,), more)
    figure: Figure = shown_in_notebooks(figsize=(width, height), layout="constrained")
    return figure


@contextmanager
def in_place_of(ax: Any) -> Iterator[Any]:
    """Yield a part of a figure in the place of axes, to draw on; None without axes.

    The axes leave their figure as soon as the picture is drawn; if it cannot be drawn, they stay. Raises Refused for
    what is no axes in the grid of a figure.
    """
    if ax is None:
        yield None
        return
    from matplotlib.axes import Axes

    if not isinstance(ax, Axes):
        several = isinstance(ax, np.ndarray | list | tuple)
        meant = "one of them is needed, such as axes[0]" if several else "figure, ax = plt.subplots() makes some"
        raise Refused(f"ax: {type(ax).__name__} is no axes of matplotlib; {meant}")
    figure: Any = ax.figure
    if figure is None or ax not in figure.axes or ax.get_subplotspec() is None:
        raise Refused(
            "ax: these axes left their figure, or have no place in its grid; plt.subplots() makes some that do"
        )
    whole = figure.figure
    if whole.get_layout_engine() is None:
        whole.set_layout_engine("constrained")
    inner = figure.add_subfigure(ax.get_subplotspec())
    try:
        yield inner
    except BaseException:
        inner.clear()
        figure.subfigs.remove(inner)
        raise
    ax.remove()


SIZES: Final = {
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "figure.titlesize": 10.0,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.2,
    "axes.linewidth": 0.8,
}
"""Sizes of letters and lines on a screen."""

STYLES: Final[dict[Style, float]] = {"screen": 1.0, "paper": 0.72, "slides": 1.65}
"""Factors to them: for a journal's page, whose columns are 84 and 174 mm wide, and for a wall."""


@contextmanager
def house_style(style: Style = "screen") -> Iterator[None]:
    """Have figures made in our style within the context; raises ExtraMissing without matplotlib."""
    with needing("plot", "a picture"):
        import matplotlib as mpl
    # From the library's own defaults: a reader's matplotlibrc must not change what a figure says.
    settings: dict[Any, Any] = dict(mpl.rcParamsDefault)
    scaled = {name: STYLES[style] * size for name, size in SIZES.items()}
    with mpl.rc_context(settings | SETTINGS | scaled | {"backend": "agg"}):
        yield


def as_bytes(figure: Any, kind: Format = "png") -> bytes:
    """Return a figure of ours as the bytes of a png, pdf or svg file, the same for the same figure on any day."""
    from matplotlib import rc_context

    stream = BytesIO()
    with rc_context(figure.house), warnings.catch_warnings():
        # A title in a script that the font lacks is drawn as boxes, which is no reason for a warning on the terminal.
        warnings.filterwarnings("ignore", message="Glyph", category=UserWarning)
        figure.savefig(stream, format=kind, dpi=DOTS_PER_INCH, metadata=_WITHOUT_ORIGIN[kind])
    return stream.getvalue()


def logarithmic(*several: "Axis") -> None:
    """Give axes of an x or a y logarithmic scales, with their powers of ten in letters: formulas are not parsed."""
    from matplotlib.ticker import FuncFormatter

    for axis in several:
        scale = axis.axes.set_xscale if axis is axis.axes.xaxis else axis.axes.set_yscale
        scale("log")
        axis.set_major_formatter(FuncFormatter(partial(_label, axis, at_power=True)))
        axis.set_minor_formatter(FuncFormatter(partial(_label, axis, at_power=False)))


def _label(axis: "Axis", value: float, _: int, *, at_power: bool) -> str:
    """Return the label of a power of ten in raised letters, and of values between on an axis that may hold none."""
    low, high = sorted(axis.get_view_interval())
    if low > 0.0 and high < 10.0 * low:
        has_room = at_power or f"{value:e}"[0] in ("25" if high > 2.5 * low else "123458")
        return f"{value:g}" if has_room else ""
    return "10" + str(round(log10(value))).translate(_RAISED) if at_power and value > 0.0 else ""


def shortened(name: str, longest: int = LONGEST_NAME) -> str:
    """Return a name from a file on one line, cut to what a title has room for."""
    name = one_line(name)
    return name if len(name) <= longest else f"{name[: longest - 3]}..."


CONFIDENCE: Final = 1.959963984540054  # half-width of a 95 % interval in standard errors

AREA: Final = "real contact area (µm²)"
DISTANCE: Final = "sliding distance (µm)"
LETTER, HANDLE = 0.55, 9.0
"""Width of a letter over its size, and how many letters have the width of what stands beside the words in a legend."""

USUAL_WIDTH: Final = 0.775  # share of a figure's width that matplotlib gives a single pane before it is laid out
NEAREST: Final = 1e-6  # span of values over the values themselves below which nothing but rounding is seen


def put_title(figure: Figure, *texts: str) -> None:
    """Put lines of a title over a figure; one that is wider than the figure is broken."""
    figure.suptitle("\n".join(texts), x=0.01, ha="left", wrap=True)


def contact_label(model: "Model") -> str:
    """Return how many junctions there are on average, and how large they are; of a free slider, if it were held."""
    held = f"{model.mean_junction_count:.4g} junctions of {model.calibrated_diameter:.3g} µm on average"
    return held if model.free is None else f"free slider; at constant separation {held}"


def one_line(text: str) -> str:
    """Return a text from a file with a space for whatever would break a line or has no shape."""
    return "".join(character if character.isprintable() else " " for character in text).strip()


def exact_band(axes: Axes, mean: float, std: float) -> None:
    """Mark an exact mean by a line, and a standard deviation about it by a band."""
    axes.axhspan(mean - std, mean + std, color=VERMILION, alpha=0.12, lw=0.0, zorder=0, label="exact mean ± std")
    # Over the curve, since a crowded one would hide the band.
    axes.axhline(mean, color=VERMILION, lw=1.2, zorder=4)
    for edge in (mean - std, mean + std):
        axes.axhline(edge, color=VERMILION, lw=0.7, ls=(0, (5, 4)), zorder=4)


def add_legends(panes: Iterable[Axes]) -> None:
    """Put a legend above each pane, flush right, where it hides nothing; what a pane before explains is left out.

    It has as many columns as the width of its pane has room for.
    """
    explained: set[str] = set()
    for axes in panes:
        named = zip(*axes.get_legend_handles_labels(), strict=True)
        new = {label: handle for handle, label in named if label not in explained}
        if new:
            columns = int(_letters(axes.xaxis.label, axes.bbox.width / USUAL_WIDTH) / (max(map(len, new)) + HANDLE))
            above: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.1}
            axes.legend(list(new.values()), list(new), ncols=min(4, max(1, columns)), **above)
        explained |= set(new)


# Labels that fit a picture of a given size: what is longer than its room is broken, and ticks stand apart.

NARROW: Final = 120.0 / 25.4
"""Width in inches below which a picture is narrow, as one column of a journal is: its letters are those of paper."""

_ROUNDS: Final = 2
_TICK: Final = 8.0  # letters of a tick's label, and what it needs beside
_WORDS: Final = 0.75  # of the width of a legend, the rest is for its handles
_FEWEST: Final = 8  # characters of a line, however little room there is


def fit_labels(figure: Figure) -> None:
    """Break labels and entries of legends that are longer than their room, and thin out ticks."""
    for _ in range(_ROUNDS):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of panes without any room, which have it when all is broken
            figure.draw_without_rendering()
        boxes = [axes.get_window_extent() for axes in figure.axes]
        for axes, box in zip(figure.axes, boxes, strict=True):
            beside = sum(other.y0 < box.y1 and box.y0 < other.y1 for other in boxes)
            _fit_pane(axes, box, figure.bbox.width / beside)


def _fit_pane(axes: Axes, box: Any, width: float) -> None:
    """Fit the texts of a pane into its box and a part of the figure's width, in dots."""
    from matplotlib.ticker import MaxNLocator

    axes.set_xlabel(_broken(axes.get_xlabel(), axes.xaxis.label, width))
    axes.set_ylabel(_broken(axes.get_ylabel(), axes.yaxis.label, box.height))
    for text in () if (legend := axes.get_legend()) is None else legend.get_texts():
        text.set_text(_broken(text.get_text(), text, _WORDS * width))
    if isinstance(axes.xaxis.get_major_locator(), MaxNLocator):
        axes.locator_params(axis="x", nbins=min(9, 1 + int(_letters(axes.xaxis.label, box.width) / _TICK)))


def _letters(like: Any, room: float) -> float:
    """Return how many letters such as those of a text a room in dots has."""
    return float(72.0 * room / (LETTER * like.get_fontsize() * like.figure.figure.dpi))


def _broken(words: str, like: Any, room: float) -> str:
    """Return words, broken between them if in the letters of a text they are longer than a room in dots."""
    most = max(_FEWEST, int(_letters(like, room)))
    if max(map(len, words.split("\n"))) <= most:
        return words
    return fill(" ".join(words.split()), most, break_long_words=False)

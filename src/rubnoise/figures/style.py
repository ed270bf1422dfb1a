"""How every figure looks: colours that the colour-blind and a grey printer tell apart, units on every axis."""

import warnings
from io import BytesIO
from math import log10
from typing import TYPE_CHECKING, Any, Final, Literal

from rubnoise.errors import Refused

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

INK: Final = "#000000"
BLUE: Final = "#0072b2"
VERMILION: Final = "#d55e00"
FAINT: Final = "#9a9a9a"
PALE: Final = "#e8e8e8"
"""Okabe and Ito's blue is what a run shows, their vermilion what theory says; in grey they are told apart too."""

STUCK: Final = (0.90, 0.90, 0.90)
"""Red, green and blue of what is shaded because the slider sticks there."""

SERIES: Final[tuple[tuple[str, str], ...]] = (
    ("#04213a", "o"),
    ("#0a4a7d", "s"),
    ("#0072b2", "^"),
    ("#4c9ed3", "D"),
    ("#8cc4e8", "v"),
)
"""Colours and markers of several runs in one picture: the blue from dark to light, which a grey printer keeps apart."""

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
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.linewidth": 0.8,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.2,
    "hatch.linewidth": 0.5,
    "hatch.color": FAINT,
    "savefig.facecolor": "white",
    "svg.hashsalt": "rubnoise",
    "pdf.fonttype": 42,
    "text.parse_math": False,  # a file's name may hold dollars
}


class PicturesMissing(Refused):
    """A picture asked for where matplotlib is not installed."""


def new_figure(width: float, height: float) -> "Figure":
    """Return an empty figure of a size in inches, laid out so that nothing is cut off.

    To be called, and drawn on, within ``house_style()``. Raises PicturesMissing without matplotlib.
    """
    # Not through pyplot: it would look for a screen and keep every figure of the process.
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def house_style() -> Any:
    """Return the context in which figures are made; raises PicturesMissing without matplotlib."""
    try:
        import matplotlib as mpl
    except ImportError as problem:
        raise PicturesMissing('a picture needs matplotlib: pip install "rubnoise[plot]"') from problem
    # From the library's own defaults: a reader's matplotlibrc must not change what a figure says.
    settings: dict[Any, Any] = dict(mpl.rcParamsDefault)
    return mpl.rc_context(settings | SETTINGS | {"backend": "agg"})


def as_bytes(figure: "Figure", kind: Format) -> bytes:
    """Return a figure as the bytes of a png, pdf or svg file, the same for the same figure on any day."""
    stream = BytesIO()
    with warnings.catch_warnings():
        # A title in a script that the font lacks is drawn as boxes, which is no reason for a warning on the terminal.
        warnings.filterwarnings("ignore", message="Glyph", category=UserWarning)
        figure.savefig(stream, format=kind, dpi=DOTS_PER_INCH, metadata=_WITHOUT_ORIGIN[kind])
    return stream.getvalue()


def as_png(figure: "Figure") -> bytes:
    """Return a figure as the bytes of a png file, the same for the same figure."""
    return as_bytes(figure, "png")


def logarithmic(axis: "Axis") -> None:
    """Give the axis of an x or a y a logarithmic scale, with its powers of ten in letters: formulas are not parsed."""
    from matplotlib.ticker import FuncFormatter

    scale = axis.axes.set_xscale if axis is axis.axes.xaxis else axis.axes.set_yscale
    scale("log")
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}" if _is_narrow(axis) else _power_of_ten(value)))
    axis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:g}" if _is_narrow(axis) else ""))


def _is_narrow(axis: "Axis") -> bool:
    """Whether an axis spans so little that it may hold no power of ten."""
    low, high = sorted(axis.get_view_interval())
    return bool(low > 0.0 and high < 10.0 * low)


def _power_of_ten(value: float) -> str:
    return "10" + str(round(log10(value))).translate(_RAISED) if value > 0.0 else ""


def shortened(name: str, longest: int = LONGEST_NAME) -> str:
    """Return a name cut to what a title has room for."""
    return name if len(name) <= longest else f"{name[: longest - 3]}..."

"""What pictures of runs have in common: headings, legends, and the marks that theory makes in them."""

from typing import TYPE_CHECKING, Final

from rubnoise.figures.style import VERMILION, shortened

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.figures.stretch import Stretch

AREA: Final = "real contact area (µm²)"
LONGEST_TITLE: Final = 64
DISTANCE: Final = "sliding distance (µm)"
NEAREST: Final = 1e-6
"""Span of values over the values themselves below which nothing but rounding is seen."""


def entitle(figure: "Figure", stretch: "Stretch", shown: str, beside: "Stretch | None" = None) -> None:
    """Put a title over a figure: what it shows, of which run, and which other one is laid over it."""
    whose = _whose(stretch) if beside is None else f"{_whose(stretch)}, and over it\n{_whose(beside)}"
    figure.suptitle(f"{shown}\n{whose}", x=0.01, ha="left", fontsize=10.0)


def _whose(stretch: "Stretch") -> str:
    title, name = printed(stretch.title), printed(stretch.file.path.name)
    return f"{shortened(title, LONGEST_TITLE)} ({shortened(name)})" if title else shortened(name, LONGEST_TITLE)


def printed(text: str) -> str:
    """Return a text from a file with a space for whatever would break a line or has no shape."""
    return "".join(character if character.isprintable() else " " for character in text).strip()


def exact_band(axes: "Axes", mean: float, std: float) -> None:
    """Mark an exact mean by a line, and a standard deviation about it by a band."""
    axes.axhspan(mean - std, mean + std, color=VERMILION, alpha=0.12, lw=0.0, zorder=0, label="exact mean ± std")
    # Over the curve, since a crowded one would hide the band.
    axes.axhline(mean, color=VERMILION, lw=1.2, zorder=4)
    for edge in (mean - std, mean + std):
        axes.axhline(edge, color=VERMILION, lw=0.7, ls=(0, (5, 4)), zorder=4)


def legend_above(axes: "Axes", columns: int = 4) -> None:
    """Put the legend above the axes, flush right, where it hides nothing."""
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.1)


def from_zero(axes: "Axes") -> None:
    """Let the values begin at 0, and leave room above them where they are constant."""
    highest = max(float(axes.dataLim.y1), 0.0)
    axes.set_ylim(0.0, max(axes.get_ylim()[1], 1.05 * highest))


def not_too_near(axes: "Axes") -> None:
    """Let values that differ by rounding alone span a fifth of themselves: no axis has the digits for less."""
    low, high = axes.get_ylim()
    middle = 0.5 * (low + high)
    if high - low < NEAREST * abs(middle):
        axes.set_ylim(middle - 0.1 * abs(middle), middle + 0.1 * abs(middle))

"""Labels that fit a picture of a given size: what is longer than its room is broken, and ticks stand apart."""

import warnings
from collections.abc import Iterator
from itertools import pairwise
from math import ceil
from textwrap import fill
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NARROW: Final = 120.0 / 25.4
"""Width in inches below which a picture is narrow, as one column of a journal is: its letters are those of paper."""

_ROUNDS: Final = 4
_APART: Final = 0.08  # inches
_BESIDE: Final = 1.3  # widths of a tick's label that it needs
_WORDS: Final = 0.75  # of the width of a legend, the rest is for its handles
_FREE: Final = 0.94  # of the way from a title to the next pane
_SMALLER: Final = 0.3  # of its size, to which a single word may shrink
_FEWEST: Final = 8  # characters of a line, however little room there is


def fit_labels(figure: "Figure") -> None:
    """Break labels, titles and entries of legends that are longer than their room, and thin out ticks."""
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    if isinstance(layout := figure.get_layout_engine(), ConstrainedLayoutEngine):
        layout.set(h_pad=_APART)  # so that the lowest tick of a pane stays off the highest of the one below
    for _ in range(_ROUNDS):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of panes without any room, which have it when all is broken
            figure.draw_without_rendering()
        for axes in figure.axes:
            _thin_ticks(axes)
        broken = [_broken(text, room, upright=upright) for text, room, upright in _labels(figure)]
        if not any(broken):
            return


def _thin_ticks(axes: "Axes") -> None:
    """Leave as many ticks as there is room for their labels: upright by their height, the others by their width."""
    from matplotlib.ticker import MaxNLocator

    box = axes.get_window_extent()
    if axes.get_yscale() == "linear" and (labels := axes.yaxis.get_ticklabels()):
        letter = float(labels[0].get_fontsize()) * axes.figure.figure.dpi / 72.0
        axes.locator_params(axis="y", nbins=max(1, min(6, int(box.height / (2.0 * letter)))))
    if isinstance(axes.xaxis.get_major_locator(), MaxNLocator) and (labels := axes.xaxis.get_ticklabels()):
        low, high = sorted(axes.get_xlim())
        room = int(box.width / (_BESIDE * max(label.get_window_extent().width for label in labels)))
        if sum(low <= tick <= high for tick in axes.get_xticks()) > room + 1:
            axes.locator_params(axis="x", nbins=max(1, room))
    if axes.get_xscale() == "log":
        _thin_between_powers(axes)


def _thin_between_powers(axes: "Axes") -> None:
    """Leave of labels between powers of ten those of 2 and 5, where neighbours would overlap."""
    from matplotlib.ticker import FuncFormatter

    low, high = sorted(axes.get_xlim())
    seen = [tick for tick in axes.xaxis.get_minor_ticks() if low <= tick.get_loc() <= high and tick.label1.get_text()]
    boxes = sorted((box.x0, box.x1) for box in (tick.label1.get_window_extent() for tick in seen))
    if any(end > begin for (_, end), (begin, _) in pairwise(boxes)):
        axes.xaxis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "25" else ""))


def _labels(figure: "Figure") -> Iterator[tuple[Any, float, bool]]:
    """Yield each text with its room in dots, and whether it is upright."""
    from matplotlib.text import Text

    width, boxes = figure.bbox.width, [axes.get_window_extent() for axes in figure.axes]
    for each in figure.legends:
        yield from ((text, _WORDS * width, False) for text in each.get_texts())
    for axes, box in zip(figure.axes, boxes, strict=True):
        left = max((other.x1 for other in boxes if other.x1 <= box.x0), default=0.0)
        right = min((other.x0 for other in boxes if other.x0 >= box.x1), default=width)
        middle = 0.5 * (box.x0 + box.x1)
        words = {axes.get_title(loc="left"), axes.get_title()} - {""}
        for text in axes.get_children():
            if isinstance(text, Text) and text.get_text() in words:
                yield text, _FREE * (right - box.x0), False
        yield axes.xaxis.label, 2.0 * min(middle - left, right - middle), False
        yield axes.yaxis.label, box.height, True
        if (legend := axes.get_legend()) is not None:
            panes = sum(other.y0 < box.y1 and box.y0 < other.y1 for other in boxes)  # which share its width
            yield from ((text, _WORDS * width / panes, False) for text in legend.get_texts())


def _broken(text: Any, room: float, *, upright: bool) -> bool:
    """Break a text that is longer than its room between words; return whether that changed it."""
    extent = text.get_window_extent()
    long = extent.height if upright else extent.width
    words = " ".join(text.get_text().split())
    longest = max(map(len, text.get_text().split("\n")), default=0)
    if not words or not 1.0 <= room < long:
        return False
    if upright and " " not in words and room > _SMALLER * long:
        text.set_fontsize(float(text.get_fontsize()) * room / long)
        return True
    if longest <= _FEWEST:
        return False
    text.set_text(fill(words, max(_FEWEST, ceil(longest * room / long) - 1), break_long_words=False))
    return True

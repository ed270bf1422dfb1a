"""The pictures of a run, by name."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from rubnoise.figures.acf import acf_figure
from rubnoise.figures.count import count_figure
from rubnoise.figures.histogram import histogram_figure
from rubnoise.figures.lives import lives_figure
from rubnoise.figures.psd import psd_figure
from rubnoise.figures.slider import slider_figure
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import Format, as_bytes, house_style
from rubnoise.figures.trace import trace_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES: Final[dict[str, Callable[[Stretch], "Figure"]]] = {
    "trace": trace_figure,
    "lives": lives_figure,
    "histogram": histogram_figure,
    "psd": psd_figure,
    "acf": acf_figure,
    "count": count_figure,
    "slider": slider_figure,
}


def picture(name: str, stretch: Stretch, kind: Format) -> bytes:
    """Return a picture of a run as the bytes of a file; raises Refused where the run has not what it shows."""
    with house_style():
        return as_bytes(PICTURES[name](stretch), kind)

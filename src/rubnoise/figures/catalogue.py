"""The pictures of a run, by name."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from rubnoise.figures.area import count_figure, lives_figure, trace_figure
from rubnoise.figures.area_statistics import acf_figure, histogram_figure, psd_figure
from rubnoise.figures.lifelines import lifelines_figure
from rubnoise.figures.motion_spectrum import Heard, motion_spectrum_figure
from rubnoise.figures.slider import landmarks_figure, phase_figure, slider_figure
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import Format, as_bytes, house_style

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
    "phase": phase_figure,
    "landmarks": landmarks_figure,
    "lifelines": lifelines_figure,
}

OVERLAID: Final[dict[str, Callable[[Stretch, Stretch], "Figure"]]] = {"slider": slider_figure, "phase": phase_figure}
"""Pictures in which another run can be laid over the first."""


def picture(
    name: str, stretch: Stretch, kind: Format, *, heard: Heard | None = None, beside: Stretch | None = None
) -> bytes:
    """Return a picture of a run as the bytes of a file.

    heard: whose spectrum `psd` shows, in place of the area's; beside: a run that is laid over the first. Raises Refused
    where a run has not what is shown.
    """
    with house_style():
        if heard is not None:
            figure = motion_spectrum_figure(stretch, heard, beside)
        else:
            figure = PICTURES[name](stretch) if beside is None else OVERLAID[name](stretch, beside)
        return as_bytes(figure, kind)

"""At the widths of a journal's columns no label of any picture is cut off, and none lies over another."""

from collections.abc import Iterator
from contextlib import suppress
from itertools import chain, combinations
from typing import Any

import matplotlib.pyplot as plt
import pytest
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

import rubnoise
from rubnoise.figures.catalogue import PICTURES

pytestmark = pytest.mark.slow

RUNS = {
    "first/rubbing": "4 mm",
    "paper/fig5_two_way": "2 mm",
    "load/fig5_load": "2 mm",
    "load/bouncing": "1 mm",
}


@pytest.fixture(scope="module", params=RUNS)
def run(request: pytest.FixtureRequest) -> rubnoise.Run:
    return rubnoise.run(rubnoise.load(request.param).replace(distance=RUNS[request.param]))


def undrawn(axis: Axis) -> Iterator[Text]:
    """Yield the labels of ticks that lie outside of an axis."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-9 * max(abs(low) if axis.get_scale() == "log" else high - low, 1e-300)
    for tick in chain(axis.get_major_ticks(), axis.get_minor_ticks()):
        if not low - slack <= tick.get_loc() <= high + max(slack, 1e-9 * abs(high)):
            yield from (tick.label1, tick.label2)


def flaws(figure: Any) -> list[str]:
    """Return the labels that are cut off, and the pairs that overlap."""
    FigureCanvasAgg(figure).draw()
    hidden = {id(label) for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for label in undrawn(axis)}
    words = [each for each in figure.findobj(Text) if each.get_visible() and each.get_text().strip()]
    boxes = [(each.get_text(), each.get_window_extent()) for each in words if id(each) not in hidden]
    width, height = figure.canvas.get_width_height()
    found = [f"{text} is cut" for text, box in boxes if min(box.x0, box.y0, width - box.x1, height - box.y1) < -1.0]
    for (one, box), (other, beside) in combinations(boxes, 2):
        wide = min(box.x1, beside.x1) - max(box.x0, beside.x0)
        high = min(box.y1, beside.y1) - max(box.y0, beside.y0)
        if wide > 1.5 and high > 1.5:
            found.append(f"{one} lies over {other}")
    return found


@pytest.mark.parametrize("size", ["single", "double"])
@pytest.mark.parametrize("what", PICTURES)
def test_nothing_is_cut_off_and_nothing_overlaps(run: rubnoise.Run, what: Any, size: str) -> None:
    with suppress(rubnoise.Refused):  # a picture of what this run does not have
        figure = run.plot(what, size=size)
        assert flaws(figure) == []
        plt.close(figure)


def test_a_cut_and_an_overlap_would_be_seen() -> None:
    figure, axes = plt.subplots(figsize=(2.0, 1.0))
    axes.set_xlabel("a label that is far longer than the picture is wide")
    assert any(each.endswith("is cut") for each in flaws(figure))
    axes.text(0.5, 0.5, "one")
    axes.text(0.5, 0.5, "other")
    assert "one lies over other" in flaws(figure)
    plt.close(figure)

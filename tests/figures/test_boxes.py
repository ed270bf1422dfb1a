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
    "first/rubbing": "40 mm",
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
        if wide > -1.0 and high > 1.5:  # beside one another they are apart
            found.append(f"{one} lies over {other}")
    return found


LEAST = 5.0 / 25.4  # inches


def crushed(figure: Any) -> list[str]:
    """Return the panes that are too low or too narrow to see anything in."""
    boxes = {axes.get_ylabel() or axes.get_title(): axes.get_window_extent() for axes in figure.axes}
    return [name for name, box in boxes.items() if box.height < LEAST * figure.dpi or box.width < 0.02 * figure.dpi]


def assert_seen(figure: Any) -> None:
    assert (flaws(figure), crushed(figure)) == ([], [])
    plt.close(figure)


HEARD = ["force", "displacement", "velocity", "normal-velocity", "load"]
DRAWN = [(what, "area") for what in PICTURES] + [(what, of) for what in ("psd", "histogram") for of in HEARD]


@pytest.mark.parametrize("size", ["single", "double"])
@pytest.mark.parametrize(("what", "of"), DRAWN)
def test_nothing_is_cut_off_and_nothing_overlaps(run: rubnoise.Run, what: Any, of: str, size: str) -> None:
    with suppress(rubnoise.Refused):  # a picture of what this run does not have
        assert_seen(run.plot(what, of=of, size=size))


@pytest.mark.parametrize("size", ["single", "double"])
def test_nor_over_another_run(size: str) -> None:
    scenario = rubnoise.load("first/rubbing").replace(distance="4 mm")
    with rubnoise.run(scenario) as run, rubnoise.run(scenario, seed=2) as other:
        for what in ("slider", "phase"):
            assert_seen(run.plot(what, beside=other, size=size))


LAWS = {"birth.law": ["poisson", "regular"]}
SWEPT = [
    {"sliding.speed": ["5 mm/s", "10 mm/s", "20 mm/s", "40 mm/s"]},
    {"interface.mean_junction_count": [5, 10, 20]} | LAWS,
    LAWS,
    {"interface.mean_real_contact_area": ["100 um^2", "120 um^2", "400 um^2"]},  # two too close for labels
]


@pytest.mark.parametrize("size", ["single", "double"])
@pytest.mark.parametrize("grid", SWEPT)
def test_nor_in_a_sweep_whose_axis_has_the_values_that_are_swept(grid: Any, size: str) -> None:
    scenario = rubnoise.load("first/rubbing").replace(distance="300 um")
    with rubnoise.sweep(scenario, grid=grid, jobs=1) as sweep:
        figure = sweep.plot("real_contact_area_std", size=size)
    ticks = [each.get_text() for each in figure.axes[0].get_xticklabels()]
    values = [str(value).split(" ")[0] for value in next(iter(grid.values()))]
    assert (ticks == values) == (grid is not SWEPT[-1])
    assert_seen(figure)


def test_a_cut_and_an_overlap_would_be_seen() -> None:
    figure, axes = plt.subplots(figsize=(2.0, 1.0))
    axes.set_xlabel("a label that is far longer than the picture is wide")
    assert any(each.endswith("is cut") for each in flaws(figure))
    axes.text(0.5, 0.5, "one")
    axes.text(0.5, 0.5, "other")
    assert "one lies over other" in flaws(figure)
    plt.close(figure)

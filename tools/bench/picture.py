"""The benchmark as a picture: who needs how much for a junction, and how that grows."""

from typing import TYPE_CHECKING, Final

from bench.clock import Timing
from bench.entrants import NAIVE_NUMPY, NAIVE_SIMPY, NUMBA, OURS, SUPERPOSED
from bench.page import grouped
from bench.results import Results
from rubnoise.figures.style import BLUE, FAINT, INK, as_png, house_style, logarithmic, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

AXES: Final = {"count": "mean number of junctions", "ticks": "ticks in a mean life", "length": "junctions in a run"}
LOOKS: Final = {
    f"{OURS}batch": (BLUE, "o", "-"),
    f"{OURS}events": (BLUE, "s", "--"),
    NUMBA: (INK, "^", "-"),
    SUPERPOSED: (INK, "D", "--"),
    NAIVE_NUMPY: (FAINT, "v", "-"),
    NAIVE_SIMPY: (FAINT, "P", "--"),
}
PARTS: Final = (("whole run, to a file", "runs"), ("births and area, in memory", "areas"), ("births alone", "births"))
MICRO: Final = 1e6


def picture(found: Results) -> bytes:
    """Return the picture as a png."""
    with house_style():
        figure = new_figure(8.0, 7.6)
        above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.35, 1.0))[:, 0]
        _bars(above.subplots(), found)
        panels = below.subplots(1, 3, sharey=True, squeeze=False)[0]
        for axes, (what, label) in zip(panels, AXES.items(), strict=True):
            _growth(axes, found.growth[what], label)
        panels[0].set_ylabel("CPU time a junction, us")
        handles, labels = panels[0].get_legend_handles_labels()
        below.legend(handles, labels, loc="outside lower center", ncols=3)
        return as_png(figure)


def _bars(axes: "Axes", found: Results) -> None:
    rows = [(part, name, timing) for part, key in PARTS for name, timing in _by_speed(getattr(found, key))]
    heights, names = [], []
    place, last = 0.0, rows[0][0]
    for part, name, timing in rows:
        place += 1.0 if part == last else 1.9
        colour = BLUE if name.startswith(OURS) else FAINT
        value = MICRO * timing.each
        axes.barh(place, value, color=colour, height=0.72)
        axes.text(1.08 * value, place, f"{value:.3g}", va="center")
        if part != last or place == 1.0:
            axes.text(0.012, place - 0.62, part, va="bottom", transform=axes.get_yaxis_transform(), style="italic")
        heights.append(place)
        names.append(name)
        last = part
    axes.set_yticks(heights, names)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(place + 0.8, -0.2)
    logarithmic(axes.xaxis)
    low, high = (choose(t.each for _, _, t in rows) * MICRO for choose in (min, max))
    axes.set_xlim(0.3 * low, 2.0 * high)
    axes.set_xlabel("CPU time a junction, us")
    axes.set_title("Figure 5's contact: 20 junctions on average, 221 ticks in a mean life")


def _by_speed(timings: dict[str, Timing]) -> list[tuple[str, Timing]]:
    return sorted(timings.items(), key=lambda item: item[1].each)


def _growth(axes: "Axes", growth: dict[str, dict[float, Timing]], label: str) -> None:
    for name, timings in growth.items():
        colour, marker, line = LOOKS[name]
        values = [MICRO * timing.each for timing in timings.values()]
        axes.plot(list(timings), values, color=colour, marker=marker, linestyle=line, markersize=4.5, label=name)
    logarithmic(axes.yaxis)
    points = sorted({point for timings in growth.values() for point in timings})
    axes.set_xscale("log")
    axes.set_xticks(points, [grouped(point) for point in points])
    axes.set_xticks([], minor=True)
    axes.margins(x=0.12)
    axes.set_xlabel(label)

"""Figure 7 of the paper: the standard deviation of the real contact area against the number of junctions."""

from dataclasses import replace
from functools import partial
from itertools import cycle
from math import pi, sqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.figures.paper_sources import Sources
from rubnoise.figures.study import PointRuns, Study, StudyLine, study_of_points
from rubnoise.figures.study_picture import LOOK, draw_exact, draw_points
from rubnoise.figures.style import INK, SERIES, VERMILION, logarithmic, new_figure
from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.record.tally import Tally
from rubnoise.runs.measuring import Measurement
from rubnoise.scenario.points import Point
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.sampling import standard_errors

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

COUNT: Final = "interface.mean_junction_count"
UNITS: Final = {COUNT: "1", "interface.mean_real_contact_area": "um^2"}


def spreads_of(sources: Sources, name: str) -> Study:
    """Run a sweep, and return the spread of A_r at each of its points, the replicates taken together.

    Its standard error is that of theory for so many runs.
    """
    runs: dict[tuple[object, ...], tuple[Point, list[float]]] = {}
    for point, variance in sources.results(name, VARIANCE):
        runs.setdefault(tuple(point.values.values()), (point, []))[1].append(variance)
    points = [
        PointRuns(
            values=point.values,
            numbers={COUNT: float(point.values[COUNT])},
            scenario=point.scenario,
            figures=[sqrt(sum(variances) / len(variances))],
            standard_error=standard_errors(point.scenario.model()).std / sqrt(len(variances)),
        )
        for point, variances in runs.values()
    ]
    return study_of_points(points, "real_contact_area_std", title=name, units=UNITS)


def _tally(_extent: Extent) -> Tally:
    return Tally()


def _variance(_model: Model, tally: Tally) -> float:
    return tally.moments["real_contact_area"].variance


VARIANCE: Final = Measurement(sink=_tally, read=_variance)

LAW: Final = 1.5 * sqrt(2.0 * pi / 3.0 - 64.0 / 45.0)
"""std/mean times sqrt(N) for lenses of one size: sqrt(c_2) / (c_1 sqrt(2 / N)) with c_1 = 2/3, c_2 = pi/3 - 32/45."""


APART: Final = 0.018
"""How far points of one number of junctions are set apart, as a part of it, so that none hides another."""


def draw_fig7(sources: Sources) -> "Figure":
    """Draw the standard deviation for each mean area, and all of them over their mean on logarithmic axes."""
    lines = spreads_of(sources, "fig7.toml").lines
    figure = new_figure(7.2, 3.8)
    absolute, relative = figure.subplots(1, 2, width_ratios=[1.2, 1.0])
    for number, (line, (colour, marker)) in enumerate(zip(lines, cycle(SERIES), strict=False)):
        look: dict[str, Any] = {"color": colour, "fmt": marker, **LOOK}
        draw_points(absolute, line, look, partial(_place, 1.0), named=False)
        draw_exact(absolute, line, partial(_place, 1.0), "-")
        end = (line.spots[-1].place, line.spots[-1].exact)
        absolute.annotate(line.label, end, xytext=(7.0, 0.0), textcoords="offset points", va="center")
        # A little beside their places, so that none hides another.
        draw_points(relative, _over_mean(line), look, partial(_place, 1.0 + APART * (number - 2.0)), named=True)
    _draw_law(relative, [spot.place for line in lines for spot in line.spots])
    _finish_spreads(absolute, relative)
    return figure


def _place(factor: float, place: float) -> float:
    return factor * place


def _over_mean(line: StudyLine) -> StudyLine:
    """Return a line whose standard deviations are over the exact mean areas."""
    means = [area_cumulants(spot.scenario.model()).mean for spot in line.spots]
    spots = [replace(spot, seen=spot.seen.times(1.0 / mean)) for spot, mean in zip(line.spots, means, strict=True)]
    return replace(line, spots=tuple(spots))


def _draw_law(axes: "Axes", places: list[float]) -> None:
    """Draw the law for sizes that are all the same, which no mean area enters."""
    counts = np.array([0.9 * min(places), 1.1 * max(places)])
    axes.plot(counts, LAW / np.sqrt(counts), color=VERMILION, lw=1.2, zorder=2)
    middle = float(np.sqrt(counts.prod()))
    axes.annotate(
        f"exact, one size:\n{LAW:.5g}/√N", (middle, LAW / sqrt(middle)), xytext=(8.0, 8.0), textcoords="offset points"
    )


def _finish_spreads(absolute: "Axes", relative: "Axes") -> None:
    absolute.errorbar([], [], [], label="simulated, 95 % interval", color=INK, fmt="o", ms=4.5, capsize=2.0)
    absolute.plot([], [], color=VERMILION, lw=1.2, label="exact")
    absolute.legend(loc="upper right")
    absolute.set_ylabel("standard deviation of\nthe real contact area (µm²)")
    absolute.set_ylim(bottom=0.0)
    absolute.set_title("For five mean areas")
    for axis in (relative.xaxis, relative.yaxis):
        logarithmic(axis)
        _few_numbers(axis)
    relative.set_ylabel("standard deviation over mean")
    relative.set_title("Over their mean: one law")
    relative.legend(loc="lower left", title="simulated", alignment="left")
    absolute.set_xlabel("mean number of junctions")
    relative.set_xlabel("mean number of junctions\n(points of one number side by side)")


def _few_numbers(axis: "Axis") -> None:
    """Label a short logarithmic axis by its own numbers, not by powers of ten of which it has one."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    axis.set_major_locator(FixedLocator([0.1, 0.15, 0.2, 0.3, 0.4, 10.0, 20.0, 30.0, 40.0, 50.0]))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))

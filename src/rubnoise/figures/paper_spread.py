"""Figure 7 of the paper: the standard deviation of the real contact area against the number of junctions."""

from dataclasses import dataclass
from itertools import cycle
from math import pi, sqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.figures.paper_sources import Sources
from rubnoise.figures.style import CONFIDENCE, INK, SERIES, VERMILION, logarithmic, new_figure
from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.record.tally import Tally
from rubnoise.scenario import Scenario, build
from rubnoise.scenario.points import Point
from rubnoise.sweep.execution import Measure
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.sampling import standard_errors

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """The spread of A_r in the runs of one point with its standard error, and the exact one with the mean, in um^2."""

    scenario: Scenario
    std: float
    standard_error: float
    exact_std: float
    exact_mean: float

    @property
    def count(self) -> float:
        """N_jm."""
        return self.scenario.model().mean_junction_count


def spreads_of(sources: Sources, name: str) -> list[Spread]:
    """Run a sweep, and return the spread at each of its points, the replicates taken together."""
    runs: dict[tuple[object, ...], tuple[Point, list[float]]] = {}
    for point, variance in sources.results(name, VARIANCE):
        runs.setdefault(tuple(point.values.values()), (point, []))[1].append(variance)
    return [_spread(point.scenario, variances) for point, variances in runs.values()]


def _tally(extent: Extent) -> Tally:
    del extent
    return Tally()


def _variance(model: Model, tally: Tally) -> float:
    del model
    return tally.moments["real_contact_area"].variance


VARIANCE: Final = Measure(sink=_tally, read=_variance)


def _spread(scenario: Scenario, variances: list[float]) -> Spread:
    model = scenario.model()
    exact = area_cumulants(model)
    return Spread(
        scenario=scenario,
        std=sqrt(sum(variances) / len(variances)),
        standard_error=standard_errors(model).std / sqrt(len(variances)),
        exact_std=exact.std,
        exact_mean=exact.mean,
    )


def by_area(spreads: list[Spread]) -> dict[float, list[Spread]]:
    """Return spreads by their mean area A_rm in um^2, each family by its number of junctions, all rising."""
    families: dict[float, list[Spread]] = {}
    for spread in sorted(spreads, key=lambda each: each.count):
        families.setdefault(spread.scenario.model().mean_real_contact_area, []).append(spread)
    return dict(sorted(families.items()))


LAW: Final = 1.5 * sqrt(2.0 * pi / 3.0 - 64.0 / 45.0)
"""std/mean times sqrt(N) for lenses of one size: sqrt(c_2) / (c_1 sqrt(2 / N)) with c_1 = 2/3, c_2 = pi/3 - 32/45."""


APART: Final = 0.018
"""How far points of one number of junctions are set apart, as a part of it, so that none hides another."""

CURVE: Final = 41
"""Points of an exact curve, from the fewest junctions to the most."""


def draw_fig7(sources: Sources) -> "Figure":
    """Draw the standard deviation for each mean area, and all of them over their mean on logarithmic axes."""
    families = by_area(spreads_of(sources, "fig7.toml"))
    figure = new_figure(7.2, 3.8)
    absolute, relative = figure.subplots(1, 2, width_ratios=[1.2, 1.0])
    for number, ((area, spreads), (colour, marker)) in enumerate(zip(families.items(), cycle(SERIES), strict=False)):
        look: dict[str, Any] = {
            "color": colour,
            "fmt": marker,
            "ms": 4.5,
            "lw": 0.0,
            "elinewidth": 1.0,
            "capsize": 2.0,
            "zorder": 3,
        }
        label = f"{area:g} µm²"
        _draw_absolute(absolute, spreads, look)
        _draw_relative(relative, spreads, look | {"label": label}, place=1.0 + APART * (number - 2.0))
        _draw_exact_spread(absolute, spreads, label)
    _draw_law(relative, [spread for spreads in families.values() for spread in spreads])
    _finish_spreads(absolute, relative)
    return figure


def _draw_absolute(axes: "Axes", spreads: list[Spread], look: dict[str, Any]) -> None:
    errors = [CONFIDENCE * spread.standard_error for spread in spreads]
    axes.errorbar([spread.count for spread in spreads], [spread.std for spread in spreads], errors, **look)


def _draw_relative(axes: "Axes", spreads: list[Spread], look: dict[str, Any], place: float) -> None:
    """Draw standard deviations over exact means, a little beside their places so that none hides another."""
    places = [place * spread.count for spread in spreads]
    errors = [CONFIDENCE * spread.standard_error / spread.exact_mean for spread in spreads]
    axes.errorbar(places, [spread.std / spread.exact_mean for spread in spreads], errors, **look)


def _draw_exact_spread(axes: "Axes", spreads: list[Spread], label: str) -> None:
    """Draw the exact curve of one mean area, with the area at its end."""
    first, last = spreads[0], spreads[-1]
    counts = np.linspace(first.count, last.count, CURVE)
    std = [_exact_std(first.scenario, count) for count in counts.tolist()]
    axes.plot(counts, std, color=VERMILION, lw=1.2, zorder=2)
    axes.annotate(label, (last.count, last.exact_std), xytext=(7.0, 0.0), textcoords="offset points", va="center")


def _exact_std(scenario: Scenario, count: float) -> float:
    values = scenario.resolved()
    return area_cumulants(
        build(values | {"interface": values["interface"] | {"mean_junction_count": count}}).model()
    ).std


def _draw_law(axes: "Axes", spreads: list[Spread]) -> None:
    """Draw the law for sizes that are all the same, which no mean area enters."""
    counts = np.array([0.9 * min(spread.count for spread in spreads), 1.1 * max(spread.count for spread in spreads)])
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

"""The number of live junctions along the sliding distance, and its distribution."""

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.births import PoissonBirths
from rubnoise.figures.marks import DISTANCE, entitle, exact_band, from_zero, legend_above
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, VERMILION, new_figure
from rubnoise.theory.exact import Exact, exact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LIVES: Final = 40.0
COUNT: Final = "live junctions"


def count_figure(stretch: Stretch) -> "Figure":
    """Draw N(s) of the stretch's beginning, and beside it how often each number was alive in the whole stretch."""
    theory = exact(stretch.model)
    figure = new_figure(7.2, 3.4)
    entitle(figure, stretch, "How many junctions are alive")
    along, often = figure.subplots(1, 2, width_ratios=[2.2, 1])
    _draw_along(along, stretch.narrowed(LIVES * stretch.model.mean_life_distance), theory)
    _draw_often(often, stretch, theory)
    return figure


def _draw_along(axes: "Axes", stretch: Stretch, theory: Exact) -> None:
    exact_band(axes, theory.count_mean, theory.count_std)
    axes.plot(*stretch.curve("trace", "junction_count"), color=BLUE, lw=0.8, drawstyle="steps-post", label="simulated")
    axes.set_xlim(stretch.start, stretch.stop)
    from_zero(axes)
    axes.locator_params(axis="y", integer=True)
    axes.set_xlabel(DISTANCE)
    axes.set_ylabel(COUNT)
    legend_above(axes)


def _draw_often(axes: "Axes", stretch: Stretch, theory: Exact) -> None:
    lowest, share = _shares(stretch)
    numbers = lowest + np.arange(share.size)
    axes.bar(numbers, share, width=1.0, color=BLUE, alpha=0.45, lw=0.0, label="simulated")
    if isinstance(stretch.model.births, PoissonBirths):
        axes.plot(numbers, _poisson(numbers, theory.count_mean), "o", color=VERMILION, ms=3.0, label="exact: Poisson")
    else:
        axes.axvline(theory.count_mean, color=VERMILION, label="exact mean")
    axes.locator_params(axis="x", integer=True)
    axes.set_xlabel(COUNT)
    axes.set_ylabel("share of the ticks")
    legend_above(axes, columns=1)


def _shares(stretch: Stretch) -> tuple[int, NDArray[np.float64]]:
    """Return the smallest number of live junctions, and how often it and every larger one was alive."""
    found: dict[int, int] = {}
    for panel in stretch.panels("trace", "junction_count"):
        numbers, often = np.unique(panel, return_counts=True)
        for number, times in zip(numbers.tolist(), often.tolist(), strict=True):
            found[number] = found.get(number, 0) + times
    lowest, highest = min(found), max(found)
    times = np.array([found.get(number, 0) for number in range(lowest, highest + 1)], dtype=np.float64)
    return lowest, times / times.sum()


def _poisson(numbers: NDArray[np.int64], mean: float) -> NDArray[np.float64]:
    """Return the probabilities m^n exp(-m) / n! of a Poisson number of mean m."""
    from scipy.special import gammaln, xlogy

    return np.asarray(np.exp(xlogy(numbers, mean) - mean - gammaln(numbers + 1.0)), dtype=np.float64)

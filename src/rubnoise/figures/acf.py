"""The autocovariance of the real contact area, beside the exact one."""

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.covariance import LaggedProducts
from rubnoise.analysis.moments import covariance_errors
from rubnoise.contact.births import PoissonBirths
from rubnoise.figures.marks import NEAREST, entitle, legend_above
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, FAINT, VERMILION, new_figure
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.correlation import autocovariance

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LAGS: Final = 80
SAMPLES: Final = 400
LIVES: Final = 1.6


def acf_figure(stretch: Stretch) -> "Figure":
    """Draw the autocovariance of A_r over a stretch and R(tau), with its standard error where theory knows one."""
    steps = _steps(stretch)
    lag = stretch.model.tick * steps
    products = LaggedProducts(steps.tolist(), area_cumulants(stretch.model).mean)
    for panel in stretch.panels("trace", "real_contact_area"):
        products.add(panel)
    figure = new_figure(7.2, 3.8)
    entitle(figure, stretch, "Autocovariance of the real contact area")
    axes = figure.subplots()
    _draw_exact(axes, stretch, float(lag[-1]))
    axes.plot(lag, products.covariances(), "o", color=BLUE, ms=2.6, label="simulated")
    axes.set_xlim(0.0, lag[-1])
    rounding = (NEAREST * area_cumulants(stretch.model).mean) ** 2
    if max(np.abs(axes.get_ylim())) < rounding:
        axes.set_ylim(-rounding, rounding)
    axes.set_xlabel("lag in sliding distance (µm)")
    axes.set_ylabel("autocovariance (µm⁴)")
    legend_above(axes)
    return figure


def _steps(stretch: Stretch) -> NDArray[np.int64]:
    """Return lags in ticks up to somewhat more than a mean life, or half of the stretch."""
    first, last = stretch.rows("trace")
    reach = min(int(LIVES * stretch.model.mean_life_distance / stretch.model.tick) + 1, (last - first) // 2)
    return np.arange(0, reach + 1, max(1, reach // LAGS))


def _draw_exact(axes: "Axes", stretch: Stretch, longest: float) -> None:
    lag = np.linspace(0.0, longest, SAMPLES)
    exact = autocovariance(stretch.model, lag)
    axes.axhline(0.0, color=FAINT, lw=0.6, zorder=0)
    if isinstance(stretch.model.births, PoissonBirths):
        error = covariance_errors(stretch.model, lag, stretch.stop - stretch.start, stretch.model.tick)
        label = "± standard error"
        axes.fill_between(lag, exact - error, exact + error, color=VERMILION, alpha=0.15, lw=0.0, label=label)
    axes.plot(lag, exact, color=VERMILION, lw=1.6, label="exact")

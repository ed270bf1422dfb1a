"""How often each real contact area occurs, beside its exact distribution."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.histogram import Histogram, histogram
from rubnoise.analysis.records import RecordTooShort
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.marks import AREA, NEAREST, entitle, legend_above
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, INK, VERMILION, logarithmic, new_figure
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.distribution import Distribution, distribution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BINS: Final = 51
"""Odd, so that an area that never varies falls into the middle of one."""
SAMPLES: Final = 1200
RARE: Final = 1e-6
"""A probability of no contact at all below which a picture need not speak of it."""


def histogram_figure(stretch: Stretch) -> "Figure":
    """Draw the histogram of A_r over a stretch with the exact density, on a linear and on a logarithmic axis.

    An area of 0 has a probability and no density: a text states it.
    """
    values = stretch.record("trace", "real_contact_area")
    seen, law = _histogram(values, stretch.model.tick), _law(stretch)
    figure = new_figure(7.2, 3.6)
    entitle(figure, stretch, _told(stretch, values, law))
    linear, tails = figure.subplots(1, 2, sharex=True)
    for axes in (linear, tails):
        _draw(axes, seen, law)
    # Not as high as the exact density: it is singular at 0.
    highest = float(seen.density.max()) or 1.0
    linear.set_ylim(0.0, 1.2 * highest)
    linear.set_ylabel("density (1/µm²)")
    logarithmic(tails.yaxis)
    lowest = float(seen.density.min(where=seen.density > 0.0, initial=highest))
    tails.set_ylim(0.3 * lowest, 3.0 * highest)
    legend_above(linear)
    return figure


def _told(stretch: Stretch, values: Doubles, law: Distribution | None) -> str:
    exact = area_cumulants(stretch.model)
    moments = f"mean {values.mean():.4g} (exact {exact.mean:.4g}), std {values.std():.4g} ({exact.std:.4g}) µm²"
    told = f"How large the real contact area is: {moments}"
    if law is not None and law.atom_at_zero > RARE:
        told += f"\nno contact at all: {np.mean(values == 0.0):.3g} (exact {law.atom_at_zero:.3g})"
    first, last = stretch.rows("trace")
    return told + (f"\nfrom its first {values.size * stretch.model.tick:.4g} µm" if values.size < last - first else "")


def _histogram(values: Doubles, tick: float) -> Histogram:
    some = values[values > 0.0]
    low, high = (float(some.min()), float(some.max())) if some.size else (0.0, 1.0)
    # Values that differ by rounding alone are one bar, on an axis that has digits for its numbers.
    room = (1e-9 if high - low > NEAREST * high else 0.1) * high
    edges = np.linspace(max(low - room, np.nextafter(0.0, 1.0)), high + room, BINS + 1)
    try:
        return histogram(values, tick, edges)
    except RecordTooShort as short:
        if isinstance(short.estimate, Histogram):
            return short.estimate
        raise


def _law(stretch: Stretch) -> Distribution | None:
    try:
        return distribution(stretch.model)
    except Refused:
        return None


def _draw(axes: "Axes", seen: Histogram, law: Distribution | None) -> None:
    axes.stairs(seen.density, seen.edges, fill=True, color=BLUE, alpha=0.4, lw=0.0, label="simulated")
    if np.all(np.isfinite(seen.standard_error)):
        axes.errorbar(
            seen.middles, seen.density, seen.standard_error, fmt="none", ecolor=INK, elinewidth=0.6, label="± std error"
        )
    if law is not None:
        area = np.linspace(seen.edges[0], seen.edges[-1], SAMPLES)
        axes.plot(area, law.density(area), color=VERMILION, lw=1.4, label="exact")
    axes.set_xlabel(AREA)

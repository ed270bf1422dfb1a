"""The report of an inference, and its picture: trace, spectrum, residuals, autocorrelation and histogram."""

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from rubnoise.analysis.records import autocovariance
from rubnoise.api.fit import NAMES
from rubnoise.figures.style import BLUE, FAINT, VERMILION, as_bytes, house_style, logarithmic, new_figure
from rubnoise.inference.inference import InferenceResult
from rubnoise.tables import as_html
from rubnoise.web_page import report_page

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_SHOWN = 2000
_MOST = 1 << 20  # samples of an autocorrelation


def page(found: InferenceResult, name: str, text: str) -> str:
    """Return a page of HTML, in the style of a run's report: estimates, five pictures, tests, the command's texts."""
    with house_style():
        picture = as_bytes(_drawn(found), "svg").decode("utf-8")
    picture = picture[picture.index("<svg") :]
    estimates = [
        (key.replace("_", " "), f"{each.value:.4g}", "{:.4g} to {:.4g}".format(*each.interval), each.unit.strip("1"))
        for key, each in ((key, found.estimates[key]) for key in NAMES if key in found.estimates)
    ]
    tests = [("flagged" if test.flagged else "", test.words) for test in found.tests]
    sections = {
        "What it shows": as_html("", ("quantity", "estimate", "95 % interval", "unit"), estimates),
        "Pictures": f"<figure>{picture}</figure>",
        "Tests of the trace": as_html("", ("", "test"), tests),
        "In full": f"<pre>{escape(text)}</pre>",
    }
    return report_page(f"Junctions behind {name}", sections)


def figure(found: InferenceResult) -> "Figure":
    """Return trace, spectrum, residuals, autocorrelation and histogram as one figure, which a notebook shows."""
    with house_style():
        return _drawn(found)


def _drawn(found: InferenceResult) -> "Figure":
    fit, signal = found.fit, found.signal
    if fit is None:
        raise AssertionError("an inference that was refused has no picture")
    figure = new_figure(9.0, 10.5)
    grid = figure.add_gridspec(3, 2)
    shown = signal.values[:_SHOWN]
    place = signal.tick * np.arange(shown.size)
    axes = figure.add_subplot(grid[0, :])
    axes.plot(place, shown, color=BLUE, linewidth=0.8)
    axes.set(xlabel="sliding distance (µm)", ylabel=f"trace ({signal.unit})", title=f"First {shown.size:,} samples")

    bands, mean = fit.problem.bands, fit.expected.mean
    k = bands.wavenumber / signal.tick
    extra = fit.residual.size - bands.energy.size
    error = np.sqrt(fit.scatter.diagonal()[extra:])
    unit = float(signal.values.std()) ** 2 * signal.tick
    axes = figure.add_subplot(grid[1, 0])
    axes.loglog(k, bands.energy * unit, ".", color=BLUE, markersize=3, label="trace")
    axes.loglog(k, mean * unit, color=VERMILION, label="expected")
    low = np.maximum(mean - 2.0 * error, 0.02 * mean)
    axes.fill_between(k, low * unit, (mean + 2.0 * error) * unit, color=VERMILION, alpha=0.2, linewidth=0)
    axes.set(xlabel="wavenumber (rad/µm)", ylabel=f"spectral density ({signal.unit}² µm)", title="Spectrum")
    logarithmic(axes.xaxis, axes.yaxis)
    axes.legend()

    axes = figure.add_subplot(grid[1, 1])
    axes.semilogx(k, fit.residual[extra:] / error, ".", color=BLUE, markersize=3)
    for level in (-2.0, 0.0, 2.0):
        axes.axhline(level, color=VERMILION if level == 0.0 else FAINT, linewidth=0.8)
    axes.set(xlabel="wavenumber (rad/µm)", ylabel="residual (standard errors)", title="Residuals")
    logarithmic(axes.xaxis)

    axes = figure.add_subplot(grid[2, 0])
    values = signal.values[:_MOST]
    measured = autocovariance(values, max(1, min(int(6.0 * fit.contact.place.diameter), values.size // 2)))
    axes.plot(signal.tick * np.arange(measured.size), measured / measured[0], color=BLUE, label="trace")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.axvline(2.0 * fit.contact.place.diameter * signal.tick, color=VERMILION, linestyle="--", label="mean life")
    axes.set(xlabel="lag (µm)", ylabel="autocorrelation", title="Autocorrelation")
    axes.legend()

    axes = figure.add_subplot(grid[2, 1])
    axes.hist(signal.values, bins=60, color=BLUE, density=True)
    axes.set(xlabel=f"trace ({signal.unit})", ylabel=f"density (1/{signal.unit})", title="Histogram")
    return figure

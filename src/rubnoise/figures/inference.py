"""The report of an inference: a page with the trace, its spectrum, residuals, autocovariance and histogram."""

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from rubnoise.figures.style import BLUE, FAINT, VERMILION, as_bytes, house_style, logarithmic, new_figure
from rubnoise.inference.inference import InferenceResult
from rubnoise.web_page import web_page

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rubnoise.arrays import Doubles

_SHOWN = 2000
_MOST = 1 << 20  # samples of an autocorrelation
_STYLE = (
    "body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
    "pre{white-space:pre-wrap}svg{max-width:100%;height:auto}"
)


def page(found: InferenceResult, name: str, text: str) -> str:
    """Return a page of HTML that needs no network: the texts of the command, and five pictures."""
    with house_style():
        picture = as_bytes(_drawn(found), "svg").decode("utf-8")
    picture = picture[picture.index("<svg") :]
    tests = "".join(
        f"<li>{'<strong>flagged</strong>: ' if test.flagged else ''}{escape(test.words)}</li>" for test in found.tests
    )
    title = f"Junctions behind {name}"
    body = f"<h1>{escape(title)}</h1><pre>{escape(text)}</pre>{picture}<h2>Tests</h2><ul>{tests}</ul>"
    return web_page(body, title=title, styles=[_STYLE])


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
    axes.set(xlabel="sliding distance (um)", ylabel=f"trace ({signal.unit})", title=f"First {shown.size:,} samples")

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
    axes.set(xlabel="wavenumber (rad/um)", ylabel=f"spectral density ({signal.unit}^2 um)", title="Spectrum")
    logarithmic(axes.xaxis, axes.yaxis)
    axes.legend()

    axes = figure.add_subplot(grid[1, 1])
    axes.semilogx(k, fit.residual[extra:] / error, ".", color=BLUE, markersize=3)
    for level in (-2.0, 0.0, 2.0):
        axes.axhline(level, color=VERMILION if level == 0.0 else FAINT, linewidth=0.8)
    axes.set(xlabel="wavenumber (rad/um)", ylabel="residual (standard errors)", title="Residuals")
    logarithmic(axes.xaxis)

    axes = figure.add_subplot(grid[2, 0])
    lags, measured = _autocovariance(signal.values, int(6.0 * fit.contact.place.diameter))
    axes.plot(lags * signal.tick, measured, color=BLUE, label="trace")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.axvline(2.0 * fit.contact.place.diameter * signal.tick, color=VERMILION, linestyle="--", label="mean life")
    axes.set(xlabel="lag (um)", ylabel="autocorrelation", title="Autocorrelation")
    axes.legend()

    axes = figure.add_subplot(grid[2, 1])
    axes.hist(signal.values, bins=60, color=BLUE, density=True)
    axes.set(xlabel=f"trace ({signal.unit})", ylabel=f"density (1/{signal.unit})", title="Histogram")
    return figure


def _autocovariance(values: "Doubles", longest: int) -> "tuple[Doubles, Doubles]":
    centred = values[:_MOST] - values[:_MOST].mean()
    transform = np.fft.rfft(centred, 2 * centred.size)
    covariance = np.fft.irfft(np.square(np.abs(transform)))[: max(2, min(longest, centred.size // 2))]
    return np.arange(covariance.size, dtype=np.float64), covariance / covariance[0]

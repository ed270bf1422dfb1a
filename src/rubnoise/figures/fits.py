"""Pictures of measurements: two surfaces under a load, and what an inference found behind a trace, with its report."""

from html import escape
from typing import Any, Final

import numpy as np

from rubnoise.figures import Axes, Figure
from rubnoise.figures.style import BLUE, FAINT, INK, VERMILION, as_bytes, house_style, logarithmic, new_figure
from rubnoise.inference.estimates import NAMES
from rubnoise.inference.inference import InferenceResult
from rubnoise.inference.signal import autocovariance as sample_autocovariance
from rubnoise.surface.height_map import Waves
from rubnoise.surface.sliding import SlidingContact
from rubnoise.tables import as_html
from rubnoise.theory.second_order import autocovariance
from rubnoise.web_page import report_page

_MOST_SHOWN: Final = 600
"""Points a side of a map as it is drawn; of more, the highest of some stand for them, so that no patch is lost."""

_BINS: Final = 60


@house_style()
def contact_figure(contact: SlidingContact) -> Figure:
    """Return five panes: both surfaces with patches, bearing curve, spectra, number, autocovariance."""
    figure = new_figure(9.0, 10.5)
    panes: Any = figure.subplot_mosaic([["map", "bearing"], ["spectra", "counts"], ["memory", "memory"]])
    _draw_map(panes["map"], contact)
    _draw_bearing(panes["bearing"], contact)
    _draw_spectra(panes["spectra"], contact)
    _draw_counts(panes["counts"], contact)
    _draw_autocovariance(panes["memory"], contact)
    for axes in figure.axes[1:]:
        axes.legend()
    return figure


def _draw_map(axes: Axes, contact: SlidingContact) -> None:
    from matplotlib.colors import ListedColormap

    total = contact.heights
    count = max(1, round(contact.share * total.size))
    gap = np.partition(total, total.size - count, axis=None)[total.size - count]
    blocks = [-(-n // _MOST_SHOWN) for n in total.shape]
    cut = total[: total.shape[0] // blocks[0] * blocks[0], : total.shape[1] // blocks[1] * blocks[1]]
    shown = cut.reshape(cut.shape[0] // blocks[0], blocks[0], cut.shape[1] // blocks[1], blocks[1]).max((1, 3))
    along, across = (n * s for n, s in zip(total.shape, contact.slider.spacing, strict=True))
    look: dict[str, Any] = {"origin": "lower", "extent": (0.0, along, 0.0, across), "interpolation": "nearest"}
    axes.imshow(shown.T, cmap="Greys", **look)
    axes.imshow(np.where(shown >= gap, 1.0, np.nan).T, cmap=ListedColormap([VERMILION]), **look)
    axes.set(xlabel="along the sliding (µm)", ylabel="across (µm)", title="Both heights, patches of contact in red")


def _draw_bearing(axes: Axes, contact: SlidingContact) -> None:
    from scipy.special import ndtri

    heights = np.sort(contact.heights, axis=None)[::-1] / contact.gaussian.roughness
    shares = np.geomspace(3.0 / heights.size, 0.5, _BINS)
    axes.semilogx(100.0 * shares, heights[(shares * heights.size).astype(int)], color=BLUE, label="maps")
    axes.semilogx(100.0 * shares, -ndtri(shares), color=VERMILION, label="Gaussian")
    axes.axvline(100.0 * contact.share, color=FAINT, linestyle="--", label="under the load")
    axes.set(xlabel="share of the area above (%)", ylabel="height over rms", title="Bearing curve")
    logarithmic(axes.xaxis)


def _draw_spectra(axes: Axes, contact: SlidingContact) -> None:
    """Draw the power per wave of both scans along and across the sliding, summed over the other direction."""
    for role, scan, colour in zip(("track", "slider"), contact.scans, (BLUE, INK), strict=True):
        power = Waves.of(scan).power
        for axis, style, words in ((1, "-", "along"), (0, ":", "across")):
            n, step = power.shape[1 - axis], scan.spacing[1 - axis]
            half = slice(1, n // 2)
            density = 2.0 * power.sum(axis)[half] * n * step
            axes.loglog(
                np.fft.fftfreq(n, step)[half], density, style, color=colour, linewidth=0.8, label=f"{role}, {words}"
            )
    axes.axvline(1.0 / contact.cutoff, color=VERMILION, linestyle="--", label="cut-off")
    if contact.longest is not None:
        axes.axvline(1.0 / contact.longest, color=VERMILION, linestyle=":", label="longest")
    bottom, top = axes.get_ylim()
    axes.set_ylim(max(bottom, 1e-12 * top), top)  # below lie the digits of the transform
    axes.set(xlabel="waves per µm", ylabel="spectral density (µm³)", title="Spectra of the scans")
    logarithmic(axes.xaxis, axes.yaxis)


def _draw_counts(axes: Axes, contact: SlidingContact) -> None:
    cutoffs, counts = contact.count_over_cutoff()
    axes.loglog(cutoffs, counts, color=VERMILION, marker="o", markersize=3, label="exact, Gaussian")
    area = contact.counted.map_area / contact.nominal_area
    axes.loglog([contact.cutoff], [contact.counted.patch_count / area], "s", color=BLUE, label="counted")
    axes.axvline(contact.cutoff, color=FAINT, linestyle="--")
    axes.set(xlabel="cut-off (µm)", ylabel="junctions", title="Number of junctions over the cut-off")
    logarithmic(axes.xaxis, axes.yaxis)


def _draw_autocovariance(axes: Axes, contact: SlidingContact) -> None:
    gaussian = contact.gaussian
    lags, moving = gaussian.curve
    end = min(float(lags[-1]), 8.0 * (gaussian.correlation_length if gaussian.correlation_length > 0.0 else lags[-1]))
    shown = lags <= end
    mean = gaussian.real_contact_area
    axes.plot(lags[shown], moving[shown] / mean**2, color=VERMILION, label="surfaces, exact: short run")
    axes.plot(
        lags[shown], gaussian.autocovariance(lags[shown]) / mean**2, color=VERMILION, linestyle=":", label="long run"
    )
    model = contact.scenario.model()
    axes.plot(lags[shown], autocovariance(model, lags[shown]) / mean**2, color=BLUE, label="the scenario")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.set(xlabel="lag (µm)", ylabel="autocovariance over mean²", title="How long the area remembers")


# Inference.

_SHOWN = 2000
_MOST = 1 << 20  # samples of an autocorrelation


def fit_page(found: InferenceResult, name: str, text: str) -> str:
    """Return a page of HTML, in the style of a run's report: estimates, five pictures, tests, the command's texts."""
    picture = as_bytes(fit_figure(found), "svg").decode("utf-8")
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


@house_style()
def fit_figure(found: InferenceResult) -> Figure:
    """Return trace, spectrum, residuals, autocorrelation and histogram as one figure."""
    fit, signal = found.fit, found.signal
    if fit is None:
        raise AssertionError("an inference that was refused has no picture")
    figure = new_figure(9.0, 10.5)
    panes: Any = figure.subplot_mosaic([["trace", "trace"], ["spectrum", "residuals"], ["memory", "histogram"]])
    shown, axes = signal.values[:_SHOWN], panes["trace"]
    axes.plot(signal.tick * np.arange(shown.size), shown, color=BLUE, linewidth=0.8)
    axes.set(xlabel="sliding distance (µm)", ylabel=f"trace ({signal.unit})", title=f"First {shown.size:,} samples")

    bands, mean, axes = fit.problem.bands, fit.expected.mean, panes["spectrum"]
    k = bands.wavenumber / signal.tick
    error = np.sqrt(fit.scatter.diagonal())
    unit = float(signal.values.std()) ** 2 * signal.tick
    axes.plot(k, bands.energy * unit, ".", color=BLUE, markersize=3, label="trace")
    axes.plot(k, mean * unit, color=VERMILION, label="expected")
    low = np.maximum(mean - 2.0 * error, 0.02 * mean)
    axes.fill_between(k, low * unit, (mean + 2.0 * error) * unit, color=VERMILION, alpha=0.2, linewidth=0)
    axes.set(xlabel="wavenumber (rad/µm)", ylabel=f"spectral density ({signal.unit}² µm)", title="Spectrum")
    axes.legend()

    residuals = panes["residuals"]
    residuals.plot(k, fit.residual / error, ".", color=BLUE, markersize=3)
    for level in (-2.0, 0.0, 2.0):
        residuals.axhline(level, color=VERMILION if level == 0.0 else FAINT, linewidth=0.8)
    residuals.set(xlabel="wavenumber (rad/µm)", ylabel="residual (standard errors)", title="Residuals")
    logarithmic(axes.xaxis, axes.yaxis, residuals.xaxis)

    values, life, axes = signal.values[:_MOST], 2.0 * fit.contact.diameter, panes["memory"]
    measured = sample_autocovariance(values, max(1, min(int(3.0 * life), values.size // 2)))
    axes.plot(signal.tick * np.arange(measured.size), measured / measured[0], color=BLUE, label="trace")
    axes.axhline(0.0, color=FAINT, linewidth=0.8)
    axes.axvline(life * signal.tick, color=VERMILION, linestyle="--", label="mean life")
    axes.set(xlabel="lag (µm)", ylabel="autocorrelation", title="Autocorrelation")
    axes.legend()

    panes["histogram"].hist(signal.values, bins=60, color=BLUE, density=True)
    panes["histogram"].set(xlabel=f"trace ({signal.unit})", ylabel=f"density (1/{signal.unit})", title="Histogram")
    return figure

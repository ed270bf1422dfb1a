"""Pictures of two surfaces under a load."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.figures.style import BLUE, FAINT, INK, VERMILION, as_bytes, house_style, logarithmic, new_figure
from rubnoise.surface.sliding import SlidingContact
from rubnoise.surface.waves import Waves
from rubnoise.theory.second_order import autocovariance

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_MOST_SHOWN: Final = 600
"""Points a side of a map as it is drawn; of more, the highest of some stand for them, so that no patch is lost."""

_BINS: Final = 60


def contact_picture(contact: SlidingContact) -> bytes:
    """Return a PNG of five panes: both surfaces with patches, bearing curve, spectra, number, autocovariance."""
    with house_style():
        return as_bytes(contact_figure(contact), "png")


def contact_figure(contact: SlidingContact) -> "Figure":
    """Return the figure of a contact, to be called within `house_style()`."""
    figure = new_figure(9.0, 10.5)
    grid = figure.add_gridspec(3, 2)
    total = contact.heights
    _draw_map(figure.add_subplot(grid[0, 0]), total, contact)
    _draw_bearing(figure.add_subplot(grid[0, 1]), total, contact)
    _draw_spectra(figure.add_subplot(grid[1, 0]), contact)
    _draw_counts(figure.add_subplot(grid[1, 1]), contact)
    _draw_autocovariance(figure.add_subplot(grid[2, :]), contact)
    return figure


def _draw_map(axes: "Axes", total: Doubles, contact: SlidingContact) -> None:
    count = max(1, round(contact.share * total.size))
    gap = np.partition(total, total.size - count, axis=None)[total.size - count]
    blocks = [-(-n // _MOST_SHOWN) for n in total.shape]
    cut = total[: total.shape[0] // blocks[0] * blocks[0], : total.shape[1] // blocks[1] * blocks[1]]
    shown = cut.reshape(cut.shape[0] // blocks[0], blocks[0], cut.shape[1] // blocks[1], blocks[1]).max((1, 3))
    along, across = (n * s for n, s in zip(total.shape, contact.slider.spacing, strict=True))
    from matplotlib.colors import ListedColormap

    look: dict[str, Any] = {"origin": "lower", "extent": (0.0, along, 0.0, across), "interpolation": "nearest"}
    axes.imshow(shown.T, cmap="Greys", **look)
    axes.imshow(np.where(shown >= gap, 1.0, np.nan).T, cmap=ListedColormap([VERMILION]), **look)
    axes.set(xlabel="along the sliding (µm)", ylabel="across (µm)", title="Both heights, patches of contact in red")


def _draw_bearing(axes: "Axes", total: Doubles, contact: SlidingContact) -> None:
    rms = contact.gaussian.roughness
    heights = np.sort(total, axis=None)[::-1] / rms
    shares = np.geomspace(3.0 / heights.size, 0.5, _BINS)
    from scipy.special import ndtri

    axes.semilogx(100.0 * shares, heights[(shares * heights.size).astype(int)], color=BLUE, label="maps")
    axes.semilogx(100.0 * shares, -ndtri(shares), color=VERMILION, label="Gaussian")
    axes.axvline(100.0 * contact.share, color=FAINT, linestyle="--", label="under the load")
    axes.set(xlabel="share of the area above (%)", ylabel="height over rms", title="Bearing curve")
    logarithmic(axes.xaxis)
    axes.legend()


def _draw_spectra(axes: "Axes", contact: SlidingContact) -> None:
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
    axes.legend()


def _draw_counts(axes: "Axes", contact: SlidingContact) -> None:
    cutoffs, counts = contact.count_over_cutoff()
    axes.loglog(cutoffs, counts, color=VERMILION, marker="o", markersize=3, label="exact, Gaussian")
    area = contact.counted.map_area / contact.nominal_area
    axes.loglog([contact.cutoff], [contact.counted.patch_count / area], "s", color=BLUE, label="counted")
    axes.axvline(contact.cutoff, color=FAINT, linestyle="--")
    axes.set(xlabel="cut-off (µm)", ylabel="junctions", title="Number of junctions over the cut-off")
    logarithmic(axes.xaxis, axes.yaxis)
    axes.legend()


def _draw_autocovariance(axes: "Axes", contact: SlidingContact) -> None:
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
    axes.legend()

"""The phase plane of a slider: its velocity over its displacement, beside the speed of the drive."""

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.figures.marks import entitle
from rubnoise.figures.motion import Motion, motions_of, names_of
from rubnoise.figures.motion_spectrum import looks
from rubnoise.figures.slider import shown_together
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import INK, VERMILION, logarithmic, new_figure
from rubnoise.theory.response import response

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MILLI: Final = 1e-3
MOST_ON_A_PATH: Final = 60_000
"""Rows that are joined to a path; of more it would be a blot, and is drawn as a density alone."""

BINS: Final = (180, 140)
SHADES: Final = ("#dcebf5", "#0072b2", "#04213a")
"""From rarely to often; a grey printer keeps them in order."""

COARSE: Final = 0.05
"""Natural periods between two rows above which a path has corners that the motion has not."""

HEADROOM: Final = 0.06
"""Least room above the drive's speed, as a share of all speeds: a slider that sticks rides there."""

COLUMNS: Final = ("displacement", "velocity")
PLACE: Final = "displacement (µm)"
SPEED: Final = "velocity (mm/s)"


def phase_figure(stretch: Stretch, beside: Stretch | None = None) -> "Figure":
    """Draw the path of a slider in the phase plane, and beside it where it is how often in the whole stretch.

    A slider that sticks rides on the horizontal line at the drive's speed V. Of a one-way slider the ellipse of the
    exact standard deviations is drawn. Another run is laid over the first at the same times, and no density is drawn.
    Raises Refused for a run without a slider.
    """
    whole = motions_of(stretch, beside)
    shown = shown_together(stretch, whole)
    first, more = shown[0], whole[0].last - whole[0].first
    path, density = more <= MOST_ON_A_PATH or not stretch.chosen, len(whole) == 1 and first.last < whole[0].last
    density |= not path
    figure = new_figure(7.2, 4.2)
    entitle(figure, stretch, "The phase plane of the slider", beside)
    panes = figure.subplots(1, path + density, sharex=True, sharey=True, squeeze=False)[0].tolist()
    if path:
        _draw_path(panes[0], shown)
    if density:
        _draw_density(panes[-1], whole[0])
    for axes in panes:
        _mark(axes, first, alone=len(whole) == 1)
        axes.set_xlabel(PLACE)
    panes[0].set_ylabel(SPEED)
    low, high = panes[0].get_ylim()
    panes[0].set_ylim(low, max(high, MILLI * first.speed + HEADROOM * (high - low)))
    figure.legend(*panes[0].get_legend_handles_labels(), loc="outside lower right", ncols=3)
    return figure


def _draw_path(axes: "Axes", motions: Sequence[Motion]) -> None:
    labels = ["simulated"] if len(motions) == 1 else names_of(motions)
    for motion, label, look in zip(motions, labels, looks(len(motions)), strict=True):
        place, speed = (motion.file.column("slider", name, motion.first, motion.last) for name in COLUMNS)
        axes.plot(place, MILLI * speed, label=label, **look)
    coarse = max(motions, key=lambda motion: motion.apart)
    note = f", a row every {coarse.apart:.3g} s" if coarse.apart * coarse.slider.natural_frequency > COARSE else ""
    axes.set_title(f"the path, {_times(motions[0])}{note}", fontsize=8.5)


def _draw_density(axes: "Axes", motion: Motion) -> None:
    """Draw which share of the time is spent in each small box of the plane, in logarithmic shades."""
    from matplotlib.colors import LinearSegmentedColormap, LogNorm

    share, edges = shares(motion)
    shades = LinearSegmentedColormap.from_list("often", SHADES)
    drawn = axes.pcolormesh(
        edges[0],
        MILLI * edges[1],
        np.ma.masked_equal(share.T, 0.0),
        cmap=shades,
        norm=LogNorm(vmin=float(share[share > 0.0].min()), vmax=float(share.max())),
        rasterized=True,
    )
    axes.set_title(f"how often it is where, {_times(motion)}", fontsize=8.5)
    bar = axes.figure.colorbar(drawn, ax=axes, pad=0.02, label="share of the time in a box")
    logarithmic(bar.ax.yaxis)


def _times(motion: Motion) -> str:
    return f"{motion.begin:.4g} to {motion.end:.4g} s"


def shares(motion: Motion) -> tuple[Doubles, tuple[Doubles, Doubles]]:
    """Return the shares of the rows in boxes of the plane, and the boxes' edges in um and um/s."""
    edges = tuple(_edges(motion, name, count) for name, count in zip(COLUMNS, BINS, strict=True))
    counts = np.zeros(BINS)
    for place, speed in zip(*(motion.panels(name) for name in COLUMNS), strict=True):
        counts += np.histogram2d(place, speed, bins=edges)[0]
    return counts / counts.sum(), (edges[0], edges[1])


def _edges(motion: Motion, name: str, count: int) -> Doubles:
    low, high = np.inf, -np.inf
    for panel in motion.panels(name):
        low, high = min(low, float(panel.min())), max(high, float(panel.max()))
    slack = 1e-9 * max(abs(low), abs(high), 1e-9) + 1e-3 * (high - low)
    return np.linspace(low - slack, high + slack, count + 1)


def _mark(axes: "Axes", motion: Motion, *, alone: bool) -> None:
    """Mark the drive's speed, and, about a one-way slider alone, the ellipse of the exact standard deviations."""
    drive = MILLI * motion.speed
    label = f"speed V of the drive, {drive:.4g} mm/s"
    axes.axhline(drive, color=INK, lw=0.8, ls=(0, (1, 2)), zorder=0.5, label=label)
    if motion.model.is_two_way or not alone:
        return
    exact = response(motion.model)
    if isfinite(exact.displacement_std):
        turn = np.linspace(0.0, 2.0 * np.pi, 200)
        place = exact.mean_displacement + exact.displacement_std * np.cos(turn)
        speed = MILLI * exact.velocity_std * np.sin(turn)
        axes.plot(place, speed, color=VERMILION, lw=1.4, zorder=5, label="exact standard deviations")

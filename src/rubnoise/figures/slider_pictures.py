"""Pictures of a slider: its motion in time and in the phase plane, its landmarks, and a run at a glance."""

from math import isfinite
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.landmarks import Flights, Sticks
from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.errors import Refused
from rubnoise.figures.panes import draw_along, draw_counts, draw_density, draw_layers, looks_of
from rubnoise.figures.spectra import draw_spectra, spectrum_of
from rubnoise.figures.style import DISTANCE, INK, VERMILION, fitting_columns
from rubnoise.figures.tracks import MOST_READ, Stretch, Track, at_the_same, tracks_of
from rubnoise.theory.motion import response

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_motion(figure: "Figure", stretch: Stretch, beside: Stretch | None = None) -> str:
    """Draw force and displacement in time, and the displacement's spectrum if the stretch has enough rows."""
    whole = tracks_of(stretch, beside, "displacement")
    driven = tracks_of(stretch, beside, "base" if all(map(_is_lifted, whole)) else "force")
    try:
        found = [(track, spectrum_of(track)) for track in whole]
    except Refused:
        found = []
    heights = [1.0, 1.0, 1.5] if found else [1.0, 1.0]
    force, place, *below = figure.subplots(len(heights), 1, height_ratios=heights)
    place.sharex(force)
    draw_along(place, at_the_same(whole))
    draw_along(force, [track.between(*place.get_xlim()) for track in driven], last=False)
    if found:
        draw_spectra(below[0], found)
    figure.align_ylabels([force, place])
    return f"The {'base' if _is_lifted(whole[0]) else 'friction force'}, and the vibration that it excites"


def _is_lifted(track: Track) -> bool:
    """Whether asperities lift the slider's base, in place of a friction force."""
    return track.swings is not None and track.swings.excitation == "base"


MOST_ON_A_PATH: Final = 60_000
"""Rows that are joined to a path; of more it would be a blot, and is drawn as a density alone."""

COARSE, HEADROOM = 0.05, 0.06
"""Natural periods from row to row above which a path has corners; room above the drive's speed over all speeds."""


def draw_phase(figure: "Figure", stretch: Stretch, beside: Stretch | None = None) -> str:
    """Draw the path of a slider in the phase plane, and beside it the density of its places in the whole stretch.

    A slider that sticks is on the horizontal line at the drive's speed V. For a one-way slider the ellipse of the exact
    standard deviations is drawn. Another run is drawn over the first at the same times, without the density.
    """
    whole, speeds = (tracks_of(stretch, beside, name) for name in ("displacement", "velocity"))
    shown = at_the_same(whole)
    first, rows = shown[0], whole[0].last - whole[0].first
    path, density = rows <= MOST_ON_A_PATH or not stretch.chosen, len(whole) == 1 and first.last < whole[0].last
    density |= not path
    panes = figure.subplots(1, path + density, sharex=True, sharey=True, squeeze=False)[0].tolist()
    if path:
        for track, fast, look in zip(shown, speeds, looks_of(shown), strict=True):
            panes[0].plot(track.record(), fast.between(first.begin, first.end).record(), **look)
        coarse = max(shown, key=lambda track: track.step)
        note = f", a row every {coarse.step:.3g} s" if coarse.step * coarse.natural > COARSE else ""
        panes[0].set_title(f"the path, {first.begin:.4g} to {first.end:.4g} s{note}", fontsize="medium")
    if density:
        draw_density(panes[-1], whole[0].record(), speeds[0].record())
        span = f"{whole[0].begin:.4g} to {whole[0].end:.4g} s"
        panes[-1].set_title(f"share of the time, {span}", fontsize="medium")
    drive = 1e-3 * (stretch.model.sliding_speed or 0.0)
    for axes in panes:
        label = f"speed V of the drive, {drive:.4g} mm/s"
        axes.axhline(drive, color=INK, lw=0.8, ls=(0, (1, 2)), zorder=0.5, label=label)
        if first.has_theory and len(whole) == 1:
            _draw_ellipse(axes, stretch)
        axes.set_xlabel(first.quantity.label)
    panes[0].set_ylabel(speeds[0].quantity.label)
    low, high = panes[0].get_ylim()
    panes[0].set_ylim(low, max(high, drive + HEADROOM * (high - low)))
    handles, labels = panes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower right", ncols=fitting_columns(figure.figure, labels, 3))
    return "The phase plane of the slider"


def _draw_ellipse(axes: "Axes", stretch: Stretch) -> None:
    known, turn = response(stretch.model), np.linspace(0.0, 2.0 * np.pi, 200)
    if isfinite(known.displacement_std):
        place = known.mean_displacement + known.displacement_std * np.cos(turn)
        speed = 1e-3 * known.velocity_std * np.sin(turn)
        axes.plot(place, speed, color=VERMILION, lw=1.4, zorder=5, label="exact standard deviations")


MOST_IMPACTS: Final = 200
"""Impacts that are marked: with more, the marks would hide one another."""


def draw_load(figure: "Figure", stretch: Stretch, beside: Stretch | None = None) -> str:
    """Draw load, separation and normal velocity in time; of free motion the exact mean load, flights and impacts."""
    panes, names = figure.subplots(3, 1, sharex=True), ("load", "separation", "normal-velocity")
    for axes, name in zip(panes, names, strict=True):
        draw_along(axes, at_the_same(tracks_of(stretch, beside, name)), last=axes is panes[-1])
    panes[-1].set_ylabel("normal velocity\n(mm/s)")
    fall = Track.of(stretch, "normal-velocity").shown()
    found = fall.landmarks()
    if beside is None and isinstance(found, Flights):
        mean = 1e-3 * (stretch.model.load or 0.0)
        panes[0].axhline(mean, color=VERMILION, lw=1.2, zorder=4, label="exact mean")
        if found.impacts.size <= MOST_IMPACTS:
            falling = np.interp(found.impacts, *fall.curve())
            panes[2].plot(found.impacts, falling, "o", color=INK, ms=3.2, mfc="white", mew=0.8, label="impact")
    figure.align_ylabels(panes.tolist())
    return "The slider on its load"


def draw_landmarks(figure: "Figure", stretch: Stretch) -> str:
    """Draw how far a slider slips and how long it sticks, or how fast it hits the surface and how long it flies."""
    held, model = stretch.model.held, stretch.model
    free = held is not None and not stretch.has_theory
    if not (free or model.is_two_way):
        raise Refused(
            'the slider has no landmarks: only with slider.coupling = "two-way" does it stick and slip;'
            " rubnoise plot RUN.h5 phase shows this one"
        )
    track = Track.of(stretch, "load" if free else "displacement")
    found, span = track.landmarks(), f"between {track.begin:.4g} and {track.end:.4g} s"
    left, right = figure.subplots(1, 2)
    if isinstance(found, Sticks):
        if not (found.slip_lengths.size or found.times.size):
            raise Refused(f"the slider ends no slip and no stick {span}")
        title = "Slip lengths and stick times"
        longer = int((found.slip_lengths > model.calibrated_diameter).sum())
        diameter = model.calibrated_diameter, f"mean diameter; {longer:,} slips are longer"
        draw_counts(left, found.slip_lengths, "slip", "slip length", "µm", diameter)
        draw_counts(right, 1e3 * found.times, "stick", "stick time", "ms", (1e3 / track.natural, NATURAL_PERIOD))
    else:
        if not (isinstance(found, Flights) and held is not None and found.impacts.size):
            raise Refused(f"the slider does not fall back on the surface {span}")
        off = 100.0 * found.share(track.begin, track.end)
        title = f"Impact speeds and flight times; off the surface for {off:.3g} % of the time"
        rise = 2e-3 * np.pi * track.natural * held.height_scale, "height scale times contact resonance"
        draw_counts(left, 1e-3 * found.speeds, "impact", "impact speed", "mm/s", rise)
        draw_counts(right, 1e3 * found.times, "flight", "flight time", "ms", (1e3 / track.natural, CONTACT_PERIOD))
    part = f", of its first {MOST_READ:,} landmarks" if stretch.file.rows("landmarks") > MOST_READ else ""
    return title + part


NATURAL_PERIOD, CONTACT_PERIOD = "natural period", "period of the contact resonance"

# A run at a glance.

WINDOW_LIVES: Final = 4.0
"""Width of the window around the junction, in its own lives."""


def draw_overview(figure: "Figure", stretch: Stretch) -> str:
    """Draw a run, and the life of one of its junctions: one in its middle, of about the mean diameter.

    Below are force and displacement of its slider, without one area and count beside theory. Raises Refused for a run
    without junctions.
    """
    junction, slider = _chosen(stretch), stretch.model.slider
    below = ["area", "count"]
    if slider is not None:
        below = ["base" if slider.excitation == "base" else "force", "displacement"]
    layout: Any = [["sum", "sum", "life"], *([name] * 3 for name in below)]
    axes: Any = figure.subplot_mosaic(layout)
    _draw_sum(axes["sum"], stretch, junction)
    _draw_life(axes["life"], junction)
    upper, lower = (Track.of(stretch, name) for name in below)
    lower = lower.shown()
    draw_along(axes[below[0]], [upper.between(lower.begin, lower.end)], last=False)
    draw_along(axes[below[1]], [lower])
    axes[below[0]].sharex(axes[below[1]])
    for name in below:  # the panes are low
        axes[name].set_ylabel(axes[name].get_ylabel().replace("contact ", "contact\n").replace("live ", "live\n"))
    return f"The run at a glance, and the life of junction {junction.rows[0]} (black)"


def _chosen(stretch: Stretch) -> Neighbours:
    """Return the junction of about the mean diameter among those that are born in a life in the middle."""
    rows = stretch.file.rows("junctions")
    if rows == 0:
        raise Refused("no junction lives in this run; there is nothing to draw")
    middle = 0.5 * (stretch.start + stretch.stop)
    first = min(stretch.first_born(middle), rows - 1)
    last = max(stretch.first_born(middle + stretch.model.mean_life_distance), first + 1)
    diameter = stretch.file.column("junctions", "diameter", first, last)
    number = first + int(np.argmin(np.abs(diameter - stretch.model.sizes.moment(1))))
    begin = float(stretch.file.column("junctions", "birth_distance", number, number + 1)[0])
    alive = neighbours(stretch.file, -1, begin, begin)
    return alive.chosen(alive.rows == number)


def _draw_sum(axes: "Axes", stretch: Stretch, junction: Neighbours) -> None:
    birth, life = float(junction.birth[0]), float(junction.death[0] - junction.birth[0])
    first = max(birth - 0.5 * (WINDOW_LIVES - 1.0) * life, 0.0)
    window = np.linspace(first, first + WINDOW_LIVES * life, 1200)
    alive = neighbours(stretch.file, -1, float(window[0]), float(window[-1]))
    draw_layers(axes, window, alive.areas(window), int(np.argmax(alive.rows == junction.rows[0])), INK)
    axes.set(xlim=(window[0], window[-1]), xlabel=DISTANCE, ylabel="area (µm²)")
    axes.set_ylim(bottom=0.0)


def _draw_life(axes: "Axes", junction: Neighbours) -> None:
    distance = np.linspace(float(junction.birth[0]), float(junction.death[0]), 400)
    age, area = distance - distance[0], junction.areas(distance)[0]
    axes.fill_between(age, area, color=INK, alpha=0.18, lw=0.0)
    axes.plot(age, area, color=INK, lw=2.2)
    axes.set(xlim=(0.0, age[-1]), xlabel="since its birth (µm)", ylabel="its area (µm²)")
    axes.set_ylim(bottom=0.0)

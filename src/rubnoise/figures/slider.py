"""The motion of the slider: force and displacement in time, its phase plane, and its slips and sticks."""

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.motion import Motion, labels_of, motions_of, prefix_refusals, shade_flights, shade_sticks
from rubnoise.figures.motion_spectrum import curve_styles, draw_spectra, spectrum_of
from rubnoise.figures.stretch import MOST_READ, Stretch
from rubnoise.figures.style import (
    BLUE,
    INK,
    VERMILION,
    add_title,
    exact_band,
    fitting_columns,
    legend_above,
    logarithmic,
    new_figure,
    widen_if_constant,
)
from rubnoise.theory.coupling import load_motion
from rubnoise.theory.moments import area_cumulants, force_cumulants
from rubnoise.theory.motion import response

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MILLI: Final = 1e-3


def slider_figure(stretch: Stretch, beside: Stretch | None = None) -> "Figure":
    """Draw force and displacement in time, and the displacement's spectrum if the stretch has enough rows.

    Exact values are known only for one-way coupling; sticks of a two-way slider are shaded. Another run is drawn over
    the first at the same times. Raises Refused for a run without a slider.
    """
    whole = motions_of(stretch, beside)
    shown = same_times(stretch, whole)
    seen = [(motion, spectrum) for motion in whole if (spectrum := spectrum_of(motion, "displacement")) is not None]
    figure = new_figure(7.2, 6.6 if seen else 4.2)
    add_title(figure, stretch, f"The {whole[0].driven_by}, and the vibration that it excites", beside)
    heights = [1.0, 1.0, 1.5] if seen else [1.0, 1.0]
    force, place, *below = figure.subplots(len(heights), 1, height_ratios=heights)
    place.sharex(force)
    if all(motion.driven_by_base for motion in whole):
        draw_in_time(force, shown, "base_displacement", 1.0)
        force.set_ylabel("height of the base (µm)")
    else:
        draw_in_time(force, shown, "friction_force", MILLI)
        force.set_ylabel("friction force (mN)")
    force.tick_params(labelbottom=False)
    legend_above(force)
    draw_in_time(place, shown, "displacement", 1.0)
    place.set_ylabel("displacement (µm)")
    place.set_xlabel("time (s)")
    if seen:
        draw_spectra(below[0], seen, "displacement")
    figure.align_ylabels([force, place])
    return figure


def same_times(stretch: Stretch, motions: Sequence[Motion]) -> list[Motion]:
    """Return the shown parts of motions: by default the beginning, and the same times of all of them.

    Raises Refused if one of them is over before another begins.
    """
    first = motions[0] if stretch.chosen else motions[0].beginning()
    shown = [first]
    for other in motions[1:]:
        with prefix_refusals(f"--with {other.file.path}"):
            shown.append(other.between(first.begin, first.end))
    return shown


def draw_in_time(axes: "Axes", motions: Sequence[Motion], name: str, scale: float) -> None:
    """Draw a column of some motions over time, with exact mean and spread if theory knows them.

    Sticks of a two-way slider and flights of a free one are shaded.
    """
    first = motions[0]
    known = _exact_moments(first, name) if len(motions) == 1 else None
    if known is not None:
        mean, std = known
        exact_band(axes, scale * mean, scale * std)
    for motion, label, look in zip(motions, labels_of(motions), curve_styles(len(motions)), strict=True):
        time, values = motion.curve(name)
        axes.plot(time, scale * values, label=label, **look)
    shade_sticks(axes, next((motion for motion in motions if motion.model.is_two_way), first))
    shade_flights(axes, first)
    axes.set_xlim(first.begin, first.end)
    widen_if_constant(axes)


def _exact_moments(motion: Motion, name: str) -> tuple[float, float] | None:
    """Return the exact mean and standard deviation of a column, None if theory does not know them."""
    if motion.model.is_two_way or motion.model.free is not None:
        return None
    if motion.group == "load":
        rises = load_motion(motion.model)
        spreads = {"separation": rises.separation_std, "velocity": rises.velocity_std, "load": rises.load_std}
        return motion.model.load or 0.0 if name == "load" else 0.0, spreads[name]
    if name == "friction_force":
        force = force_cumulants(motion.model)
        return force.mean, force.std
    exact = response(motion.model)
    if name == "base_displacement":
        return exact.mean_displacement, motion.model.base_per_area * area_cumulants(motion.model).std
    if name == "velocity":
        return 0.0, exact.velocity_std
    return exact.mean_displacement, exact.displacement_std


MOST_ON_A_PATH: Final = 60_000
"""Rows that are joined to a path; of more it would be a blot, and is drawn as a density alone."""

BOXES: Final = (180, 140)
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
    """Draw the path of a slider in the phase plane, and beside it the density of its places in the whole stretch.

    A slider that sticks is on the horizontal line at the drive's speed V. For a one-way slider the ellipse of the exact
    standard deviations is drawn. Another run is drawn over the first at the same times, without the density.
    Raises Refused for a run without a slider.
    """
    whole = motions_of(stretch, beside)
    shown = same_times(stretch, whole)
    first, more = shown[0], whole[0].last - whole[0].first
    path, density = more <= MOST_ON_A_PATH or not stretch.chosen, len(whole) == 1 and first.last < whole[0].last
    density |= not path
    figure = new_figure(7.2, 4.2)
    add_title(figure, stretch, "The phase plane of the slider", beside)
    panes = figure.subplots(1, path + density, sharex=True, sharey=True, squeeze=False)[0].tolist()
    if path:
        _draw_path(panes[0], shown)
    if density:
        _draw_density(panes[-1], whole[0])
    for axes in panes:
        _mark_exact(axes, first, alone=len(whole) == 1)
        axes.set_xlabel(PLACE)
    panes[0].set_ylabel(SPEED)
    low, high = panes[0].get_ylim()
    panes[0].set_ylim(low, max(high, MILLI * first.speed + HEADROOM * (high - low)))
    handles, labels = panes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower right", ncols=fitting_columns(figure.figure, labels, 3))
    return figure


def _draw_path(axes: "Axes", motions: Sequence[Motion]) -> None:
    for motion, label, look in zip(motions, labels_of(motions), curve_styles(len(motions)), strict=True):
        place, speed = (motion.file.column("slider", name, motion.first, motion.last) for name in COLUMNS)
        axes.plot(place, MILLI * speed, label=label, **look)
    coarse = max(motions, key=lambda motion: motion.apart)
    note = f", a row every {coarse.apart:.3g} s" if coarse.apart * coarse.slider.natural_frequency > COARSE else ""
    axes.set_title(f"the path, {_time_range(motions[0])}{note}", fontsize="medium")


def _draw_density(axes: "Axes", motion: Motion) -> None:
    """Draw the share of the time in each small box of the plane, in logarithmic shades."""
    from matplotlib.colors import LinearSegmentedColormap, LogNorm

    share, edges = time_shares(motion)
    shades = LinearSegmentedColormap.from_list("often", SHADES)
    drawn = axes.pcolormesh(
        edges[0],
        MILLI * edges[1],
        np.ma.masked_equal(share.T, 0.0),
        cmap=shades,
        norm=LogNorm(vmin=float(share[share > 0.0].min()), vmax=float(share.max())),
        rasterized=True,
    )
    axes.set_title(f"how often it is where, {_time_range(motion)}", fontsize="medium")
    bar = axes.figure.colorbar(drawn, ax=axes, pad=0.02, label="share of the time in a box")
    logarithmic(bar.ax.yaxis)


def _time_range(motion: Motion) -> str:
    return f"{motion.begin:.4g} to {motion.end:.4g} s"


def time_shares(motion: Motion) -> tuple[Doubles, tuple[Doubles, Doubles]]:
    """Return the shares of the rows in boxes of the plane, and the boxes' edges in um and um/s."""
    edges = tuple(_box_edges(motion, name, count) for name, count in zip(COLUMNS, BOXES, strict=True))
    counts = np.zeros(BOXES)
    for place, speed in zip(*(motion.chunks(name) for name in COLUMNS), strict=True):
        counts += np.histogram2d(place, speed, bins=edges)[0]
    return counts / counts.sum(), (edges[0], edges[1])


def _box_edges(motion: Motion, name: str, count: int) -> Doubles:
    low, high = np.inf, -np.inf
    for chunk in motion.chunks(name):
        low, high = min(low, float(chunk.min())), max(high, float(chunk.max()))
    slack = 1e-9 * max(abs(low), abs(high), 1e-9) + 1e-3 * (high - low)
    return np.linspace(low - slack, high + slack, count + 1)


def _mark_exact(axes: "Axes", motion: Motion, *, alone: bool) -> None:
    """Mark the drive's speed, and for a single one-way slider the ellipse of the exact standard deviations."""
    drive = MILLI * motion.speed
    label = f"speed V of the drive, {drive:.4g} mm/s"
    axes.axhline(drive, color=INK, lw=0.8, ls=(0, (1, 2)), zorder=0.5, label=label)
    if motion.model.is_two_way or motion.model.free is not None or not alone:
        return
    exact = response(motion.model)
    if isfinite(exact.displacement_std):
        turn = np.linspace(0.0, 2.0 * np.pi, 200)
        place = exact.mean_displacement + exact.displacement_std * np.cos(turn)
        speed = MILLI * exact.velocity_std * np.sin(turn)
        axes.plot(place, speed, color=VERMILION, lw=1.4, zorder=5, label="exact standard deviations")


PER_DECADE: Final = 8
"""Bins for each factor of ten."""

MOST_DECADES: Final = 8


def landmarks_figure(stretch: Stretch) -> "Figure":
    """Draw the histograms of slip lengths and stick durations, in bins of equal ratio.

    They show the mean diameter of a junction and the slider's natural period for comparison. For a slider that may
    leave its contact, they are those of impact speeds and flight durations. Raises Refused for a run without landmarks,
    and if nothing of the kind occurs.
    """
    if stretch.model.held is not None and not stretch.has_theory:
        return _flights_figure(stretch, stretch.model.held.height_scale)
    if not stretch.model.is_two_way:
        raise Refused(
            'the slider has no landmarks: only with slider.coupling = "two-way" does it stick and slip;'
            " rubnoise plot RUN.h5 phase shows this one"
        )
    motion = Motion.of(stretch)
    found = motion.stick_slip()
    if not (found.slip_lengths.size or found.stick_times.size):
        raise Refused(f"the slider ends no slip and no stick between {motion.begin:.4g} and {motion.end:.4g} s")
    figure = new_figure(7.2, 3.6)
    add_title(figure, stretch, f"How far the slider slips and how long it sticks{_part_shown(motion)}")
    slips, sticks = figure.subplots(1, 2)
    _draw_counts(slips, found.slip_lengths, "slip", "slip length", "µm", 1.0)
    diameter = stretch.model.calibrated_diameter
    longer = int((found.slip_lengths > diameter).sum())
    _mark_reference(slips, diameter, f"mean diameter; {longer:,} slips are longer")
    _draw_counts(sticks, found.stick_times, "stick", "stick time", "ms", 1e3)
    _mark_reference(sticks, 1e3 / motion.slider.natural_frequency, "natural period")
    return figure


def _flights_figure(stretch: Stretch, height_scale: float) -> "Figure":
    motion = Motion.of(stretch, "load")
    found = motion.flights()
    if found is None or not found.impacts.size:
        raise Refused(f"the slider does not fall back on the surface between {motion.begin:.4g} and {motion.end:.4g} s")
    figure = new_figure(7.2, 3.6)
    off = 100.0 * found.share(motion.begin, motion.end)
    shown = f"How fast overlaps grow at impacts, and how long the slider was off: {off:.3g} % of the time"
    add_title(figure, stretch, f"{shown}{_part_shown(motion)}")
    speeds, times = figure.subplots(1, 2)
    _draw_counts(speeds, found.speeds, "impact", "impact speed", "mm/s", MILLI)
    _draw_counts(times, found.times, "flight", "flight time", "ms", 1e3)
    period = 1.0 / motion.slider.natural_frequency
    rise = motion.slider.natural_angular_frequency * height_scale
    _mark_reference(speeds, MILLI * rise, "height scale times contact resonance")
    _mark_reference(times, 1e3 * period, "period of the contact resonance")
    return figure


def _part_shown(motion: Motion) -> str:
    """Return a note if not all landmarks are shown."""
    total = motion.file.rows("landmarks")
    return f", of its first {MOST_READ:,} landmarks" if total > MOST_READ else ""


def _draw_counts(axes: "Axes", values: Doubles, what: str, label: str, unit: str, scale: float) -> None:
    """Draw the counts of values in bins; values of 0 are counted in the legend."""
    shown = scale * values[values > 0.0]
    nothing = values.size - shown.size
    axes.set_xlabel(f"{label} ({unit})")
    axes.set_ylabel(f"number of {what}s")
    if not values.size:
        axes.set_ylim(0.0, 1.0)
        axes.text(0.5, 0.5, f"no {what}s", transform=axes.transAxes, ha="center")
    if shown.size:
        edges = ratio_bins(shown)
        name = f"{values.size:,} {what}{'s' * (values.size != 1)}" + (f", {nothing:,} of them 0" if nothing else "")
        axes.hist(np.maximum(shown, edges[0]), bins=edges.tolist(), color=BLUE, alpha=0.55, lw=0.0, label=name)
        median = scale * float(np.median(values))
        axes.axvline(median, color=INK, lw=1.2, label=f"median {median:.3g} {unit}")
        logarithmic(axes.xaxis)
        axes.set_xlim(edges[0], edges[-1])
    axes.locator_params(axis="y", integer=True)


def ratio_bins(values: Doubles) -> Doubles:
    """Return the edges of bins of equal ratio, which include a power of ten and the largest of some values > 0."""
    highest = np.ceil(PER_DECADE * np.log10(values.max()) + 1e-9)
    lowest = max(np.floor(PER_DECADE * np.log10(values.min())), highest - PER_DECADE * MOST_DECADES)
    return 10.0 ** (np.arange(lowest, highest + 1.0) / PER_DECADE)


def _mark_reference(axes: "Axes", place: float, label: str) -> None:
    """Mark a length or a time for comparison, if anything is drawn."""
    if axes.get_xscale() != "log":
        return
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, 0.8 * place), max(high, 1.25 * place))
    axes.axvline(place, color=VERMILION, lw=1.2, ls=(0, (5, 3)), label=label)
    legend_above(axes, columns=1)

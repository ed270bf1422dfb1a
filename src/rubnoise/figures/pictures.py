"""The pictures of a run: each draws its panes into a figure and returns its title."""

from collections.abc import Mapping
from contextlib import suppress
from math import isfinite
from typing import Any, Final, Literal

import numpy as np

from rubnoise.analysis.junctions import Life, Neighbours, neighbours
from rubnoise.analysis.moments import covariance_errors
from rubnoise.analysis.motion import Flights, Sticks
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.errors import Refused
from rubnoise.figures import Figure, panes, style
from rubnoise.figures.panes import draw_along
from rubnoise.figures.style import BLUE, FAINT, INK, VERMILION
from rubnoise.figures.tracks import MOST_READ, Stretch, Track, at_the_same, tracks_of
from rubnoise.inference.signal import autocovariance
from rubnoise.record.rows import JunctionState
from rubnoise.theory import second_order
from rubnoise.theory.moments import area_cumulants, distribution, share_of


def draw_trace(figure: Figure, stretch: Stretch) -> str:
    """Draw A_r of a stretch, and above it the place of the stretch in the whole record."""
    whole, shown = Track.of(stretch.whole(), "area"), Track.of(stretch, "area").shown()
    if shown.ends == whole.ends:
        axes = figure.subplots()
    else:
        strip, axes = figure.subplots(2, 1, height_ratios=[1, 2.6])
        strip.axvspan(*shown.ends, color=style.PALE, lw=0.0, zorder=0)
        strip.plot(*whole.curve(), color=FAINT, lw=0.5)
        strip.set(xlim=whole.ends, xlabel="sliding distance (µm), the stretch below shaded", ylabel="µm²")
        strip.set_ylim(bottom=0.0)
    draw_along(axes, [shown])
    return "The real contact area"


def draw_count(figure: Figure, stretch: Stretch) -> str:
    """Draw N(s) of the stretch's beginning, and beside it the share of each live count in the whole stretch."""
    along, often = figure.subplots(1, 2, width_ratios=[2.2, 1])
    track = Track.of(stretch, "count")
    draw_along(along, [track.shown()], drawstyle="steps-post")
    counts = np.bincount(track.record().astype(np.int64))
    numbers = np.arange(int(np.flatnonzero(counts)[0]), counts.size)
    look: dict[str, Any] = {"width": 1.0, "color": BLUE, "alpha": 0.45, "lw": 0.0, "label": "simulated"}
    often.bar(numbers, counts[numbers] / counts.sum(), **look)
    mean = stretch.model.mean_live_junctions
    if stretch.has_theory and isinstance(stretch.model.births, PoissonBirths):
        from scipy.special import gammaln

        law = np.exp(numbers * np.log(mean) - mean - gammaln(numbers + 1.0))
        often.plot(numbers, law, "o", color=VERMILION, ms=3.0, label="exact: Poisson")
    elif stretch.has_theory:
        often.axvline(mean, color=VERMILION, label="exact mean")
    along.locator_params(axis="y", integer=True)
    often.locator_params(axis="x", integer=True)
    often.set(xlabel=track.quantity.label, ylabel="share of the ticks")
    return "Live junctions"


LAGS, LAG_LIVES = 80, 1.6  # lags that are shown, and to how many mean lives


def draw_acf(figure: Figure, stretch: Stretch) -> str:
    """Draw the autocovariance of A_r over a stretch, R(tau), and the band with 95 % of estimates at each lag."""
    track, axes, model = Track.of(stretch, "area"), figure.subplots(), stretch.model
    reach = min(int(LAG_LIVES * model.mean_life_distance / track.step) + 1, (track.last - track.first) // 2)
    steps, values = np.arange(0, reach + 1, max(1, reach // LAGS)), track.record()
    seen = autocovariance(values, reach)[steps] / (1.0 - steps / values.size)  # over the pairs of each lag
    if stretch.has_theory:
        lag = np.linspace(0.0, float(track.step * steps[-1]), 400)
        exact = second_order.autocovariance(model, lag)
        axes.axhline(0.0, color=FAINT, lw=0.6, zorder=0)
        if isinstance(model.births, PoissonBirths):
            label = "95 % of estimates, each lag alone: neighbours err together"
            band = covariance_band(stretch, lag, exact)
            axes.fill_between(lag, *band, color=VERMILION, alpha=0.15, lw=0.0, label=label)
        axes.plot(lag, exact, color=VERMILION, lw=1.6, label="exact")
        words = f"the mean life, {model.mean_life_distance:.4g} µm"
        axes.axvline(model.mean_life_distance, color=INK, lw=0.9, ls=(0, (4, 3)), zorder=0, label=words)
    axes.plot(track.step * steps, seen, "o", color=BLUE, ms=2.6, label="simulated")
    rounding = (style.NEAREST * float(values.mean())) ** 2
    if max(np.abs(axes.get_ylim())) < rounding:
        axes.set_ylim(-rounding, rounding)
    axes.set(xlim=(0.0, track.step * steps[-1]), xlabel="lag in sliding distance (µm)", ylabel="autocovariance (µm⁴)")
    return "Autocovariance of the real contact area"


def covariance_band(stretch: Stretch, lag: Doubles, exact: Doubles) -> tuple[Doubles, Doubles]:
    """Return the bounds in um^4 of the estimate at each lag in um in 95 % of such runs, to first order in life/run.

    They lie about the expected estimate: R(tau) less the variance of the subtracted mean, S(0) over the stretch.
    """
    length = stretch.stop - stretch.start
    error = style.CONFIDENCE * covariance_errors(stretch.model, lag, length, stretch.model.tick)
    expected = exact - float(second_order.spectral_density(stretch.model, 0.0)) / length
    return expected - error, expected + error


LAYER_LIVES, MOST_DRAWN, DEFAULT_DRAWN = 4.0, 2000, 400
"""Mean lives that a picture of single ones shows, junctions at most, and about how many by default."""

MARGIN: Final = 0.1  # how far a picture of one life goes beyond it, in lengths of the life


def _single(stretch: Stretch, life: Life | None = None, *, touches: bool = False) -> tuple[Stretch, Neighbours]:
    """Return the stretch that a picture of single lives shows, or one life, and its lives: beside one the nearest.

    Raises Refused for too many of them.
    """
    if life is not None:
        shown = stretch.about(life.birth_distance, life.death_distance, MARGIN)
        alive = neighbours(stretch.file, shown.start, shown.stop)
        apart = np.abs(alive.birth + alive.death - life.birth_distance - life.death_distance)
        return shown, alive.chosen(np.sort(np.argsort(apart, kind="stable")[:MOST_DRAWN]))
    model = stretch.model
    births = max(DEFAULT_DRAWN - model.mean_junction_count, 0.1 * model.mean_junction_count)
    width = min(LAYER_LIVES * model.mean_life_distance, births * model.mean_birth_spacing)
    shown = stretch.narrowed(width if stretch.has_theory else 40.0 * model.mean_life_distance)
    alive = neighbours(stretch.file, shown.start, shown.stop, touches=touches)
    if alive.rows.size > MOST_DRAWN:
        raise Refused(
            f"{alive.rows.size:,} junctions live in this stretch, of which a picture shows {MOST_DRAWN:,} at most;"
            " rubnoise plot RUN.h5 lives --from and --to choose a shorter one"
        )
    return shown, alive


def draw_lives(figure: Figure, stretch: Stretch, life: Life | None = None) -> str:
    """Draw the areas of all junctions of a stretch, stacked to their sum, and below it each by itself.

    The largest is black; or, of one ``life``, that junction, and the stretch is as much of its life as the run has.
    """
    shown, alive = _single(stretch, life)
    lives = (shown.stop - shown.start) / shown.model.mean_life_distance
    place = np.linspace(shown.start, shown.stop, int(min(max(800.0, 40.0 * lives), 4000.0)))
    areas, law, peak = alive.areas(place), area_cumulants(shown.model), 0.25 * np.pi * shown.model.sizes.moment(2)
    tallest = areas.max(axis=1, initial=0.0)
    marked = int(np.argmax(np.append(tallest, 0.0) if life is None else alive.rows == life.number))
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.5, 1])
    if life is None or alive.rows.size < MOST_DRAWN:
        style.exact_band(above, law.mean, law.std)
        panes.draw_layers(above, place, areas, marked)
    else:
        panes.draw_layers(above, place, areas, marked, f"sum of the {MOST_DRAWN:,} nearest in time")
    above.set_ylabel(style.AREA)
    below.plot(place, np.where(areas > 0.0, areas, np.nan).T, color=FAINT, lw=0.6)
    if tallest.size:
        row, label = areas[marked], "the largest of them" if life is None else f"junction {life.number:,}"
        below.plot(place[row > 0.0], row[row > 0.0], color=INK, lw=1.6, label=label)
    below.axhline(peak, color=VERMILION, lw=1.2, zorder=0, label="exact mean of the area at mid-life")
    highest, even = 1.1 * max(peak, float(tallest.max(initial=0.0))), np.ones(alive.rows.size)
    panes.mark_ends(below, alive, -0.09 * highest * even, -0.18 * highest * even)
    below.set(ylim=(-0.27 * highest, highest), ylabel="junction area (µm²)", xlabel=style.DISTANCE)
    below.set_yticks([tick for tick in below.get_yticks() if 0.0 <= tick <= highest])
    return f"{alive.rows.size} junctions and their sum" if life is None else _words_of(life)


def _words_of(life: Life) -> str:
    ended = ", ended early" if JunctionState.ENDED_EARLY in life.state else ""
    born = f"diameter {life.diameter:.4g} µm, born at {life.birth_distance:,.2f} µm{ended}"
    share = f"{100.0 * life.peak.area_share:.3g} % of the real contact area"
    return f"Junction {life.number:,}: {born}\n{share} at its peak"


def draw_lifelines(figure: Figure, stretch: Stretch) -> str:
    """Draw the lives of a stretch as bars in lanes, a line across its middle, and below them the count.

    In free motion a bar is a touch of a summit.
    """
    shown, alive = _single(stretch, touches=True)
    middle = 0.5 * (shown.start + shown.stop)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    panes.draw_lanes(above, alive, middle)
    draw_along(below, [Track.of(shown, "count")], drawstyle="steps-post")
    below.locator_params(axis="y", integer=True)
    for axes in (above, below):
        axes.axvline(middle, color=INK, lw=1.0)
    words = "lives, from birth to death" if stretch.has_theory else "touches, from contact made to contact lost"
    return f"{alive.rows.size} {words}"


def draw_psd(figure: Figure, stretch: Stretch, beside: Stretch | None = None, of: str = "area") -> str:
    """Draw Welch's estimate of a spectrum beside the exact one, and over the estimate that theory expects."""
    found = [(track, panes.spectrum_of(track)) for track in tracks_of(stretch, beside, of)]
    looks = panes.looks_of([track for track, _ in found])
    known = [
        (each, expected, look["label"])
        for each, look in zip(found, looks, strict=True)
        if (expected := panes.expectation(*each)) is not None
    ]
    heights = [2.6, 1] if known else [1]
    axes, *ratio = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    panes.draw_spectra(axes, found)
    if known:
        panes.draw_expected(axes, ratio[0], *known[0])
    return f"The spectrum of the {found[0][0].quantity.words}"


BINS: Final = 51  # odd, so that what never varies falls into the middle of one


def draw_values(figure: Figure, stretch: Stretch, of: str = "area") -> str:
    """Draw how often a quantity has each value, on a linear and on a logarithmic axis.

    An area or a load of 0 has a probability and no density: the title states it.
    """
    track, law = Track.of(stretch, of), None
    values, unit = track.record(), track.quantity.unit
    if of == "area" and stretch.has_theory:
        with suppress(Refused):
            law = distribution(stretch.model)
    shown = values[values > 0.0] if of in {"area", "load"} else values
    edges = panes.edges_of(shown, BINS)
    shares = None if law is None else np.diff(np.asarray(law.cdf(edges), dtype=np.float64))
    linear, tails = figure.subplots(1, 2, sharex=True)
    for axes in (linear, tails):
        density = panes.draw_histogram(axes, shown, edges, values.size, shares)
        axes.set_xlabel(track.quantity.label)
    linear.set_ylabel(f"density (1/({unit}))" if "/" in unit else f"density (1/{unit})")
    highest = float(density.max()) or 1.0
    linear.set_ylim(0.0, 1.2 * highest)  # not as high as the exact density: it is singular at 0
    tails.set_ylim(0.3 * float(density.min(where=density > 0.0, initial=highest)), 3.0 * highest)
    style.logarithmic(tails.yaxis)
    title = f"Distribution of the {track.quantity.words}"
    if shown.size < values.size:
        what = "off the surface" if law is None else f"no contact at all (exact {100.0 * law.atom_at_zero:.3g} %)"
        title += f"\n{what} for {100.0 * np.mean(values == 0.0):.3g} % of the time"
    if values.size < track.last - track.first:
        title += f"\nfrom its first {values.size * track.step:.4g} {'s' if track.timed else 'µm'}"
    return title


Law = Literal["sizes", "lives", "gaps"]
LAWS: Final[Mapping[Law, tuple[str, str]]] = {
    "sizes": ("Diameters at birth", "diameter (µm)"),
    "lives": ("Life distances", "life distance (µm)"),
    "gaps": ("Gaps between births", "gap (µm)"),
}
POPULATION_BINS, LONGEST_GAPS = 40, 6.0
"""Bins of a histogram, and mean gaps that are shown: 0.25 % of gaps at random are longer."""


def born(stretch: Stretch, name: str) -> Doubles:
    """Return a column of /junctions for those born in a stretch; if there are very many, the first ones.

    Junctions alive at the start of a run are left out, since longer lives are more probable among them. Raises Refused
    for fewer than three.
    """
    first, last = stretch.first_born(max(stretch.start, 0.0)), stretch.first_born(stretch.stop)
    if last - first < 3:
        raise Refused(f"{last - first} junctions are born in this stretch; a histogram needs three")
    return stretch.file.column("junctions", name, first, min(last, first + MOST_READ)).astype(np.float64)


def draw_population(figure: Figure, stretch: Stretch, of: Law) -> str:
    """Draw sizes, lives or gaps of the junctions born in a stretch, beside their law."""
    (words, label), mean = LAWS[of], stretch.model.births.mean_spacing
    values = born(stretch, "diameter" if of == "sizes" else "birth_distance")
    if of == "lives":
        values = born(stretch, "death_distance") - values
    elif of == "gaps":
        values = np.diff(values)
    edges, axes = panes.edges_of(values, POPULATION_BINS), figure.subplots()
    if of == "gaps" and np.ptp(values) > style.NEAREST * mean:
        edges = np.linspace(0.0, LONGEST_GAPS * mean, POPULATION_BINS + 1)
    law = share_of(of, stretch.model, edges) if stretch.has_theory else None
    panes.draw_histogram(axes, values, edges, values.size, law)
    axes.set(xlim=(edges[0], edges[-1]), xlabel=label, ylabel="density (1/µm)")
    return words


# Motion.


def draw_motion(figure: Figure, stretch: Stretch, beside: Stretch | None = None) -> str:
    """Draw force and displacement in time, and the displacement's spectrum if the stretch has enough rows."""
    whole = tracks_of(stretch, beside, "displacement")
    lifted = all(track.swings is not None and track.swings.excitation == "base" for track in whole)
    driven = tracks_of(stretch, beside, "base" if lifted else "force")
    found = []
    with suppress(Refused):
        found = [(track, panes.spectrum_of(track)) for track in whole]
    heights = [1.0, 1.0, 1.5] if found else [1.0, 1.0]
    force, place, *below = figure.subplots(len(heights), 1, height_ratios=heights)
    place.sharex(force)
    draw_along(place, at_the_same(whole))
    draw_along(force, [track.between(*place.get_xlim()) for track in driven], last=False)
    if found:
        panes.draw_spectra(below[0], found)
    figure.align_ylabels([force, place])
    return f"The {'base' if lifted else 'friction force'}, and the vibration that it excites"


MOST_ON_A_PATH: Final = 60_000
"""Rows that are joined to a path; of more it would be a blot, and their density is drawn alone."""

HEADROOM: Final = 0.06  # room above the drive's speed over all speeds


def draw_phase(figure: Figure, stretch: Stretch, beside: Stretch | None = None) -> str:
    """Draw the path of a slider in the phase plane, over the density of all places of a longer stretch.

    A slider that sticks is on the horizontal line at the drive's speed V. For a one-way slider the ellipse of the exact
    standard deviations is drawn. Another run is drawn over the first at the same times, without the density.
    """
    whole, speeds = (tracks_of(stretch, beside, name) for name in ("displacement", "velocity"))
    shown, axes = at_the_same(whole), figure.subplots()
    first, drive = shown[0], 1e-3 * (stretch.model.sliding_speed or 0.0)
    path = first.last - first.first <= MOST_ON_A_PATH
    if beside is None and (first.ends != whole[0].ends or not path):
        panes.draw_density(axes, whole[0].record(), speeds[0].record())
    for track, fast, look in zip(shown, speeds, panes.looks_of(shown), strict=True):
        if path:
            axes.plot(track.record(), fast.between(*first.ends).record(), **look)
    label = f"speed V of the drive, {drive:.4g} mm/s"
    axes.axhline(drive, color=INK, lw=0.8, ls=(0, (1, 2)), zorder=0.5, label=label)
    if beside is None and first.has_theory and isfinite(first.moments()[1]):
        turn, (place, wide), (_, rapid) = np.linspace(0.0, 2.0 * np.pi, 200), first.moments(), speeds[0].moments()
        ellipse = place + wide * np.cos(turn), rapid * np.sin(turn)
        axes.plot(*ellipse, color=VERMILION, lw=1.4, zorder=5, label="exact standard deviations")
    low, high = axes.get_ylim()
    axes.set(ylim=(low, max(high, drive + HEADROOM * (high - low))), ylabel=speeds[0].quantity.label)
    axes.set_xlabel(first.quantity.label)
    return "The phase plane of the slider, {:.4g} to {:.4g} s".format(*first.ends)


MOST_IMPACTS: Final = 200  # impacts that are marked: with more, the marks would hide one another


def draw_load(figure: Figure, stretch: Stretch, beside: Stretch | None = None) -> str:
    """Draw load, separation and normal velocity in time; of free motion the exact mean load, flights and impacts."""
    low, names = figure.subplots(3, 1, sharex=True), ("load", "separation", "normal-velocity")
    for axes, name in zip(low, names, strict=True):
        draw_along(axes, at_the_same(tracks_of(stretch, beside, name)), last=axes is low[-1])
    low[-1].set_ylabel("normal velocity\n(mm/s)")
    fall = Track.of(stretch, "normal-velocity").shown()
    if beside is None and isinstance(found := fall.landmarks(), Flights):
        low[0].axhline(1e-3 * (stretch.model.load or 0.0), color=VERMILION, lw=1.2, zorder=4, label="exact mean")
        if found.impacts.size <= MOST_IMPACTS:
            falling = np.interp(found.impacts, *fall.curve())
            low[2].plot(found.impacts, falling, "o", color=INK, ms=3.2, mfc="white", mew=0.8, label="impact")
    figure.align_ylabels(low.tolist())
    return "The slider on its load"


def draw_landmarks(figure: Figure, stretch: Stretch) -> str:
    """Draw how far a slider slips and how long it sticks, or how fast it hits the surface and how long it flies."""
    model, held = stretch.model, stretch.model.held
    track = Track.of(stretch, "displacement" if model.free is None else "load")
    found, period = track.landmarks(), 1e3 / track.natural
    if isinstance(found, Flights) and held is not None:
        title, rise = "Impact speeds and flight times", 2e-3 * np.pi * track.natural * held.height_scale
        drawn = [
            (1e-3 * found.speeds, "impact", "impact speed", "mm/s", (rise, "height scale times contact resonance")),
            (1e3 * found.times, "flight", "flight time", "ms", (period, "period of the contact resonance")),
        ]
    elif isinstance(found, Sticks):
        title, diameter, lengths = "Slip lengths and stick times", model.calibrated_diameter, found.slip_lengths
        longer = f"mean diameter; {(lengths > diameter).sum():,} slips are longer"
        drawn = [
            (lengths, "slip", "slip length", "µm", (diameter, longer)),
            (1e3 * found.times, "stick", "stick time", "ms", (period, "natural period")),
        ]
    else:
        raise Refused(
            'the slider has no landmarks: only with slider.coupling = "two-way" does it stick and slip;'
            " rubnoise plot RUN.h5 phase shows this one"
        )
    if not any(values.size for values, *_ in drawn):
        ends = "{:.4g} and {:.4g} s".format(*track.ends)
        raise Refused(f"the slider ends no {drawn[0][1]} and no {drawn[1][1]} between {ends}")
    for axes, pane in zip(figure.subplots(1, 2), drawn, strict=True):
        panes.draw_counts(axes, *pane)
    return title

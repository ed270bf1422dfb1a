"""Pictures of the contact: its area, its junctions, their laws, and the spectrum and histogram of any quantity.

Each draws its panes into a figure and returns its title.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from rubnoise.analysis.landmarks import Flights
from rubnoise.analysis.moments import covariance_errors
from rubnoise.analysis.records import CovarianceSum
from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.errors import Refused
from rubnoise.figures import style
from rubnoise.figures.panes import draw_along, draw_histogram, draw_lanes, draw_layers, edges_of, mark_ends, mark_mean
from rubnoise.figures.spectra import draw_spectra, is_expected, spectrum_of
from rubnoise.figures.tracks import MOST_READ, Stretch, Track, tracks_of
from rubnoise.theory.moments import area_cumulants, distribution, share_of
from rubnoise.theory.second_order import autocovariance, spectral_density

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_trace(figure: "Figure", stretch: Stretch) -> str:
    """Draw A_r of a stretch, and above it the place of the stretch in the whole record."""
    whole, shown = Track.of(stretch.whole(), "area"), Track.of(stretch, "area").shown()
    if (shown.first, shown.last) == (whole.first, whole.last):
        axes = figure.subplots()
    else:
        strip, axes = figure.subplots(2, 1, height_ratios=[1, 2.6])
        strip.axvspan(shown.begin, shown.end, color=style.PALE, lw=0.0, zorder=0)
        strip.plot(*whole.curve(), color=style.FAINT, lw=0.5)
        strip.set(xlim=(whole.begin, whole.end), xlabel="sliding distance (µm), the stretch below shaded", ylabel="µm²")
        strip.set_ylim(bottom=0.0)
    draw_along(axes, [shown])
    return "The real contact area"


def draw_count(figure: "Figure", stretch: Stretch) -> str:
    """Draw N(s) of the stretch's beginning, and beside it the share of each live count in the whole stretch."""
    along, often = figure.subplots(1, 2, width_ratios=[2.2, 1])
    track = Track.of(stretch, "count")
    draw_along(along, [track.shown()], drawstyle="steps-post")
    counts = np.bincount(track.record().astype(np.int64))
    numbers = np.arange(int(np.flatnonzero(counts)[0]), counts.size)
    often.bar(
        numbers, counts[numbers] / counts.sum(), width=1.0, color=style.BLUE, alpha=0.45, lw=0.0, label="simulated"
    )
    mean = stretch.model.mean_live_junctions
    if stretch.has_theory and isinstance(stretch.model.births, PoissonBirths):
        from scipy.special import gammaln

        law = np.exp(numbers * np.log(mean) - mean - gammaln(numbers + 1.0))
        often.plot(numbers, law, "o", color=style.VERMILION, ms=3.0, label="exact: Poisson")
    elif stretch.has_theory:
        often.axvline(mean, color=style.VERMILION, label="exact mean")
    along.locator_params(axis="y", integer=True)
    often.locator_params(axis="x", integer=True)
    often.set(xlabel=track.quantity.label, ylabel="share of the ticks")
    return "Live junctions"


LAGS, LAG_LIVES = 80, 1.6
"""Lags that are shown, and to how many mean lives."""


def draw_acf(figure: "Figure", stretch: Stretch) -> str:
    """Draw the autocovariance of A_r over a stretch, R(tau), and the band with 95 % of estimates at each lag."""
    track, life = Track.of(stretch, "area"), stretch.model.mean_life_distance
    reach = min(int(LAG_LIVES * life / track.step) + 1, (track.last - track.first) // 2)
    steps = np.arange(0, reach + 1, max(1, reach // LAGS))
    lag, mean = track.step * steps, float(track.record().mean())
    products = CovarianceSum(steps, mean)
    for chunk in track.chunks():
        products.add(chunk)
    axes = figure.subplots()
    if stretch.has_theory:
        _draw_exact(axes, stretch, np.linspace(0.0, float(lag[-1]), 400))
    axes.plot(lag, products.covariances(), "o", color=style.BLUE, ms=2.6, label="simulated")
    rounding = (style.NEAREST * mean) ** 2
    if max(np.abs(axes.get_ylim())) < rounding:
        axes.set_ylim(-rounding, rounding)
    axes.set(xlim=(0.0, lag[-1]), xlabel="lag in sliding distance (µm)", ylabel="autocovariance (µm⁴)")
    return "Autocovariance of the real contact area"


def _draw_exact(axes: "Axes", stretch: Stretch, lag: Doubles) -> None:
    exact, model = autocovariance(stretch.model, lag), stretch.model
    axes.axhline(0.0, color=style.FAINT, lw=0.6, zorder=0)
    if isinstance(model.births, PoissonBirths):
        label = "95 % of estimates, each lag alone: neighbours err together"
        band = covariance_band(stretch, lag, exact)
        axes.fill_between(lag, *band, color=style.VERMILION, alpha=0.15, lw=0.0, label=label)
    axes.plot(lag, exact, color=style.VERMILION, lw=1.6, label="exact")
    centred, (smallest, largest) = model.pulse.offset == "none", model.sizes.support
    whose = "a life" if smallest == largest and centred else "the mean life"
    words = f"{whose}, {'2d' if centred else 'πd/2'} = {model.mean_life_distance:.4g} µm"
    axes.axvline(model.mean_life_distance, color=style.INK, lw=0.9, ls=(0, (4, 3)), zorder=0, label=words)


def covariance_band(stretch: Stretch, lag: Doubles, exact: Doubles) -> tuple[Doubles, Doubles]:
    """Return the bounds in um^4 of the estimate at each lag in um in 95 % of such runs, to first order in life/run.

    They lie about the expected estimate: R(tau) less the variance of the subtracted mean, S(0) over the stretch.
    """
    length = stretch.stop - stretch.start
    error = style.CONFIDENCE * covariance_errors(stretch.model, lag, length, stretch.model.tick)
    expected = exact - float(spectral_density(stretch.model, 0.0)) / length
    return expected - error, expected + error


LAYER_LIVES, MOST_DRAWN, DEFAULT_DRAWN = 4.0, 2000, 400
"""Mean lives that a picture of single ones shows, junctions at most, and about how many by default."""


def _single(stretch: Stretch, *, touches: bool = False) -> tuple[Stretch, Neighbours]:
    """Return the stretch that a picture of single lives shows, and these; raises Refused for too many of them."""
    model = stretch.model
    births = max(DEFAULT_DRAWN - model.mean_junction_count, 0.1 * model.mean_junction_count)
    width = min(LAYER_LIVES * model.mean_life_distance, births * model.mean_birth_spacing)
    shown = stretch.narrowed(width if stretch.has_theory else 40.0 * model.mean_life_distance)
    alive = neighbours(stretch.file, -1, shown.start, shown.stop, touches=touches)
    if alive.rows.size > MOST_DRAWN:
        raise Refused(
            f"{alive.rows.size:,} junctions live in this stretch, of which a picture shows {MOST_DRAWN:,} at most;"
            " --from and --to choose a shorter one"
        )
    return shown, alive


def draw_single_lives(figure: "Figure", stretch: Stretch) -> str:
    """Draw the areas of all junctions of a stretch, stacked to their sum, and each by itself."""
    shown, alive = _single(stretch)
    draw_lives(figure, shown, alive)
    return f"{alive.rows.size} junctions and their sum"


def draw_lives(figure: "Figure", shown: Stretch, alive: Neighbours) -> None:
    """Draw the sum of the areas of junctions in a stretch, and below it each area by itself."""
    model, lives = shown.model, (shown.stop - shown.start) / shown.model.mean_life_distance
    place = np.linspace(shown.start, shown.stop, int(min(max(800.0, 40.0 * lives), 4000.0)))
    areas, law = alive.areas(place), area_cumulants(model)
    tallest = areas.max(axis=1, initial=0.0)
    largest, peak = int(np.argmax(np.append(tallest, 0.0))), 0.25 * np.pi * model.sizes.moment(2)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.5, 1])
    style.exact_band(above, law.mean, law.std)
    draw_layers(above, place, areas, largest, style.INK)
    above.set(xlim=(shown.start, shown.stop), ylabel=style.AREA)
    above.set_ylim(bottom=0.0)
    below.plot(place, np.where(areas > 0.0, areas, np.nan).T, color=style.FAINT, lw=0.6)
    if tallest.size:
        row = areas[largest]
        below.plot(place[row > 0.0], row[row > 0.0], color=style.INK, lw=1.6, label="the largest of them")
    below.axhline(peak, color=style.VERMILION, lw=1.2, zorder=0, label="exact mean of the area at mid-life")
    highest, even = 1.1 * max(peak, float(tallest.max(initial=0.0))), np.ones(alive.rows.size)
    mark_ends(below, alive, -0.09 * highest * even, -0.18 * highest * even)
    below.set(ylim=(-0.27 * highest, highest), ylabel="junction area (µm²)", xlabel=style.DISTANCE)
    below.set_yticks([tick for tick in below.get_yticks() if 0.0 <= tick <= highest])


def draw_lifelines(figure: "Figure", stretch: Stretch) -> str:
    """Draw the lives of a stretch as bars in lanes, a line across its middle, and below them the count.

    In free motion a bar is a touch of a summit.
    """
    shown, alive = _single(stretch, touches=True)
    middle = 0.5 * (shown.start + shown.stop)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1])
    draw_lanes(above, alive, middle)
    draw_along(below, [Track.of(shown, "count")], drawstyle="steps-post")
    below.locator_params(axis="y", integer=True)
    for axes in (above, below):
        axes.axvline(middle, color=style.INK, lw=1.0)
    words = "lives, from birth to death" if stretch.has_theory else "touches, from contact made to contact lost"
    return f"{alive.rows.size} {words}"


# Any quantity.


def draw_psd(figure: "Figure", stretch: Stretch, beside: Stretch | None = None, of: str = "area") -> str:
    """Draw Welch's estimate of a spectrum beside the exact one, and over the estimate that theory expects."""
    tracks = tracks_of(stretch, beside, of)
    found = [(track, spectrum_of(track)) for track in tracks]
    if any(map(is_expected, tracks)):
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.6, 1])
        draw_spectra(above, found, below)
    else:
        draw_spectra(figure.subplots(), found)
    (track, seen), segments = found[0], ""
    if of == "area":
        segments = f" ({seen.segments} segments of {seen.ticks * track.step:.4g} µm)"
    return f"The spectrum of the {track.quantity.words}{segments}"


BINS: Final = 51
"""Odd, so that what never varies falls into the middle of one."""

RARE: Final = 1e-6
"""A probability of no contact at all below which a picture need not speak of it."""


def draw_values(figure: "Figure", stretch: Stretch, of: str = "area") -> str:
    """Draw how often a quantity has each value, on a linear and on a logarithmic axis.

    An area or a load of 0 has a probability and no density: the title states it.
    """
    track = Track.of(stretch, of)
    values, law, unit = track.record(), None, track.quantity.unit
    if of == "area" and stretch.has_theory:
        try:
            law = distribution(stretch.model)
        except Refused:
            law = None
    shown = values[values > 0.0] if of in {"area", "load"} else values
    edges = edges_of(shown, BINS)
    shares = None if law is None else np.diff(np.asarray(law.cdf(edges), dtype=np.float64))
    linear, tails = figure.subplots(1, 2, sharex=True)
    for axes in (linear, tails):
        density = draw_histogram(axes, shown, edges, values.size, shares)
        mark_mean(axes, values, "mean of all")
        axes.set_xlabel(track.quantity.label)
    linear.set_ylabel(f"density (1/({unit}))" if "/" in unit else f"density (1/{unit})")
    highest = float(density.max()) or 1.0
    linear.set_ylim(0.0, 1.2 * highest)  # not as high as the exact density: it is singular at 0
    tails.set_ylim(0.3 * float(density.min(where=density > 0.0, initial=highest)), 3.0 * highest)
    style.logarithmic(tails.yaxis)
    atom = 0.0 if law is None else law.atom_at_zero
    known = f"\nno contact at all: {np.mean(values == 0.0):.3g} (exact {atom:.3g})" if atom > RARE else ""
    return f"Distribution of the {track.quantity.words}{_off_surface(track, values)}{known}"


def _off_surface(track: Track, values: Doubles) -> str:
    """Return how long a slider that may leave its contact is off the surface, and how much of a long run was read."""
    found, words = track.landmarks(), ""
    if isinstance(found, Flights):
        words = f"\noff the surface for {100.0 * found.share(track.begin, track.end):.3g} % of the time"
    elif not track.stretch.has_theory:
        words = f"\noff the surface for {100.0 * np.mean(values == 0.0):.3g} % of the ticks"
    whole = values.size == track.last - track.first
    return words if whole else f"{words}\nfrom its first {values.size * track.step:.4g} {'s' if track.timed else 'µm'}"


# The junctions.

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


def draw_population(figure: "Figure", stretch: Stretch, of: Law) -> str:
    """Draw sizes, lives or gaps of the junctions born in a stretch, beside their law."""
    if of == "sizes":
        values = born(stretch, "diameter")
    elif of == "lives":
        values = born(stretch, "death_distance") - born(stretch, "birth_distance")
    else:
        values = np.diff(born(stretch, "birth_distance"))
    edges, mean = edges_of(values, POPULATION_BINS), stretch.model.births.mean_spacing
    if of == "gaps" and np.ptp(values) > style.NEAREST * mean:
        edges = np.linspace(0.0, LONGEST_GAPS * mean, POPULATION_BINS + 1)
    (words, label), axes = LAWS[of], figure.subplots()
    law = share_of(of, stretch.model, edges) if stretch.has_theory else None
    draw_histogram(axes, values, edges, values.size, law, band=True)
    mark_mean(axes, values, "mean")
    axes.set(xlim=(edges[0], edges[-1]), xlabel=label, ylabel="density (1/µm)")
    return f"{words}: {values.size:,}, mean {values.mean():.4g} µm"

"""The picture of one junction: its area among its neighbours', and its part of the real contact area."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.life import Life
from rubnoise.figures.style import BLUE, FAINT, INK, PALE, as_png, house_style, new_figure, shortened, with_minus
from rubnoise.record.rows import JunctionState

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_DRAWN: Final = 60
"""Neighbours drawn, evenly chosen in order of birth; of more the picture would be a grey cloud."""

SAMPLES: Final = 401
UNITS_OF_TIME: Final = (("s", 1.0), ("ms", 1e3), ("µs", 1e6), ("ns", 1e9))


def life_png(life: Life, source: str = "") -> bytes:
    """Return the picture of one life as a png; ``source`` is the origin in its title."""
    with house_style():
        figure = new_figure(6.6, 5.6)
        above, below = figure.subplots(2, 1, sharex=True)
        above.set_title(_title(life, source), pad=10.0)
        _draw_neighbours(above, life)
        _draw_own(above, life)
        _draw_contact(below, life)
        for axes in (above, below):
            _shade_unknown(axes, life)
            axes.legend(loc="upper right", ncols=3, frameon=True, fancybox=False, edgecolor="none", framealpha=1.0)
        _add_times(above, below, life)
        below.set_xlabel("sliding distance since its birth (µm)")
        below.set_xlim(0.0, life.life_distance)
        return as_png(figure)


def _title(life: Life, source: str) -> str:
    whose = f"Junction {life.number:,}" + (f" of {shortened(source)}" if source else "")
    ended = ", ended early" if JunctionState.ENDED_EARLY in life.state else ""
    return f"{whose}\ndiameter {life.diameter:.4g} µm, born at {with_minus(f'{life.birth_distance:,.2f}')} µm{ended}"


def _draw_neighbours(axes: "Axes", life: Life) -> None:
    count = life.others.birth.size
    drawn = min(count, MOST_DRAWN)
    age = np.linspace(0.0, life.life_distance, SAMPLES)
    some = np.zeros(count, dtype=np.bool_)
    some[np.arange(drawn) * count // max(drawn, 1)] = True
    areas = life.others.chosen(some).areas(life.birth_distance + age)
    lines = axes.plot(age, np.where(areas > 0.0, areas, np.nan).T, color=FAINT, lw=0.7)
    if lines:
        lines[0].set_label("the others" if drawn == count else f"{drawn} of the {count:,} others")


def _draw_own(axes: "Axes", life: Life) -> None:
    curve = life.curve()
    age, area = curve["distance"] - life.birth_distance, curve["area"]
    axes.fill_between(age, area, color=BLUE, alpha=0.18, lw=0.0)
    axes.plot(age, area, color=BLUE, lw=2.4, label="this junction")
    axes.plot([life.peak_age], [life.peak_area], "o", color=INK, ms=4.5, zorder=5, clip_on=False)
    beyond_middle = life.peak_age > 0.5 * life.life_distance
    axes.annotate(
        f"{life.peak_area:.4g} µm²" + (", ended here" if life.peak_distance == life.death_distance else ""),
        (life.peak_age, life.peak_area),
        xytext=(-6.0 if beyond_middle else 6.0, 5.0),
        textcoords="offset points",
        ha="right" if beyond_middle else "left",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.85},
    )
    tallest = max(float(area.max()), float(0.25 * np.pi * np.max(life.others.diameter, initial=0.0) ** 2))
    axes.set_ylim(0.0, 1.32 * tallest)
    axes.set_ylabel("junction area (µm²)")


def _draw_contact(axes: "Axes", life: Life) -> None:
    age = np.linspace(0.0, life.life_distance, SAMPLES)
    distance = life.birth_distance + age
    known = (distance >= 0.0) & (distance <= life.record_end)
    own = life.area_at_age(age)
    total = np.where(known, own + life.others.total_area(distance), np.nan)
    axes.fill_between(age, np.where(known, own, np.nan), color=BLUE, lw=0.0, label="this junction")
    axes.plot(age, total, color=INK, lw=1.4, label="all junctions")
    axes.plot([life.peak_age], [life.real_contact_area], "o", color=INK, ms=4.5, clip_on=False)
    axes.set_ylim(0.0, 1.25 * float(np.nanmax(total, initial=life.real_contact_area)))
    axes.set_ylabel("real contact area (µm²)")
    where = "the end of the record" if life.peak_distance == life.record_end else "its peak"
    if life.peak_age == -life.birth_distance:
        where = "the start of the record"
    axes.set_title(f"{100.0 * life.area_share:.3g} % of the real contact area at {where}")


def _shade_unknown(axes: "Axes", life: Life) -> None:
    """Mark the parts before the start and after the end of the record, where the other live junctions are unknown."""
    start, end = -life.birth_distance, life.record_end - life.birth_distance
    beyond = [(0.0, start, "before the start"), (end, life.life_distance, "after the end")]
    beyond = [(first, last, words) for first, last, words in beyond if first < last]
    # Named in the legend: in the band itself the words would hide curves, or, in a narrow one, the axis beside it.
    label = ", ".join(words for _, _, words in beyond)
    for first, last, _ in beyond:
        axes.axvspan(first, last, facecolor=PALE, edgecolor=FAINT, hatch="//", lw=0.0, zorder=0, label=label)
        label = "_one entry is enough"


def _add_times(above: "Axes", below: "Axes", life: Life) -> None:
    """Write times since birth on top, in the unit that suits them."""
    if life.birth_time is None or life.death_time is None or not life.slides_evenly:
        return
    whole = life.death_time - life.birth_time
    unit, factor = next((unit, factor) for unit, factor in UNITS_OF_TIME if whole * factor > 1.0 or unit == "ns")
    pace = whole * factor / life.life_distance
    top = above.secondary_xaxis("top", functions=(lambda s: np.multiply(s, pace), lambda t: np.divide(t, pace)))
    top.set_xlabel(f"time since its birth ({unit})")
    above.tick_params(labelbottom=True)
    below.tick_params(labelbottom=True)

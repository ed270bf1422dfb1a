"""A study and its picture: a quantity of a sweep against a key, in lines of points with the exact curve of each."""

import re
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import cycle
from math import isfinite, nan
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.figures import expected_figure
from rubnoise.analysis.replicates import PooledEstimate, pooled
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figure_names import FIGURE_NAMES
from rubnoise.figures import style
from rubnoise.scenario import Scenario, build
from rubnoise.storage.index import Index
from rubnoise.units import NUMBER, Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CURVE: Final = 31
"""Points of an exact curve, from the lowest value of a key to the highest, besides those of the sweep."""

WIDE: Final = 30.0
"""Ratio of the highest to the lowest value of a key from which its axis is logarithmic, however its points lie."""

_EVEN: Final = 0.1

LAWS: Final[Mapping[str, Any]] = {"exact": "-", "law of weak coupling": (0, (4, 2))}
"""What theory knows of a line, and how its curve is dashed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spot:
    """One point of a sweep: the quantity over its runs beside the exact one, and its place on the axis.

    ``values`` are those of the swept keys as written, ``numbers`` those of the numeric ones in the units of the keys.
    """

    values: Mapping[str, Any]
    numbers: Mapping[str, float]
    scenario: Scenario
    seen: PooledEstimate
    exact: float
    place: float = nan


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyLine:
    """The points of a line, and the exact curve through them; without one, only their exact values."""

    label: str
    spots: tuple[Spot, ...]
    curve: tuple[Doubles, Doubles] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A quantity against a key, one line for each value of the others.

    ``numeric`` says whether the key has numbers; of others the points lie at 0, 1, 2, ... The axis has ``unit``, in
    which the values are written; a place is ``scale`` times as large in it. ``title`` says whose the study is.
    """

    title: str
    quantity: str
    key: str
    unit: str
    scale: float
    others: tuple[str, ...]
    numeric: bool
    lines: tuple[StudyLine, ...]

    @property
    def logarithmic(self) -> bool:
        """Whether the points are spaced by ratios, or so wide apart that an even axis would crowd most of them."""
        places = sorted({spot.place for line in self.lines for spot in line.spots})
        if not self.numeric or len(places) < 3 or places[0] <= 0.0:
            return False
        ratios, steps = np.diff(np.log(places)), np.diff(places)
        even = bool(np.ptp(ratios) <= _EVEN * ratios.mean() and np.ptp(steps) > _EVEN * steps.mean())
        return even or places[-1] > WIDE * places[0]

    def law(self, line: StudyLine) -> str:
        """Return what theory knows of a line, one of LAWS: of a two-way motion the law of weak coupling; or ""."""
        if not any(isfinite(spot.exact) for spot in line.spots):
            return ""
        moving = self.quantity.startswith(("displacement", "velocity"))
        return "law of weak coupling" if moving and line.spots[0].scenario.model().is_two_way else "exact"


def exact_curve(spots: Sequence[Spot], key: str, quantity: str) -> tuple[Doubles, Doubles]:
    """Return exact values of a quantity between the points of a line, all but the key as at the first point.

    Where that is not a valid scenario the curve has a gap.
    """
    places = np.array([spot.place for spot in spots])
    low, high = float(places.min()), float(places.max())
    between = np.geomspace(low, high, CURVE) if low > 0.0 and high > 2.0 * low else np.linspace(low, high, CURVE)
    across = np.unique(np.concatenate([places, between]))
    resolved, (table, _, name) = spots[0].scenario.resolved(), key.partition(".")
    there = getattr(getattr(spots[0].scenario, table), name)
    known = {spot.place: spot.exact for spot in spots}
    for value in across[~np.isin(across, places)].tolist():
        written = Quantity(Fraction(repr(value)), there.kind) if isinstance(there, Quantity) else value
        with suppress(Refused):
            known[value] = exact_of(build(resolved | {table: resolved[table] | {name: written}}), quantity)
    return across, np.array([known.get(value, nan) for value in across.tolist()])


def exact_of(scenario: Scenario, quantity: str) -> float:
    """Return the exact quantity of a scenario; nan if theory has none."""
    try:
        return expected_figure(scenario.model(), quantity)
    except Refused:
        return nan


def quantities_of(index: Index) -> tuple[str, ...]:
    """Return the quantities of a sweep that can be drawn, in the order of a summary."""
    return tuple(name for name in FIGURE_NAMES if name in index.runs)


def study_of_sweep(index: Index, name: str, quantity: str) -> Study:
    """Return a quantity of a sweep, called by a name, against what is swept, from the runs that are done.

    Raises Refused for a quantity that the sweep does not have, and as `study_of_points`.
    """
    known, columns = quantities_of(index), {column: filled.values for column, filled in index.runs.items()}
    if quantity not in known:
        raise Refused(f'"{quantity[:40]}": no quantity of this sweep; there are {", ".join(known) or "none yet"}')
    errors = columns.get(f"{quantity}_standard_error", np.full(columns["point"].size, nan))
    keys, points = {key: index.points[key] for key in index.keys}, []
    for number, values in enumerate(index.values):
        rows, scenario = columns["point"] == number, index.scenario(number)
        error = errors[rows & np.isfinite(errors)]
        places = {key: column.values[number] for key, column in keys.items()}
        points.append(
            Spot(
                values=values,
                numbers={key: float(place) for key, place in places.items() if isinstance(place, np.number)},
                scenario=scenario,
                seen=pooled(quantity, columns[quantity][rows].tolist(), float(error[0]) if error.size else nan),
                exact=exact_of(scenario, quantity),
            )
        )
    units, together = {key: column.about.units for key, column in keys.items()}, index.swept("side_by_side")
    return study_of_points(points, quantity, title=name, units=units, side_by_side=together)


def study_of_points(
    points: Sequence[Spot],
    quantity: str,
    *,
    title: str,
    units: Mapping[str, str],
    side_by_side: Collection[str] = (),
) -> Study:
    """Return a quantity of a sweep against the key that has the most numbers, or the first key if none has any.

    ``units`` are those of the swept keys, in their order. Keys that go side by side with it vary along the axis, every
    other one distinguishes lines. Raises Refused if nothing is swept, or no run has the quantity.
    """
    counts = {key: len({str(point.values[key]) for point in points}) for key in units}
    varied = [key for key, count in counts.items() if count > 1]
    if not varied:
        raise Refused("nothing is swept: one point makes no picture; rubnoise info shows its figures")
    if not any(isfinite(point.seen.value) for point in points):
        raise Refused(f"{quantity}: no run has it")
    numeric = [key for key in varied if all(key in point.numbers for point in points)]
    key = max(numeric, key=lambda each: counts[each]) if numeric else varied[0]
    together = [each for each in varied if each in side_by_side]
    along = [each for each in together if each != key] if key in together else []
    # Of keys side by side one is enough to distinguish lines.
    others = tuple(each for each in varied if each != key and each not in (along or together[1:]))
    words = {text: float(n) for n, text in enumerate(dict.fromkeys(str(point.values[key]) for point in points))}
    spots: dict[str, list[Spot]] = {}
    for point in points:
        label = ", ".join(shown_unit(str(point.values[other])) for other in others)
        place = point.numbers[key] if numeric else words[str(point.values[key])]
        spots.setdefault(label, []).append(replace(point, place=place))
    lines = []
    for label, found in spots.items():
        inorder = tuple(sorted(found, key=lambda spot: spot.place))
        through = exact_curve(inorder, key, quantity) if numeric and not along and len(inorder) > 1 else None
        lines.append(StudyLine(label=label, spots=inorder, curve=through))
    unit, scale = _written_unit(points, key, units[key])
    return Study(
        title=title,
        quantity=quantity,
        key=key,
        unit=unit,
        scale=scale,
        others=others,
        numeric=bool(numeric),
        lines=tuple(lines),
    )


WRITTEN: Final = re.compile(rf"((?>{NUMBER})) *([^ ].*)")


def _written_unit(points: Sequence[Spot], key: str, unit: str) -> tuple[str, float]:
    """Return the unit in which all values of a key are written, and the factor to it; else the key's unit and 1."""
    found = [(WRITTEN.fullmatch(str(point.values[key]).strip()), point.numbers.get(key)) for point in points]
    units = {each[2] if each else "" for each, _ in found}
    scales = [float(each[1]) / number for each, number in found if each and number]
    return (units.pop(), scales[0]) if scales and len(units) == 1 else (unit, 1.0)


def shown_unit(unit: str) -> str:
    """Return a unit in printed form."""
    return unit.replace("um", "µm").replace("uN", "µN").replace("^2", "²").replace("*", " ")


# The picture.

LOOK: Final[dict[str, Any]] = {"ms": 4.5, "lw": 0.0, "elinewidth": 1.0, "capsize": 2.0, "zorder": 3}
MOST_LABELS: Final = 10
CLOSE: Final = 0.1
"""Least distance of two labelled values over the length of the axis."""

APART: Final = 0.06
"""How far lines are drawn apart if the key has words for values, which lie 1 apart."""

LONGEST_LABEL: Final = 24
TALL: Final = 10.0
"""Ratio of the highest to the lowest value from which a quantity over a logarithmic axis has one too."""


def draw_study(study: Study, inches: tuple[float, float] | None = None) -> "Figure":
    """Draw the points of every line with their 95 % intervals, and the exact curves. Within ``house_style()``."""
    figure = style.new_figure(*(inches or (6.4 if len(study.lines) > 1 else 5.4, 4.0)))
    axes = figure.subplots()
    for number, (line, (colour, marker)) in enumerate(zip(study.lines, cycle(style.SERIES), strict=False)):
        shift = 0.0 if study.numeric else APART * (number - 0.5 * (len(study.lines) - 1))
        places = shift + study.scale * np.array([spot.place for spot in line.spots])
        values, reach = np.array([(spot.seen.value, spot.seen.reach) for spot in line.spots]).T
        label = style.one_line(line.label) if number < MOST_LABELS and line.label else "_"
        known = np.where(np.isfinite(reach), reach, nan)
        axes.errorbar(places, values, known, color=colour, fmt=marker, label=label, **LOOK)
        if (law := study.law(line)) and line.curve is not None:
            across, exact = line.curve
            axes.plot(study.scale * across + shift, exact, color=style.VERMILION, lw=1.2, zorder=2, ls=LAWS[law])
        elif law:  # between points there is nothing
            dashes: dict[str, Any] = {"marker": "_", "ms": 14.0, "mew": 1.4, "ls": "none"}
            axes.plot(places, [spot.exact for spot in line.spots], color=style.VERMILION, zorder=2, **dashes)
    _label(axes, study)
    _legend(axes, study)
    shown = f"{quantity_words(study.quantity)} over {key_words(study.key)}"
    name = style.shortened(study.title)
    style.put_title(figure, shown[0].upper() + shown[1:], f"sweep {name}" if name else "")
    return figure


def _label(axes: "Axes", study: Study) -> None:
    """Name the axes, and label the swept values if they are few and apart.

    Axes are logarithmic if the points lie so, and that of the quantity if it then falls by more than ten.
    """
    unit = shown_unit(FIGURE_NAMES[study.quantity].unit)
    axes.set_xlabel(key_label(study.key, study.unit))
    axes.set_ylabel(FIGURE_NAMES[study.quantity].words + (f" ({unit})" if unit else ""))
    spots = [spot for line in study.lines for spot in line.spots]
    values = np.array([value for spot in spots for value in (spot.seen.value, spot.exact)])
    labels = {
        study.scale * spot.place: str(spot.values[study.key]) for spot in sorted(spots, key=lambda spot: spot.place)
    }
    places = np.array([*labels])
    if study.logarithmic:
        style.logarithmic(axes.xaxis)
        if np.nanmin(values) > 0.0 and np.nanmax(values) > TALL * np.nanmin(values):
            style.logarithmic(axes.yaxis)
    along = np.log(places) if study.logarithmic else places
    if not study.numeric:
        axes.set_xticks(places, [style.shortened(labels[place], LONGEST_LABEL) for place in places.tolist()])
        axes.margins(x=0.15)
    elif places.size > 1 and np.diff(along).min() > CLOSE * np.ptp(along):
        axes.set_xticks(places, [f"{place:.4g}" for place in places])
        axes.set_xticks([], minor=True)
    if axes.get_yscale() == "linear" and np.nanmin(values) >= 0.0:
        axes.set_ylim(bottom=0.0)


def _legend(axes: "Axes", study: Study) -> None:
    """Distinguish lines by the values of the other keys; below them stands the exact curve."""
    handles: list[Any]
    handles, labels = axes.get_legend_handles_labels()
    title = f"simulated, 95 % interval,\n{style.one_line(', '.join(map(key_words, study.others)))}:"
    if not study.others:
        handles, labels, title = [*axes.containers], ["simulated, 95 % interval"], ""
    for law in sorted({study.law(line) for line in study.lines} - {""}):
        handles += axes.plot([], [], color=style.VERMILION, lw=1.2, ls=LAWS[law])
        labels.append(law)
    axes.legend(handles, labels, loc="best", title=title, alignment="left")


def quantity_words(name: str) -> str:
    """Return a figure in words, on one line."""
    return FIGURE_NAMES[name].words.replace("\n", " ")


def key_label(key: str, unit: str) -> str:
    """Return the label of a swept key's axis: its name in words, and the unit that its column has."""
    return f"{key_words(key)} ({shown_unit(unit)})" if unit not in {"", "1"} else key_words(key)


def key_words(key: str) -> str:
    """Return a key in words, with its table if the name needs it."""
    table, _, name = key.rpartition(".")
    words = name.replace("_", " ")
    return f"{table} {words}" if name in {"law", "spread", "mean", "start", "shape", "speed"} else words

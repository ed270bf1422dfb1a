"""A study and its picture: a quantity of a sweep against a key, in lines of points with the exact curve of each."""

import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import cycle
from math import isfinite, nan
from typing import Any, Final

import numpy as np

from rubnoise.analysis.figures import expected_figure
from rubnoise.analysis.replicates import PooledEstimate, pooled
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figure_names import FIGURE_NAMES
from rubnoise.figures import Axes, Figure, style
from rubnoise.scenario import Scenario, build
from rubnoise.storage.index import Index
from rubnoise.units import NUMBER, Quantity

CURVE: Final = 31  # points of an exact curve, from the lowest value of a key to the highest, besides those of the sweep

WIDE: Final = 30.0
"""Ratio of the highest to the lowest value of a key from which its axis is logarithmic, however its points lie."""

_EVEN: Final = 0.1

LAWS: Final[Mapping[str, Any]] = {"exact": "-", "law of weak coupling": (0, (4, 2))}
"""What theory knows of a line, and how its curve is dashed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A quantity of a sweep against a key: columns with a row for each point, and the rows of each line by its label.

    ``place`` is the number of the key, or, if it has words, 0, 1, 2, ... in their order. The axis has ``unit``, in
    which the values are ``written``; a place is ``scale`` times as large in it. A line for each value of the ``others``
    has its rows in the order of places; ``title`` says whose the study is.
    """

    title: str
    quantity: str
    key: str
    unit: str
    scale: float
    others: tuple[str, ...]
    numeric: bool
    has_curves: bool
    lines: Mapping[str, list[int]]
    place: Doubles
    written: list[str]
    scenario: list[Scenario]
    seen: list[PooledEstimate]
    exact: Doubles

    @property
    def logarithmic(self) -> bool:
        """Whether the points are spaced by ratios, or so wide apart that an even axis would crowd most of them."""
        places = np.unique(self.place)
        if not self.numeric or places.size < 3 or places[0] <= 0.0:
            return False
        ratios, steps = np.diff(np.log(places)), np.diff(places)
        even = bool(np.ptp(ratios) <= _EVEN * ratios.mean() and np.ptp(steps) > _EVEN * steps.mean())
        return even or bool(places[-1] > WIDE * places[0])

    def law(self, rows: list[int]) -> str:
        """Return what theory knows of a line, one of LAWS: of a two-way motion the law of weak coupling; or ""."""
        if not np.isfinite(self.exact[rows]).any():
            return ""
        moving = self.quantity.startswith(("displacement", "velocity"))
        return "law of weak coupling" if moving and self.scenario[rows[0]].model().is_two_way else "exact"

    def curve(self, rows: list[int]) -> tuple[Doubles, Doubles]:
        """Return places and exact values on a line and between its points, all but the key as at the first point.

        Where that is not a valid scenario the curve has a gap.
        """
        places, scenario, (table, _, name) = self.place[rows], self.scenario[rows[0]], self.key.partition(".")
        low, high = float(places.min()), float(places.max())
        between = np.geomspace(low, high, CURVE) if low > 0.0 and high > 2.0 * low else np.linspace(low, high, CURVE)
        across = np.unique(np.concatenate([places, between]))
        resolved, there = scenario.resolved(), getattr(getattr(scenario, table), name)
        known = dict(zip(places.tolist(), self.exact[rows].tolist(), strict=True))
        for value in across[~np.isin(across, places)].tolist():
            written = Quantity(Fraction(repr(value)), there.kind) if isinstance(there, Quantity) else value
            with suppress(Refused):
                known[value] = exact_of(build(resolved | {table: resolved[table] | {name: written}}), self.quantity)
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


def _pooled_points(index: Index, quantity: str) -> list[PooledEstimate]:
    """Return a quantity of every point over its runs that are done; of a single run with theory's standard error."""
    values, point = index.runs[quantity].values, index.runs["point"].values
    about_errors = index.runs.get(f"{quantity}_standard_error")
    errors = np.full(point.size, nan) if about_errors is None else about_errors.values
    found = []
    for number in range(len(index.points["values"].values)):
        rows = point == number
        error = errors[rows & np.isfinite(errors)].tolist()
        found.append(pooled(quantity, values[rows].tolist(), error[0] if error else nan))
    return found


def study_of_sweep(index: Index, name: str, quantity: str) -> Study:
    """Return a quantity of a sweep, called by a name, against the key that has the most numbers.

    It is the first key if none has numbers. Keys that go side by side with it vary along the axis, every other one
    distinguishes lines. Raises Refused for a quantity that the sweep or no run of it has, and if nothing is swept.
    """
    if quantity not in (known := quantities_of(index)):
        raise Refused(f'"{quantity[:40]}": no quantity of this sweep; there are {", ".join(known) or "none yet"}')
    written = {key: [str(values[key]) for values in index.values] for key in index.keys}
    counts = {key: len(set(texts)) for key, texts in written.items()}
    varied = [key for key, count in counts.items() if count > 1]
    if not varied:
        raise Refused("nothing is swept: one point makes no picture; rubnoise info shows its figures")
    seen = _pooled_points(index, quantity)
    if not any(isfinite(point.value) for point in seen):
        raise Refused(f"{quantity}: no run has it")
    numeric = [key for key in varied if index.points[key].values.dtype.kind in "iuf"]
    key = max(numeric, key=counts.__getitem__) if numeric else varied[0]
    together = [each for each in varied if each in index.swept("side_by_side")]
    along = [each for each in together if each != key] if key in together else []
    # Of keys side by side one is enough to distinguish lines.
    others = tuple(each for each in varied if each != key and each not in (along or together[1:]))
    column, words = index.points[key], [*dict.fromkeys(written[key])]
    place = (
        column.values.astype(np.float64) if numeric else np.array([float(words.index(text)) for text in written[key]])
    )
    unit, scale = _written_unit(written[key], place, column.about.units) if numeric else (column.about.units, 1.0)
    lines: dict[str, list[int]] = {}
    for row in range(place.size):
        lines.setdefault(", ".join(shown_unit(written[other][row]) for other in others), []).append(row)
    scenarios = [index.scenario(row) for row in range(place.size)]
    return Study(
        title=name,
        quantity=quantity,
        key=key,
        unit=unit,
        scale=scale,
        others=others,
        numeric=bool(numeric),
        has_curves=bool(numeric) and not along,
        lines={label: sorted(rows, key=place.__getitem__) for label, rows in lines.items()},
        place=place,
        written=written[key],
        scenario=scenarios,
        seen=seen,
        exact=np.array([exact_of(scenario, quantity) for scenario in scenarios]),
    )


WRITTEN: Final = re.compile(rf"((?>{NUMBER})) *([^ ].*)")


def _written_unit(written: list[str], numbers: Doubles, unit: str) -> tuple[str, float]:
    """Return the unit in which all values of a key are written, and the factor to it; else the key's unit and 1."""
    found = [WRITTEN.fullmatch(text.strip()) for text in written]
    units = {each[2] if each else "" for each in found}
    scales = [float(each[1]) / number for each, number in zip(found, numbers.tolist(), strict=True) if each and number]
    return (units.pop(), scales[0]) if scales and len(units) == 1 else (unit, 1.0)


def shown_unit(unit: str) -> str:
    """Return a unit in printed form."""
    return unit.replace("um", "µm").replace("uN", "µN").replace("^2", "²").replace("*", " ")


# The picture.

LOOK: Final[dict[str, Any]] = {"ms": 4.5, "lw": 0.0, "elinewidth": 1.0, "capsize": 2.0, "zorder": 3}
MOST_LABELS: Final = 10
CLOSE: Final = 0.1
"""Least distance of two labelled values over the length of the axis."""

APART: Final = 0.06  # how far lines are drawn apart if the key has words for values, which lie 1 apart

LONGEST_LABEL: Final = 24
TALL: Final = 10.0
"""Ratio of the highest to the lowest value from which a quantity over a logarithmic axis has one too."""


def draw_study(study: Study, inches: tuple[float, float] | None = None) -> Figure:
    """Draw the points of every line with their 95 % intervals, and the exact curves. Within ``house_style()``."""
    figure = style.new_figure(*(inches or (6.4 if len(study.lines) > 1 else 5.4, 4.0)))
    axes = figure.subplots()
    for number, ((label, rows), (colour, marker)) in enumerate(
        zip(study.lines.items(), cycle(style.SERIES), strict=False)
    ):
        shift = 0.0 if study.numeric else APART * (number - 0.5 * (len(study.lines) - 1))
        places = shift + study.scale * study.place[rows]
        values, reach = np.array([(study.seen[row].value, study.seen[row].reach) for row in rows]).T
        name = style.one_line(label) if number < MOST_LABELS and label else "_"
        known = np.where(np.isfinite(reach), reach, nan)
        axes.errorbar(places, values, known, color=colour, fmt=marker, label=name, **LOOK)
        if (law := study.law(rows)) and study.has_curves and len(rows) > 1:
            across, exact = study.curve(rows)
            axes.plot(study.scale * across + shift, exact, color=style.VERMILION, lw=1.2, zorder=2, ls=LAWS[law])
        elif law:  # between points there is nothing
            dashes: dict[str, Any] = {"marker": "_", "ms": 14.0, "mew": 1.4, "ls": "none"}
            axes.plot(places, study.exact[rows], color=style.VERMILION, zorder=2, **dashes)
    _label(axes, study)
    _legend(axes, study)
    shown = f"{quantity_words(study.quantity)} over {key_words(study.key)}"
    style.put_title(figure, shown[0].upper() + shown[1:], f"sweep {style.shortened(study.title)}")
    return figure


def _label(axes: Axes, study: Study) -> None:
    """Name the axes, and label the swept values if they are few and apart.

    Axes are logarithmic if the points lie so, and that of the quantity if it then falls by more than ten.
    """
    unit = shown_unit(FIGURE_NAMES[study.quantity].unit)
    axes.set_xlabel(key_label(study.key, study.unit))
    axes.set_ylabel(FIGURE_NAMES[study.quantity].words + (f" ({unit})" if unit else ""))
    values = np.array([*(point.value for point in study.seen), *study.exact])
    places = study.scale * np.unique(study.place)
    if study.logarithmic:
        style.logarithmic(axes.xaxis)
        if np.nanmin(values) > 0.0 and np.nanmax(values) > TALL * np.nanmin(values):
            style.logarithmic(axes.yaxis)
    along = np.log(places) if study.logarithmic else places
    if not study.numeric:
        axes.set_xticks(places, [style.shortened(text, LONGEST_LABEL) for text in dict.fromkeys(study.written)])
        axes.margins(x=0.15)
    elif places.size > 1 and np.diff(along).min() > CLOSE * np.ptp(along):
        axes.set_xticks(places, [f"{place:.4g}" for place in places])
        axes.set_xticks([], minor=True)
    if axes.get_yscale() == "linear" and np.nanmin(values) >= 0.0:
        axes.set_ylim(bottom=0.0)


def _legend(axes: Axes, study: Study) -> None:
    """Distinguish lines by the values of the other keys; below them stands the exact curve."""
    handles: list[Any]
    handles, labels = axes.get_legend_handles_labels()
    title = f"simulated, 95 % interval,\n{style.one_line(', '.join(map(key_words, study.others)))}:"
    if not study.others:
        handles, labels, title = [*axes.containers], ["simulated, 95 % interval"], ""
    for law in sorted({study.law(rows) for rows in study.lines.values()} - {""}):
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

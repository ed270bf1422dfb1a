"""A quantity of a sweep against what is swept: its points in lines, and what theory says there and in between."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite, nan
from typing import Any, Final

import numpy as np

from rubnoise.analysis.replicates import Pooled
from rubnoise.analysis.summary import expected_figure
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.scenario import Scenario, build
from rubnoise.units import Quantity

CURVE: Final = 61
"""Points of an exact curve, from the lowest value of a key to the highest, besides those of the sweep."""

WIDE: Final = 30.0
"""Ratio of the highest to the lowest value of a key from which its axis is logarithmic, however its points lie."""

_EVEN: Final = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Spot:
    """One point of a sweep: where it lies on the axis, how it is called there, and the quantity with the exact one.

    ``numbers`` are the values of all swept keys that have numbers, in working units.
    """

    place: float
    numbers: Mapping[str, float]
    label: str
    seen: Pooled
    exact: float
    scenario: Scenario


Curve = Callable[[Sequence[Spot]], tuple[Doubles, Doubles]]
"""Finds exact values through the points of a line and between them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """The points that belong together, and the exact curve through them; without one, their exact values alone."""

    label: str
    spots: tuple[Spot, ...]
    curve: tuple[Doubles, Doubles] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A quantity against a key, one line for each value of the others.

    ``numeric`` says whether the key has numbers, in ``unit``; of others the points lie at 0, 1, 2, ...
    """

    title: str
    quantity: str
    key: str
    unit: str
    others: tuple[str, ...]
    numeric: bool
    lines: tuple[Line, ...]

    @property
    def logarithmic(self) -> bool:
        """Whether the points are spaced by ratios, or so wide apart that an even axis would crowd most of them."""
        places = sorted({spot.place for line in self.lines for spot in line.spots})
        if not self.numeric or len(places) < 3 or places[0] <= 0.0:
            return False
        if places[-1] > WIDE * places[0]:
            return True
        ratios, steps = np.diff(np.log(places)), np.diff(places)
        return bool(np.ptp(ratios) <= _EVEN * ratios.mean() and np.ptp(steps) > _EVEN * steps.mean())


def exact_curve(spots: Sequence[Spot], keys: Sequence[str], quantity: str) -> tuple[Doubles, Doubles]:
    """Return exact values of a quantity between the points of a line; the first of the keys goes along the axis.

    The others go along with it, straight from point to point, in logarithms where they are positive; all else is as at
    the first point. Where that makes no scenario the curve has a gap.
    """
    places = np.array([spot.place for spot in spots])
    low, high = float(places.min()), float(places.max())
    between = np.geomspace(low, high, CURVE) if low > 0.0 and high > 2.0 * low else np.linspace(low, high, CURVE)
    across = np.unique(np.concatenate([places, between]))
    known = {spot.place: spot.exact for spot in spots}
    values = [known[x] if x in known else _between(spots, keys, x, quantity) for x in across.tolist()]
    return across, np.array(values)


def _between(spots: Sequence[Spot], keys: Sequence[str], place: float, quantity: str) -> float:
    changes = {key: _gone_along([spot.numbers[key] for spot in spots], spots, place) for key in keys[1:]}
    return exact_at(spots[0].scenario, {keys[0]: place, **changes}, quantity)


def _gone_along(values: Sequence[float], spots: Sequence[Spot], place: float) -> float:
    places = np.array([spot.place for spot in spots])
    if places[0] > 0.0 and min(values) > 0.0:
        return float(np.exp(np.interp(np.log(place), np.log(places), np.log(values))))
    return float(np.interp(place, places, values))


def exact_at(scenario: Scenario, changes: Mapping[str, float], quantity: str) -> float:
    """Return the exact quantity where keys, all else being as in a scenario, have other values in working units."""
    resolved = scenario.resolved()
    for key, value in changes.items():
        table, _, name = key.partition(".")
        resolved[table] = resolved[table] | {name: _written(scenario, table, name, value)}
    try:
        return exact_of(build(resolved), quantity)
    except Refused:
        return nan


def exact_of(scenario: Scenario, quantity: str) -> float:
    """Return the exact quantity of a scenario; nan where theory is silent."""
    try:
        return expected_figure(scenario.model(), quantity)
    except Refused:
        return nan


def _written(scenario: Scenario, table: str, name: str, value: float) -> Any:
    """Return a value as the key has it: a number, or a quantity of the same kind."""
    there = getattr(getattr(scenario, table), name)
    return Quantity(Fraction(repr(value)), there.kind) if isinstance(there, Quantity) else value


def without_values(lines: Sequence[Line]) -> bool:
    """Whether no point of any line has a value."""
    return not any(isfinite(spot.seen.value) for line in lines for spot in line.spots)


def line_of(label: str, spots: Sequence[Spot], *, curve: Curve | None) -> Line:
    """Return a line through points, which are put in order; no curve goes through a single one."""
    inorder = sorted(spots, key=lambda spot: spot.place)
    return Line(label=label, spots=tuple(inorder), curve=curve(inorder) if curve and len(inorder) > 1 else None)

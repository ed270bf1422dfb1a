"""A study made of the points of a sweep: which key goes along the axis, and which ones tell lines apart."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from rubnoise.analysis.replicates import pooled
from rubnoise.errors import Refused
from rubnoise.figures.study import Curve, Line, Spot, Study, exact_curve, exact_of, line_of, without_values
from rubnoise.figures.sweep_words import shown_unit
from rubnoise.scenario import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class PointRuns:
    """One point of a sweep and the quantity in each of its runs, nan where a run has none.

    ``values`` are those of the swept keys as written, ``numbers`` those of the numeric ones in the units of the keys.
    ``standard_error`` is what theory gives one run.
    """

    values: Mapping[str, Any]
    numbers: Mapping[str, float]
    scenario: Scenario
    figures: Sequence[float]
    standard_error: float


def study_of(
    points: Sequence[PointRuns],
    quantity: str,
    *,
    title: str,
    units: Mapping[str, str],
    side_by_side: Collection[str] = (),
) -> Study:
    """Return a quantity of a sweep against the key that has the most numbers, or the first key where none has any.

    ``units`` are those of the swept keys, in their order. Keys that go side by side with it vary along the axis, every
    other one tells lines apart. Raises Refused where nothing is swept, or no run has the quantity.
    """
    counts = {key: len({str(point.values[key]) for point in points}) for key in units}
    varied = [key for key, count in counts.items() if count > 1]
    if not varied:
        raise Refused("nothing is swept: one point makes no picture; rubnoise info tells its figures")
    numeric = [key for key in varied if all(key in point.numbers for point in points)]
    key = max(numeric, key=lambda each: counts[each]) if numeric else varied[0]
    together = [each for each in varied if each in side_by_side]
    along = [each for each in together if each != key] if key in together else []
    # Of keys side by side one is enough to tell lines apart.
    others = tuple(each for each in varied if each != key and each not in (along or together[1:]))
    smooth = bool(numeric) and set(along) <= set(numeric)
    curve = partial(exact_curve, keys=(key, *along), quantity=quantity) if smooth else None
    lines = _lines(points, quantity, key if numeric else "", key, others, curve)
    if without_values(lines):
        raise Refused(f"{quantity}: no run has it")
    return Study(
        title=title,
        quantity=quantity,
        key=key,
        unit=units[key],
        others=others,
        numeric=bool(numeric),
        lines=lines,
    )


def _lines(
    points: Sequence[PointRuns], quantity: str, number: str, key: str, others: tuple[str, ...], curve: Curve | None
) -> tuple[Line, ...]:
    """Return the lines in the order of the file; places are those of the key ``number``, or 0, 1, 2, ... without."""
    words = {text: float(n) for n, text in enumerate(dict.fromkeys(str(point.values[key]) for point in points))}
    spots: dict[str, list[Spot]] = {}
    for point in points:
        written = str(point.values[key])
        spot = Spot(
            place=point.numbers[number] if number else words[written],
            numbers=point.numbers,
            label=written,
            seen=pooled(quantity, point.figures, point.standard_error),
            exact=exact_of(point.scenario, quantity),
            scenario=point.scenario,
        )
        spots.setdefault(_label(point, others), []).append(spot)
    return tuple(line_of(label, line, curve=curve) for label, line in spots.items())


def _label(point: PointRuns, others: tuple[str, ...]) -> str:
    return ", ".join(shown_unit(str(point.values[key])) for key in others)

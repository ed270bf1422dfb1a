"""A ledger of claims: read from its TOML file, each number evaluated by runs and by theory, each claim with a verdict.

A number is an expression over quantities at points of a sweep, as in ``force_std(count=50) / force_std(count=10)``. A
point is chosen by its swept values as they are written in the scenario; a word stands for the key that ends with it.
"""

import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from math import hypot, inf, isfinite, isnan, log, log10, nan, pi
from pathlib import Path
from typing import Any, Final

from scipy.special import ndtr, stdtrit

from paper.quantities import QUANTITIES, Band, Quantity, Run
from rubnoise.analysis.replicates import PooledEstimate, estimate, ratio
from rubnoise.api.running import simulate
from rubnoise.model import Model
from rubnoise.scenario.layers import shipped
from rubnoise.scenario.sweep import expand, load_sweep

LEDGERS: Final = {name: Path(__file__).with_name(f"{name}.toml") for name in ("paper", "field")}
MANY: Final = 1 << 30
"""As many runs as an exact number counts for."""

Tell = Callable[[str], None]
"""Called with a text about each run before it begins."""

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Number:
    """A number as simulated and as exact; nan where theory has none. Both go through the same operations."""

    simulated: PooledEstimate
    exact: float

    def __sub__(self, other: "Number | float") -> "Number":
        taken = _number(other)
        one, two = self.simulated, taken.simulated
        error, runs = hypot(one.standard_error, two.standard_error), min(one.runs, two.runs)
        return Number(
            PooledEstimate(value=one.value - two.value, standard_error=error, runs=runs), self.exact - taken.exact
        )

    def __rsub__(self, other: float) -> "Number":
        return _number(other) - self

    def __truediv__(self, other: "Number | float") -> "Number":
        by = _number(other)
        # Of means, since the mean of ratios is too large.
        return Number(ratio(self.simulated, by.simulated), self.exact / by.exact)

    def __rtruediv__(self, other: float) -> "Number":
        return _number(other) / self

    def __rmul__(self, factor: float) -> "Number":
        return self.changed(lambda value: factor * value, factor)

    def changed(self, by: Callable[[float], float], slope: float) -> "Number":
        """Return a function of the number, whose error grows by its slope."""
        found = self.simulated
        error = abs(slope) * found.standard_error
        return Number(
            PooledEstimate(value=by(found.value), standard_error=error, runs=found.runs),
            nan if isnan(self.exact) else by(self.exact),
        )


def _number(value: "Number | float") -> Number:
    if isinstance(value, Number):
        return value
    return Number(PooledEstimate(value=value, standard_error=0.0, runs=MANY), value)


def exactly(number: Number) -> Number:
    """Return the exact number, which does not scatter."""
    return _number(number.exact)


def exponent(near: Number, far: Number, factor: float) -> Number:
    """Return n of a power law between two points whose variable differs by ``factor``: ln(far/near) / ln(factor)."""
    grown = far / near
    return grown.changed(lambda value: log(value) / log(factor), 1.0 / (grown.simulated.value * log(factor)))


def decibels(number: Number) -> Number:
    """Return the level of an amplitude over another in dB."""
    return number.changed(lambda value: 20.0 * log10(value), 20.0 / (log(10.0) * number.simulated.value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Claimed:
    """One number of a claim: its name on the page, its expression, and what is claimed of it.

    ``range`` is where the claim puts it, ``near`` where the claim needs a correction only; a number without a range
    is shown and not judged. ``printed`` is shown as the source has it. ``rounding`` is the needed agreement of runs
    that do not scatter.
    """

    name: str
    number: str
    unit: str = ""
    printed: float | None = None
    range: Range | None = None
    near: Range | None = None
    rounding: float = 0.0
    found: Number

    @property
    def agrees(self) -> bool:
        """Whether runs and theory agree: within four standard errors, or as rare a distance for few runs."""
        runs, exact = self.found.simulated, self.found.exact
        reach = float(stdtrit(runs.runs - 1, ndtr(4.0))) * runs.standard_error if runs.runs > 1 else inf
        return isnan(exact) or abs(runs.value - exact) <= max(reach, self.rounding)

    def lies_in(self, ends: Sequence[float]) -> bool:
        """Whether the exact number and the runs lie in a range.

        Of a range with two ends the 95 % interval of the runs has a part; below or above one end it is whole.
        """
        (low, high), (least, most) = ends, self.found.simulated.interval
        within = least <= high and low <= most if isfinite(high - low) else low <= least and most <= high
        return within and (isnan(self.found.exact) or low <= self.found.exact <= high)


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A place of the paper, or a publication: its name in a table, its authors, its DOI if it was found.

    ``known`` says how well its statement is known.
    """

    label: str
    name: str
    doi: str | None = None
    known: str = "original"


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A claim with its numbers: its source, its words, and the reason of the verdict.

    ``readings`` counts the readings of the source that its range holds: to lie in a range of two is no test.
    """

    id: str
    source: Source
    statement: str
    because: str
    expected: str
    scenario: str
    conditions: str = ""
    readings: int = 1
    numbers: tuple[Claimed, ...]
    words: Mapping[str, str] = field(repr=False)

    @property
    def verdict(self) -> str:
        """The verdict that follows from the numbers, in the words of the ledger."""
        return self.words[self._verdict()]

    def _verdict(self) -> str:
        judged = [(each, each.range) for each in self.numbers if each.range is not None]
        if not all(each.agrees for each in self.numbers):
            return "unsettled"
        if all(each.lies_in(ends) for each, ends in judged):
            return "holds" if judged and self.readings == 1 else "untested"
        return "corrected" if all(each.lies_in(each.near or ends) for each, ends in judged) else "fails"


@dataclass(frozen=True, slots=True)
class Point:
    """One point of a sweep: its swept values as written, its model, and each measured quantity with its scatter."""

    values: Mapping[str, Any]
    model: Model
    measured: Mapping[str, PooledEstimate]

    def lies_at(self, place: Mapping[str, Any]) -> bool:
        """Whether each swept value whose key ends with a word is as given."""
        return all(
            any(key.endswith(word) and value == given for key, value in self.values.items())
            for word, given in place.items()
        )


@dataclass(frozen=True)
class Ledger:
    """The claims of a file; ``tell`` hears of each run."""

    path: Path
    tell: Tell = lambda _text: None

    @cached_property
    def data(self) -> dict[str, Any]:
        """The file as it stands."""
        return tomllib.loads(self.path.read_text(encoding="utf-8"))

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """Every quantity by name, and the bands of this file among them."""
        return {**QUANTITIES, **{name: Band(**band).quantity() for name, band in self.data["bands"].items()}}

    def source(self, label: str) -> Source:
        """Return a source by its name in a table; the file says more of publications."""
        return Source(label=label, **self.data.get("sources", {}).get(label, {"name": label}))

    def claims(self, scenarios: Sequence[str] | None = None) -> Iterator[Claim]:
        """Make the runs of every scenario, or of some, from fixed seeds, and yield their claims in the file's order."""
        rows = [row for row in self.data["claim"] if scenarios is None or row["scenario"] in scenarios]
        swept = {name: self._swept(name, rows) for name in dict.fromkeys(row["scenario"] for row in rows)}
        for row in rows:
            names = self._names(swept[row["scenario"]])
            numbers = tuple(Claimed(**each, found=_evaluated(each["number"], names)) for each in row["numbers"])
            shown = [_evaluated(each, names) for each in row.get("shown", ())]
            reason = row["because"] % tuple(_best(each) for each in shown) if shown else row["because"]
            told = {key: _one_line(text) for key, text in {**row, "because": reason}.items() if isinstance(text, str)}
            known = {**row, **told, "source": self.source(row["source"]), "numbers": numbers}
            known.pop("shown", None)
            yield Claim(**known, words=self.data["verdicts"])

    def _swept(self, scenario: str, rows: Sequence[Mapping[str, Any]]) -> tuple[Point, ...]:
        """Run every point of a sweep in memory, and measure what the rows about it name."""
        own = [row for row in rows if row["scenario"] == scenario]
        texts = [text for row in own for text in (*(each["number"] for each in row["numbers"]), *row.get("shown", ()))]
        read = {
            name: measured
            for name in sorted({name for text in texts for name in compile(text, scenario, "eval").co_names})
            if name in self.quantities and (measured := self.quantities[name].measured) is not None
        }

        points = expand(load_sweep(shipped(f"claims/{scenario}.toml")))
        found: dict[int, tuple[Any, list[dict[str, float]]]] = {}
        for number, point in enumerate(points):
            run = Run(point.scenario.model(), simulate(point.scenario).reader())
            numbers = {name: measured(run) for name, measured in read.items()}
            self.tell(f"{scenario}: run {number + 1} of {len(points)}")
            found.setdefault(number - point.replicate, (point, []))[1].append(numbers)
        return tuple(
            Point(point.values, point.scenario.model(), {name: estimate([run[name] for run in runs]) for name in read})
            for point, runs in found.values()
        )

    def _names(self, points: Sequence[Point]) -> dict[str, Any]:
        """Return what an expression over the points of a sweep may name."""
        functions = {"exactly": exactly, "exponent": exponent, "decibels": decibels, "pi": pi}
        return functions | {name: partial(self._at, points, name) for name in self.quantities}

    def _at(self, points: Sequence[Point], name: str, /, **place: Any) -> Number:
        [point] = [each for each in points if each.lies_at(place)]
        exact = self.quantities[name].exact(point.model)
        return Number(point.measured[name], exact) if name in point.measured else _number(exact)


def _evaluated(expression: str, names: Mapping[str, Any]) -> Number:
    """Return the number of an expression of a ledger, which is a file of this package."""
    return _number(eval(expression, {"__builtins__": {}}, dict(names)))  # noqa: S307


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _best(number: Number) -> float:
    return number.simulated.value if isnan(number.exact) else number.exact


def unexpected(claims: Sequence[Claim]) -> list[str]:
    """Return a line about each claim whose verdict is not the expected one."""
    return [f"{each.id}: {each.verdict}, expected: {each.expected}" for each in claims if each.verdict != each.expected]


def as_row(claim: Claim, number: Claimed) -> dict[str, Any]:
    """Return one number of a claim as a row of JSON; an end of a range at infinity is None."""
    found, source = number.found, claim.source
    return {
        **{key: getattr(claim, key) for key in ("id", "statement", "conditions", "verdict", "because")},
        "source": source.name,
        "doi": source.doi,
        "known_from": source.known,
        **{key: getattr(number, key) for key in ("unit", "number", "printed")},
        "quantity": number.name,
        "range": None if number.range is None else [_finite(end) for end in number.range],
        "exact": _finite(found.exact),
        "simulated": found.simulated.value,
        "interval": [_finite(end) for end in found.simulated.interval],
        "runs": found.simulated.runs,
        "scenario": f"scenarios/claims/{claim.scenario}.toml",
    }


def _finite(value: float) -> float | None:
    return value if abs(value) < inf else None

"""The findings of a comparison with theory: figures with scores, identities, and figures left out.

A number and its standard error become a figure with a score, or a reason why it has none.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, log1p
from typing import Final, Protocol

import numpy as np

from rubnoise.analysis.records import longer
from rubnoise.analysis.scores import FAMILY_WISE_ERROR, family_wise_bound, figure, normal_deviate
from rubnoise.answer import Answer, Row, left_out
from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.streams import LARGEST_UNIFORM

LARGEST_TAIL_SKEWNESS: Final = 0.35
LARGEST_TAIL_KURTOSIS: Final = 0.4
"""Skewness and excess kurtosis up to which a score of 4 or 5, taken on the scale of a lognormal law, may be trusted."""

RARE: Final = 1e-5
"""Chance that a record holds a value at all beyond which values are left out: no false alarm is worth a rarer one."""

_VALUES = 400
_LONGEST = 1e15  # times the births of the record


class Drawn(Protocol):
    """A law of which values are drawn."""

    def quantile(self, probability: Doubles) -> Doubles:
        """Return the values with these probabilities below them."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Tail:
    """The skewness of a sum, and the length in um from which on its law is close enough to normal for a score."""

    skewness: float
    needed: float


NORMAL: Final = Tail(skewness=0.0, needed=0.0)


def tail_of(model: Model, length: float, size_power: int, strength_power: int = 0) -> Tail:
    """Return the tail of a sum over the births of ``length`` um, each bringing d^p psi^q (p and q the powers).

    With n births the skewness is E[y^3] / (E[y^2]^1.5 sqrt(n)), the excess kurtosis E[y^4] / (E[y^2]^2 n), as for any
    compound Poisson sum. Source: Feller, An Introduction to Probability Theory and Its Applications II, section XII.2.
    """
    laws: list[tuple[Drawn, Callable[[Doubles], Doubles]]] = [(model.sizes, lambda d: np.power(d / d[0], size_power))]
    if strength_power and model.strengths is not None:
        laws.append((model.strengths, lambda psi: np.power(psi / psi[0], strength_power)))
    return _tail(laws, model.birth_rate * length, length)


def tail_of_squares(law: Drawn, mean: float, births: float, length: float) -> Tail:
    """Return the tail of the sum of squared deviations from the mean, of ``births`` draws over ``length`` um."""
    return _tail([(law, lambda value: np.square(value / mean - 1.0))], births, length)


def _tail(laws: list[tuple[Drawn, Callable[[Doubles], Doubles]]], births: float, length: float) -> Tail:
    skewness, kurtosis = _shape(laws, births)
    first = skewness
    factor = 1.0
    while not (skewness <= LARGEST_TAIL_SKEWNESS and kurtosis <= LARGEST_TAIL_KURTOSIS):
        factor *= 1.25
        if factor > _LONGEST:
            return Tail(skewness=first, needed=inf)
        skewness, kurtosis = _shape(laws, factor * births)
    return Tail(skewness=first, needed=factor * length if factor > 1.0 else 0.0)


def _shape(laws: list[tuple[Drawn, Callable[[Doubles], Doubles]]], births: float) -> tuple[float, float]:
    """Return skewness and excess kurtosis, from the part of each law that a record of these births probably shows."""
    survival = np.geomspace(1.0, min(RARE / max(births, 1.0), 0.1), _VALUES)
    shares = -np.diff(survival)
    middle = 0.5 * (survival[1:] + survival[:-1])
    third = fourth = 1.0
    for law, brings in laws:
        # From the median on, so that what is brought is of order 1 whatever the unit.
        values = law.quantile(np.minimum(np.concatenate([[0.5], 1.0 - middle]), LARGEST_UNIFORM))
        brought = brings(values)[1:]
        second = float(shares @ brought**2)
        third *= float(shares @ brought**3) / second**1.5
        fourth *= float(shares @ brought**4) / second**2
    return third / births**0.5, fourth / births


IDENTITIES: Final = "identities"


def identity(name: str, deviation: float, allowed: float, unit: str) -> Row:
    """Return a relation that holds in every right run but for rounding: its largest deviation, and the allowed one."""
    fails = not deviation <= allowed
    return Row(part=IDENTITIES, name=name, value=deviation, unit=unit, exact=0.0, error=allowed, fails=fails)


@dataclass(frozen=True, kw_only=True, repr=False)
class Comparison(Answer):
    """A run compared with the theory of its scenario: every figure with its exact value, standard error and z.

    ``passed`` is true if all figures lie within ``bound`` and all identities hold; ``outside`` names those that do not,
    ``left_out`` names figures that could not be compared, with the reason. ``bound`` is the largest |z| that a correct
    run may have.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     answer = run.compare()
    >>> answer.passed, answer.outside, answer["birth_count"].part
    (True, (), 'births')
    """

    bound: float = inf

    @property
    def figures(self) -> list[Row]:
        """Every figure, under the heading of its part."""
        beside = {"", IDENTITIES, "left_out"}
        return [row for row in self.rows if row.part not in beside and row.name != "begins"]

    @property
    def identities(self) -> list[Row]:
        """Every identity."""
        return [row for row in self.rows if row.part == IDENTITIES]

    @property
    def outside(self) -> tuple[str, ...]:
        """The same as ``failing``: figures beyond the bound, and identities that do not hold."""
        return self.failing


def comparison(
    found: Mapping[str, Sequence[Row]], begins: Mapping[str, float], bound: float | None = None
) -> Comparison:
    """Return the findings of each part, whose records ``begin`` at distances in um.

    Without a bound it is the family-wise bound of all their figures.
    """
    figures = {heading: [row for row in part if not row.part] for heading, part in found.items()}
    scored = sum(row.z is not None for part in figures.values() for row in part)
    limit = family_wise_bound(scored) if bound is None else bound
    rows = [Row(name="bound", value=limit)]
    for heading, part in figures.items():
        if part and begins[heading]:
            rows.append(Row(part=heading, name="begins", value=begins[heading], unit="um"))
        rows += [replace(row, part=heading, fails=row.z is not None and not abs(row.z) <= limit) for row in part]
    others = sorted((row for part in found.values() for row in part if row.part), key=lambda row: row.part)
    identities = sum(row.part == IDENTITIES for row in others)
    whence = f", which all keep in {1.0 - FAMILY_WISE_ERROR:.1%} of right runs" if bound is None else ""
    judged = f"{scored} figures and {identities} identities compared, |z| <= {limit:.3g}{whence}"
    return Comparison(rows=(*rows, *others), judged=judged, bound=limit)


LARGEST_ERROR = 0.1
"""Standard error up to which a variance, a power or a shape, over what it is measured by, has a score."""

SKEWNESS = 3.5
"""Skewness of such an estimate over that relative error; runs of many models had 2 to 4."""

LARGEST_SKEWNESS = 0.05
"""Skewness of a mean up to which its law is near enough to a normal one for a score of 4 or 5."""

_MANY = 10_000.0


def judged(
    name: str,
    observed: float,
    expected: float,
    error: float,
    *,
    length: float,
    scale: float | None = None,
    skewness: float = SKEWNESS,
    tail: Tail = NORMAL,
) -> Row:
    """Return a figure with its score, or the length that it needs if its error exceeds a tenth of its ``scale``.

    The scale is the expected value if none is given; ``length`` (um) is that of the record. Estimates of squares
    have a longer upper tail, with a skewness of ``skewness`` times the error over the scale. So has a sum that its
    largest junctions dominate, and its ``tail`` may need a longer record, too. The larger skewness counts.
    """
    relative = error / abs(expected if scale is None else scale) if error else 0.0
    if not relative <= LARGEST_ERROR:
        return too_short(name, max(longer(length, relative, LARGEST_ERROR), tail.needed))
    return judged_mean(
        name,
        observed,
        expected,
        error,
        length=length,
        tail=Tail(skewness=max(skewness * relative, tail.skewness), needed=tail.needed),
    )


def judged_mean(name: str, observed: float, expected: float, error: float, *, length: float, tail: Tail) -> Row:
    """Return a figure with its score, or the length that it needs if its ``tail`` is too heavy for a score.

    On the side of the longer tail, above the expected value for a skewness g > 0 and below it for g < 0, the score is
    (3/g) log(1 + g z/3), that of a lognormal law of the tail's skewness g.
    """
    if tail.needed > length:
        return too_short(name, tail.needed)
    z = (observed - expected) / error if error else None
    if z is not None and z * tail.skewness > 0.0:
        third = tail.skewness / 3.0
        z = log1p(third * z) / third
    return figure(name, observed, expected, error, z)


def too_short(name: str, needed: float) -> Row:
    """Return a figure left out because the run is too short, with the length in um that it needs."""
    needs = f"it needs about {needed:.3g} um" if isfinite(needed) else "no length would do"
    return left_out(name, f"the run is too short; {needs}")


def poisson_figure(name: str, observed: int, mean: float) -> Row:
    """Return a count beside the mean of its Poisson law, with the score of its tail probability."""
    from scipy.special import pdtr, pdtrc

    deviate = None
    if mean < _MANY:
        above = float(pdtrc(observed - 1, mean)) if observed else 1.0
        deviate = normal_deviate(float(pdtr(observed, mean)), above)
    return figure(name, float(observed), mean, mean**0.5, deviate)

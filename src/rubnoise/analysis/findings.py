"""The findings of a comparison with theory: figures with scores, distances from laws, identities, and figures left out.

A number and its standard error become a figure with a score, or a reason why it has none; a score is how far the
measured value is from the exact one, in standard errors.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, log1p, sqrt
from typing import Final

import numpy as np

from rubnoise.analysis.records import longer
from rubnoise.answer import Answer, Row, left_out
from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import Law
from rubnoise.errors import Refused
from rubnoise.figure_names import unit_of
from rubnoise.model import Model
from rubnoise.streams import LARGEST_UNIFORM

LARGEST_TAIL_SKEWNESS: Final = 0.35
LARGEST_TAIL_KURTOSIS: Final = 0.4
"""Skewness and excess kurtosis up to which a score of 4 or 5, taken on the scale of a lognormal law, may be trusted."""

RARE: Final = 1e-5
"""Chance that a record holds a value at all beyond which values are left out: no false alarm is worth a rarer one."""

_VALUES = 400
_LONGEST = 1e15  # times the births of the record


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
    laws: list[tuple[Law, Callable[[Doubles], Doubles]]] = [(model.sizes, lambda d: np.power(d / d[0], size_power))]
    if strength_power and model.strengths is not None:
        laws.append((model.strengths, lambda psi: np.power(psi / psi[0], strength_power)))
    return _tail(laws, model.birth_rate * length, length)


def tail_of_squares(law: Law, mean: float, births: float, length: float) -> Tail:
    """Return the tail of the sum of squared deviations from the mean, of ``births`` draws over ``length`` um."""
    return _tail([(law, lambda value: np.square(value / mean - 1.0))], births, length)


def _tail(laws: list[tuple[Law, Callable[[Doubles], Doubles]]], births: float, length: float) -> Tail:
    skewness, kurtosis = first = _shape(laws, births)
    factor = 1.0
    while not (skewness <= LARGEST_TAIL_SKEWNESS and kurtosis <= LARGEST_TAIL_KURTOSIS) and factor <= _LONGEST:
        factor *= 1.25
        skewness, kurtosis = _shape(laws, factor * births)
    return Tail(skewness=first[0], needed=factor * length if factor <= _LONGEST else inf)


def _shape(laws: list[tuple[Law, Callable[[Doubles], Doubles]]], births: float) -> tuple[float, float]:
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

SKEWNESS = 3.5  # skewness of such an estimate over that relative error; runs of many models had 2 to 4
LARGEST_SKEWNESS = 0.05  # skewness of a mean up to which its law is near enough to a normal one for a score of 4 or 5


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
    unit: str = "",
) -> Row:
    """Return a figure with its score, or the length that it needs if its law is not close enough to normal for one.

    The error of an estimate of squares may be a tenth of its ``scale``, the expected value if none is given, and its
    upper tail is longer, with a skewness of ``skewness`` times the error over the scale; of a mean it is 0. A sum that
    its largest junctions dominate has a ``tail``, too, which may need more than the ``length`` (um) of the record. The
    larger skewness g counts: on the side of the longer tail, above the expected value for g > 0 and below it for
    g < 0, the score is (3/g) log(1 + g z/3), that of a lognormal law.
    """
    relative = error / abs(expected if scale is None else scale) if error and skewness else 0.0
    needed = max(0.0 if relative <= LARGEST_ERROR else longer(length, relative, LARGEST_ERROR), tail.needed)
    if not needed <= length:
        return too_short(name, needed)
    z, skewed = (observed - expected) / error if error else None, tail.skewness
    if skewness:
        skewed = max(skewness * relative, skewed)
    if z is not None and z * skewed > 0.0:
        third = skewed / 3.0
        z = log1p(third * z) / third
    return figure(name, observed, expected, error, z, unit=unit)


def too_short(name: str, needed: float) -> Row:
    """Return a figure left out because the run is too short, with the length in um that it needs."""
    needs = f"it needs about {needed:.3g} um" if isfinite(needed) else "no length would do"
    return left_out(name, f"the run is too short; {needs}")


def need(length: float, needed: float) -> None:
    """Raise Refused, with the length in um that a part of a comparison needs, if a record is shorter."""
    if length < needed:
        raise Refused(too_short("", needed).note)


def poisson_figure(name: str, observed: int, mean: float) -> Row:
    """Return a count beside the mean of its Poisson law, with the score of its tail probability."""
    from scipy.special import pdtr, pdtrc

    above = float(pdtrc(observed - 1, mean)) if observed else 1.0
    return figure(name, float(observed), mean, mean**0.5, normal_deviate(float(pdtr(observed, mean)), above))


FEWEST = 10  # independent values from which a distance is given at all

_BINS = 1 << 18
_EXACT_UP_TO = 1000  # the limit's own error is some tenth of 1/sqrt(n)
# Mean and standard deviation of D sqrt(n) for many values: sqrt(pi/2) ln 2, and sqrt(pi^2/12 - mean^2).
_MEAN, _STD = 0.868731, 0.260333


def kolmogorov_figure(name: str, sample: "UniformSample", needed: float = 0.0) -> Row:
    """Return the figure of the largest distance between the distribution functions of independent values and their law.

    It has the mean and standard deviation of the distance for a right law. Its score is that of its tail probability; 0
    for small distances of few values, since only a bound is known there. Of fewer than FEWEST values it says what
    length in um is ``needed``.
    Source: Feller (1948), doi:10.1214/aoms/1177730243.
    """
    distance, count = sample.distance(), sample.count
    if count < FEWEST:
        return too_short(name, needed)
    tail = distance_tail(distance, count)
    below = 1.0 - tail if count > _EXACT_UP_TO else 0.5
    root = sqrt(count)
    return figure(name, distance, _MEAN / root, _STD / root, normal_deviate(below, tail))


def distance_tail(distance: float, count: int) -> float:
    """Return P(D >= distance) for values of a continuous law: up to 1000 by the bound of both one-sided exact tails.

    The bound is close to the probability if that is small. Beyond 1000 values Kolmogorov's limit is used.
    """
    from scipy.special import kolmogorov, smirnov

    if count > _EXACT_UP_TO:
        return float(kolmogorov(distance * sqrt(count)))
    return min(1.0, 2.0 * float(smirnov(count, min(distance, 1.0))))


class UniformSample:
    """Values that should be uniform on [0, 1], counted in 2^18 bins, so that any number of them takes 2 MB.

    Their distance is taken at the edges of the bins only: never more than D, and less by at most 2^-18 and the share of
    a bin.
    """

    def __init__(self) -> None:
        self._counts = np.zeros(_BINS, dtype=np.int64)

    def add(self, values: Doubles) -> None:
        """Add values."""
        bins = np.minimum((np.clip(values, 0.0, 1.0) * _BINS).astype(np.int64), _BINS - 1)
        self._counts += np.bincount(bins, minlength=_BINS)

    @property
    def count(self) -> int:
        """Number of values."""
        return int(self._counts.sum())

    def distance(self) -> float:
        """Return the largest distance of the values' distribution function from the diagonal."""
        heights = np.cumsum(self._counts) / max(self.count, 1)
        return float(np.max(np.abs(heights - np.arange(1, _BINS + 1) / _BINS)))


EXACT, ERROR = "_exact", "_standard_error"

FAMILY_WISE_ERROR = 1e-3  # probability that any figure at all of a right run lies outside of the family-wise bound


def figure(
    name: str, value: float, exact: float | None, error: float | None, z: float | None = None, *, unit: str = ""
) -> Row:
    """Return a measured figure beside its exact value and standard error, None if theory gives none.

    The score z is the distance in standard errors, None if that is not known. It is given if the law of the figure is
    far from normal, as for a small count: the value of a standard normal that is as improbable (see `normal_deviate`).
    """
    if z is None and exact is not None and error:
        z = (value - exact) / error
    return Row(name=name, value=value, unit=unit, exact=exact, error=error, z=z)


def attributes_of(figures: Iterable[Row]) -> dict[str, float]:
    """Return figures under their names, and their exact values and errors under these names with a suffix."""
    found: dict[str, float] = {}
    for each in figures:
        beside = {each.name: each.value, each.name + EXACT: each.exact, each.name + ERROR: each.error}
        found |= {name: value for name, value in beside.items() if value is not None}
    return found


def from_attributes(attributes: Mapping[str, object]) -> list[Row]:
    """Return the figures of a result file's /summary, in its order."""
    numbers = {name: float(value) for name, value in attributes.items() if isinstance(value, int | float)}
    return [
        figure(name, value, numbers.get(name + EXACT), numbers.get(name + ERROR), unit=unit_of(name))
        for name, value in numbers.items()
        if not name.endswith((EXACT, ERROR))
    ]


def normal_deviate(below: float, above: float) -> float:
    """Return the z of a unit normal with the tail of a figure: P(values <= it) is ``below``, P(values >= it) ``above``.

    The tail below 1/2 counts; if neither is below, z is 0, so a count is never called less probable than it is. Tails
    below 1e-300 count as 1e-300, |z| = 37.
    """
    from scipy.special import ndtri

    if above < 0.5:
        return -float(ndtri(max(above, 1e-300)))
    return float(ndtri(max(below, 1e-300))) if below < 0.5 else 0.0


def family_wise_bound(count: int, error: float = FAMILY_WISE_ERROR) -> float:
    """Return the bound on |z| within which ``count`` normal scores all lie with a probability of at least 1 - error.

    P(|z| > bound) = error/count for each: Bonferroni's inequality, which holds however the scores depend on each other,
    as the figures of one run do. Source: Miller, Simultaneous Statistical Inference (1981), section 1.
    """
    from scipy.special import ndtri

    return -float(ndtri(0.5 * error / max(count, 1)))

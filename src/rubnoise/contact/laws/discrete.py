"""Laws made of parts: a mixture of laws, and measured values with equal probabilities."""

from dataclasses import dataclass
from functools import lru_cache
from math import fsum
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws.fixed import Fixed
from rubnoise.contact.laws.law import Law, LawEntry
from rubnoise.streams import LARGEST_UNIFORM


@dataclass(frozen=True, slots=True, kw_only=True)
class Mixture:
    """One of several laws, each with its probability: E[x^n] = sum w_i E_i[x^n]."""

    weights: tuple[float, ...]
    laws: tuple[Law, ...]

    @property
    def parts(self) -> tuple[tuple[float, Law], ...]:
        """Each law with its probability."""
        return tuple(zip(self.weights, self.laws, strict=True))

    @property
    def mean(self) -> float:
        """E[x]."""
        return self.moment(1)

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        return fsum(weight * law.moment(power) for weight, law in self.parts)

    def density(self, value: Doubles) -> Doubles:
        """Return the density of the continuous parts."""
        return sum((weight * law.density(value) for weight, law in self.parts), np.zeros_like(value))

    @property
    def support(self) -> tuple[float, float]:
        """The least and the largest value of any part."""
        ends = [law.support for law in self.laws]
        return min(low for low, _ in ends), max(high for _, high in ends)

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform, which chooses the part and, within its share of [0, 1), the value."""
        values, below = np.empty(uniform.shape), 0.0
        for number, (weight, law) in enumerate(self.parts):
            last = number == len(self.weights) - 1
            rows = (uniform >= below) & (last | (uniform < below + weight))
            within = (uniform[rows] - below) / weight
            values[rows] = law.draw(np.clip(within, 0.0, LARGEST_UNIFORM))
            below += weight
        return values

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): a part by its share of the mean, then its value."""
        chosen, values, below = generator.random(count), np.empty(count), 0.0
        mean = self.moment(1)
        for number, (weight, law) in enumerate(self.parts):
            share = weight * law.moment(1) / mean
            rows = (chosen >= below) & ((number == len(self.weights) - 1) | (chosen < below + share))
            values[rows] = law.draw_length_biased(generator, int(np.count_nonzero(rows)))
            below += share
        return values


@dataclass(frozen=True, slots=True, kw_only=True)
class Empirical:
    """Values with their probabilities, in ascending order: E[x^n] = sum p_i x_i^n.

    Measured as they are born, values are equally likely; found alive in a snapshot, where a value is met in proportion
    to its life, each counts by 1/x. Source: length-biased sampling (Cox 1962, Renewal Theory, section 5.4).
    """

    values: tuple[float, ...]
    weights: tuple[float, ...]

    @property
    def parts(self) -> tuple[tuple[float, Law], ...]:
        """Each value as a law with its probability."""
        return tuple((weight, Fixed(value=value)) for value, weight in zip(self.values, self.weights, strict=True))

    @property
    def mean(self) -> float:
        """E[x]."""
        return self.moment(1)

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        return fsum(weight * law.moment(power) for weight, law in self.parts)

    def density(self, value: Doubles) -> Doubles:
        """Return zeros: single values have no continuous part."""
        return np.zeros_like(value)

    @property
    def support(self) -> tuple[float, float]:
        """The least and the largest value."""
        return self.values[0], self.values[-1]

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform, by its place among the sums of probabilities."""
        return self._drawn(uniform, self.weights)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with probabilities in proportion to x."""
        weights = [weight * value for value, weight in zip(self.values, self.weights, strict=True)]
        return self._drawn(generator.random(count), tuple(weights))

    def _drawn(self, uniform: Doubles, weights: tuple[float, ...]) -> Doubles:
        sums = np.add.accumulate(np.array(weights))
        index = np.searchsorted(sums / sums[-1], uniform, side="right")
        return np.array(self.values)[np.minimum(index, len(self.values) - 1)]


def parts_of(law: Law) -> tuple[tuple[float, Law], ...]:
    """Return the parts of a mixture or of measured values with their probabilities; an empty tuple for other laws."""
    return law.parts if isinstance(law, Mixture | Empirical) else ()


def has_single_values(law: Law) -> bool:
    """Whether a law has single values with a probability of their own, so that a density is not enough."""
    return isinstance(law, Fixed | Empirical) or any(has_single_values(part) for _, part in parts_of(law))


def largest_of(law: Law) -> float:
    """Return the largest value that a law, or any part of it, can draw: from the largest uniform."""
    if isinstance(law, Mixture):
        return max(largest_of(part) for part in law.laws)
    return float(law.draw(np.array([LARGEST_UNIFORM]))[0])


Part = tuple[LawEntry, float, float]
"""A part of a mixture as given: its law's entry, its mean, and its standard deviation over its mean."""


def _scale(own: dict[str, Any]) -> float:
    return fsum(weight * mean for weight, (_, mean, _) in zip(own["weights"], own["parts"], strict=True))


def _mixture(centre: float, _std: float, own: dict[str, Any]) -> Mixture:
    scaled = [(entry, centre * (mean / _scale(own)), ratio) for entry, mean, ratio in own["parts"]]
    laws = tuple(entry.make(mean, ratio * mean, {}) for entry, mean, ratio in scaled)
    return Mixture(weights=tuple(own["weights"]), laws=laws)


def _mixture_moment(centre: Any, _std: Any, own: dict[str, Any], power: int) -> Any:
    import mpmath

    total = mpmath.mpf(0)
    for weight, (entry, mean, ratio) in zip(own["weights"], own["parts"], strict=True):
        middle = centre * (mpmath.mpf(mean) / _scale(own))
        total += weight * entry.moment(middle, ratio * middle, {}, power)
    return total


@lru_cache(maxsize=16)
def _unit(values: tuple[float, ...], *, alive: bool) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return ascending values of unit mean and their probabilities, each rounded once."""
    import mpmath

    with mpmath.workdps(40):
        ordered = [mpmath.mpf(value) for value in sorted(values)]
        counts = [1 / value if alive else mpmath.mpf(1) for value in ordered]
        whole = mpmath.fsum(counts)
        mean = mpmath.fsum(value * count for value, count in zip(ordered, counts, strict=True)) / whole
        return tuple(float(value / mean) for value in ordered), tuple(float(count / whole) for count in counts)


def _empirical(centre: float, _std: float, own: dict[str, Any]) -> Empirical:
    values, weights = _unit(own["values"], alive=own["sampled"] == "alive")
    return Empirical(values=tuple(centre * value for value in values), weights=weights)


def _empirical_moment(centre: Any, _std: Any, own: dict[str, Any], power: int) -> Any:
    import mpmath

    values, weights = _unit(own["values"], alive=own["sampled"] == "alive")
    terms = (weight * (centre * mpmath.mpf(value)) ** power for value, weight in zip(values, weights, strict=True))
    return mpmath.fsum(terms)


MIXTURE_ENTRY = LawEntry(
    name="mixture",
    about="one of several laws, each with its weight",
    make=_mixture,
    moment=_mixture_moment,
    takes_spread=False,
    own_keys=("weights", "parts"),
)
EMPIRICAL_ENTRY = LawEntry(
    name="empirical",
    about="measured values, each as likely",
    make=_empirical,
    moment=_empirical_moment,
    takes_spread=False,
    own_keys=("values", "sampled", "file", "column", "hash"),
    optional=("sampled", "file", "column", "hash"),
)

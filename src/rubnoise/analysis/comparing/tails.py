"""How far from a normal law a sum over the junctions of a record is, which a few of the largest may rule."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Final, Protocol

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.streams import LARGEST_UNIFORM

LARGEST_SKEWNESS: Final = 0.35
LARGEST_KURTOSIS: Final = 0.4
"""Skewness and excess kurtosis up to which a score of 4 or 5, taken on the scale of a lognormal law, may be trusted."""

RARE: Final = 1e-5
"""Chance that a record holds a value at all beyond which values are left out: no false alarm is worth a rarer one."""

_VALUES = 400
_LONGEST = 1e15  # times the births of the record


class Drawn(Protocol):
    """A law whose values grow with the uniforms that make them."""

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Tail:
    """The skewness of a sum, and from which length in um on its law is near enough to a normal one for a score."""

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
    """Return the tail of the sum of squared distances from their mean of so many draws, made over ``length`` um."""
    return _tail([(law, lambda value: np.square(value / mean - 1.0))], births, length)


def _tail(laws: list[tuple[Drawn, Callable[[Doubles], Doubles]]], births: float, length: float) -> Tail:
    skewness, kurtosis = _shape(laws, births)
    first = skewness
    factor = 1.0
    while not (skewness <= LARGEST_SKEWNESS and kurtosis <= LARGEST_KURTOSIS):
        factor *= 1.25
        if factor > _LONGEST:
            return Tail(skewness=first, needed=inf)
        skewness, kurtosis = _shape(laws, factor * births)
    return Tail(skewness=first, needed=factor * length if factor > 1.0 else 0.0)


def _shape(laws: list[tuple[Drawn, Callable[[Doubles], Doubles]]], births: float) -> tuple[float, float]:
    """Return skewness and excess kurtosis, from as much of each law as a record of so many births is likely to show."""
    survival = np.geomspace(1.0, min(RARE / max(births, 1.0), 0.1), _VALUES)
    shares = -np.diff(survival)
    middle = 0.5 * (survival[1:] + survival[:-1])
    third = fourth = 1.0
    for law, brings in laws:
        # From the median on, so that what is brought is of order 1 whatever the unit.
        values = law.draw(np.minimum(np.concatenate([[0.5], 1.0 - middle]), LARGEST_UNIFORM))
        brought = brings(values)[1:]
        second = float(shares @ brought**2)
        third *= float(shares @ brought**3) / second**1.5
        fourth *= float(shares @ brought**4) / second**2
    return third / births**0.5, fourth / births

"""The interface of a law of a positive quantity, and its entry in the registry."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final, Protocol

import numpy as np

from rubnoise.arrays import Doubles

WIDEST: Final = 3.0
"""Standard deviation over mean up to which laws with a long tail are drawn: gamma deviates lose digits beyond it."""

# Values below this part of the mean, which a uniform of 0 or a steep law can make, become it: a junction needs an
# extent to divide by, and its square and fifth power may not vanish. No moment notices.
LEAST = 2.0**-100


class Law(Protocol):
    """A law of a positive quantity x, in whatever unit its parameters have."""

    def __hash__(self) -> int:
        """Laws of equal parameters are one: tables are kept by law."""
        ...

    @property
    def mean(self) -> float:
        """E[x]."""
        ...

    def moment(self, power: int) -> float:
        """Return E[x^n], exact for the law as it is drawn."""
        ...

    def density(self, value: Doubles) -> Doubles:
        """Return the probability density of the continuous part, in one over the unit of x."""
        ...

    @property
    def support(self) -> tuple[float, float]:
        """Values outside which less than 1e-16 of the law lies; equal ends mean a single value."""
        ...

    def draw(self, uniform: Doubles) -> Doubles:
        """Return one value for each uniform on [0, 1)."""
        ...

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return values with density proportional to x f(x): diameters of junctions alive at a random place."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A parameter of a law, which has its own key beside `law`: its bounds and an ordinary value."""

    name: str
    about: str
    low: float
    high: float
    sample: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LawEntry:
    """A law of the registry: its name in scenarios, what a page says of it, the keys it takes, and how it is made.

    ``make`` takes centre, standard deviation and the law's own parameters and returns the law; ``moment`` returns
    E[x^n] of the same with mpmath numbers. Parameters named in ``ascending`` have to grow in this order.
    ``with_spread`` names the law to advise if this one is given a spread. A law with ``own_keys``, lists that are no
    parameters, is for diameters alone; those in ``optional`` may be left out.
    """

    name: str
    about: str
    make: Callable[[float, float, dict[str, Any]], Law]
    moment: Callable[[Any, Any, dict[str, Any], int], Any]
    parameters: tuple[Parameter, ...] = ()
    ascending: tuple[str, ...] = ()
    takes_spread: bool = True
    widest: float = WIDEST
    with_spread: str = ""
    own_keys: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()


@lru_cache(maxsize=256)
def rounded_moment(moment: Callable[[Any, Any, int], Any], mean: float, std: float, power: int) -> float:
    """Return a moment of a law with a mean and a standard deviation, at 60 digits rounded once."""
    import mpmath

    with mpmath.workdps(60):
        return float(moment(mpmath.mpf(mean), mpmath.mpf(std), power))

"""One value for all junctions."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws.law import LawEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixed:
    """One value for every junction; E[x^n] = x^n."""

    value: float

    @property
    def mean(self) -> float:
        """The value."""
        return self.value

    def moment(self, power: int) -> float:
        """Return E[x^n], rounded once: a library's pow changes bits between processors."""
        return float(Fraction(self.value) ** power)

    def density(self, value: Doubles) -> Doubles:
        """Return zeros: a single value has no continuous part."""
        return np.zeros_like(value)

    @property
    def support(self) -> tuple[float, float]:
        """The value, twice."""
        return self.value, self.value

    def draw(self, uniform: Doubles) -> Doubles:
        """Return the value for each uniform."""
        return np.full(uniform.shape, self.value)

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        """Return the value ``count`` times: one size is not biased by its length."""
        del generator
        return np.full(count, self.value)


ENTRY = LawEntry(
    name="fixed",
    about="one value",
    make=lambda centre, _std, _own: Fixed(value=centre),
    moment=lambda centre, _std, _own, n: centre**n,
    takes_spread=False,
    with_spread="normal",
)

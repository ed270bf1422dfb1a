"""From a mean diameter and how sizes spread about it to their law."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from rubnoise.contact.sizes import FixedSizes, NormalSizes, SizeLaw
from rubnoise.contact.sizes_gamma import ExponentialSizes, GammaSizes
from rubnoise.contact.sizes_lognormal import LognormalSizes

SizeLawName = Literal["normal", "lognormal", "exponential", "gamma"]

WIDEST = 3.0
"""Standard deviation over mean that laws with a long tail are made for: gamma deviates lose digits beyond it."""

_LAWS: dict[str, Callable[..., SizeLaw]] = {"normal": NormalSizes, "lognormal": LognormalSizes, "gamma": GammaSizes}


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Standard deviation of a size law: a length in um, or a fraction of the mean diameter; neither is one size.

    Of the normal law it is that before drawing again. The exponential law has none of its own: it spreads by its mean.
    """

    absolute: float | None = None
    relative: float | None = None
    law: SizeLawName = "normal"

    @property
    def fraction(self) -> float | None:
        """The standard deviation as a fraction of the mean diameter, where it is one."""
        return 1.0 if self.law == "exponential" else self.relative

    def std(self, mean_diameter: float) -> float:
        """Return the standard deviation in um for a mean diameter in um."""
        if self.fraction is not None:
            return self.fraction * mean_diameter
        return self.absolute or 0.0


def sizes_for(mean_diameter: float, spread: Spread) -> SizeLaw:
    """Return the size law of a mean diameter and a spread; no spread is one size."""
    if spread.law == "exponential":
        return ExponentialSizes(mean=mean_diameter)
    std = spread.std(mean_diameter)
    return _LAWS[spread.law](mean=mean_diameter, std=std) if std > 0.0 else FixedSizes(diameter=mean_diameter)

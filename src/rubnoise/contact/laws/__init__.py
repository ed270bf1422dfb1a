"""The laws of positive quantities: how large junctions are, in um, and how strong, in MPa.

Each law is a file with its class and its entry for the registry `LAWS`, from which scenario keys, calibration, schema
and docs read. A value is drawn from one uniform by inversion, in operations that round the same on every processor.
To add a law, write its file, name its entry below, and give tests/unit/test_laws.py its cases and its textbook. The
calibration `matched` needs E[x^3]/centre to be least, for unit spread, where contact/calibration.py looks.
"""

from dataclasses import dataclass
from typing import Any, Final

from rubnoise.contact.laws import discrete, fixed, gamma, lognormal, normal, power, weibull
from rubnoise.contact.laws.discrete import Empirical, Mixture
from rubnoise.contact.laws.fixed import Fixed
from rubnoise.contact.laws.gamma import Exponential, Gamma
from rubnoise.contact.laws.law import Law, LawEntry, Parameter
from rubnoise.contact.laws.lognormal import Lognormal
from rubnoise.contact.laws.normal import Normal
from rubnoise.contact.laws.power import Power
from rubnoise.contact.laws.weibull import Weibull

__all__ = [
    "LAWS",
    "Empirical",
    "Exponential",
    "Fixed",
    "Gamma",
    "Law",
    "LawEntry",
    "Lognormal",
    "Mixture",
    "Normal",
    "Parameter",
    "Power",
    "Spread",
    "Weibull",
    "law_for",
]

LAWS: Final[dict[str, LawEntry]] = {
    entry.name: entry
    for entry in (
        fixed.ENTRY,
        normal.ENTRY,
        lognormal.ENTRY,
        gamma.EXPONENTIAL_ENTRY,
        gamma.GAMMA_ENTRY,
        weibull.ENTRY,
        power.ENTRY,
        discrete.MIXTURE_ENTRY,
        discrete.EMPIRICAL_ENTRY,
    )
}
"""Every law by its name in a scenario."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """The law of a quantity about its centre, and its spread: all that a scenario says but the centre.

    The standard deviation is absolute, in the unit of the centre, or ``relative``, a part of it; neither is one value.
    Of the normal law it is that before drawing again. ``parameters`` are the law's own, by name.
    """

    absolute: float | None = None
    relative: float | None = None
    law: str = "normal"
    parameters: tuple[tuple[str, Any], ...] = ()

    @property
    def entry(self) -> LawEntry:
        """The law's entry in the registry; that of `fixed` if there is no spread."""
        entry = LAWS[self.law]
        return entry if self.absolute or self.relative or not entry.takes_spread else LAWS["fixed"]

    def std(self, centre: float) -> float:
        """Return the standard deviation about a centre as given; 0 if the law takes none."""
        return self.relative * centre if self.relative is not None else self.absolute or 0.0

    def moment(self, centre: Any, power: int) -> Any:
        """Return E[x^n] about a centre, mpmath numbers in and out, at the working precision."""
        import mpmath

        std = mpmath.mpf(self.absolute) if self.absolute else mpmath.mpf(self.relative or 0) * centre
        return self.entry.moment(centre, std, dict(self.parameters), power)


def law_for(centre: float, spread: Spread) -> Law:
    """Return the law of a quantity about a centre: a diameter's about d_m in um, a strength's about psi in MPa."""
    return spread.entry.make(centre, spread.std(centre), dict(spread.parameters))

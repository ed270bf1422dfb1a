"""What a comparison of a run with the theory finds: figures with scores, identities, and what had to be left out."""

from collections.abc import Iterable
from dataclasses import dataclass

from rubnoise.analysis.agreement import Agreement, family_wise_bound, outside


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """Something that holds in every right run but for rounding: how far it is off at most, and how far it may be.

    Both in ``units``.
    """

    name: str
    deviation: float
    allowed: float
    units: str

    @property
    def holds(self) -> bool:
        """Whether the deviation is what rounding explains."""
        return self.deviation <= self.allowed


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOut:
    """Figures that a run cannot be held against, and why."""

    name: str
    reason: str


Finding = Agreement | Identity | LeftOut


@dataclass(frozen=True, slots=True, kw_only=True)
class Findings:
    """What was found about one part of a run, under a heading; its record ``begins`` at a distance in um."""

    heading: str
    found: tuple[Finding, ...]
    begins: float = 0.0

    @property
    def figures(self) -> list[Agreement]:
        """The figures with scores."""
        return [each for each in self.found if isinstance(each, Agreement)]

    @property
    def identities(self) -> list[Identity]:
        """What must hold to rounding."""
        return [each for each in self.found if isinstance(each, Identity)]

    @property
    def left_out(self) -> list[LeftOut]:
        """What could not be compared."""
        return [each for each in self.found if isinstance(each, LeftOut)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A run compared with the theory of its scenario, part by part.

    ``bound`` is the largest |z| that a right run may have; ``by_family`` says that it is the one which all figures keep
    together, and not one that was asked for.
    """

    parts: tuple[Findings, ...]
    bound: float
    by_family: bool

    @property
    def figures(self) -> list[Agreement]:
        """Every figure with a score."""
        return [figure for part in self.parts for figure in part.figures]

    @property
    def identities(self) -> list[Identity]:
        """Every identity."""
        return [identity for part in self.parts for identity in part.identities]

    @property
    def left_out(self) -> list[LeftOut]:
        """Everything that could not be compared."""
        return [each for part in self.parts for each in part.left_out]

    @property
    def outside(self) -> list[str]:
        """Names of what is outside: figures beyond the bound, and identities that do not hold."""
        broken = [identity.name for identity in self.identities if not identity.holds]
        return [figure.name for figure in outside(self.figures, self.bound)] + broken


def comparison(parts: Iterable[Findings], bound: float | None = None) -> Comparison:
    """Return the parts that hold anything, with a bound: the family-wise one of all their figures if none is given."""
    kept = tuple(part for part in parts if part.found)
    if bound is not None:
        return Comparison(parts=kept, bound=bound, by_family=False)
    scored = sum(figure.z is not None for part in kept for figure in part.figures)
    return Comparison(parts=kept, bound=family_wise_bound(scored), by_family=True)

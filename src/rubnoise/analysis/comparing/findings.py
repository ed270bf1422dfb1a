"""What a comparison of a run with the theory finds: figures with scores, identities, and what is left out.

A number and its standard error become a figure that is judged, or a reason why it is not.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import isfinite, log1p

from rubnoise.analysis.agreement import Agreement, family_wise_bound, normal_deviate, outside
from rubnoise.analysis.comparing.tails import NORMAL, Tail
from rubnoise.analysis.records import longer


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
) -> Finding:
    """Return a figure with its score, or, where its error exceeds a tenth of its ``scale``, what length it needs.

    The scale is the expected value where none is given; ``length`` (um) is that of the record. Estimates of squares
    have a longer tail upwards, of a skewness that is ``skewness`` times the error over the scale; so has a sum that
    its largest junctions rule, and its ``tail`` may need a longer record, too. The larger skewness counts.
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


def judged_mean(name: str, observed: float, expected: float, error: float, *, length: float, tail: Tail) -> Finding:
    """Return a figure with its score, or, where its ``tail`` is too heavy for one, what length it needs.

    On the side of the longer tail, above the expected value for a skewness g > 0 and below it for g < 0, the score is
    (3/g) log(1 + g z/3), that of a lognormal law of the tail's skewness g.
    """
    if tail.needed > length:
        return too_short(name, tail.needed)
    z = (observed - expected) / error if error else None
    if z is not None and z * tail.skewness > 0.0:
        third = tail.skewness / 3.0
        z = log1p(third * z) / third
    return Agreement(name=name, observed=observed, expected=expected, standard_error=error, deviate=z)


def too_short(name: str, needed: float) -> LeftOut:
    """Return that a run is too short for a figure, and how long it should be in um."""
    told = f"it needs about {needed:.3g} um" if isfinite(needed) else "no length would do"
    return LeftOut(name=name, reason=f"the run is too short; {told}")


def poisson_figure(name: str, observed: int, mean: float) -> Agreement:
    """Return a count beside the mean of its Poisson law, its score that of its own tail probability."""
    from scipy.special import pdtr, pdtrc

    deviate = None
    if mean < _MANY:
        above = float(pdtrc(observed - 1, mean)) if observed else 1.0
        deviate = normal_deviate(float(pdtr(observed, mean)), above)
    return Agreement(name=name, observed=float(observed), expected=mean, standard_error=mean**0.5, deviate=deviate)

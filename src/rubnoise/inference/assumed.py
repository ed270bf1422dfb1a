"""What a trace cannot tell of its junctions and is taken for granted: said with every answer."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from rubnoise.inference.estimates import Estimate
from rubnoise.inference.scoring import Known

SPREADS: Final = (0.0, 0.25, 0.5, 1.0)
"""Relative spreads of strengths for which number and strength are told beside the assumed one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumed:
    """What is taken for granted: ``strength_spread`` is the standard deviation over the mean of lognormal strengths."""

    strength_spread: float = 0.0

    @property
    def inequality(self) -> float:
        """E[psi^2] / E[psi]^2 = 1 + v, v the squared relative spread."""
        return 1.0 + self.strength_spread**2


NOTHING: Final = Assumed()
"""Equal strengths."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IfSpread:
    """Number and strength (where it is told, in MPa) if strengths had another relative spread."""

    strength_spread: float
    junction_count: float
    shear_strength: float | None


def moves_with_spread(known: Known) -> bool:
    """Return whether a number is told that leans on the spread of strengths, which is not told itself."""
    return "inequality" not in known.free and known.free != ("strength",)


def by_spread(estimates: Mapping[str, Estimate], known: Known) -> tuple[IfSpread, ...]:
    """Return how number and strength move with the spread of strengths; nothing where they do not lean on it.

    Mean and spectrum give A = lam E[psi] and B = lam E[psi^2]: the strength is B / (A (1 + v)), the number goes as
    A^2 (1 + v) / B. With a known strength and no mean the number goes as B / (psi^2 (1 + v)).
    """
    if not moves_with_spread(known) or "junction_count" not in estimates:
        return ()
    strength = estimates.get("shear_strength")
    found = []
    for spread in SPREADS:
        more = (1.0 + spread**2) / known.inequality
        count = estimates["junction_count"].value
        found.append(
            IfSpread(
                strength_spread=spread,
                junction_count=count * more if known.mean is not None else count / more,
                shear_strength=None if strength is None else strength.value / more,
            )
        )
    return tuple(found)


def sentences(assumed: Assumed, known: Known, *, is_area: bool) -> tuple[str, ...]:
    """Return what the answer takes for granted, a sentence each."""
    said = []
    if moves_with_spread(known) and not is_area:
        said.append(
            f"strengths are taken for lognormal with a spread of {100.0 * assumed.strength_spread:.3g} % of their mean"
            if assumed.strength_spread
            else "junctions are taken for equally strong (--strength-spread gives another spread)"
        )
    return tuple(said)

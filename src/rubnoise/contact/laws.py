"""The laws of sizes and strengths by their names in a scenario, and what a scenario says of one.

Scenario keys, calibration, schema and docs read `LAWS`. A new law also needs its cases and its textbook in
tests/unit/test_laws.py; the calibration `matched` needs E[x^3]/centre to be least, for unit spread, where
`contact.calibration` looks.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import fsum, inf
from typing import Any, Final

import numpy as np

from rubnoise.contact.distributions import (
    Fixed,
    Gamma,
    Law,
    Lognormal,
    Mixture,
    Normal,
    Power,
    Weibull,
)

WIDEST: Final = 3.0
"""Standard deviation over mean up to which laws with a long tail are drawn: their moments need ever longer runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A parameter of a law, which has its own key beside `law`: its bounds, if here, and an ordinary value."""

    name: str
    about: str
    sample: Any
    low: float = -inf
    high: float = inf


@dataclass(frozen=True, slots=True)
class LawEntry:
    """A law of a registry: its name in scenarios, what a page says of it, how it is made, and the keys it takes.

    ``make`` takes centre, standard deviation and the law's own parameters and returns the law. Parameters named in
    ``ascending`` have to grow in this order. ``with_spread`` names the law to advise if this one is given a spread. A
    law with ``own_keys``, lists that are no parameters, is for diameters alone; those in ``optional`` may be left out.
    """

    name: str
    about: str
    make: Callable[..., Any]
    parameters: tuple[Parameter, ...] = ()
    ascending: tuple[str, ...] = ()
    takes_spread: bool = True
    widest: float = WIDEST
    with_spread: str = ""
    own_keys: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()


def _mixture(centre: float, _std: float, own: dict[str, Any]) -> Mixture:
    """Return a mixture of the mean ``centre``; each part is an entry, its mean, and its deviation over its mean."""
    scale = centre / fsum(weight * mean for weight, (_, mean, _) in zip(own["weights"], own["parts"], strict=True))
    laws = tuple(entry.make(scale * mean, ratio * scale * mean, {}) for entry, mean, ratio in own["parts"])
    return Mixture(weights=tuple(own["weights"]), laws=laws)


def _empirical(centre: float, _std: float, own: dict[str, Any]) -> Mixture:
    """Return measured values, scaled to the mean ``centre``.

    Measured as they are born, values are equally likely; found alive in a snapshot, where a value is met in proportion
    to its life, each counts by 1/x. Source: length-biased sampling (Cox 1962, Renewal Theory, section 5.4).
    """
    values = np.sort(np.array(own["values"], dtype=np.float64))
    weights = 1.0 / values if own["sampled"] == "alive" else np.ones(values.size)
    weights /= fsum(weights)
    values *= centre / fsum(weights * values)
    return Mixture(weights=tuple(weights.tolist()), laws=tuple(Fixed(value=each) for each in values.tolist()))


_ENTRIES: Final = (
    LawEntry(
        "fixed", "one value", lambda centre, _std, _own: Fixed(value=centre), takes_spread=False, with_spread="normal"
    ),
    LawEntry(
        "normal", "redrawn while not positive", lambda centre, std, _own: Normal(centre=centre, std=std), widest=inf
    ),
    LawEntry("lognormal", "a normal logarithm", lambda centre, std, _own: Lognormal(mean=centre, std=std)),
    LawEntry(
        "exponential",
        "a standard deviation equal to the mean",
        lambda centre, _std, _own: Weibull(mean=centre, std=centre),
        takes_spread=False,
        with_spread="gamma",
    ),
    LawEntry("gamma", "an exponential tail", lambda centre, std, _own: Gamma(mean=centre, std=std)),
    LawEntry("weibull", "the weakest of many parts", lambda centre, std, _own: Weibull(mean=centre, std=std)),
    LawEntry(
        "power",
        "density ~ x^-exponent between smallest and largest",
        lambda centre, _std, own: Power(
            exponent=own["exponent"], smallest=own["smallest"] * centre, largest=own["largest"] * centre
        ),
        (
            Parameter(name="exponent", about="Fall of the density ~ x^-exponent", low=-10.0, high=10.0, sample=2.5),
            Parameter(name="smallest", about="Smallest value over {centre}", low=1e-3, high=1e3, sample=0.5),
            Parameter(name="largest", about="Largest value over {centre}", low=1e-3, high=1e3, sample=4.0),
        ),
        ascending=("smallest", "largest"),
        takes_spread=False,
        with_spread="lognormal",
    ),
    LawEntry(
        "mixture",
        "one of several laws, each with its weight",
        _mixture,
        takes_spread=False,
        own_keys=("weights", "parts"),
    ),
    LawEntry(
        "empirical",
        "measured values, each as likely",
        _empirical,
        takes_spread=False,
        own_keys=("values", "sampled", "file", "column", "hash"),
        optional=("sampled", "file", "column", "hash"),
    ),
)

LAWS: Final[dict[str, LawEntry]] = {entry.name: entry for entry in _ENTRIES}  # every law by its name in a scenario


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


def law_for(centre: float, spread: Spread) -> Law:
    """Return the law of a quantity about a centre: a diameter's about d_m in um, a strength's about psi in MPa."""
    law: Law = spread.entry.make(centre, spread.std(centre), dict(spread.parameters))
    return law

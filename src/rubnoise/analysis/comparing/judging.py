"""From a number and its standard error to a figure that a run can be held against, or to the length that it needs."""

from math import isfinite, log1p

from rubnoise.analysis.agreement import Agreement, normal_deviate
from rubnoise.analysis.comparing.findings import Finding, LeftOut
from rubnoise.analysis.comparing.tails import NORMAL, Tail
from rubnoise.analysis.records import longer

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

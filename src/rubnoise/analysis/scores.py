"""Scores of figures: how far a measured value is from the exact one, in standard errors, and what bounds them."""

from collections.abc import Iterable, Mapping

from rubnoise.answer import Row
from rubnoise.figure_names import unit_of

EXACT, ERROR = "_exact", "_standard_error"

FAMILY_WISE_ERROR = 1e-3
"""Probability that any figure at all of a right run lies outside of the family-wise bound."""


def figure(name: str, value: float, exact: float | None, error: float | None, z: float | None = None) -> Row:
    """Return a measured figure beside its exact value and standard error, None if theory gives none.

    The score z is the distance in standard errors, None if that is not known. It is given if the law of the figure is
    far from normal, as for a small count: the value of a standard normal that is as improbable (see `normal_deviate`).
    """
    if z is None and exact is not None and error:
        z = (value - exact) / error
    return Row(name=name, value=value, unit=unit_of(name), exact=exact, error=error, z=z)


def attributes_of(figures: Iterable[Row]) -> dict[str, float]:
    """Return figures under their names, and their exact values and errors under these names with a suffix."""
    found: dict[str, float] = {}
    for each in figures:
        beside = {each.name: each.value, each.name + EXACT: each.exact, each.name + ERROR: each.error}
        found |= {name: value for name, value in beside.items() if value is not None}
    return found


def from_attributes(attributes: Mapping[str, object]) -> list[Row]:
    """Return the figures of a result file's /summary, in its order."""
    numbers = {name: float(value) for name, value in attributes.items() if isinstance(value, int | float)}
    return [
        figure(name, value, numbers.get(name + EXACT), numbers.get(name + ERROR))
        for name, value in numbers.items()
        if not name.endswith((EXACT, ERROR))
    ]


def normal_deviate(below: float, above: float) -> float:
    """Return the z of a unit normal with the tail of a figure: P(values <= it) is ``below``, P(values >= it) ``above``.

    The tail below 1/2 counts; if neither is below, z is 0, so a count is never called less probable than it is. Tails
    below 1e-300 count as 1e-300, |z| = 37.
    """
    from scipy.special import ndtri

    if above < 0.5:
        return -float(ndtri(max(above, 1e-300)))
    return float(ndtri(max(below, 1e-300))) if below < 0.5 else 0.0


def family_wise_bound(count: int, error: float = FAMILY_WISE_ERROR) -> float:
    """Return the bound on |z| within which ``count`` normal scores all lie with a probability of at least 1 - error.

    P(|z| > bound) = error/count for each: Bonferroni's inequality, which holds however the scores depend on each other,
    as the figures of one run do. Source: Miller, Simultaneous Statistical Inference (1981), section 1.
    """
    from scipy.special import ndtri

    return -float(ndtri(0.5 * error / max(count, 1)))

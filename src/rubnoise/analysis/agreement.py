"""Measured figures of a run beside their expected values and standard errors from theory."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from rubnoise.answer import Row
from rubnoise.figure_names import unit_of

EXACT, ERROR = "_exact", "_standard_error"

FAMILY_WISE_ERROR = 1e-3
"""Probability that any figure at all of a right run lies outside of the family-wise bound."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """One measured figure of a run; ``expected`` and ``standard_error`` are None if theory gives none.

    ``deviate`` is given if the law of the figure is known and far from normal, as for a small count: the value of a
    standard normal that is as improbable as the figure (see `normal_deviate`).

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     first = run.summary[0]
    >>> first.name, first.z is not None and abs(first.z) < 4.0
    ('real_contact_area_mean', True)
    """

    name: str
    observed: float
    expected: float | None
    standard_error: float | None
    deviate: float | None = None

    @property
    def z(self) -> float | None:
        """Distance from the expected value in standard errors, or the deviate; None if it is not known."""
        if self.deviate is not None:
            return self.deviate
        if self.expected is None or not self.standard_error:
            return None
        return (self.observed - self.expected) / self.standard_error

    def row(self, part: str, *, fails: bool = False) -> Row:
        """Return the figure as a row of an answer."""
        return Row(
            part=part,
            name=self.name,
            value=self.observed,
            unit=unit_of(self.name),
            exact=self.expected,
            error=self.standard_error,
            z=self.z,
            fails=fails,
        )

    def as_attributes(self) -> dict[str, float]:
        """Return the figure under its name, and its expected value, error and deviate under its name with a suffix."""
        beside = {EXACT: self.expected, ERROR: self.standard_error}
        return {self.name: self.observed} | {
            self.name + end: value for end, value in beside.items() if value is not None
        }


def from_attributes(attributes: Mapping[str, object]) -> list[Agreement]:
    """Return the figures of a result file's /summary, in its order."""
    numbers = {name: float(value) for name, value in attributes.items() if isinstance(value, int | float)}
    return [
        Agreement(
            name=name,
            observed=value,
            expected=numbers.get(name + EXACT),
            standard_error=numbers.get(name + ERROR),
        )
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


def outside(figures: Iterable[Agreement], bound: float) -> list[Agreement]:
    """Return the figures whose |z| exceeds a bound; figures without a z are never outside."""
    return [figure for figure in figures if figure.z is not None and not abs(figure.z) <= bound]

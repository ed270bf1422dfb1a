"""What a run measured, beside what it should have: one line each, with the standard error the theory gives it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

EXACT, ERROR = "_exact", "_standard_error"


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """One measured figure of a run; expected and standard_error are None where the theory promises nothing."""

    name: str
    observed: float
    expected: float | None
    standard_error: float | None

    @property
    def z(self) -> float | None:
        """Distance from the expected value in standard errors; None where it cannot be told."""
        if self.expected is None or not self.standard_error:
            return None
        return (self.observed - self.expected) / self.standard_error

    def as_attributes(self) -> dict[str, float]:
        """Return the figure under its name, and what is known beside it under its name and a suffix."""
        beside = {EXACT: self.expected, ERROR: self.standard_error}
        return {self.name: self.observed} | {
            self.name + end: value for end, value in beside.items() if value is not None
        }


def from_attributes(attributes: Mapping[str, object]) -> list[Agreement]:
    """Return the figures that a result file keeps in /summary, in its order."""
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


def as_json(figures: Iterable[Agreement]) -> dict[str, dict[str, float | None]]:
    """Return figures by name as plain objects, z-score included."""
    return {
        figure.name: {
            "observed": figure.observed,
            "expected": figure.expected,
            "standard_error": figure.standard_error,
            "z": figure.z,
        }
        for figure in figures
    }

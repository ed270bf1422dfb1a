"""The keys of the table `[sweep]`, which a scenario file has if it stands for many runs."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, fsum, inf, isfinite, sqrt
from typing import Final, Literal

from rubnoise.figure_names import QUANTITIES
from rubnoise.scenario.fields import Choice, Number, Range, Section, key

SWEEP: Final = "sweep"
"""The table of many runs, which is read apart: a scenario is one run."""

SWEEP_RUNS: Final = 100_000
FEWEST: Final = 8
"""Runs from which their scatter says how precise their mean is: to some 27 %, 1/sqrt(2 (n - 1))."""

Keep = Literal["runs", "summary"]

_SPARE: Final = 1.1
_AT_LEAST: Final = 0.125


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweeping(Section):
    """Many runs from one file; `[sweep.grid]` and `[sweep.zip]` list the values that vary.

    keep: runs: a result file for each run; summary: only its figures and curves, without traces.
    precision: Target for the relative standard error of the quantity's mean; runs are added to meet it.
    quantity: The figure of a run that must reach this precision.
    most_replicates: Most runs of a point, even if it does not reach the precision.
    """

    replicates: int = key(
        Number(Range(1, SWEEP_RUNS), whole=True),
        1,
        about=f"Runs of each point, each with its own seed; with a precision, the first runs, {FEWEST} or more.",
    )
    keep: Keep = key(Choice(("runs", "summary")), "runs")  # noqa: RUF009
    precision: float | None = key(Number(Range(1e-6, 1.0)), sample=0.005)
    quantity: str = key(Choice(tuple(QUANTITIES)), "real_contact_area_std")
    most_replicates: int = key(Number(Range(FEWEST, SWEEP_RUNS), whole=True), 1000)

    @property
    def largest(self) -> int:
        """Largest number of runs of a point."""
        return self.replicates if self.precision is None else self.most_replicates

    def reached(self, values: Sequence[float]) -> float:
        """Return s / (sqrt(n) |mean|) of replicates without nan, s being their standard deviation.

        It is inf for fewer than two, and 0 for equal values.
        """
        finite = [value for value in values if isfinite(value)]
        if len(finite) < 2:
            return inf
        mean = fsum(finite) / len(finite)
        error = sqrt(fsum((value - mean) ** 2 for value in finite) / (len(finite) * (len(finite) - 1)))
        if error == 0.0:
            return 0.0
        return error / abs(mean) if mean else inf

    def wanted(self, values: Sequence[float]) -> int:
        """Return how many replicates a point should have, from its present ones; not more if it has its precision.

        At most twice as many at a time, since the scatter of few replicates is uncertain.
        """
        have, reached = len(values), self.reached(values)
        if self.precision is None or reached <= self.precision or have >= self.most_replicates:
            return have
        needed = min(2.0, _SPARE * (reached / self.precision) ** 2)
        return min(self.most_replicates, ceil(have * max(needed, 1.0 + _AT_LEAST)))
